/* Files in memory as Assimp opens them: it sees those it is given, and no others. */
#ifndef ORL_SCENE_PARSE_GLTF_FILE_H
#define ORL_SCENE_PARSE_GLTF_FILE_H

#include <assimp/cfileio.h>

#include "scene/parse/gltf.h"

struct orl_gltf_files {
    const char *name; /* of the file that is read; its buffers have other names */
    struct orl_file file;
    const struct orl_gltf_buffers *buffers;
    int code; /* why a buffer could not be opened, with err; 0: all were */
    struct orl_error err;
};

/* files stays where it is for as long as the result is used. */
struct aiFileIO orl_gltf_file_io(struct orl_gltf_files *files);

#endif
