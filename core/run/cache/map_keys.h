/*
 * Keys of photon maps. A key is the digest of all that determines a map. A family is the digest of
 * all but the number of photons, so that the larger of two maps of one family contains the smaller.
 */
#ifndef ORL_RUN_CACHE_MAP_KEYS_H
#define ORL_RUN_CACHE_MAP_KEYS_H

#include "run/run_state.h"

struct orl_map_name {
    char key[ORL_DIGEST_HEX + 1];
    char family[ORL_DIGEST_HEX + 1]; /* "" for precomputed irradiance, which is made as a whole */
};

/* Returns the name of the job's map of a kind, after its world and plan are made. */
struct orl_map_name orl_run_map_name(const struct orl_run_state *state, enum orl_map_kind kind,
                                     uint64_t target);

#endif
