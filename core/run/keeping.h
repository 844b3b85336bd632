/*
 * Things that take long to load, and no job's own: found in the store beside the photon maps, where
 * an earlier job has kept them, or made and kept. The result is the same either way, to the bit.
 *
 * A kept file that is damaged or of an earlier version is made again, with a warning; one that
 * cannot be kept costs nothing but time.
 */
#ifndef ORL_RUN_KEEPING_H
#define ORL_RUN_KEEPING_H

#include "run/stages.h"

struct orl_keepable {
    const char *kind, *key;  /* as the store has it */
    const char *what, *name; /* "BSDF", "pane.xml", for messages */
    bool outdates; /* it is of files that the key does not tell, too: ORL_ERR_VERSION is no news */
    void *ctx;
    int (*open)(void *ctx, const char *path, struct orl_error *err);
    int (*make)(void *ctx, struct orl_error *err);
    /* What was made is worth keeping? NULL: always. */
    bool (*is_worth_it)(void *ctx);
    /* Writes it, and fills the info's bytes and stored. */
    int (*keep)(void *ctx, const char *path, struct orl_map_info *info, struct orl_error *err);
};

/* The state's env has a store. What open, make and cancelling give. */
int orl_run_keep(struct orl_run_state *state, const struct orl_keepable *thing,
                 struct orl_error *err);

#endif
