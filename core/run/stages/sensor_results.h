/* The render stage, and a sensor's values in the result. */
#ifndef ORL_RUN_STAGES_SENSOR_RESULTS_H
#define ORL_RUN_STAGES_SENSOR_RESULTS_H

#include "base/statistics/estimate.h"
#include "render/image/paint.h"
#include "run/run_state.h"

/* Result of a sensor. */
struct orl_sensor_estimate {
    struct orl_estimate estimate;
    /* 1: it receives caustics otherwise than by density (render/gather/gather.h) */
    uint64_t in_free_space;
};

/* Callbacks of a technique for the render stage. */
struct orl_renderer {
    void *ctx;
    /* Computes a sensor and records it; called by any member of the crew. */
    void (*sensor)(void *ctx, size_t index, uint32_t member, struct orl_sensor_estimate *ret_found);
    /* Records a sensor that another process has computed. */
    void (*sensor_loaded)(void *ctx, size_t index, const struct orl_sensor_estimate *found);
    /* Work for all sensors together, after all of them; may be NULL. */
    int (*sensors)(void *ctx, struct orl_error *err);
    int (*view)(void *ctx, const struct orl_painting *painting, struct orl_error *err);
};

uint32_t orl_run_sensor_samples(const struct orl_run_state *state, size_t index);

/* Stores a sensor's value and errors in the result, in lux. */
void orl_run_store_sensor(const struct orl_run_state *state, size_t index,
                          const struct orl_estimate *estimate);

/* Widens errors and intervals by the light that sensors have missed by chance, as the other sensors
 * show (base/statistics/sparse_events.h). Call it after all are recorded. */
void orl_run_add_sparse_errors(struct orl_result *result, const struct orl_sensor *sensors,
                               const struct orl_ray_moments *rays);

/* Render stage: computes sensors and views into the result and the output folder. */
int orl_run_render(struct orl_run_state *state, const struct orl_renderer *renderer,
                   struct orl_error *err);

#endif
