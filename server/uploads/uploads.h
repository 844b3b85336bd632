/*
 * Files of an upload: received into tmp/ (incoming.c), split from a multipart body (multipart.c),
 * and unpacked from a zip (unzip.c).
 */
#ifndef ORL_SERVER_UPLOADS_UPLOADS_H
#define ORL_SERVER_UPLOADS_UPLOADS_H

#include <oriel/base/sha256.h>

#include "http/quota/quota.h"
#include "store/files/scene_bundle.h"

struct MHD_Connection;

/*
 * A file being received: written to tmp/ and hashed as data arrives, bounded by
 * ORL_LIMIT_FILE_BYTES, entered into a bundle as a temporary file.
 * Threads: one at a time. Errors: ORL_ERR_IO, ORL_ERR_LIMIT, and those of orl_bundle_add.
 */

/* Callbacks that receive the files in place of tmp/. */
struct orl_incoming_sink {
    int (*file)(void *ctx, const char *name, struct orl_error *err);
    int (*data)(void *ctx, const char *data, size_t size, struct orl_error *err);
    void *ctx;
};

struct orl_incoming {
    struct orl_bundle *bundle;            /* borrowed; its last file is the current one */
    const struct orl_incoming_sink *sink; /* borrowed; NULL: tmp/ */
    struct orl_reservation *reservation;  /* borrowed; bounds the bytes on disk; NULL: no bound */
    int fd;                               /* -1: no file is open */
    struct orl_sha256 hash;
};

void orl_incoming_init(struct orl_incoming *incoming, struct orl_bundle *bundle);

/* Enters a file; the previous one must have ended. A file that goes to a sink has neither path nor
 * digest in the bundle; folders may then be NULL. */
int orl_incoming_begin(struct orl_incoming *incoming, const struct orl_folders *folders,
                       const char *name, bool resource, struct orl_error *err);
int orl_incoming_append(struct orl_incoming *incoming, const char *data, size_t size,
                        struct orl_error *err);
/* Closes the current file, if any, and records its digest. Call it after an error too. */
void orl_incoming_end(struct orl_incoming *incoming);

/*
 * Splits a multipart/form-data body into parts: files go to tmp/ and are hashed as they are read,
 * other fields stay in memory. Pool threads; the connection must be suspended meanwhile (its
 * headers are read for the boundary).
 */

struct orl_multipart {
    struct orl_bundle files; /* in the order sent; temporary */
    struct orl_bundle zips;  /* likewise: zips to be unpacked */
    char *bsdfs;             /* the field "bsdfs", NUL-terminated, or NULL */
    char *mains;             /* the fields "main", one per line, or NULL */
};

/*
 * Splits the body. A part with a file name is a file: a resource if its field is "resource" or its
 * name ends in .xml, otherwise a main file. It is a zip if its type or name says so. Honeybee
 * models are not recognised here. Fields other than "bsdfs" and "main" are refused.
 */
int orl_multipart_split(struct MHD_Connection *connection, const struct orl_file *body,
                        const struct orl_folders *folders, struct orl_multipart *ret_parts,
                        struct orl_error *err);
void orl_multipart_done(struct orl_multipart *parts);

/* Returns true if the name ends in .xml, in any case. */
bool orl_is_xml_name(const char *name);

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
