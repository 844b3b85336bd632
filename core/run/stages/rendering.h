/*
 * The render stage: sensors in chunks, views one by one; a sensor's values and a view's glare
 * in the result.
 */
#ifndef ORL_RUN_STAGES_RENDERING_H
#define ORL_RUN_STAGES_RENDERING_H

#include <stdatomic.h>

#include "base/sampling/sampling.h"
#include "base/statistics/estimate.h"
#include "render/film/film.h"
#include "render/technique/technique.h"
#include "run/distributed/task_work.h"
#include "run/run_state.h"

uint32_t orl_run_sensor_samples(const struct orl_run_state *state, size_t index);

/* Stores a sensor's value and errors in the result, in lux. */
void orl_run_store_sensor(const struct orl_run_state *state, size_t index,
                          const struct orl_estimate *estimate);

/* Widens errors and intervals by the light that sensors have missed by chance, as the other sensors
 * show (base/statistics/estimate.h). Call it after all are recorded. */
void orl_run_add_sparse_errors(struct orl_result *result, const struct orl_sensor *sensors,
                               const struct orl_ray_moments *rays);

/* Render stage: computes sensors and views by state->renderer, which is prepared, into the result
 * and the output folder. */
int orl_run_render(struct orl_run_state *state, struct orl_error *err);

/* State of the render stage: sensors in chunks, views one by one. render_stage.c renders all of
 * them; shared_rendering.c distributes them as tasks. */

/* Maximum sensors of a chunk; cancelling is polled between chunks. */
enum { ORL_SENSOR_CHUNK = 128 };

/* Position of one view in the progress of the stage. */
struct orl_view_progress {
    const struct orl_run_state *state;
    double before, share; /* shares of the stage: before the view, and of painting it */
};

/* Counters and progress of the render stage. */
struct orl_rendering {
    struct orl_run_state *state;
    size_t chunk;  /* sensors of each chunk but the last */
    size_t first;  /* first sensor of this chunk, in permuted order */
    double share;  /* the sensors' share of the stage */
    size_t stride; /* stride of the permutation */
    uint64_t samples;
    atomic_uint_fast64_t samples_done; /* samples of sensors done so far */
    double done_by_main;               /* samples of samples_done that the lead thread did */
    double total_done;                 /* samples done, including those of other processes */
    struct orl_view_progress *views;
    struct orl_sensor_estimate found[ORL_SENSOR_CHUNK];
};

/* Returns the sensor at a place of the permuted order. */
static inline size_t orl_rendering_sensor_at(const struct orl_rendering *rendering, size_t place)
{
    return orl_golden_order(place, rendering->stride, rendering->state->n_sensors);
}

static inline size_t orl_sensor_chunk_size(const struct orl_rendering *rendering, size_t first)
{
    const size_t left = rendering->state->n_sensors - first;
    return left < rendering->chunk ? left : rendering->chunk;
}

/* Returns the number of sensors in a task of a distributed job: few enough for a thousand
 * processes. Results do not depend on it. */
static inline size_t orl_task_chunk_size(size_t n_sensors)
{
    enum { CHUNKS = 2000, LEAST = 8 };
    const size_t size = n_sensors / CHUNKS;
    return size < LEAST ? LEAST : size < ORL_SENSOR_CHUNK ? size : ORL_SENSOR_CHUNK;
}

/* Reports progress. */
void orl_rendering_report_sensors(const struct orl_rendering *rendering);
/* Computes and records a chunk; rendering->found has its results. */
int orl_rendering_compute_chunk(struct orl_rendering *rendering, size_t first,
                                struct orl_error *err);
/* Records a sensor that another process has computed. */
void orl_rendering_load_sensor(struct orl_rendering *rendering, size_t sensor,
                               const struct orl_sensor_estimate *found);
/* Distributes all sensors as tasks of a distributed run. */
int orl_rendering_share_sensors(struct orl_rendering *rendering, struct orl_error *err);

/* Prepares a view's empty picture and issues its warnings. The caller owns *ret_film. */
int orl_rendering_open_view(struct orl_run_state *state, size_t index, struct orl_view *ret_view,
                            struct orl_film *ret_film, struct orl_error *err);
/* Prepares and paints a view. The caller owns *ret_film. */
int orl_rendering_paint_view(struct orl_rendering *rendering, size_t index,
                             struct orl_film *ret_film, struct orl_error *err);
/* Stores or writes a finished picture. started_s: time at which it was begun. */
int orl_rendering_finish_view(struct orl_rendering *rendering, size_t index,
                              const struct orl_film *film, double started_s, struct orl_error *err);
/* Distributes views as tasks of a distributed run. */
int orl_rendering_share_views(struct orl_rendering *rendering, const size_t *views, size_t n,
                              struct orl_error *err);

/* Glare of a view, in the result. */

/* Reads the luminances of the mask that a view with metrics names; the caller owns *ret_mask, which
 * is NULL if there is no mask. Fails if the picture cannot be read or has another size. */
int orl_run_read_mask(const struct orl_files *files, const struct orl_view_request *view,
                      float **ret_mask, struct orl_error *err);

/* Stores the glare of a view with metrics in the result. */
int orl_run_evaluate_glare(struct orl_run_state *state, size_t index, const struct orl_film *film,
                           struct orl_error *err);
/* Stores the errors of that glare, from the view's batches; call it after orl_run_evaluate_glare.
 */
struct orl_view_batches;
int orl_run_evaluate_glare_errors(struct orl_run_state *state, size_t index,
                                  const struct orl_film *film,
                                  const struct orl_view_batches *batches, struct orl_error *err);

#endif
