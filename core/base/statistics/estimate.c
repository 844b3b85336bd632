#include "base/statistics/estimate.h"

#include <math.h>

/* Number of events below which they count as few. A variance from so many events is known as well
 * as one from 16 groups of many rays: its relative variance is 1 / number, and 2 / 15 for
 * groups. */
static const double fewest_events = 7.5;

static const double least_share = 0.5; /* share of a variance that events must cause to count */

/* Floor of a sensor's value, relative to the mean of the sensors. */
static const double darkest = 1e-3;

static const double normal_95 = 1.959963984540054;

struct orl_ray_moments orl_ray_moments_mix(struct orl_ray_moments a, double of_a,
                                           struct orl_ray_moments b, double of_b)
{
    const double a4 = pow(of_a, 4), b4 = pow(of_b, 4);
    return (struct orl_ray_moments){a4 * a.fourths + b4 * b.fourths,
                                    a4 * a4 * a.eighths + b4 * b4 * b.eighths};
}

/* Returns the effective number of the brightest rays; 0 if there is no light, or they are many. */
static double effective_count(const struct orl_ray_moments *moments)
{
    const double n =
        moments->eighths > 0 ? moments->fourths * moments->fourths / moments->eighths : 0;
    return n < fewest_events ? n : 0;
}

int orl_sensor_orientation(struct orl_vec3 direction)
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

static void average_light(const struct orl_sparse_event_sensors *s,
                          struct orl_sparse_events ret_sparse[ORL_SENSOR_ORIENTATIONS],
                          size_t ret_counts[ORL_SENSOR_ORIENTATIONS])
{
    for (int orientation = 0; orientation < ORL_SENSOR_ORIENTATIONS; orientation++) {
        ret_sparse[orientation] = (struct orl_sparse_events){0, 0, 0};
        ret_counts[orientation] = 0;
    }
    for (size_t i = 0; i < s->count; i++) {
        const int orientation = orl_sensor_orientation(s->sensors[i].direction);
        ret_sparse[orientation].light += s->values[i];
        ret_counts[orientation]++;
    }
    for (int orientation = 0; orientation < ORL_SENSOR_ORIENTATIONS; orientation++)
        if (ret_counts[orientation] > 0)
            ret_sparse[orientation].light /= (double)ret_counts[orientation];
}

void orl_sparse_events_of(const struct orl_sparse_event_sensors *s,
                          struct orl_sparse_events ret_sparse[ORL_SENSOR_ORIENTATIONS])
{
    double events[ORL_SENSOR_ORIENTATIONS] = {0}, squares[ORL_SENSOR_ORIENTATIONS] = {0};
    size_t counts[ORL_SENSOR_ORIENTATIONS];
    average_light(s, ret_sparse, counts);
    for (size_t i = 0; i < s->count; i++) {
        const int orientation = orl_sensor_orientation(s->sensors[i].direction);
        const double few = effective_count(&s->moments[i]),
                     square =
                         few > 0 ? few * sqrt(s->moments[i].eighths / s->moments[i].fourths) : 0;
        const double unit = unit_of(s->values[i], ret_sparse[orientation].light);
        if (square > least_share * s->standard_errors[i] * s->standard_errors[i]) {
            events[orientation] += few;
            squares[orientation] += square / (unit * unit);
        }
    }
    for (int orientation = 0; orientation < ORL_SENSOR_ORIENTATIONS; orientation++)
        if (events[orientation] > 0) {
            ret_sparse[orientation].events = events[orientation] / (double)counts[orientation];
            ret_sparse[orientation].size = sqrt(squares[orientation] / events[orientation]);
        }
}

/* Returns a percentile of a gamma law of scale 1; `normal` is the percentile of the normal law. */
static double gamma_at(double shape, double normal)
{
    const double root = 1 - 1 / (9 * shape) + normal / (3 * sqrt(shape));
    return shape * fmax(root * root * root, 0);
}

struct orl_sparse_event_bounds orl_sparse_event_bounds(const struct orl_sparse_events *sparse,
                                                       const struct orl_ray_moments *own,
                                                       double value)
{
    if (!(sparse->events > 0))
        return (struct orl_sparse_event_bounds){0, 0, 0};
    const double met = effective_count(own), shape = 1 + met;
    const double scale = sparse->events / (1 + sparse->events);
    const double size = sparse->size * unit_of(value, sparse->light);
    return (struct orl_sparse_event_bounds){
        .standard_error = size * sqrt(shape) * scale,
        .below = size * fmax(met - scale * gamma_at(shape, -normal_95), 0),
        .above = size * fmax(scale * gamma_at(shape, normal_95) - met, 0)};
}

