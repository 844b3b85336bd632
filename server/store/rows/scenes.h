/*
 * Rows of scenes and BSDFs. Loop thread only; the files they name must be in place already. A
 * missing row is no error: *ret_found is then false. ret_scene and ret_bsdf may be NULL.
 */
#ifndef ORL_STORE_ROWS_SCENES_H
#define ORL_STORE_ROWS_SCENES_H

#include <stdbool.h>
#include <stdint.h>

#include "store/database/db.h"
#include "store/files/folders.h"
#include "store/files/scene_bundle.h"

struct orl_stored_item {
    int64_t created_ms;
    uint64_t bytes;
    char *summary; /* JSON text, owned; free() */
};

/* Inserts a scene in one transaction. *ret_created is false if a scene of that id exists. */
int orl_scene_insert(struct orl_db *db, const char *id, const struct orl_bundle *bundle,
                     const char *summary, bool *ret_created, struct orl_error *err);
int orl_scene_find(struct orl_db *db, const char *id, struct orl_stored_item *ret_scene,
                   bool *ret_found, struct orl_error *err);
/* Returns the scene's files as a bundle over blobs (orl_bundle_done); empty if there is no such
 * scene. */
int orl_scene_files(struct orl_db *db, const struct orl_folders *folders, const char *id,
                    struct orl_bundle *ret_bundle, struct orl_error *err);

/*
 * Removes the row and those of its files. Their digests are returned in ret_blobs (*ret_count of
 * them; free()). *ret_removed is false if there is no such scene. ORL_ERR_IO if a job that waits or
 * runs needs the scene.
 */
int orl_scene_drop(struct orl_db *db, const char *id, char (**ret_blobs)[ORL_SHA_HEX],
                   size_t *ret_count, bool *ret_removed, struct orl_error *err);

int orl_bsdf_insert(struct orl_db *db, const char *id, const char *name, uint64_t bytes,
                    const char *summary, bool *ret_created, struct orl_error *err);
int orl_bsdf_find(struct orl_db *db, const char *id, struct orl_stored_item *ret_bsdf,
                  bool *ret_found, struct orl_error *err);
/* Removes the row. ORL_ERR_IO if scenes have the BSDF as a file. */
int orl_bsdf_drop(struct orl_db *db, const char *id, bool *ret_removed, struct orl_error *err);

/* is_named: true if a scene, a BSDF or a job names the blob. in_scene: true if it is a file of a
 * scene. */
int orl_blob_is_referenced(struct orl_db *db, const char *sha, bool *ret_named,
                           struct orl_error *err);
int orl_blob_in_scene(struct orl_db *db, const char *sha, bool *ret_named, struct orl_error *err);

/* Lists: scenes and BSDFs, a page at a time, most recently uploaded first, with their uses. */

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

/* Calls visit for at most limit scenes after the position. Stops when visit returns non-zero, and
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
