/*
 * State of an annual run that its stages share, and helpers that all of them need.
 *
 * Threads: the lead thread. sensor_chunks.c describes the work of the thread pool.
 */
#ifndef ORL_ANNUAL_YEAR_ANNUAL_YEAR_H
#define ORL_ANNUAL_YEAR_ANNUAL_YEAR_H

#include <stdatomic.h>

#include <oriel/annual/annual.h>
#include <oriel/base/sha256.h>

#include "annual/coefficients/apply_weather.h"
#include "annual/coefficients/chunk_sums.h"
#include "annual/panes/bsdf_panes.h"
#include "annual/sun/sun_weights.h"
#include "annual/year/annual_cache.h"
#include "annual/year/annual_scene.h"
#include "base/memory/memory.h"
#include "light/lights.h"

enum { ORL_YEAR_CHUNK = 64 }; /* most sensors of a chunk */

struct orl_year;

/* A run that sums light by window group (annual_scene.h). The last window group holds the
 * windows in no group. All pointers are borrowed. */
struct orl_year_window_groups {
    size_t n_groups;
    const bool *used; /* by group; a used group needs windows, and its other surfaces near them */
    const unsigned char
        *wanted; /* [window group][column]: the window group's light is added up there; NULL: all */
    bool direct_as_wanted; /* true if direct sunlight is needed only where wanted is set */
    /* Receives the direct sunlight of a window group at a sensor, by column, if nothing else is
     * requested. */
    void (*sunlit)(void *ctx, size_t sensor, uint32_t window_group, const float *lx);
    void *ctx; /* for sunlit */
};

/* Differences of a run from its request; zeros: none. All pointers are borrowed. */
struct orl_year_overrides {
    /* The year whose hours are used; NULL: the run reads its own. */
    const struct orl_year *hours_of;
    const struct orl_material_overrides
        *material_overrides; /* overrides of the scene's materials; may be NULL */
    const struct orl_year_window_groups
        *window_groups; /* NULL: light is not separated by window group */
    /* true if the run computes direct sunlight alone; other light stays 0. With window groups, it
     * calls their sunlit and writes nothing into the result. */
    bool sun_only;
    bool sensors_checked; /* an earlier run of the job has warned of misplaced sensors */
    /* Called once the year is prepared, before any chunk is computed. It may replace the year's
     * request by one that differs in its sensors alone. May be NULL. A negative orl_err ends the
     * run. */
    int (*prepared)(void *ctx, struct orl_year *year, struct orl_error *err);
    void *ctx; /* for prepared */
};

/* The current chunk of sensors. Arrays by sensor are indexed within the chunk. */
struct orl_year_chunk {
    /* True if runs share chunks: the one that computes a chunk also computes its hours. */
    bool shares_rows;
    size_t size; /* sensors of each chunk, except the last one */
    size_t first, count;
    atomic_size_t traced;   /* batches traced so far */
    uint32_t traced_before; /* samples of each batch that the store already had */
    struct orl_shading_point places[ORL_YEAR_CHUNK];
    struct orl_chunk_sums sums;
    unsigned char
        *wanted_suns; /* [window group][sun]: true if some column needs it; NULL: all suns */
    uint16_t *window_group_of_beam;
    float *rows;                       /* [sensor][total, direct, se][column] */
    float *interpolation_error;        /* [sensor][column]: relative error of interpolation
                                          (apply_weather.h) */
    struct orl_error_sums *error_sums; /* [tile][sensor][band] (apply_weather.h) */
    struct orl_sun_cells cells;
    bool *lit; /* by sensor and window group: true if it has coefficients */
    struct orl_sparse_coefficients *sparse;    /* by sensor and window group */
    double *node_values;                       /* node arrays of the coefficients */
    struct orl_annual_beams *beams;            /* by sensor */
    double *beam_values, *photon_batch_values; /* arrays of the beams */
    uint32_t *beam_lists;       /* [sensor][beam]: the beams that have coefficients */
    struct orl_health *healths; /* one per thread */
};

