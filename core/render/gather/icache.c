#include "render/gather/icache_iterator.h"

#include <stdlib.h>
#include <string.h>

void orl_icache_init(struct orl_icache *cache, uint32_t channels)
{
    memset(cache, 0, sizeof *cache);
    cache->channels = channels;
}

void orl_icache_done(struct orl_icache *cache)
{
    free(cache->records);
    free(cache->entries);
    free(cache->heads);
    memset(cache, 0, sizeof *cache);
}

int orl_icache_add(struct orl_icache *cache, const struct orl_irradiance_record *records,
                   size_t count)
{
    if (cache->count + count > cache->capacity) {
        const size_t capacity = 2 * (cache->count + count);
        struct orl_irradiance_record *grown = realloc(cache->records, capacity * sizeof *grown);
        if (!grown)
            return ORL_ERR_NOMEM;
        cache->records = grown;
        cache->capacity = capacity;
    }
    if (count > 0)
        memcpy(cache->records + cache->count, records, count * sizeof *records);
    cache->count += count;
    return 0;
}

double orl_irradiance_record_radius(const struct orl_irradiance_record *record)
{
    return fmax(record->radius, record->least);
}

/* Returns the radius for reading. A record whose radius was raised to the pixels' limit is not
 * extended further. */
static double radius_read(const struct orl_irradiance_record *record)
{
    return fmax(ORL_ICACHE_OVERLAP * record->radius, record->least);
}

/* Returns the largest distance at which a record is read; a cell of its level is at least twice as
 * wide. */
static double reach_of(const struct orl_irradiance_record *record)
{
    return ORL_ICACHE_ACCURACY * radius_read(record);
}

static int exponent_of(double value)
{
    int exponent;
    frexp(value, &exponent);
    return exponent;
}

/* Approximate limit, in bits, of cells' coordinates. Smaller cells would hold no more than one
 * place, and their coordinates would overflow. */
enum { CELL_BITS = 40 };

static int level_of(const struct orl_icache *cache, const struct orl_irradiance_record *record)
{
    const int level = exponent_of(2 * reach_of(record));
    return level > cache->least_level ? level : cache->least_level;
}

static void find_least_level(struct orl_icache *cache)
{
    double largest = 0;
    for (size_t i = 0; i < cache->count; i++) {
        const struct orl_vec3 p = cache->records[i].place.point;
        largest = fmax(largest, fmax(fabs(p.x), fmax(fabs(p.y), fabs(p.z))));
    }
    cache->least_level = largest > 0 ? exponent_of(largest) - CELL_BITS : INT_MIN;
}

/* Cells of a record's level that its reach touches, at most eight. */
struct cells {
    int level;
    int64_t low[3], high[3];
};

static struct cells cells_of(const struct orl_icache *cache,
                             const struct orl_irradiance_record *record)
{
    struct cells cells = {.level = level_of(cache, record)};
    const double cell = ldexp(1, cells.level), reach = reach_of(record);
    const double at[3] = {record->place.point.x, record->place.point.y, record->place.point.z};
    for (int k = 0; k < 3; k++) {
        cells.low[k] = (int64_t)floor((at[k] - reach) / cell);
        cells.high[k] = (int64_t)floor((at[k] + reach) / cell);
    }
    return cells;
}

static struct orl_icache_entry entry_of(const struct orl_irradiance_record *record, uint32_t index)
{
    const struct orl_vec3 p = record->place.point;
    /* Places are doubles: the margin exceeds the rounding of them. */
    const double reach = 1.001 * reach_of(record) + 1e-6 * (fabs(p.x) + fabs(p.y) + fabs(p.z));
    return (struct orl_icache_entry){.at = {(float)p.x, (float)p.y, (float)p.z},
                                     .reach2 = (float)(reach * reach),
                                     .record = index};
}

/* Inserts a record into each of its cells, or, if count is set, only counts the cells by bucket. A
 * record that reaches no place, not even its own, is left out. */
static void insert_record(struct orl_icache *cache, uint32_t index, bool count)
{
    if (!(reach_of(&cache->records[index]) > 0))
        return;
    const struct cells cells = cells_of(cache, &cache->records[index]);
    struct orl_icache_entry entry = entry_of(&cache->records[index], index);
    for (int64_t z = cells.low[2]; z <= cells.high[2]; z++)
        for (int64_t y = cells.low[1]; y <= cells.high[1]; y++)
            for (int64_t x = cells.low[0]; x <= cells.high[0]; x++) {
                entry.key = orl_icache_cell_key(cells.level, x, y, z);
                uint32_t *head = &cache->heads[entry.key & (cache->n_heads - 1)];
                if (count)
                    ++*head;
                else
                    cache->entries[--*head] = entry;
            }
    if (cells.level < cache->lowest_level)
        cache->lowest_level = cells.level;
    if (cells.level > cache->highest_level)
        cache->highest_level = cells.level;
}