/* Smallest skewness of a single group that counts. Chance gives 16 normal groups a standard
 * deviation of 0.56. */
static const double least_skewness = 1;
/* Ratio of true to observed skewness for 16 groups. Lognormal groups (sigma 0.5 to 1) show a half
 * to a quarter of it. */
static const double skewness_correction = 2;

struct orl_estimate orl_estimate_of_mean(const struct orl_rgb *values, uint32_t count)
{
    struct orl_rgb mean = orl_gray(0);
    double square = 0, cube = 0;
    const double n = count;
    for (uint32_t i = 0; i < count; i++)
        mean = orl_rgb_add(mean, orl_rgb_scale(values[i], 1.0 / count));
    for (uint32_t i = 0; i < count; i++) {
        const double off = orl_luma(values[i]) - orl_luma(mean);
        square += off * off;
        cube += off * off * off;
    }
    return (struct orl_estimate){.value = mean,
                                 .standard_error = sqrt(square / n / (n - 1)),
                                 .degrees_of_freedom = n - 1,
                                 .third_cumulant = count > 2 ? cube / (n * (n - 1) * (n - 2)) : 0};
}

struct orl_estimate orl_estimate_add(struct orl_estimate a, struct orl_estimate b)
{
    const double va = a.standard_error * a.standard_error, vb = b.standard_error * b.standard_error;
    const double spread = va * va / a.degrees_of_freedom + vb * vb / b.degrees_of_freedom;
    return (struct orl_estimate){.value = orl_rgb_add(a.value, b.value),
                                 .standard_error = sqrt(va + vb),
                                 .degrees_of_freedom =
                                     spread > 0 ? (va + vb) * (va + vb) / spread
                                                : fmin(a.degrees_of_freedom, b.degrees_of_freedom),
                                 .bias = a.bias + b.bias,
                                 .third_cumulant = a.third_cumulant + b.third_cumulant,
                                 .rays = orl_ray_moments_mix(a.rays, 1, b.rays, 1)};
}

/* Returns the ratio of Student's t to the normal law at 97.5 %. The first terms in 1 / degrees are
 * good to 1 % from 3 degrees on. */
static double student_over_normal(double degrees_of_freedom)
{
    const double z2 = normal_95 * normal_95, d = degrees_of_freedom;
    return 1 + (z2 + 1) / (4 * d) + ((5 * z2 + 16) * z2 + 3) / (96 * d * d) +
           (((3 * z2 + 19) * z2 + 17) * z2 - 15) / (384 * d * d * d);
}

static double normal_below(double x)
{
    return 0.5 * erfc(-x * sqrt(0.5));
}

/* Returns the 95th percentile of |N(bias, 1)|, by Newton's method from above, where the law is
 * concave. */
static double biased_95(double bias)
{
    double c = bias + normal_95;
    for (int i = 0; i < 6; i++) {
        const double off = normal_below(c - bias) - normal_below(-c - bias) - 0.95;
        const double slope =
            (exp(-0.5 * (c - bias) * (c - bias)) + exp(-0.5 * (c + bias) * (c + bias))) /
            sqrt(2 * acos(-1));
        c -= off / slope;
    }
    return c;
}

/* Returns the extension of the upper margin due to sparse events, in standard errors; t is
 * Student's. */
static double skewness_margin(const struct orl_estimate *e, double t)
{
    const double cube = e->standard_error * e->standard_error * e->standard_error;
    const double skewness = cube > 0 ? e->third_cumulant / cube : 0;
    if (!(skewness * sqrt(e->degrees_of_freedom + 1) > least_skewness))
        return 0;
    return skewness_correction * skewness * (1 + 2 * t * t) / 6;
}

struct orl_margins orl_estimate_margins(const struct orl_estimate *e)
{
    const double se = e->standard_error, bias = fabs(e->bias);
    if (!(se > 1e-6 * bias))
        return (struct orl_margins){bias, bias};
    const double student = student_over_normal(e->degrees_of_freedom);
    const double half = se * student * biased_95(bias / se);
    return (struct orl_margins){half, half + se * skewness_margin(e, student * normal_95)};
}
