/*
 * A zip of a scene's folder, unpacked into files of an upload.
 *
 * Names are those in the archive; where all lie in one folder at the top, its name is left out,
 * unless it is the "model" of a project, whose texts know it by that (honeybee/project.h), and so
 * is what desktops put beside them (__MACOSX, .DS_Store, Thumbs.db, desktop.ini). Which of them are
 * main files, and in which order: main_files.h.
 *
 * Refused, with the entry's name: names unfit for a bundle (absolute, climbing, not UTF-8), two
 * files of one name, links and devices, encrypted entries, methods other than deflate, damage;
 * archives of more entries, files or bytes than limits.h allows, or that unpack to too many times
 * their size. Entries are unpacked one after the other, in a buffer of fixed size; memory is
 * bounded by the number of entries, which are counted before the archive is opened.
 *
 * Threads: pool. Errors: ORL_ERR_SYNTAX, _INVALID, _UNSUPPORTED, _LIMIT, _IO, _NOMEM.
 */
#ifndef ORL_SERVER_UPLOADS_UNZIP_H
#define ORL_SERVER_UPLOADS_UNZIP_H

#include "uploads/incoming.h"

/* Appends the archive's files to the bundle, as temporary files; as resources, unless roles are to
 * be guessed. All of it, in one process. */
int orl_unzip(const struct orl_file *archive, const struct orl_folders *folders, bool guess_roles,
              struct orl_bundle *bundle, struct orl_error *err);

/* ---- In two steps: the first reads what a stranger has sent -----------------------------------
 */

/* Opens what names in other scripts take, a file of the system's: to be called before the process
 * may open none any more. */
void orl_unzip_prepare(void);

/* The entries, in the archive's order, by its own names: to tmp/, or to the sink. before: bytes of
 * the upload's other files. */
int orl_unzip_entries(const struct orl_file *archive, const struct orl_folders *folders,
                      const struct orl_incoming_sink *sink, uint64_t before,
                      struct orl_bundle *ret_files, struct orl_error *err);

/* Which of the files, sorted by name, are main ones: their places among those, from 1; else 0. */
typedef int (*orl_unzip_guesser)(void *ctx, struct orl_bundle *files, unsigned *ret_places,
                                 struct orl_error *err);
int orl_unzip_guess(void *ctx, struct orl_bundle *files, unsigned *ret_places,
                    struct orl_error *err);
/* Names and roles; then the files are the bundle's. Without a guesser all are resources. */
int orl_unzip_settle(struct orl_bundle *files, orl_unzip_guesser guess, void *ctx,
                     struct orl_bundle *bundle, struct orl_error *err);

/* A media type that zips go by, parameters ignored; NULL is none. */
bool orl_is_zip_type(const char *type);

#endif
