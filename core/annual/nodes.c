#include "annual/nodes.h"

#include <stdlib.h>

#include <oriel/error.h>

/* The sun as the sky's equator has it. */
struct place {
    double declination, hour_angle; /* radians, west positive */
};

/* Duffett-Smith 1988, section 25: horizon coordinates to equatorial ones. */
static struct place place_of(double latitude, struct orl_vec3 sun)
{
    const double s = sin(latitude), c = cos(latitude);
    const double sine = fmin(fmax(s * sun.z + c * sun.y, -1), 1);
    return (struct place){asin(sine), atan2(-sun.x, c * sun.z - s * sun.y)};
}

static struct orl_vec3 sun_at(double latitude, struct place place)
{
    const double s = sin(latitude), c = cos(latitude);
    const double d = cos(place.declination), up = sin(place.declination);
    const double w = cos(place.hour_angle);
    return orl_normalize(
        orl_v3(-d * sin(place.hour_angle), c * up - s * d * w, s * up + c * d * w));
}

/* The hour angle at which the sun sets: 0 where it never rises, pi where it never sets. */
static double setting(double latitude, double declination)
{
    const double x = -tan(latitude) * tan(declination);
    return acos(fmin(fmax(x, -1), 1));
}

static double circle_rad(const struct orl_sun_nodes *nodes, uint32_t circle)
{
    return nodes->circles < 2 ? nodes->low_rad
                              : nodes->low_rad + (nodes->high_rad - nodes->low_rad) * circle /
                                                     (nodes->circles - 1);
}

static uint32_t how_many(double span_deg, double step_deg)
{
    return (uint32_t)ceil(span_deg / step_deg - 1e-9) + 1;
}

static void span(struct orl_sun_nodes *nodes, const struct orl_vec3 *suns, size_t count)
{
    nodes->low_rad = INFINITY;
    nodes->high_rad = -INFINITY;
    for (size_t i = 0; i < count; i++) {
        const double d = place_of(nodes->latitude_rad, suns[i]).declination;
        nodes->low_rad = fmin(nodes->low_rad, d);
        nodes->high_rad = fmax(nodes->high_rad, d);
    }
}

int orl_sun_nodes_init(struct orl_sun_nodes *nodes, double latitude_deg,
                       const struct orl_vec3 *suns, size_t count, struct orl_sun_spacing steps)
{
    /* At a pole itself, hour angles have no beginning. */
    const double most_rad = 89.999 * ORL_DEG_TO_RAD;
    *nodes = (struct orl_sun_nodes){
        .latitude_rad = fmin(fmax(latitude_deg * ORL_DEG_TO_RAD, -most_rad), most_rad)};
    if (count == 0)
        return 0;
    span(nodes, suns, count);
    const double longest = fmax(setting(nodes->latitude_rad, nodes->low_rad),
                                setting(nodes->latitude_rad, nodes->high_rad));
    nodes->circles =
        how_many((nodes->high_rad - nodes->low_rad) / ORL_DEG_TO_RAD, steps.declination_deg);
    nodes->a_circle = how_many(2 * longest / ORL_DEG_TO_RAD, steps.hour_angle_deg);
    nodes->count = (size_t)nodes->circles * nodes->a_circle;
    nodes->at = malloc(nodes->count * sizeof *nodes->at);
    if (!nodes->at)
        return ORL_ERR_NOMEM;
    for (size_t i = 0; i < nodes->count; i++) {
        const double d = circle_rad(nodes, (uint32_t)(i / nodes->a_circle));
        const double along =
            nodes->a_circle < 2 ? 0.5 : (double)(i % nodes->a_circle) / (nodes->a_circle - 1);
        const double widest = setting(nodes->latitude_rad, d);
        nodes->at[i] = sun_at(nodes->latitude_rad, (struct place){d, widest * (2 * along - 1)});
    }
    return 0;
}

void orl_sun_nodes_done(struct orl_sun_nodes *nodes)
{
    free(nodes->at);
    *nodes = (struct orl_sun_nodes){.at = NULL};
}

/* Which two of n points on [0, 1] a share lies between: the first, and how far from it. */
static uint32_t cell(double share, uint32_t n, double *ret_part)
{
    const double at = fmin(fmax(share, 0), 1) * (n - 1);
    const uint32_t first = n < 2 ? 0 : (uint32_t)fmin(floor(at), n - 2.0);
    *ret_part = n < 2 ? 0 : at - first;
    return first;
}

struct orl_sun_between orl_sun_nodes_between(const struct orl_sun_nodes *nodes, struct orl_vec3 sun)
{
    const struct place place = place_of(nodes->latitude_rad, sun);
    const double height = nodes->high_rad - nodes->low_rad;
    const double widest = setting(nodes->latitude_rad, place.declination);
    double up, along;
    const uint32_t c =
        cell(height > 0 ? (place.declination - nodes->low_rad) / height : 0, nodes->circles, &up);
    const uint32_t k =
        cell(widest > 0 ? 0.5 + 0.5 * place.hour_angle / widest : 0.5, nodes->a_circle, &along);
    const uint32_t next_c = c + 1 < nodes->circles ? c + 1 : c;
    const uint32_t next_k = k + 1 < nodes->a_circle ? k + 1 : k;
    const uint32_t a = c * nodes->a_circle, b = next_c * nodes->a_circle;
    return (struct orl_sun_between){{a + k, a + next_k, b + k, b + next_k},
                                    {(float)((1 - up) * (1 - along)), (float)((1 - up) * along),
                                     (float)(up * (1 - along)), (float)(up * along)}};
}
