/*
 * Rows of photon maps. Loop thread only.
 */
#ifndef ORL_SERVER_STORE_ROWS_STORED_MAPS_H
#define ORL_SERVER_STORE_ROWS_STORED_MAPS_H

#include <stdbool.h>

#include <oriel/job/run.h>

#include "store/database/db.h"

struct orl_stored_map {
    struct orl_map_info info;
    uint64_t hits;
    double seconds_saved;
    int64_t created_ms, last_used_ms;
    bool in_use; /* a job uses it now; not stored */
};

int orl_map_row_put(struct orl_db *db, const struct orl_stored_map *map, struct orl_error *err);
int orl_map_row_drop(struct orl_db *db, const char *kind, const char *key, struct orl_error *err);
/* Calls row for every map, most recently used first. Stops when it returns non-zero, and returns
 * that. */
int orl_map_rows(struct orl_db *db, int (*row)(void *ctx, const struct orl_stored_map *map),
                 void *ctx, struct orl_error *err);

#endif
