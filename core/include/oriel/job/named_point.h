/* Named point that results are reported for. */
#ifndef ORIEL_JOB_NAMED_POINT_H
#define ORIEL_JOB_NAMED_POINT_H

#include <stddef.h>
#include <stdlib.h>

#include <oriel/base/error.h>
#include <oriel/base/vec.h>

struct orl_named_point {
    char *name; /* owned */
    struct orl_vec3 at;
};

/* Checks each point with orl_check_point. Returns 0 or ORL_ERR_RANGE, with the point's name. */
int orl_named_points_check(const struct orl_named_point *points, size_t n, struct orl_error *err);

static inline void orl_named_points_free(struct orl_named_point *points, size_t n)
{
    for (size_t i = 0; points && i < n; i++)
        free(points[i].name);
    free(points);
}

#endif
