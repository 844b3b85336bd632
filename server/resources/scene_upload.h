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
    json_t *choice; /* of a project: {"states", "sky"}; NULL: nothing is chosen */
    bool listed;    /* the summary is to tell what the project holds */
    bool guessed;   /* nobody has said which files are main ones (main_files.h) */
    char *mains;    /* names of the main files, in order, a line each; NULL: as each form has it */
    char *summary;  /* JSON text, once checked */
};

void orl_scene_upload_done(struct orl_scene_upload *upload);

/* One more main file. The names given are the only ones then, of whatever form. */
int orl_scene_upload_add_main(struct orl_scene_upload *upload, const char *names,
                              struct orl_error *err);

/* Of a project: "GROUP=STATE", and the name of a sky. */
int orl_scene_upload_choose_state(struct orl_scene_upload *upload, const char *choice,
                                  struct orl_error *err);
int orl_scene_upload_choose_sky(struct orl_scene_upload *upload, const char *name,
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