/* Builds the index. Each bucket's entries are contiguous, from its head to the next one's. */
int orl_icache_index(struct orl_icache *cache)
{
    struct orl_icache_entry *entries =
        realloc(cache->entries, (8 * cache->count + 1) * sizeof *entries);
    if (!entries)
        return ORL_ERR_NOMEM;
    cache->entries = entries;
    cache->n_heads = 1;
    while (cache->n_heads < 4 * cache->count)
        cache->n_heads *= 2;
    uint32_t *heads = realloc(cache->heads, (cache->n_heads + 1) * sizeof *heads);
    if (!heads)
        return ORL_ERR_NOMEM;
    cache->heads = heads;
    memset(heads, 0, (cache->n_heads + 1) * sizeof *heads);
    find_least_level(cache);
    cache->lowest_level = 10000;
    cache->highest_level = -10000;
    for (size_t i = 0; i < cache->count; i++)
        insert_record(cache, (uint32_t)i, true);
    for (size_t i = 0, end = 0; i <= cache->n_heads; i++) {
        end += heads[i];
        heads[i] = (uint32_t)end;
    }
    for (size_t i = 0; i < cache->count; i++)
        insert_record(cache, (uint32_t)i, false);
    return 0;
}

static double channel_at(const struct orl_irradiance_record *record, int c, double value,
                         struct orl_vec3 turn, struct orl_vec3 shift)
{
    return value + orl_dot(turn, record->rotation_gradient[c]) +
           orl_dot(shift, record->translation_gradient[c]);
}

/* Returns a record's irradiance, extrapolated to the place along its gradients and never below
 * zero. */
static struct orl_rgb extrapolate_record(const struct orl_irradiance_record *record,
                                         const struct orl_shading_point *place, uint32_t channels)
{
    const struct orl_vec3 turn =
        orl_cross(record->place.normal, place->textured ? place->shading : place->normal);
    const struct orl_vec3 shift = orl_sub(place->point, record->place.point);
    const struct orl_rgb e = record->irradiance;
    if (channels == 1)
        return orl_gray(fmax(channel_at(record, 0, e.r, turn, shift), 0));
    return (struct orl_rgb){fmax(channel_at(record, 0, e.r, turn, shift), 0),
                            fmax(channel_at(record, 1, e.g, turn, shift), 0),
                            fmax(channel_at(record, 2, e.b, turn, shift), 0)};
}

/* Returns the error of a record at a place, for that radius, or INFINITY if it exceeds the
 * accuracy. */
static double error_of(const struct orl_irradiance_record *record,
                       const struct orl_shading_point *place, double radius, double overlap)
{
    const struct orl_vec3 shift = orl_sub(place->point, record->place.point);
    const double distance = orl_length(shift);
    const double cosine = orl_dot(place->normal, record->place.normal);
    const double reach = ORL_ICACHE_ACCURACY * radius;
    if (record->place.outside != place->outside || record->place.proxied != place->proxied ||
        distance >= reach || cosine < 0.8)
        return INFINITY;
    /* A place well behind or before the record's surface sees another scene. */
    const struct orl_vec3 both = orl_add(place->normal, record->place.normal);
    if (fabs(orl_dot(shift, both)) > 0.1 * reach)
        return INFINITY;
    const double error = distance / radius + sqrt(fmax(0, 1 - cosine)) / overlap;
    return error < ORL_ICACHE_ACCURACY ? error : INFINITY;
}

bool orl_irradiance_record_covers(const struct orl_irradiance_record *record,
                                  const struct orl_shading_point *place)
{
    return error_of(record, place, orl_irradiance_record_radius(record), 1) < INFINITY;
}

/* Returns the weight of a record at a place; 0 if it is not read there. */
static double weight_of(const struct orl_irradiance_record *record,
                        const struct orl_shading_point *place)
{
    const double error = error_of(record, place, radius_read(record), ORL_ICACHE_OVERLAP);
    return fmax(0, 1 - error / ORL_ICACHE_ACCURACY);
}

/* Returns true if nothing occludes a record from a place where it is read. Both are lifted a
 * little, because the straight line between places on a vault's outside passes through it. */
