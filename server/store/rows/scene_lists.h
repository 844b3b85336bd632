/*
 * Rows of scenes and BSDFs, a page at a time, most recently uploaded first, with their uses. Loop
 * thread only.
 */
#ifndef ORL_STORE_ROWS_SCENE_LISTS_H
#define ORL_STORE_ROWS_SCENE_LISTS_H

#include <stdbool.h>

#include "store/database/db.h"
#include "store/files/folders.h"

/* The row before a page: its time and id; for the first page INT64_MAX and "". */
struct orl_list_position {
    int64_t created_ms;
    char id[ORL_SHA_HEX];
};

struct orl_listed_scene {
    struct orl_list_position position;
    uint64_t bytes;
    int64_t last_used_ms;              /* uploaded, or a job with it submitted */
    uint64_t jobs_under_way, all_jobs; /* waiting or running jobs; all jobs */
};

struct orl_listed_bsdf {
    struct orl_list_position position;
    const char *name; /* borrowed */
    uint64_t bytes;
    int64_t last_used_ms; /* uploaded, or a scene that contains it was used */
    bool by_itself;       /* uploaded by itself; otherwise with a scene */
    uint64_t n_scenes;    /* scenes that have it as a file */
    const char *scenes; /* ids of up to ORL_LISTED_SCENES of them, separated by commas; borrowed */
};

enum { ORL_LISTED_SCENES = 10 };

/* Calls visit for at most limit scenes after `behind`. Stops when visit returns non-zero, and
 * returns that. */
int orl_scene_rows(struct orl_db *db, const struct orl_list_position *after, size_t limit,
                   int (*visit)(void *ctx, const struct orl_listed_scene *scene), void *ctx,
                   struct orl_error *err);
/* Calls visit for BSDFs uploaded by themselves and XML files of scenes. scene: only those of that
 * scene; NULL: all. */
int orl_bsdf_rows(struct orl_db *db, const struct orl_list_position *after, const char *scene,
                  size_t limit, int (*visit)(void *ctx, const struct orl_listed_bsdf *bsdf),
                  void *ctx, struct orl_error *err);

/* A BSDF that came with a scene: its name there, and when it was uploaded. */
struct orl_scene_bsdf {
    char name[256];
    int64_t created_ms;
    uint64_t bytes;
};
int orl_scene_bsdf_find(struct orl_db *db, const char *id, struct orl_scene_bsdf *ret_bsdf,
                        bool *ret_found, struct orl_error *err);

#endif