struct orl_year {
    const struct orl_annual_request *request;
    const struct orl_year_overrides *overrides;
    const struct orl_annual_env *env;
    struct orl_annual_result *result;
    struct orl_arrays arrays; /* freed with the year: node_frames, and the arrays of the chunk */
    struct orl_bins bins;
    struct orl_overcast overcast;
    struct orl_hours hours;
    struct orl_sun_grid nodes;
    struct orl_frame *node_frames; /* the nodes in the scene's axes, n towards the sun */
    struct orl_sun_weights sun_weights;
    size_t n_beams;
    struct orl_lights *lights;
    struct orl_lit_scene *lit_scene;
    struct orl_annual_scene scene;
    struct orl_bsdf_panes bsdf_panes;
    bool has_bsdf_panes; /* true once the BSDF panes are made */
    struct orl_annual_cache cache;
    unsigned char digest[ORL_SHA256_BYTES]; /* digest of the scene's files and overrides */
    /* True while warnings are suppressed: those stored with the suns have been issued. */
    bool warnings_emitted;
    uint32_t batch_samples;
    double started_s, chunks_s; /* by the run's clock: start of the run, and of its chunks */
    double reported_progress;   /* progress reported so far, 0..1; never decreases */
    size_t restored;            /* sensors whose rows were restored instead of computed */
    uint32_t n_window_groups;   /* window groups */
    struct orl_year_chunk chunk;
};

/* Does what orl_annual_run does, for one scene, and ignores the request's groups. overrides may be
 * NULL. */
int orl_year_run(const struct orl_annual_request *request, const struct orl_annual_env *env,
                 const struct orl_year_overrides *overrides, struct orl_annual_result *ret_result,
                 struct orl_error *err);

/* Returns [column] of a window group: nonzero where its light is added up; NULL: in all columns. */
static inline const unsigned char *orl_year_wanted(const struct orl_year *y, uint32_t window_group)
{
    const struct orl_year_window_groups *const groups = y->overrides->window_groups;
    return groups && groups->wanted ? groups->wanted + window_group * y->hours.n_columns : NULL;
}

/* Fill the year's hours: read them from its weather file, or borrow those of another year.
 * orl_year_move_hours hands the steps to the result. Hours that were read need orl_hours_done, also
 * after an error. Borrowed hours share all but steps and step_of_column, which are copies. */
int orl_year_read_hours(struct orl_year *y, struct orl_error *err);
int orl_year_borrow_hours(struct orl_year *y, const struct orl_year *from, struct orl_error *err);
void orl_year_move_hours(struct orl_year *y);

/* Lists of texts in a result. Adding a copy of a text returns 0 or ORL_ERR_NOMEM. */
bool orl_year_has_text(char *const *list, size_t count, const char *text);
int orl_year_add_text(char ***list, size_t *count, const char *text);

/* Returns the place of a sensor, moved clear of surfaces; the caller sets `outside`. */
struct orl_shading_point orl_year_place_of(const struct orl_year *y,
                                           const struct orl_sensor *sensor);

void orl_year_warn(struct orl_year *y, const char *format, ...)
    __attribute__((format(printf, 2, 3)));

double orl_year_now(const struct orl_year *y);
/* Adds the time since *since to a stage's timing, and sets *since to now. */
void orl_year_add_timing(struct orl_year *y, enum orl_annual_stage stage, double *since);

/* Reports the run's progress, estimated from the time that its chunks have taken so far. sensors:
 * the number that are done, whole or in part. */
void orl_year_report_progress(struct orl_year *y, enum orl_stage stage, double sensors);

/* Each sets err and returns its code. */
int orl_year_no_memory(struct orl_error *err);
int orl_year_cancelled(struct orl_error *err);
/* Sets one of these two errors, and returns its code. */
int orl_year_failed(const struct orl_year *y, int code, struct orl_error *err);

/*
 * Inputs of a year's light: lit scene, ports, mirrors, sunlight on surfaces inside, and BSDF panes,
 * each made when first needed; and interpolation weights of the suns over nodes and beams. If all
 * results come from a store, no ray is traced.
 *
 * Errors: ORL_ERR_UNSUPPORTED, naming a surface, _INVALID, _LIMIT, _NOMEM, _CANCELLED.
 */

/* Finds sun_weights and n_beams of a year whose nodes are placed. */
int orl_year_find_sun_weights(struct orl_year *y, struct orl_error *err);
/* Makes lit_scene and scene if necessary; paths need them. */
int orl_year_ensure_scene(struct orl_year *y, struct orl_error *err);
/* Also makes the BSDF panes; sunlight at sensors needs them. */
int orl_year_ensure_bsdf_panes(struct orl_year *y, struct orl_error *err);
void orl_year_inputs_done(struct orl_year *y);

#endif