static bool is_open(const struct orl_icache *cache, const struct orl_irradiance_record *record,
                    const struct orl_shading_point *place)
{
    static const double lifted = 0.05;
    const struct orl_vec3 shift = orl_sub(place->point, record->place.point);
    const double away = orl_length(shift);
    if (away <= record->clear || !cache->geometry)
        return true;
    const struct orl_vec3 from = orl_madd(record->place.point, record->place.normal, lifted * away);
    const struct orl_vec3 way = orl_sub(orl_madd(place->point, place->normal, lifted * away), from);
    const double length = orl_length(way);
    return !orl_geometry_occluded(cache->geometry, from, orl_scale(way, 1 / length), length);
}

bool orl_icache_covers(const struct orl_icache *cache, const struct orl_shading_point *place)
{
    struct orl_icache_iterator v = orl_icache_iterator_begin(cache, place);
    for (uint32_t i = orl_icache_iterator_next(&v); i != ORL_ICACHE_END;
         i = orl_icache_iterator_next(&v))
        if (orl_irradiance_record_covers(&cache->records[i], place) &&
            is_open(cache, &cache->records[i], place))
            return true;
    return false;
}

bool orl_icache_has_record_for(const struct orl_icache *cache,
                               const struct orl_shading_point *place)
{
    struct orl_icache_iterator v = orl_icache_iterator_begin(cache, place);
    for (uint32_t i = orl_icache_iterator_next(&v); i != ORL_ICACHE_END;
         i = orl_icache_iterator_next(&v))
        if (weight_of(&cache->records[i], place) > 0 && is_open(cache, &cache->records[i], place))
            return true;
    return false;
}

/* Weighted sums over the records read at a place. */
struct joined {
    struct orl_rgb sum;
    double total, by_photons, by_rays;
    /* Weighted sums of the records' squared lumas, and of their variances by rays. */
    double squares, noise;
};

static void join_record(struct joined *joined, const struct orl_icache *cache,
                        const struct orl_irradiance_record *record,
                        const struct orl_shading_point *place)
{
    const double weight = weight_of(record, place);
    if (!(weight > 0) || !is_open(cache, record, place))
        return;
    const struct orl_rgb value = extrapolate_record(record, place, cache->channels);
    joined->sum = orl_rgb_add(joined->sum, orl_rgb_scale(value, weight));
    joined->squares += weight * orl_luma(value) * orl_luma(value);
    joined->noise += weight * record->ray_error * record->ray_error;
    joined->by_photons += weight * record->photon_error;
    joined->by_rays += weight * weight * record->ray_error * record->ray_error;
    joined->total += weight;
}

/*
 * Computes the interpolated value and its error. The interpolation error is the records' scatter
 * beyond their rays' noise. Each extrapolation errs by the curvature of the light times its squared
 * distance. These errors differ between records by about their own size, and do not average out.
 */
static bool resolve_interpolation(const struct joined *joined,
                                  struct orl_cached_irradiance *ret_cached)
{
    const double total = joined->total, by_photons = joined->by_photons;
    if (!(total > 0))
        return false;
    const double mean = orl_luma(joined->sum) / total;
    const double by_interpolation =
        fmax((joined->squares - joined->noise) / total - mean * mean, 0);
    *ret_cached = (struct orl_cached_irradiance){
        orl_rgb_scale(joined->sum, 1 / total),
        sqrt((by_photons * by_photons + joined->by_rays) / (total * total) + by_interpolation)};
    return true;
}

bool orl_icache_lookup(const struct orl_icache *cache, const struct orl_shading_point *place,
                       struct orl_cached_irradiance *ret_cached)
{
    struct joined joined = {.total = 0};
    struct orl_icache_iterator v = orl_icache_iterator_begin(cache, place);
    for (uint32_t i = orl_icache_iterator_next(&v); i != ORL_ICACHE_END;
         i = orl_icache_iterator_next(&v))
        join_record(&joined, cache, &cache->records[i], place);
    return resolve_interpolation(&joined, ret_cached);
}

bool orl_irradiance_records_lookup(const struct orl_irradiance_record *records, size_t count,
                                   const struct orl_icache *like,
                                   const struct orl_shading_point *place,
                                   struct orl_cached_irradiance *ret_cached)
{
    struct joined joined = {.total = 0};
    for (size_t i = 0; i < count; i++)
        join_record(&joined, like, &records[i], place);
    return resolve_interpolation(&joined, ret_cached);
}
