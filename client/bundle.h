/*
 * What an upload of a scene must carry: the main files, in order, and every file they refer to
 * (BSDFs, !xform files). The core's own parser finds the references, so that nothing is forgotten
 * and a mistake in the scene is reported before a byte is sent. So are what a goniophotometer
 * wrote, and mistakes in that.
 *
 * Names travel as the scene's texts spell them, because that is how the daemon will look them up;
 * names that leave the folder ("../", "/") cannot travel and are refused.
 */
#ifndef ORL_CLIENT_BUNDLE_H
#define ORL_CLIENT_BUNDLE_H

#include <stddef.h>

#include "http.h"

struct orl_upload {
    struct orl_upload_part *parts; /* owned, with their strings; main files first */
    size_t n_parts, room;
};

/* Collects the files below folder. */
int orl_bundle_collect(const char *folder, const char *const *main_files, size_t n_files,
                       struct orl_upload *ret_bundle, struct orl_error *err);

/* The names of a folder's main files (orl_scene_guess_main), sorted; *ret_names and what is in it
 * are owned. */
int orl_bundle_main_files(const char *folder, char ***ret_names, size_t *ret_count,
                          struct orl_error *err);
void orl_bundle_names_free(char **names, size_t count); /* NULL is fine */

/* Adds a file that the scene does not mention but a job does: a weather file. */
int orl_bundle_add(struct orl_upload *bundle, const char *folder, const char *name,
                   struct orl_error *err);
/* Adds what these files refer to, read after each other, and not they themselves. */
int orl_bundle_add_referenced(struct orl_upload *bundle, const char *folder,
                              const char *const *names, size_t count, struct orl_error *err);
void orl_bundle_done(struct orl_upload *bundle); /* NULL and half-filled are fine */

/* Uploads it, unless the daemon has it; says on stderr which. *ret_id is owned (free()). */
int orl_bundle_upload(const struct orl_upload *bundle, struct orl_http *http, char **ret_id,
                      struct orl_error *err);

#endif
