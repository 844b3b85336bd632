/* Sunlight at sensors through BSDF panes. */
#ifndef ORL_ANNUAL_PANES_BSDF_PANES_H
#define ORL_ANNUAL_PANES_BSDF_PANES_H

#include "annual/panes/bounding_rects.h"
#include "annual/sky/hours.h"
#include "annual/sun/sunlight.h"
#include "annual/year/annual_scene.h"
#include "base/memory/memory.h"
#include "base/sampling/sampling.h"
#include "bsdf/loaded_bsdf.h"
#include "light/direct.h"

/*
 * BSDF samples of an hour's sun: the directions into the room in which a kind of BSDF pane sends
 * it. Each sample has a random point of the sun's disc. All sensors and panes of the kind share
 * them.
 */

enum { ORL_BSDF_PANE_SAMPLES = 128 /* samples per kind of pane and sun */ };

struct orl_bsdf_pane_kind {
    const struct orl_material *material;
    struct orl_vec3 normal, inward;
    struct orl_frame frame; /* local frame of the BSDF */
    /* True if the material is its BSDF data alone, with nothing added or removed. */
    bool data_alone;
};

/* A direction in which a kind of pane sends an hour's sun into the room. */
struct orl_bsdf_pane_sample {
    float light;   /* radiance divided by pdf, for a sun with a normal irradiance of 1 */
    float density; /* pdf of the direction for that point of the disc, per steradian */
    float from[2]; /* sample numbers of the point on the disc */
};

/* Samples of an hour's sun. Directions are stored by coordinate, for vectorised loops. */
struct orl_bsdf_pane_samples {
    float towards[3][ORL_BSDF_PANE_SAMPLES];
    struct orl_bsdf_pane_sample at[ORL_BSDF_PANE_SAMPLES];
    bool spans_cells; /* true if the disc spans cells of the BSDF with different transmittances */
    /* True if the whole disc lies in one cell of the BSDF, which `middle` holds. */
    bool in_one_cell;
    /* Incidence from the centre of the disc; valid if the kind has data alone. */
    struct orl_bsdf_incidence middle;
};

static inline struct orl_sun orl_bsdf_pane_sun_disc(const struct orl_hour_sun *sun)
{
    return (struct orl_sun){.frame = orl_frame_about(sun->towards),
                            .cos_half_angle = cos(0.5 * sun->angle_rad)};
}

static inline struct orl_bsdf_incidence
orl_bsdf_pane_incidence(const struct orl_bsdf_pane_kind *kind, struct orl_vec3 from)
{
    return orl_bsdf_locate_incident(orl_material_bsdf(kind->material),
                                    orl_to_local(&kind->frame, from));
}

/* Samples a kind's BSDF for a sun. seed: for these samples alone. */
void orl_bsdf_pane_samples_make(const struct orl_bsdf_pane_kind *kind,
                                const struct orl_hour_sun *sun, const struct orl_sobol *sobol,
                                uint64_t seed, struct orl_bsdf_pane_samples *ret_samples);

/*
 * Sunlight at sensors through BSDF panes, with the position of the sun of every hour.
 *
 * Two techniques sample the radiance that a pane sends to a sensor: points of the pane, and BSDF
 * samples of the hour's sun. They are weighted by the balance heuristic (Veach 1997, chapter 9).
 * BSDF samples do not depend on the position of the pane or the sensor, so all sensors share them.
 * Visibility of a pane from a sensor is computed once for all hours.
 *
 * Most panes are fully visible from a sensor, and fully in the sun or in shade. If 64 stratified
 * points of a pane agree, no more rays are traced for that sensor or that sun. An obstacle that
 * hides a share f of the pane is missed with probability (1 - f)^64. The mean error is at most 0.6
 * % of the light. Points behind the sensor's plane do not count. With half of the points it is 1.1
 * %; with fewer points rays are traced. A pane is probed for a sun when the first sensor needs the
 * two.
 *
 * Panes are ports of a sealed building. Immutable once made, except for the results of probes,
 * which do not depend on the order of requests.
 */

enum {
    ORL_BSDF_PANE_PROBING_SENSORS = 16
}; /* with fewer sensors, probes cost more than they save */

enum {
    ORL_BSDF_PANE_SIDE = 8, /* strata of a pane along an edge */
    ORL_BSDF_PANE_STRATA = ORL_BSDF_PANE_SIDE * ORL_BSDF_PANE_SIDE,
    ORL_BSDF_PANE_BATCHES = 8,     /* independent batches, for standard errors */
    ORL_BSDF_PANE_MOST_KINDS = 32, /* kinds: combinations of material and normal */
};

struct orl_bsdf_pane {
    struct orl_bounding_rect window;
    struct orl_vec3 inward;
    uint32_t kind;         /* index into kinds */
    uint32_t window_group; /* window group (annual_scene.h) */
    double area;
};

struct orl_bsdf_panes {
    const struct orl_lit_scene *lit_scene; /* borrowed, like suns */
    const struct orl_year_suns *suns;
    struct orl_arrays arrays; /* owns all arrays */
    struct orl_bsdf_pane *at;
    size_t count;
    struct orl_bsdf_pane_kind kinds[ORL_BSDF_PANE_MOST_KINDS];
    size_t n_kinds;
    struct orl_bsdf_pane_samples *samples; /* [kind][sun] */
    uint64_t seed;
    /* [pane][sun]: share of the sun's light that reaches all points of the pane. -1: points differ;
     * -2: not probed yet. NULL: panes are not probed. */
    _Atomic float *sunlit;
};

/* Returns 0, ORL_ERR_NOMEM, _LIMIT (too many kinds) or _CANCELLED. The caller calls
 * orl_bsdf_panes_done in either case. */
int orl_bsdf_panes_init(struct orl_bsdf_panes *bsdf_panes, const struct orl_annual_scene *scene,
                        const struct orl_year_suns *suns, size_t n_sensors, uint64_t seed,
                        struct orl_thread_pool *pool);
static inline void orl_bsdf_panes_done(struct orl_bsdf_panes *bsdf_panes)
{
    orl_arrays_free(&bsdf_panes->arrays);
}

/* Adds the direct sunlight through BSDF panes for every wanted sun, and the square of its standard
 * error. name: number of the sensor, for random numbers. The cancel flag of the pool is polled
 * before each pane; the remaining panes are then left out. pool may be NULL. */
void orl_bsdf_panes_add(const struct orl_bsdf_panes *bsdf_panes,
                        const struct orl_shading_point *place, uint64_t name,
                        const struct orl_thread_pool *pool,
                        const struct orl_sensor_sunlight *sunlight);

#endif
