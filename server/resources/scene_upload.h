/*
 * A scene on its way in: taken apart, named by its content, checked, kept. What reads what was sent
 * does so in children (checks/). Pool threads, one at a time; the rows are handle_scenes.c's.
 */
#ifndef ORL_SERVER_RESOURCES_SCENE_UPLOAD_H
#define ORL_SERVER_RESOURCES_SCENE_UPLOAD_H

#include <jansson.h>
#include <microhttpd.h>

#include "checks/ask.h"

struct orl_scene_upload {
    struct orl_bundle bundle; /* files still in tmp/ are removed by done */
    char id[ORL_SHA_HEX];
    char *mains;   /* names of the main files, in order, a line each; NULL: as each form has it */
    char *summary; /* JSON text, once checked */
};

void orl_scene_upload_done(struct orl_scene_upload *upload);

/* One more main file. The names given are the only ones then, of whatever form. */
int orl_scene_upload_add_main(struct orl_scene_upload *upload, const char *names,
                              struct orl_error *err);

/* From multipart/form-data; zips among its parts are unpacked after all others. */
int orl_scene_upload_multipart(struct orl_scene_upload *upload, struct MHD_Connection *connection,
                               const struct orl_file *body, const struct orl_folders *folders,
                               struct orl_asking *asking, struct orl_error *err);
/* From the file of a document (checks/scene_document.h). */
int orl_scene_upload_json(struct orl_scene_upload *upload, const char *path,
                          const struct orl_folders *folders, struct orl_asking *asking,
                          struct orl_error *err);
/* From a zip of its folder (unzip.h). */
int orl_scene_upload_zip(struct orl_scene_upload *upload, const char *path,
                         const struct orl_folders *folders, struct orl_asking *asking,
                         struct orl_error *err);

/* Has the whole scene parsed as a job would; fills summary. */
int orl_scene_upload_check(struct orl_scene_upload *upload, struct orl_asking *asking,
                           struct orl_error *err);
/* Moves the files to their places among the blobs. */
int orl_scene_upload_keep(struct orl_scene_upload *upload, const struct orl_folders *folders,
                          struct orl_error *err);

#endif
