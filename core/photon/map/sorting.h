/*
 * Sorting of photons into the order of the map file: by code, and for equal codes by a hash of
 * their words. The order depends only on the set of photons, not on the number of threads.
 */
#ifndef ORL_PHOTON_MAP_SORTING_H
#define ORL_PHOTON_MAP_SORTING_H

#include <oriel/base/thread_pool.h>

#include "photon/map/map_encode.h"

struct orl_sort_item {
    uint64_t code;  /* zorder.h */
    uint32_t index; /* index of the photon's words */
};

/* Sorts items in place. Returns 0, ORL_ERR_NOMEM or an error of orl_parallel_try. */
int orl_sort_photons(struct orl_sort_item *items, size_t count,
                     const struct orl_photon_words *words, struct orl_thread_pool *pool);

#endif
