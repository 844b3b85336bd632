#include "render/gather/record.h"

/* Columns of a hemisphere: some three for each row. A multiple of four, so that a wall at right
 * angles with the place's own ends where columns do, in rooms that lie along the axes. */
static uint32_t columns_of(uint32_t rows)
{
    return (3 * rows + 2) / 4 * 4;
}

/* How far records reach, in pixels: their radii are held between these over the accuracy. */
static const double least_reach_pixels = 1.5, most_reach_pixels = 40;

/* And no record stands for more than half of the way to the nearest thing it has seen. */
static const double nearest_reach = 0.5;

double orl_record_least(const struct orl_grain *grain, double distance)
{
    return (grain->width + distance * grain->angle) * least_reach_pixels / ORL_ICACHE_ACCURACY;
}

/* Where light would have changed by as much as there is: no record should reach that far. */
static double bend_radius(const struct orl_hemisphere *h)
{
    const double slope = orl_length(h->by_translation[0]) + orl_length(h->by_translation[1]) +
                         orl_length(h->by_translation[2]);
    const double value = h->irradiance.r + h->irradiance.g + h->irradiance.b;
    return slope > 0 ? value / slope : INFINITY;
}

struct orl_record orl_record_make(const struct orl_gather *gather, const struct orl_place *place,
                                  double least, uint32_t rows, const struct orl_icache *known,
                                  struct orl_random *random, struct orl_search *search)
{
    const struct orl_hemisphere h =
        orl_gather_hemisphere(gather, place, rows, columns_of(rows), known, random, search);
    const double radius = fmin(fmin(h.mean_distance, bend_radius(&h)),
                               nearest_reach / ORL_ICACHE_ACCURACY * h.least_distance);
    struct orl_record record = {.place = *place,
                                .irradiance = h.irradiance,
                                .error_by_photons = h.error_by_photons,
                                .error_by_rays = h.error_by_rays,
                                .rays = (double)rows * columns_of(rows),
                                .radius =
                                    fmin(radius, least * most_reach_pixels / least_reach_pixels),
                                .least = least,
                                .clear = h.least_distance};
    const double served = fmax(record.radius, least);
    for (int c = 0; c < 3; c++) {
        const double value = c == 0 ? h.irradiance.r : c == 1 ? h.irradiance.g : h.irradiance.b;
        const double steepest = value / served, slope = orl_length(h.by_translation[c]);
        /* So near an edge that the value would be gone within the radius. */
        record.by_rotation[c] = h.by_rotation[c];
        record.by_translation[c] =
            orl_scale(h.by_translation[c], slope > steepest ? steepest / slope : 1);
    }
    return record;
}
