#include "annual/sun/sun_grid.h"

#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include <oriel/base/error.h>

/* The sun in equatorial coordinates. */
struct equatorial {
    double declination, hour_angle; /* radians, hour angle positive towards west */
};

/* Converts horizon coordinates to equatorial ones (Duffett-Smith 1988, section 25). */
static struct equatorial to_equatorial(double latitude, struct orl_vec3 sun)
{
    const double s = sin(latitude), c = cos(latitude);
    const double sine = fmin(fmax(s * sun.z + c * sun.y, -1), 1);
    return (struct equatorial){asin(sine), atan2(-sun.x, c * sun.z - s * sun.y)};
}

static struct orl_vec3 from_equatorial(double latitude, struct equatorial equatorial)
{
    const double s = sin(latitude), c = cos(latitude);
    const double d = cos(equatorial.declination), up = sin(equatorial.declination);
    const double w = cos(equatorial.hour_angle);
    return orl_normalize(
        orl_v3(-d * sin(equatorial.hour_angle), c * up - s * d * w, s * up + c * d * w));
}

/* Hour angle of sunset, rad: 0 if the sun never rises, pi if it never sets. */
static double sunset_angle(double latitude, double declination)
{
    const double x = -tan(latitude) * tan(declination);
    return acos(fmin(fmax(x, -1), 1));
}

static double circle_rad(const struct orl_sun_grid *nodes, uint32_t circle)
{
    return nodes->circles < 2 ? nodes->low_rad
                              : nodes->low_rad + (nodes->high_rad - nodes->low_rad) * circle /
                                                     (nodes->circles - 1);
}

static uint32_t count_steps(double span_deg, double step_deg)
{
    return (uint32_t)ceil(span_deg / step_deg - 1e-9) + 1;
}

static void span_declinations(struct orl_sun_grid *nodes, const struct orl_vec3 *suns, size_t count)
{
    nodes->low_rad = INFINITY;
    nodes->high_rad = -INFINITY;
    for (size_t i = 0; i < count; i++) {
        const double d = to_equatorial(nodes->latitude_rad, suns[i]).declination;
        nodes->low_rad = fmin(nodes->low_rad, d);
        nodes->high_rad = fmax(nodes->high_rad, d);
    }
}

int orl_sun_grid_init(struct orl_sun_grid *nodes, double latitude_deg, const struct orl_vec3 *suns,
                      size_t count, struct orl_sun_spacing steps)
{
    /* At a pole hour angles are undefined, so the latitude is clamped. */
    const double most_rad = 89.999 * ORL_DEG_TO_RAD;
    *nodes = (struct orl_sun_grid){
        .latitude_rad = fmin(fmax(latitude_deg * ORL_DEG_TO_RAD, -most_rad), most_rad)};
    if (count == 0)
        return 0;
    span_declinations(nodes, suns, count);
    const double longest = fmax(sunset_angle(nodes->latitude_rad, nodes->low_rad),
                                sunset_angle(nodes->latitude_rad, nodes->high_rad));
    nodes->circles =
        count_steps((nodes->high_rad - nodes->low_rad) / ORL_DEG_TO_RAD, steps.declination_deg);
    nodes->nodes_per_circle = count_steps(2 * longest / ORL_DEG_TO_RAD, steps.hour_angle_deg) | 1;
    nodes->count = (size_t)nodes->circles * nodes->nodes_per_circle;
    nodes->at = malloc(nodes->count * sizeof *nodes->at);
    if (!nodes->at)
        return ORL_ERR_NOMEM;
    for (size_t i = 0; i < nodes->count; i++) {
        const double d = circle_rad(nodes, (uint32_t)(i / nodes->nodes_per_circle));
        const double along = nodes->nodes_per_circle < 2 ? 0.5
                                                         : (double)(i % nodes->nodes_per_circle) /
                                                               (nodes->nodes_per_circle - 1);
        const double widest = sunset_angle(nodes->latitude_rad, d);
        nodes->at[i] =
            from_equatorial(nodes->latitude_rad, (struct equatorial){d, widest * (2 * along - 1)});
    }
    return 0;
}

void orl_sun_grid_done(struct orl_sun_grid *nodes)
{
    free(nodes->at);
    *nodes = (struct orl_sun_grid){.at = NULL};
}

