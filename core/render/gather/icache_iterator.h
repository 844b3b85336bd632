/* The index of a cache, and an iterator over the records that may serve a place. Used by the cache
 * (icache.c) and by the fit of records (icache_fit.c). */
#ifndef ORL_RENDER_GATHER_ICACHE_ITERATOR_H
#define ORL_RENDER_GATHER_ICACHE_ITERATOR_H

#include <limits.h>

#include "render/gather/icache.h"

/* orl_irradiance_record_radius returns the radius with which a record serves.
 * orl_irradiance_record_covers returns true if it serves a place that nothing occludes. */
double orl_irradiance_record_radius(const struct orl_irradiance_record *record);
bool orl_irradiance_record_covers(const struct orl_irradiance_record *record,
                                  const struct orl_shading_point *place);

#define ORL_ICACHE_END UINT32_MAX

/* Half a cache line. Most visits are decided here without reading the record. */
struct orl_icache_entry {
    uint64_t key;
    float at[3], reach2; /* the record's place, and its squared reach, rounded up */
    uint32_t record;
};

static inline uint64_t orl_icache_cell_key(int level, int64_t x, int64_t y, int64_t z)
{
    return orl_mix64((uint64_t)level * 0x9e3779b97f4a7c15 + (uint64_t)x * 0xbf58476d1ce4e5b9 +
                     (uint64_t)y * 0x94d049bb133111eb + (uint64_t)z * 0xd6e8feb86659fd93);
}

/* Iterates over the records whose cells hold a point: those that may serve it, and some that do
 * not. */
struct orl_icache_iterator {
    const struct orl_icache *cache;
    const struct orl_shading_point *place;
    float at[3];
    int64_t cell[3]; /* cell of the next level */
    int level;
    uint64_t key;
    uint32_t entry, end; /* remaining entries of the bucket */
};

static inline struct orl_icache_iterator
orl_icache_iterator_begin(const struct orl_icache *cache, const struct orl_shading_point *place)
{
    struct orl_icache_iterator v = {
        .cache = cache,
        .place = place,
        .at = {(float)place->point.x, (float)place->point.y, (float)place->point.z},
        .level = INT_MAX - 1};
    if (cache->lowest_level > cache->highest_level || cache->count == 0)
        return v; /* no record reaches any place */
    const double inverse = ldexp(1, -cache->lowest_level);
    v.cell[0] = (int64_t)floor(place->point.x * inverse);
    v.cell[1] = (int64_t)floor(place->point.y * inverse);
    v.cell[2] = (int64_t)floor(place->point.z * inverse);
    v.level = cache->lowest_level - 1;
    return v;
}

static inline bool orl_icache_is_near(const struct orl_icache_entry *entry, const float at[3])
{
    const float x = entry->at[0] - at[0], y = entry->at[1] - at[1], z = entry->at[2] - at[2];
    return x * x + y * y + z * z <= entry->reach2;
}

/* Returns the next record's index, or ORL_ICACHE_END. */
static inline uint32_t orl_icache_iterator_next(struct orl_icache_iterator *v)
{
    const struct orl_icache *cache = v->cache;
    for (;;) {
        while (v->entry < v->end) {
            const struct orl_icache_entry *e = &cache->entries[v->entry++];
            if (e->key == v->key && orl_icache_is_near(e, v->at))
                return e->record;
        }
        if (++v->level > cache->highest_level)
            return ORL_ICACHE_END;
        v->key = orl_icache_cell_key(v->level, v->cell[0], v->cell[1], v->cell[2]);
        /* Halve the coordinates for the level above, whose cells are twice as wide. */
        for (int k = 0; k < 3; k++)
            v->cell[k] >>= 1;
        const uint32_t *head = &cache->heads[v->key & (cache->n_heads - 1)];
        v->entry = head[0];
        v->end = head[1];
    }
}

#endif
