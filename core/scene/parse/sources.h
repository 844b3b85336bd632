/*
 * The files a scene is made of: found, opened once, hashed in order of first use, and closed at the
 * end. Names are resolved lexically ("a/../b" is "b"): first in the folder of the file that
 * mentions them, then as written.
 *
 * Ownership: orl_sources_done closes all; names are kept in the description's arena.
 */
#ifndef ORL_SCENE_PARSE_SOURCES_H
#define ORL_SCENE_PARSE_SOURCES_H

#include <stdatomic.h>
#include <stdbool.h>
#include <stddef.h>

#include <oriel/bsdf.h>
#include <oriel/files.h>
#include <oriel/sha256.h>

#include "base/arena.h"
#include "scene/description.h"

struct orl_source {
    char *name;   /* resolved: how the provider found it */
    char *folder; /* "a" for "a/b.rad", "" for "b.rad" */
    struct orl_file file;
    bool open, library; /* library: the user's, not the scene's own */
    unsigned char content[ORL_SHA256_BYTES];
    struct orl_bsdf *bsdf; /* a reference, once it was loaded as one */
};

/* Who loads BSDFs, if not orl_bsdf_load_xml: the same, but perhaps from a store; and who may stop
 * it all. */
struct orl_bsdf_loader {
    void *ctx;
    int (*load)(void *ctx, const struct orl_bsdf_xml *xml,
                const unsigned char content[ORL_SHA256_BYTES], struct orl_bsdf **ret_bsdf,
                struct orl_error *err);
    const atomic_bool *cancel; /* heard while scene text is read; NULL: nothing */
};

enum { ORL_SOURCES_MISSED = 1024 };

struct orl_sources {
    const struct orl_files *files;
    const struct orl_bsdf_loader *loader; /* NULL: none */
    struct orl_arena *arena;
    struct orl_source *items;
    size_t count, room;
    struct orl_file_missed *missed; /* names that no file had, each once */
    size_t n_missed, missed_room;   /* one more than ORL_SOURCES_MISSED: not all are listed */
    struct orl_sha256 digest;       /* over length and SHA-256 of the content of each file used */
};

void orl_sources_init(struct orl_sources *sources, const struct orl_files *files,
                      const struct orl_bsdf_loader *loader, struct orl_arena *arena);
void orl_sources_done(struct orl_sources *sources);

/* Whether one of the files that a scene is made of is no text of its own: a BSDF's (.xml). */
bool orl_sources_is_resource(const char *name);

/* What mends an ORL_ERR_NOT_FOUND of those below, who say it: for errors put in other words. */
void orl_sources_hint(struct orl_error *err);

/*
 * Finds a file mentioned as name in a file of that folder ("" for none), or else in the user's
 * library (names that start with '.' or '/' are not looked for there). ret_index is good for
 * ever; pointers to items only until the next call. ORL_ERR_NOT_FOUND, _IO, _LIMIT, _NOMEM.
 */
int orl_sources_find(struct orl_sources *sources, const char *folder, const char *name,
                     size_t *ret_index, struct orl_error *err);

/* The same without the library. */
int orl_sources_find_own(struct orl_sources *sources, const char *folder, const char *name,
                         size_t *ret_index, struct orl_error *err);

/* A file by the name that the provider knows it by: the scene's own, or the library's. */
int orl_sources_open(struct orl_sources *sources, const char *name, bool library, size_t *ret_index,
                     struct orl_error *err);

/* Counts a file once more in the digest: the caller named it twice. */
void orl_sources_count_again(struct orl_sources *sources, size_t index);

/* Loads the file as a BSDF, each distinct content once. ret_bsdf is borrowed. */
int orl_sources_bsdf(struct orl_sources *sources, size_t index, struct orl_bsdf **ret_bsdf,
                     struct orl_error *err);

#endif
