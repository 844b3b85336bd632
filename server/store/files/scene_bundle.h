/*
 * A bundle: the files of one scene, each a name, a role and a path on disk, and the provider that
 * hands them to the core.
 *
 * Main files come first, in the order of the scene. Resources (BSDFs, files that !xform names)
 * follow, sorted by name. The id is the SHA-256 of this text, so that a client can compute it too:
 *
 *     oriel-scene 1\n
 *     main <sha256 of the bytes> <name>\n          for each main file, in order
 *     resource <sha256 of the bytes> <name>\n      for each resource, sorted by name (bytewise)
 *
 * Names: relative, components separated by '/', none of them empty, "." or "..", no control
 * characters or backslashes, UTF-8, at most 255 bytes.
 * Ownership: a bundle owns its entries; files on disk belong to the code that made them.
 * Threads: build on one thread; the provider may then be used by one thread at a time.
 */
#ifndef ORL_SERVER_STORE_FILES_SCENE_BUNDLE_H
#define ORL_SERVER_STORE_FILES_SCENE_BUNDLE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <oriel/base/error.h>
#include <oriel/base/files.h>

#include "store/files/folders.h"

struct orl_bundle_file {
    char *name;
    char *path; /* path of its bytes on disk */
    uint64_t bytes;
    bool resource;
    bool temporary; /* the bundle must remove the file at path */
    char sha[ORL_SHA_HEX];
};

struct orl_bundle {
    struct orl_bundle_file *files;
    size_t count, capacity;
};

/* Frees the entries, and removes files still marked temporary. NULL and a zeroed struct are
 * allowed. */
void orl_bundle_done(struct orl_bundle *bundle);

/* Checks a file name. ORL_ERR_INVALID with the reason if it is not allowed. */
int orl_bundle_check_name(const char *name, struct orl_error *err);

/* Appends a file. Refuses invalid and duplicate names, and more files than limits.h allows. sha may
 * be NULL. */
int orl_bundle_add(struct orl_bundle *bundle, const char *name, bool resource, const char *path,
                   uint64_t bytes, const char *sha, bool temporary, struct orl_error *err);

/* Removes the file at that index, and deletes it from disk if it is temporary. */
void orl_bundle_remove(struct orl_bundle *bundle, size_t index);

/* Moves the temporary files of `from` to bundle, which then owns them. */
int orl_bundle_move(struct orl_bundle *from, struct orl_bundle *bundle, struct orl_error *err);

/* sort: puts main files first, and sorts resources. id: computes the id; needs every sha. */
void orl_bundle_sort(struct orl_bundle *bundle);
int orl_bundle_id(const struct orl_bundle *bundle, char ret_id[ORL_SHA_HEX], struct orl_error *err);

size_t orl_bundle_main_count(const struct orl_bundle *bundle);
uint64_t orl_bundle_bytes(const struct orl_bundle *bundle);
/* Returns the entry of that name, or NULL; a leading "./" is ignored. */
const struct orl_bundle_file *orl_bundle_find(const struct orl_bundle *bundle, const char *name);

/* Returns a provider that maps the files read-only; borrows bundle. */
struct orl_files orl_bundle_provider(struct orl_bundle *bundle);

/* Checks that a mapped file still has the uploaded bytes. ORL_ERR_CORRUPT if not. */
int orl_bundle_verify_file(const struct orl_bundle_file *file, const struct orl_file *data,
                           struct orl_error *err);
/* Sets the error of providers for a missing name: ORL_ERR_NOT_FOUND. */
int orl_bundle_refuse_missing(const struct orl_bundle *bundle, const char *name,
                              struct orl_error *err);
/* Finds a file whose name differs in case only; see other_case of struct orl_files. */
bool orl_bundle_other_case(const struct orl_bundle *bundle, const char *name, char *ret_name,
                           size_t size);

#endif
