/* Floor plan of a scene: the lines in which a horizontal plane cuts its surfaces. */
#ifndef ORIEL_JOB_FLOOR_PLAN_H
#define ORIEL_JOB_FLOOR_PLAN_H

#include <oriel/job/run.h>

enum { ORL_FLOOR_PLAN_LINES = 8192 };

struct orl_floor_plan {
    double height;          /* z of the plane, scene units */
    double (*lines)[4];     /* x and y of both ends; owned */
    size_t count;           /* at most ORL_FLOOR_PLAN_LINES */
    bool more;              /* true: further lines exist, shorter than all of these */
    double low[3], high[3]; /* bounds of the scene; 0 without surfaces */
};

/*
 * Cuts the scene at that height; NAN: half-way up. Round surfaces are cut as prisms. Errors are
 * those of orl_scene_check.
 */
int orl_scene_floor_plan(const char *const *main_files, size_t n_files,
                         const struct orl_files *files, double height,
                         struct orl_floor_plan *ret_plan, struct orl_error *err);
void orl_floor_plan_done(struct orl_floor_plan *plan);

#endif
