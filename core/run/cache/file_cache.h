/*
 * Caches data that take long to load and do not depend on the job. They are found in the store
 * beside the photon maps, or made and stored. The result is bit-identical in both cases.
 *
 * A stored file that is damaged or of an earlier version is made again, with a warning. Failing to
 * store costs only time.
 */
#ifndef ORL_RUN_CACHE_FILE_CACHE_H
#define ORL_RUN_CACHE_FILE_CACHE_H

#include "run/run_state.h"

struct orl_file_cache_entry {
    const char *kind, *key;  /* names in the store */
    const char *what, *name; /* "BSDF", "pane.xml", for messages */
    /* True if it also depends on files that the key does not include, so that ORL_ERR_VERSION
     * causes no warning. */
    bool may_be_outdated;
    void *ctx;
    int (*open)(void *ctx, const char *path, struct orl_error *err);
    int (*make)(void *ctx, struct orl_error *err);
    /* Returns true if the data are worth storing. NULL: always. */
    bool (*is_worth_storing)(void *ctx);
    /* Writes the data, and fills the info's bytes and stored. */
    int (*write)(void *ctx, const char *path, struct orl_map_info *info, struct orl_error *err);
};

/* Opens or makes the thing. The state's env must have a store. Returns the codes of open and make,
 * or ORL_ERR_CANCELLED. */
int orl_file_cache_get(struct orl_run_state *state, const struct orl_file_cache_entry *entry,
                       struct orl_error *err);

#endif
