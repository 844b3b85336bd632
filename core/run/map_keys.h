/*
 * Keys of photon maps. A key is the digest of all that determines a map; its family that of all but
 * the photons asked for, so that of two maps of one family the larger holds the smaller.
 */
#ifndef ORL_RUN_MAP_KEYS_H
#define ORL_RUN_MAP_KEYS_H

#include "run/stages.h"

struct orl_map_name {
    char key[ORL_DIGEST_HEX + 1];
    char family[ORL_DIGEST_HEX + 1]; /* "" of precomputed irradiance: it is made as a whole */
};

/* Of the job's map of that kind, once its world and plan are made. */
struct orl_map_name orl_run_map_name(const struct orl_run_state *state, enum orl_map_kind kind,
                                     uint64_t target);

#endif
