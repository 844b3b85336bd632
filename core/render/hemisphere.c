/* The gathered part at a place: a stratified hemisphere of rays. */
#include <stdlib.h>

#include "light/proxies.h"
#include "render/gather.h"

/* One ray of the hemisphere: what it saw and how far it went. */
struct strand {
    struct orl_rgb radiance;
    double distance;
};

static double channel(struct orl_rgb c, uint32_t i)
{
    return i == 0 ? c.r : i == 1 ? c.g : c.b;
}

/* A column's directions in the plane: along its middle, across that, and across its first edge. */
struct spoke {
    struct orl_vec3 out, turn, around;
};

static struct spoke spoke_of(const struct orl_frame *frame, uint32_t column, uint32_t columns)
{
    const double phi = 2 * ORL_PI * (column + 0.5) / columns, edge = 2 * ORL_PI * column / columns;
    return (struct spoke){
        .out = orl_add(orl_scale(frame->u, cos(phi)), orl_scale(frame->v, sin(phi))),
        .turn = orl_add(orl_scale(frame->u, -sin(phi)), orl_scale(frame->v, cos(phi))),
        .around = orl_add(orl_scale(frame->u, -sin(edge)), orl_scale(frame->v, cos(edge)))};
}

/* Adds one row's share of the gradients: differences to strands' neighbours below and beside. */
static void add_row(struct orl_hemisphere *h, const struct spoke *spokes,
                    const struct strand *strands, uint32_t rows, uint32_t columns, uint32_t row,
                    uint32_t channels)
{
    const double sine_low = sqrt((double)row / rows), sine_high = sqrt((row + 1.0) / rows);
    const double middle = sqrt((row + 0.5) / rows);
    const double turning = -middle / sqrt(1 - middle * middle) * ORL_PI / ((double)rows * columns);
    const double outwards = 2 * ORL_PI / columns * sine_low * (1 - sine_low * sine_low);
    for (uint32_t column = 0; column < columns; column++) {
        const struct strand *here = &strands[row * columns + column];
        const struct strand *beside = &strands[row * columns + (column + columns - 1) % columns];
        const struct strand *below = row > 0 ? here - columns : NULL;
        const double by_below = below ? outwards / fmin(here->distance, below->distance) : 0;
        const double by_beside = (sine_high - sine_low) / fmin(here->distance, beside->distance);
        for (uint32_t c = 0; c < channels; c++) {
            const double value = channel(here->radiance, c);
            struct orl_vec3 *shift = &h->by_translation[c];
            h->by_rotation[c] = orl_madd(h->by_rotation[c], spokes[column].turn, turning * value);
            if (below)
                *shift = orl_madd(*shift, spokes[column].out,
                                  by_below * (value - channel(below->radiance, c)));
            *shift = orl_madd(*shift, spokes[column].around,
                              by_beside * (value - channel(beside->radiance, c)));
        }
    }
}

/* Without memory for the spokes gradients stay flat. */
static void add_gradients(struct orl_hemisphere *h, const struct orl_frame *frame,
                          const struct strand *strands, uint32_t rows, uint32_t columns,
                          uint32_t channels)
{
    struct spoke *spokes = malloc(columns * sizeof *spokes);
    for (uint32_t column = 0; spokes && column < columns; column++)
        spokes[column] = spoke_of(frame, column, columns);
    for (uint32_t row = 0; spokes && row < rows; row++)
        add_row(h, spokes, strands, rows, columns, row, channels);
    free(spokes);
}

/* Of the mean of the rays, one a stratum: half the squared difference of neighbours is a variance.
 */
static double variance_of_mean(const struct strand *strands, uint32_t rows, uint32_t columns)
{
    double square = 0;
    for (uint32_t i = 0; i < rows * columns; i++) {
        const uint32_t row = i / columns, beside = row * columns + (i + 1) % columns;
        const double difference =
            orl_luma(strands[i].radiance) - orl_luma(strands[beside].radiance);
        square += difference * difference / 2;
    }
    return square / ((double)rows * columns * rows * columns);
}

/* What a ray sees: on a surface that a BSDF stands for, as views do. */
static struct strand follow(const struct orl_gather *gather, const struct orl_place *place,
                            struct orl_gather_ray ray, struct orl_random *random,
                            struct orl_search *search)
{
    struct strand strand = {.distance = INFINITY};
    ray.ret_distance = &strand.distance;
    strand.radiance =
        place->proxied
            ? orl_health_keep(&search->health,
                              orl_exterior_radiance(orl_world_seen(gather->world), ray.origin,
                                                    ray.direction, orl_chance_found(), random,
                                                    &search->health))
            : orl_gather_radiance(gather, &ray, random, search);
    strand.distance = fmax(strand.distance, 1e-9 * gather->world->geometry->radius);
    return strand;
}

struct orl_hemisphere orl_gather_hemisphere(const struct orl_gather *gather,
                                            const struct orl_place *place, uint32_t rows,
                                            uint32_t columns, struct orl_random *random,
                                            struct orl_search *search)
{
    const struct orl_frame frame = orl_frame_about(place->normal);
    const uint32_t channels = gather->world->omit.channels;
    struct orl_hemisphere h = {.irradiance = {0, 0, 0}};
    struct orl_tally tally = {{{{0}}}};
    double nearness = 0;
    const uint32_t sequence = (uint32_t)orl_random_bits(random);
    h.least_distance = INFINITY;
    struct strand *strands = calloc((size_t)rows * columns, sizeof *strands);
    for (uint32_t i = 0; i < rows * columns; i++) {
        const uint32_t row = i / columns, column = i % columns;
        const double sine = sqrt((row + orl_random_uniform(random)) / rows);
        const double phi = 2 * ORL_PI * (column + orl_random_uniform(random)) / columns;
        const struct orl_vec3 direction = orl_to_world(
            &frame, orl_v3(sine * cos(phi), sine * sin(phi), sqrt(fmax(0, 1 - sine * sine))));
        double first[3];
        orl_sobol_point(&gather->sobol, i, sequence, 3, first);
        const struct orl_gather_ray ray = {.origin = place->point,
                                           .direction = direction,
                                           .outside = place->outside,
                                           .first = first,
                                           .by_texels = true,
                                           .tally = &tally,
                                           .share = ORL_PI / ((double)rows * columns)};
        const struct strand strand = follow(gather, place, ray, random, search);
        h.irradiance = orl_rgb_add(h.irradiance, strand.radiance);
        nearness += 1 / strand.distance;
        h.least_distance = fmin(h.least_distance, strand.distance);
        if (strands)
            strands[i] = strand;
    }
    h.irradiance = orl_rgb_scale(h.irradiance, ORL_PI / ((double)rows * columns));
    h.mean_distance = nearness > 0 ? (double)rows * columns / nearness : INFINITY;
    /* Without memory for the strands the estimate stands, with flat gradients. */
    if (strands)
        add_gradients(&h, &frame, strands, rows, columns, channels);
    for (uint32_t c = channels; c < 3; c++) {
        h.by_rotation[c] = h.by_rotation[0];
        h.by_translation[c] = h.by_translation[0];
    }
    h.error_by_photons = sqrt(orl_tally_variance(&tally));
    h.error_by_rays = strands ? ORL_PI * sqrt(variance_of_mean(strands, rows, columns)) : 0;
    free(strands);
    return h;
}
