#include <oriel/base/coordinates.h>

#include <math.h>
#include <stdbool.h>
#include <stdio.h>

#include <oriel/base/limits.h>
#include <oriel/job/named_point.h>

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
