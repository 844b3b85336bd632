/*
 * Rows of scenes and BSDFs, a page at a time, the latest uploaded first, with what uses them. Loop
 * thread only.
 */
#ifndef ORL_STORE_SCENE_LISTS_H
#define ORL_STORE_SCENE_LISTS_H

#include <stdbool.h>

#include "store/db.h"
#include "store/folders.h"

/* Behind which row a page begins: a row's own time and id; the first page has INT64_MAX and "". */
struct orl_stored_place {
    int64_t created_ms;
    char id[ORL_SHA_HEX];
};

struct orl_listed_scene {
    struct orl_stored_place place;
    uint64_t bytes;
    int64_t last_used_ms;              /* uploaded, or a job of it submitted */
    uint64_t jobs_under_way, all_jobs; /* that wait or run; that there are */
};

struct orl_listed_bsdf {
    struct orl_stored_place place;
    const char *name; /* borrowed */
    uint64_t bytes;
    int64_t last_used_ms; /* uploaded, or a scene that has it was of use */
    bool by_itself;       /* uploaded so; else it came with a scene */
    uint64_t n_scenes;    /* that have it as a file */
    const char *scenes;   /* ids of some of them, up to ORL_LISTED_SCENES, with commas; borrowed */
};

enum { ORL_LISTED_SCENES = 10 };

/* At most limit of them. Stops when visit returns non-zero, and returns that. */
int orl_scene_rows(struct orl_db *db, const struct orl_stored_place *behind, size_t limit,
                   int (*visit)(void *ctx, const struct orl_listed_scene *scene), void *ctx,
                   struct orl_error *err);
/* BSDFs are those uploaded by themselves, and the XML files of scenes; scene: of that one alone, or
 * NULL. */
int orl_bsdf_rows(struct orl_db *db, const struct orl_stored_place *behind, const char *scene,
                  size_t limit, int (*visit)(void *ctx, const struct orl_listed_bsdf *bsdf),
                  void *ctx, struct orl_error *err);

/* A BSDF that came with a scene: what it is called there, and since when it is here. */
struct orl_scene_bsdf {
    char name[256];
    int64_t created_ms;
    uint64_t bytes;
};
int orl_scene_bsdf_find(struct orl_db *db, const char *id, struct orl_scene_bsdf *ret_bsdf,
                        bool *ret_found, struct orl_error *err);

#endif
