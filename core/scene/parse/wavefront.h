/*
 * Wavefront OBJ: its polygonal faces, with the names they were given. Lines, points and curved
 * surfaces are counted and passed over, as are materials of .mtl files: a name of usemtl is that of
 * a modifier. Lengths and axes are the file's own. Reference: Wavefront, "Object Files (.obj)",
 * appendix B1 of the Advanced Visualizer's manual.
 */
#ifndef ORL_SCENE_PARSE_WAVEFRONT_H
#define ORL_SCENE_PARSE_WAVEFRONT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <oriel/vec.h>

#include <oriel/error.h>

enum { ORL_WAVEFRONT_NAME = 128, ORL_WAVEFRONT_GROUPS = 16 };

struct orl_wavefront_face {
    const struct orl_vec3 *corners;
    const struct orl_vec3 *normals; /* of the corners, of any length; NULL: some have none */
    size_t n_corners;               /* three at least */
    uint64_t number;                /* from 1 */
    int line;                       /* 1-based */
    /* "": none was given. Of several groups the first are kept. */
    char material[ORL_WAVEFRONT_NAME], map[ORL_WAVEFRONT_NAME], object[ORL_WAVEFRONT_NAME];
    char groups[ORL_WAVEFRONT_GROUPS][ORL_WAVEFRONT_NAME];
    size_t n_groups;
};

struct orl_wavefront_sink {
    int (*add)(void *ctx, const struct orl_wavefront_face *face, struct orl_error *err);
    void *ctx;
};

/* What was passed over. */
struct orl_wavefront_rest {
    uint64_t lines, curved; /* points and lines; curves and curved surfaces */
};

/* Does the text begin as an OBJ file does, and as no Radiance scene does? */
bool orl_wavefront_is(const char *text, size_t size);

/* ORL_ERR_SYNTAX with file and line; or what the sink says, which ends it. file is for messages. */
int orl_wavefront_read(const char *file, const char *text, size_t size,
                       const struct orl_wavefront_sink *sink, struct orl_wavefront_rest *ret_rest,
                       struct orl_error *err);

#endif
