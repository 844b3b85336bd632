#include "render/gather/icache.h"

#include <stdlib.h>

#include "base/sampling/sampling.h"

/* Returns the columns of a hemisphere, about three for each row. The number is a multiple of four.
 * In rooms aligned with the axes a perpendicular wall then ends at a column. */
static uint32_t columns_of(uint32_t rows)
{
    return (3 * rows + 2) / 4 * 4;
}

/* Limits of records' reach, in pixels; radii are limited to these over the accuracy. */
static const double least_reach_pixels = 1.5, most_reach_pixels = 40;

/* Limit of a record's reach, as a share of the distance to the nearest surface it has seen. */
static const double nearest_reach = 0.5;

double orl_pixel_footprint_radius(const struct orl_pixel_footprint *footprint, double distance)
{
    const double width =
        footprint->width + fmax(footprint->start + distance, footprint->nearest) * footprint->angle;
    return width * least_reach_pixels / ORL_ICACHE_ACCURACY;
}

/* Returns the radius over which light changes by its own value, an upper limit of the record's
 * radius. */
static double bend_radius(const struct orl_hemisphere *h)
{
    const double slope = orl_length(h->translation_gradient[0]) +
                         orl_length(h->translation_gradient[1]) +
                         orl_length(h->translation_gradient[2]);
    const double value = h->irradiance.r + h->irradiance.g + h->irradiance.b;
    return slope > 0 ? value / slope : INFINITY;
}

struct orl_irradiance_record
orl_irradiance_record_make(const struct orl_gather *gather, const struct orl_shading_point *place,
                           double least, uint32_t rows, const struct orl_icache *icache,
                           struct orl_random *random, struct orl_search *search)
{
    const struct orl_hemisphere h =
        orl_gather_hemisphere(gather, place, rows, columns_of(rows), icache, random, search);
    const double radius = fmin(fmin(h.mean_distance, bend_radius(&h)),
                               nearest_reach / ORL_ICACHE_ACCURACY * h.least_distance);
    struct orl_irradiance_record record = {
        .place = *place,
        .irradiance = h.irradiance,
        .photon_error = h.photon_error,
        .ray_error = h.ray_error,
        .rays = (double)rows * columns_of(rows),
        .radius = fmin(radius, least * most_reach_pixels / least_reach_pixels),
        .least = least,
        .clear = h.least_distance};
    const double served = fmax(record.radius, least);
    for (int c = 0; c < 3; c++) {
        const double value = c == 0 ? h.irradiance.r : c == 1 ? h.irradiance.g : h.irradiance.b;
        const double steepest = value / served, slope = orl_length(h.translation_gradient[c]);
        /* Near an edge the extrapolated value would reach zero within the radius. */
        record.rotation_gradient[c] = h.rotation_gradient[c];
        record.translation_gradient[c] =
            orl_scale(h.translation_gradient[c], slope > steepest ? steepest / slope : 1);
    }
    return record;
}

/* One record is enough for each cell of positions and normals. cell_width: a share of the least
 * reach. */
static const double cell_width = 0.25, cell_of_normals = 0.125;

static uint64_t cell_number(double at, double width)
{
    return (uint64_t)(int64_t)fmax(fmin(floor(at / width), 0x1p62), -0x1p62);
}

/* Returns a non-zero name of the cell of place and normal that a record lies in. */
static uint64_t cell_of(const struct orl_irradiance_record *record)
{
    const struct orl_shading_point *place = &record->place;
    int level;
    frexp(cell_width * ORL_ICACHE_ACCURACY * record->least, &level);
    const double width = ldexp(1, level - 1);
    const double parts[6][2] = {{place->point.x, width},
                                {place->point.y, width},
                                {place->point.z, width},
                                {place->normal.x, cell_of_normals},
                                {place->normal.y, cell_of_normals},
                                {place->normal.z, cell_of_normals}};
    uint64_t key =
        orl_mix64((uint64_t)level << 2 | (uint64_t)place->outside << 1 | (uint64_t)place->proxied);
    for (int i = 0; i < 6; i++)
        key = orl_mix64(key ^ cell_number(parts[i][0], parts[i][1]));
    return key | 1;
}

int orl_irradiance_records_thin(struct orl_irradiance_record *records, size_t *count)
{
    size_t buckets = 1, kept = 0;
    while (buckets < 2 * *count)
        buckets *= 2;
    uint64_t *cells = calloc(buckets, sizeof *cells); /* hash table; 0: empty slot */
    if (!cells)
        return ORL_ERR_NOMEM;
    for (size_t i = 0; i < *count; i++) {
        const uint64_t cell = cell_of(&records[i]);
        size_t at = (size_t)(cell >> 1) & (buckets - 1);
        while (cells[at] && cells[at] != cell)
            at = (at + 1) & (buckets - 1);
        if (cells[at])
            continue;
        cells[at] = cell;
        records[kept++] = records[i];
    }
    free(cells);
    *count = kept;
    return 0;
}