enum { TAPS = 4 };

/* The TAPS points nearest to a position among n points spaced evenly on [0, 1], and their
 * weights. */
struct taps {
    uint32_t at[TAPS];
    double cubic[TAPS], plain[TAPS], wide[TAPS];
};

/* Adds a point's weight. The weight of a point beyond an end goes to the three points inside it, by
 * extrapolating a parabola. */
static void add_tap(struct taps *taps, uint32_t first, uint32_t n, int tap, double weight)
{
    const int64_t at = (int64_t)first + tap - 1;
    if (at >= 0 && at < n) {
        taps->cubic[tap] += weight;
        return;
    }
    const int in = at < 0 ? 1 : -1;
    taps->cubic[tap + in] += 3 * weight;
    taps->cubic[tap + 2 * in] -= 3 * weight;
    taps->cubic[tap + 3 * in] += weight;
}

static struct taps taps_at(double share, uint32_t n)
{
    const double at = fmin(fmax(share, 0), 1) * (n - 1);
    const uint32_t first = n < 2 ? 0 : (uint32_t)fmin(floor(at), n - 2.0);
    const double t = n < 2 ? 0 : at - first;
    struct taps taps = {.plain = {0, 1 - t, t, 0}};
    for (int i = 0; i < TAPS; i++) {
        const int64_t k = (int64_t)first + i - 1;
        taps.at[i] = (uint32_t)(k < 0 ? 0 : k >= n ? n - 1 : k);
    }
    const bool inner = first > 0 && first + 2 < n;
    for (int i = 0; i < TAPS; i++)
        taps.cubic[i] = taps.wide[i] = taps.plain[i];
    if (n < 3)
        return taps;
    memset(taps.cubic, 0, sizeof taps.cubic);
    if (inner) {
        memset(taps.wide, 0, sizeof taps.wide);
        taps.wide[0] = (2 - t) / 3;
        taps.wide[TAPS - 1] = (1 + t) / 3;
    }
    const double t2 = t * t, t3 = t2 * t;
    const double weights[TAPS] = {0.5 * (-t + 2 * t2 - t3), 0.5 * (2 - 5 * t2 + 3 * t3),
                                  0.5 * (t + 4 * t2 - 3 * t3), 0.5 * (t3 - t2)};
    for (int i = 0; i < TAPS; i++)
        add_tap(&taps, first, n, i, weights[i]);
    return taps;
}

/* Returns true if the sun sets on some of the circles and never on others. Node positions then have
 * a kink that a cubic cannot follow. */
static bool is_kinked(const struct orl_sun_grid *nodes, const struct taps *up)
{
    bool sets = false, never = false;
    for (int i = 0; i < TAPS; i++) {
        const double at = sunset_angle(nodes->latitude_rad, circle_rad(nodes, up->at[i]));
        never = never || at <= 0 || at >= ORL_PI;
        sets = sets || (at > 0 && at < ORL_PI);
    }
    return sets && never;
}

struct orl_sun_interpolation orl_sun_grid_interpolate(const struct orl_sun_grid *nodes,
                                                      struct orl_vec3 sun)
{
    const struct equatorial equatorial = to_equatorial(nodes->latitude_rad, sun);
    const double height = nodes->high_rad - nodes->low_rad;
    const double widest = sunset_angle(nodes->latitude_rad, equatorial.declination);
    struct taps up = taps_at(height > 0 ? (equatorial.declination - nodes->low_rad) / height : 0,
                             nodes->circles);
    const struct taps along = taps_at(widest > 0 ? 0.5 + 0.5 * equatorial.hour_angle / widest : 0.5,
                                      nodes->nodes_per_circle);
    if (is_kinked(nodes, &up))
        memcpy(up.cubic, up.plain, sizeof up.cubic);
    struct orl_sun_interpolation ret;
    for (int i = 0; i < ORL_SUN_CORNERS; i++) {
        const int c = i / TAPS, k = i % TAPS;
        ret.nodes[i] = up.at[c] * nodes->nodes_per_circle + along.at[k];
        ret.weights[i] = (float)(up.cubic[c] * along.cubic[k]);
        ret.plain[i] = (float)(up.plain[c] * along.plain[k]);
        ret.wide[i] = (float)(up.wide[c] * along.wide[k]);
    }
    return ret;
}
