/*
 * A scene as a floor plan: where a level plane cuts its surfaces, as one draws a plan of a
 * building.
 */
#ifndef ORIEL_FLOOR_PLAN_H
#define ORIEL_FLOOR_PLAN_H

#include <oriel/run.h>

enum { ORL_FLOOR_PLAN_LINES = 8192 };

struct orl_floor_plan {
    double height;          /* of the plane: z, in scene units */
    double (*lines)[4];     /* x and y of one end, of the other; owned */
    size_t count;           /* at most ORL_FLOOR_PLAN_LINES */
    bool more;              /* there were others, shorter than all of these */
    double low[3], high[3]; /* bounds of the scene; 0 where it has no surfaces */
};

/*
 * Of the scene at that height; half-way up when it is NAN. Round surfaces are cut as prisms. Errors
 * are those of orl_scene_check.
 */
int orl_scene_floor_plan(const char *const *main_files, size_t n_files,
                         const struct orl_files *files, double height,
                         struct orl_floor_plan *ret_plan, struct orl_error *err);
void orl_floor_plan_done(struct orl_floor_plan *plan);

#endif
