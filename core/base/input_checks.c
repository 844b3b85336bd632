#include <math.h>
#include <stdbool.h>
#include <stdio.h>

#include <oriel/base/input_checks.h>
#include <oriel/base/limits.h>

static bool is_within_limit(struct orl_vec3 v)
{
    const double most = ORL_LIMIT_DISTANCE;
    return fabs(v.x) <= most && fabs(v.y) <= most && fabs(v.z) <= most;
}

int orl_check_point(struct orl_vec3 point, const char *what, struct orl_error *err)
{
    if (is_within_limit(point))
        return 0;
    return orl_error_set(err, ORL_ERR_RANGE,
                         "%s: a position needs finite coordinates of at most %g in magnitude", what,
                         ORL_LIMIT_DISTANCE);
}

int orl_check_direction(struct orl_vec3 direction, const char *what, struct orl_error *err)
{
    if (!is_within_limit(direction))
        return orl_error_set(err, ORL_ERR_RANGE,
                             "%s: a direction needs finite components of at most %g in magnitude",
                             what, ORL_LIMIT_DISTANCE);
    /* The squares of a very short direction underflow, and then it has no unit vector. */
    if (!isnormal(orl_dot(direction, direction)))
        return orl_error_set(err, ORL_ERR_RANGE, "%s: the direction has no length", what);
    return 0;
}

int orl_named_points_check(const struct orl_named_point *places, size_t n, struct orl_error *err)
{
    int code = 0;
    for (size_t i = 0; i < n && code == 0; i++) {
        char what[96];
        snprintf(what, sizeof what, "the point '%.64s'", places[i].name ? places[i].name : "");
        code = orl_check_point(places[i].at, what, err);
    }
    return code;
}

void orl_health_add(struct orl_health *sum, const struct orl_health *part)
{
    const struct orl_vec3 first = sum->leak_towards;
    sum->non_finite += part->non_finite;
    sum->bsdf_clamped += part->bsdf_clamped;
    sum->bsdf_rescaled += part->bsdf_rescaled;
    sum->degenerate += part->degenerate;
    sum->photons_capped += part->photons_capped;
    sum->paths_capped += part->paths_capped;
    sum->rays_leaked += part->rays_leaked;
    sum->sparse += part->sparse;
    sum->bsdf_values += part->bsdf_values;
    sum->surfaces += part->surfaces;
    sum->instances += part->instances;
    sum->photons += part->photons;
    sum->paths += part->paths;
    sum->rays += part->rays;
    sum->estimates += part->estimates;
    sum->flux_w += part->flux_w;
    sum->flux_capped_w += part->flux_capped_w;
    if (first.x == 0 && first.y == 0 && first.z == 0) {
        sum->leak_from = part->leak_from;
        sum->leak_towards = part->leak_towards;
    }
}
