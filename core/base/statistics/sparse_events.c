#include "base/statistics/sparse_events.h"

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

static double size2_of(const struct orl_ray_moments *moments)
{
    return sqrt(moments->eighths / moments->fourths);
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
                     square = few > 0 ? few * size2_of(&s->moments[i]) : 0;
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
