/*
 * How the records of a cache are found that may serve a place: its index, and a walk through it.
 * For the cache (icache.c) and for who fits records to each other (icache_fit.h).
 */
#ifndef ORL_RENDER_GATHER_ICACHE_VISIT_H
#define ORL_RENDER_GATHER_ICACHE_VISIT_H

#include <limits.h>

#include "render/gather/icache.h"

#define ORL_ICACHE_NOTHING UINT32_MAX

/* Half a cache line: most visits end here, without a look at the record. */
struct orl_icache_entry {
    uint64_t key;
    float at[3], reach2; /* the record's place, and how far it is read at most: a little more */
    uint32_t record;
};

static inline uint64_t orl_icache_cell_key(int level, int64_t x, int64_t y, int64_t z)
{
    uint64_t key = orl_mix64((uint64_t)level + 0x51ed270b);
    key = orl_mix64(key ^ (uint64_t)x);
    key = orl_mix64(key ^ (uint64_t)y);
    return orl_mix64(key ^ (uint64_t)z);
}

/* Visits the records whose cells hold a point: those that may serve it, and some that do not. */
struct orl_icache_visit {
    const struct orl_icache *cache;
    const struct orl_place *place;
    float at[3];
    int level;
    uint64_t key;
    uint32_t entry, end; /* of the bucket, what is left */
};

static inline struct orl_icache_visit orl_icache_visit_begin(const struct orl_icache *cache,
                                                             const struct orl_place *place)
{
    return (struct orl_icache_visit){
        .cache = cache,
        .place = place,
        .at = {(float)place->point.x, (float)place->point.y, (float)place->point.z},
        .level = cache->count > 0 ? cache->lowest_level - 1 : INT_MAX - 1};
}

static inline bool orl_icache_is_near(const struct orl_icache_entry *entry, const float at[3])
{
    const float x = entry->at[0] - at[0], y = entry->at[1] - at[1], z = entry->at[2] - at[2];
    return x * x + y * y + z * z <= entry->reach2;
}

/* The next one's index, or ORL_ICACHE_NOTHING. */
static inline uint32_t orl_icache_visit_next(struct orl_icache_visit *v)
{
    const struct orl_icache *cache = v->cache;
    for (;;) {
        while (v->entry < v->end) {
            const struct orl_icache_entry *e = &cache->entries[v->entry++];
            if (e->key == v->key && orl_icache_is_near(e, v->at))
                return e->record;
        }
        if (++v->level > cache->highest_level)
            return ORL_ICACHE_NOTHING;
        const double cell = ldexp(1, v->level);
        const struct orl_vec3 p = v->place->point;
        v->key = orl_icache_cell_key(v->level, (int64_t)floor(p.x / cell),
                                     (int64_t)floor(p.y / cell), (int64_t)floor(p.z / cell));
        const uint32_t *head = &cache->heads[v->key & (cache->n_heads - 1)];
        v->entry = head[0];
        v->end = head[1];
    }
}

#endif
