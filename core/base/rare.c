#include "base/rare.h"

#include <math.h>

/* Number of events below which they count as few. A variance from so many events is known as well
 * as one from 16 groups of many rays: its relative variance is 1 / number, and 2 / 15 for
 * groups. */
static const double fewest_events = 7.5;

static const double least_share = 0.5; /* share of a variance that events must cause to count */

/* Floor of a sensor's value, relative to the mean of the sensors. */
static const double darkest = 1e-3;

static const double normal_95 = 1.959963984540054;

struct orl_rays orl_rays_mix(struct orl_rays a, double of_a, struct orl_rays b, double of_b)
{
    const double a4 = pow(of_a, 4), b4 = pow(of_b, 4);
    return (struct orl_rays){a4 * a.fourths + b4 * b.fourths,
                             a4 * a4 * a.eighths + b4 * b4 * b.eighths};
}

/* Returns the effective number of the brightest rays; 0 if there is no light, or they are many. */
static double few_of(const struct orl_rays *rays)
{
    const double n = rays->eighths > 0 ? rays->fourths * rays->fourths / rays->eighths : 0;
    return n < fewest_events ? n : 0;
}

static double size2_of(const struct orl_rays *rays)
{
    return sqrt(rays->eighths / rays->fourths);
}

int orl_rare_side(struct orl_vec3 direction)
{
    const double x = fabs(direction.x), y = fabs(direction.y), z = fabs(direction.z);
    if (z >= x && z >= y)
        return direction.z < 0;
    return y >= x ? 2 + (direction.y < 0) : 4 + (direction.x < 0);
}

/* Returns the unit of event sizes at a sensor of that value. */
static double unit_of(double value, double mean)
{
    return sqrt(fmax(value, darkest * mean));
}

static void average_light(const struct orl_rare_sensors *s,
                          struct orl_rare ret_rare[ORL_RARE_SIDES],
                          size_t ret_counts[ORL_RARE_SIDES])
{
    for (int side = 0; side < ORL_RARE_SIDES; side++) {
        ret_rare[side] = (struct orl_rare){0, 0, 0};
        ret_counts[side] = 0;
    }
    for (size_t i = 0; i < s->count; i++) {
        const int side = orl_rare_side(s->sensors[i].direction);
        ret_rare[side].light += s->values[i];
        ret_counts[side]++;
    }
    for (int side = 0; side < ORL_RARE_SIDES; side++)
        if (ret_counts[side] > 0)
            ret_rare[side].light /= (double)ret_counts[side];
}

void orl_rare_of(const struct orl_rare_sensors *s, struct orl_rare ret_rare[ORL_RARE_SIDES])
{
    double events[ORL_RARE_SIDES] = {0}, squares[ORL_RARE_SIDES] = {0};
    size_t counts[ORL_RARE_SIDES];
    average_light(s, ret_rare, counts);
    for (size_t i = 0; i < s->count; i++) {
        const int side = orl_rare_side(s->sensors[i].direction);
        const double few = few_of(&s->rays[i]), square = few > 0 ? few * size2_of(&s->rays[i]) : 0;
        const double unit = unit_of(s->values[i], ret_rare[side].light);
        if (square > least_share * s->standard_errors[i] * s->standard_errors[i]) {
            events[side] += few;
            squares[side] += square / (unit * unit);
        }
    }
    for (int side = 0; side < ORL_RARE_SIDES; side++)
        if (events[side] > 0) {
            ret_rare[side].events = events[side] / (double)counts[side];
            ret_rare[side].size = sqrt(squares[side] / events[side]);
        }
}

/* Returns a percentile of a gamma law of scale 1; `normal` is the percentile of the normal law. */
static double gamma_at(double shape, double normal)
{
    const double root = 1 - 1 / (9 * shape) + normal / (3 * sqrt(shape));
    return shape * fmax(root * root * root, 0);
}

struct orl_rare_bounds orl_rare_bounds(const struct orl_rare *rare, const struct orl_rays *own,
                                       double value)
{
    if (!(rare->events > 0))
        return (struct orl_rare_bounds){0, 0, 0};
    const double met = few_of(own), shape = 1 + met;
    const double scale = rare->events / (1 + rare->events);
    const double size = rare->size * unit_of(value, rare->light);
    return (struct orl_rare_bounds){
        .standard_error = size * sqrt(shape) * scale,
        .below = size * fmax(met - scale * gamma_at(shape, -normal_95), 0),
        .above = size * fmax(scale * gamma_at(shape, normal_95) - met, 0)};
}
