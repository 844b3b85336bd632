/*
 * Unpacks a zip of a scene's folder into files of an upload.
 *
 * Names are those in the archive. If all files are in one top-level folder, its name is removed.
 * The exception is the "model" folder of a project, whose files refer to each other by that name
 * (project/project.h). Files that desktops add (__MACOSX, .DS_Store, Thumbs.db, desktop.ini) are
 * skipped. main_files.h determines the main files and their order.
 *
 * Refused, with the entry's name: names not allowed in a bundle (absolute, with "..", not UTF-8),
 * duplicate names, links and devices, encrypted entries, methods other than deflate, damage. Also
 * archives of more entries, files or bytes than limits.h allows, or that unpack to too many times
 * their size. Entries are unpacked one after the other, in a buffer of fixed size. Memory is
 * bounded by the number of entries, which are counted before the archive is opened.
 *
 * Threads: pool. Errors: ORL_ERR_SYNTAX, _INVALID, _UNSUPPORTED, _LIMIT, _IO, _NOMEM.
 */
#ifndef ORL_SERVER_UPLOADS_UNZIP_H
#define ORL_SERVER_UPLOADS_UNZIP_H

#include "uploads/incoming.h"

/* Unpacks the archive in one process. Appends its files to the bundle as temporary files. They are
 * resources unless roles are guessed. */
int orl_unzip(const struct orl_file *archive, const struct orl_folders *folders, bool guess_roles,
              struct orl_bundle *bundle, struct orl_error *err);

/* ---- In two steps: the first reads untrusted data ------------------------------------------- */

/* Opens the system's data for names in other scripts. Call it before the sandbox forbids open(). */
void orl_unzip_prepare(void);

/* Unpacks the entries, in the archive's order and with its names, to tmp/ or to the sink. before:
 * bytes of the upload's other files. */
int orl_unzip_entries(const struct orl_file *archive, const struct orl_folders *folders,
                      const struct orl_incoming_sink *sink, uint64_t before,
                      struct orl_bundle *ret_files, struct orl_error *err);

/* Guesses the main files among files, which are sorted by name: for each file its place among the
 * main ones, from 1; else 0. */
typedef int (*orl_unzip_guesser)(void *ctx, struct orl_bundle *files, unsigned *ret_places,
                                 struct orl_error *err);
int orl_unzip_guess(void *ctx, struct orl_bundle *files, unsigned *ret_places,
                    struct orl_error *err);
/* Sets names and roles, and moves the files to the bundle. Without a guesser all are resources. */
int orl_unzip_finish(struct orl_bundle *files, orl_unzip_guesser guess, void *ctx,
                     struct orl_bundle *bundle, struct orl_error *err);

/* Returns true for a media type of zips, ignoring parameters; false for NULL. */
bool orl_is_zip_type(const char *type);

#endif
