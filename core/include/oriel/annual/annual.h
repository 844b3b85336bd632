/*
 * A year of daylight at sensors: one set of paths per sensor, shared by all hours of a weather
 * file.
 *
 * The light of an hour at a sensor is the sum of three disjoint parts:
 * - Sky and ground: paths binned by the direction in which they leave the scene, times the radiance
 *   of the hour's sky there.
 * - The sun seen from the sensor, directly or through panes: at its true position in every hour,
 *   with its disc sampled.
 * - The sun by reflection at surfaces: computed for nodes in declination and hour angle, and
 *   interpolated between them.
 *
 * Conventions. Illuminances are in lux (179 lm/W). Hours are those of the weather file, at the
 * middle of the interval that a row stands for. The sun of an EPW row of hour 12 (11:00 to 12:00)
 * has its position at 11:30, and so has the sun of its step here. Skies are those of a `render` job
 * with `sky.weather`, with the same ground reflectance and sun (oriel/job/sky.h, ORL_SKY_FLUX).
 * Sensors are in scene units; directions need not be unit. A scene has no distant sources of its
 * own. Its lamps are left out, with a warning, because only daylight is computed.
 *
 * Direct. This definition of direct sunlight holds for everything that reads it: ASE, LM-83's
 * blinds and other controls by sun, hours of direct sunlight, .direct.ill. Direct sunlight reaches
 * a sensor after any number of transmissions and no reflection. It comes from the disc, through
 * panes of glass, or through a pane described by a BSDF, into any direction. Redirected and
 * scattered light counts. IES LM-83-12 defines ASE by the beam of the sun alone, without light from
 * other surfaces and with shades open. It has no rule for glazing that scatters. Radiance's
 * two-phase method with black surfaces, by which Honeybee computes ASE, counts the same light. A
 * matrix of Klems' basis spreads the sun over one of its cells, which is 10 to 15 degrees wide. The
 * flux of a patch of sun is then right, but its rim is blurred, and more sensors exceed 1000 lx
 * than behind glass. For clear panes, aBSDF, a tensor tree or glass keep the rim. Light through
 * trans and other diffuse surfaces is not direct.
 *
 * Errors. `se` is the standard error of `total`, and includes that of `direct`. It is estimated
 * from the differences between independent batches of paths, between groups of photons, and between
 * two ways of interpolating between the sun's nodes. Errors of ONE sensor are strongly correlated
 * over hours, since all hours use the same paths: the mean of a year is hardly more certain than an
 * hour. To get an interval of a quantity derived from a sensor's hours, move the whole row by a
 * common factor. Evaluate the quantity at value - z se and at value + z se, in every hour at once.
 * Sensors' errors are nearly independent of each other: they share only the sunlight on surfaces
 * inside.
 *
 * Results are the same bytes for any number of threads. Threads: the calling thread leads the pool.
 */
#ifndef ORIEL_ANNUAL_ANNUAL_H
#define ORIEL_ANNUAL_ANNUAL_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <oriel/annual/annual_shades.h>
#include <oriel/base/error.h>
#include <oriel/base/files.h>
#include <oriel/job/run.h>

/*
 * Matrices of other programs in place of paths: daylight coefficients, or the three-phase method
 * (McNeil and Lee 2013, J. Building Performance Simulation 6, 24), in Radiance's format.
 *
 * A term holds for the sensors of a grid in their order. It is either coefficients (sensors x sky
 * patches), or view (sensors x window exit directions) times transmission (exit directions x entry
 * directions) times daylight (entry directions x sky patches). Both are multiplied by the sky (sky
 * patches x rows of the weather file, as gendaymtx writes it; all rows, dark ones too), in W/m2 of
 * three channels. A transmission may be a BSDF's XML with a matrix, for light from outside. Windows
 * add up. A term may be subtracted, as in the five-phase method for the sun that patches contain.
 *
 * The sum is the year's total at the hours with light, clamped at 0. Since matrices carry no
 * errors, intervals are not known, and verdicts are unknown. Direct sunlight is still computed by
 * Oriel from the request's scene, with exact suns of all hours; it is not part of that total.
 */

enum { ORL_MATRICES_MOST_TERMS = 256 };

/* Term of the sum, with file names for the provider. All owned; orl_matrix_term_done frees them. */
struct orl_matrix_term {
    char *grid;         /* NULL: all sensors of the request */
    char *coefficients; /* alternative to the next three; unused names are NULL */
    char *view, *transmission, *daylight;
    char *sky;
    bool subtract;
};
void orl_matrix_term_done(struct orl_matrix_term *term); /* NULL and zeros are fine */

/* Reads the matrices of all terms, one file at a time. Returns in *ret_bytes the memory of the
 * largest term, in bytes, with its products and sky. Errors are those of reading the files. */
int orl_matrix_terms_measure(const struct orl_matrix_term *terms, size_t count,
                             const struct orl_files *files, uint64_t *ret_bytes,
                             struct orl_error *err);

/* ---- The request ----------------------------------------------------------------------------- */

/* Named group of sensors, such as a room's work plane. Grids lie one after the other. */
struct orl_annual_grid {
    char *name;
    size_t first, count; /* range of the request's sensors */
};

/*
 * Technique for sunlight inside the building. By paths: photons bring sunlight to the first diffuse
 * surfaces inside, and paths from sensors continue from surface to surface. Precomputed: photons of
 * each of the sun's nodes are traced until they are absorbed. Their deposits on surfaces are stored
 * by node, and paths read them at their first hit (contribution photons, Schregle, Bauer, Grobe and
 * Wienold 2015: there for 5184 suns and in spheres about points; here for the sun's nodes and in
 * squares of surfaces). Both techniques use paths for light of the sky, and for sunlight reflected
 * outdoors. Paths find bright spots only by chance; photons are dense there.
 */
enum orl_annual_technique { ORL_ANNUAL_BY_PATHS, ORL_ANNUAL_PRECOMPUTED, ORL_ANNUAL_TECHNIQUES };
const char *orl_annual_technique_name(enum orl_annual_technique technique);

/* Request for a year. It owns its strings and arrays; orl_annual_request_done frees them. */
struct orl_annual_request {
    char **scene_files; /* names for the provider, as in orl_job */
    size_t n_scene_files;
    char *weather_file;             /* EPW or WEA, for the provider */
    int weather_year;               /* keep only the rows of this year; 0: all rows */
    double north_deg;               /* true north, counter-clockwise from +Y */
    double ground_reflectance;      /* ground outdoors, if the scene has none; 0..1 */
    enum orl_sun_method sun_method; /* ORL_SUN_ACCURATE by default */
    struct orl_sensor *sensors;
    size_t n_sensors;
    struct orl_annual_grid *grids; /* optional; one after the other: no sensor is in two grids */
    size_t n_grids;
    struct orl_window_group *groups; /* windows with shades; optional */
    size_t n_groups;
    struct orl_matrix_term *terms; /* matrices of other programs that replace paths; optional */
    size_t n_terms;
    uint64_t seed;
    uint32_t samples; /* paths per sensor; 0: ORL_ANNUAL_SAMPLES */
    /* Number of times that the distance between the sun's nodes is halved. Each halving makes four
     * times the nodes. If interpolation errors dominate those of paths, more paths alone do not
     * help. */
    uint32_t sun_halvings;
    /* ORL_ANNUAL_PRECOMPUTED needs a closed building with windows. It supports no shades, no
     * matrices of other programs and no viewpoints. */
    enum orl_annual_technique technique;
    uint32_t photons;  /* photons for sunlight indoors, over all nodes; 0: chosen by the scene */
    bool coefficients; /* true: return daylight coefficients; not for years with shades */
};

enum {
    ORL_ANNUAL_SAMPLES = 2048,
    ORL_ANNUAL_BATCHES = 16,
    ORL_ANNUAL_MOST_SAMPLES = 1 << 20,
    ORL_ANNUAL_MOST_HALVINGS = 2,
    ORL_ANNUAL_MOST_PHOTONS = 200000000,
    ORL_ANNUAL_MOST_MAP_VALUES = 1 << 24 /* limit of values in the map of sunlight */
};

void orl_annual_request_init(struct orl_annual_request *request); /* sets the defaults */
/* NULL and half-filled are fine. */
void orl_annual_request_done(struct orl_annual_request *request);

/* Checks everything that needs no scene: counts, limits, finite numbers, grids in bounds. */
int orl_annual_validate(const struct orl_annual_request *request, struct orl_error *err);
/* Does the checks of orl_annual_validate that are possible before the scene is known and before
 * sensor files are read. */
int orl_annual_validate_numbers(const struct orl_annual_request *request, struct orl_error *err);

/* ---- The result ------------------------------------------------------------------------------ */

#define ORL_ANNUAL_DARK UINT32_MAX

/* Number of patches of the daylight coefficients: the ground, then Reinhart's sky MF:4 in the order
 * of Radiance's reinhart.cal and gendaymtx, azimuth clockwise from north. */
enum { ORL_ANNUAL_PATCHES = 2306 };

/* Row of the weather file. Steps are in the file's order. If the file's year continues over 31
 * December, the rows from 1 January on come first. */
struct orl_annual_step {
    int month, day;
    double hour;     /* middle of the interval, for which the sun's position is computed: 11.5 */
    bool missing;    /* true: sun and sky were not measured. The step has no value, and is not dark
                        either */
    uint32_t column; /* column of the arrays, or ORL_ANNUAL_DARK if the sky gives no light */
    /* From south towards west, true position of the middle of the disc. */
    double sun_altitude_deg, sun_azimuth_deg;
    double direct_normal_lx; /* illuminance by the sun's disc on a plane that faces it */
    double diffuse_lx;       /* sky alone, horizontal, unobstructed */
    double global_lx;        /* sky and sun, horizontal, unobstructed */
};

/* Kinds of intermediate data that later years can reuse: positions of suns among nodes and beams,
 * sunlight on surfaces inside, paths of chunks of sensors, and direct sunlight at sensors. */
enum orl_annual_cache_kind {
    ORL_ANNUAL_CACHE_SUN_WEIGHTS,
    ORL_ANNUAL_CACHE_SUN_MAP,
    ORL_ANNUAL_CACHE_PATHS,
    ORL_ANNUAL_CACHE_SUNLIGHT,
    ORL_ANNUAL_CACHE_KINDS
};
const char *
orl_annual_cache_kind_name(enum orl_annual_cache_kind kind); /* "suns", "map", "paths", "sun" */

struct orl_annual_cache_stats {
    /* Entries found complete, extended from fewer samples, and built anew. */
    uint64_t found, topped_up, made;
    uint64_t rays_saved; /* paths only: rays that an earlier run had cast */
};
static inline void orl_annual_cache_stats_add(struct orl_annual_cache_stats *sum,
                                              const struct orl_annual_cache_stats *more)
{
    sum->found += more->found;
    sum->topped_up += more->topped_up;
    sum->made += more->made;
    sum->rays_saved += more->rays_saved;
}

/* Data reused from a store. */
struct orl_annual_reuse {
    bool asked;
    struct orl_annual_cache_stats of[ORL_ANNUAL_CACHE_KINDS];
};

enum orl_annual_stage {
    ORL_ANNUAL_LOAD,  /* the scene, its hierarchy and ports */
    ORL_ANNUAL_SKIES, /* skies of all hours, and the sun's nodes */
    ORL_ANNUAL_PATHS, /* paths from sensors */
    ORL_ANNUAL_SUN,   /* direct sunlight at sensors, every hour */
    ORL_ANNUAL_HOURS, /* product of paths and skies */
    ORL_ANNUAL_STAGES
};
const char *orl_annual_stage_name(enum orl_annual_stage stage); /* "load", "skies", ... */

/* Site in the convention of weather files: degrees, east. */
struct orl_annual_site {
    double latitude_deg, longitude_deg, time_zone_h;
};

struct orl_annual_result {
    uint64_t seed;
    uint32_t threads, samples;
    struct orl_annual_site site; /* of the weather file */
    int first_weekday; /* weekday of 1 January in the file: 0 Monday ... 6 Sunday; -1: not given */
    size_t n_moved;    /* steps from 1 January on that are the file's last rows (see
                          orl_annual_row_of_step) */
    /* Names of the files that the scene was read from, now or by an earlier job. */
    char **scene_read;
    size_t n_scene_read;
    struct orl_annual_step *steps; /* all rows of the file */
    size_t n_steps;
    size_t n_columns; /* number of steps with light; row length of the arrays below */
    uint32_t *step_of_column;
    size_t n_sensors;
    /*
     * [sensor * n_columns + column], lx. NULL if the row callback took the rows (orl_annual_env).
     * `total` includes `direct`. With shades, `total` is for the states of the hour, and `direct`
     * for all groups open.
     */
    float *total, *direct, *se;
    /* Illuminance of each sensor under the CIE overcast sky of ORL_OVERCAST_LX on a level plane,
     * with the ground and with shades open, lx; and standard errors. */
    float *overcast, *overcast_se;
    /* Coherence of each sensor's errors, 0 to 1: the standard error of the sum of relative errors
     * over all hours with sun, divided by the sum of the relative standard errors of these hours.
     * Under the sky alone it is near 1. With shades it is the largest of the runs. NULL: not
     * known. */
    float *coherence;
    /*
     * Daylight coefficients [sensor * ORL_ANNUAL_PATCHES + patch], sr, if requested: irradiance by
     * a patch of radiance 1, including all reflections. Times the sky of an hour they give `total`
     * without the sun's light, which has no patch of its own here.
     */
    float *coefficients;
    size_t n_nodes;        /* nodes of the sun */
    unsigned char *states; /* [group * n_steps + step]; NULL: no groups */
    /* Shades: number of groups, and of runs that the year was combined from. */
    size_t n_groups, n_runs;
    bool summed; /* true: light of groups was added up (oriel/annual/annual_shades.h) */
    struct orl_annual_reuse reuse;
    double timings_s[ORL_ANNUAL_STAGES], total_s;
    struct orl_health health; /* numerical health counters of this run */
    char **warnings;
    size_t n_warnings;
};
void orl_annual_done(struct orl_annual_result *result); /* NULL and half-filled are fine */

/* Returns the index of a step's row among the counted rows of the weather file, from 0. */
static inline size_t orl_annual_row_of_step(const struct orl_annual_result *result, size_t step)
{
    return (step + result->n_steps - result->n_moved) % result->n_steps;
}

static inline size_t orl_annual_step_of_row(const struct orl_annual_result *result, size_t row)
{
    return (row + result->n_moved) % result->n_steps;
}

/* Returns a sensor's row in `array`, which is the result's total, direct or se. */
static inline const float *orl_annual_row(const struct orl_annual_result *result,
                                          const float *array, size_t sensor)
{
    return array + sensor * result->n_columns;
}

/* ---- Running --------------------------------------------------------------------------------- */

/* Rows of consecutive sensors: [count][n_columns] each, in the result's arrays. */
struct orl_annual_chunk {
    uint32_t round; /* copy of orl_annual_env's round */
    size_t first, count, n_columns;
    float *total, *direct, *se;
    float *overcast, *overcast_se, *coherence; /* [count] */
};

struct orl_annual_env {
    /* Borrowed. The run uses the fields pool, files, store (for BSDFs, and for `reuse`),
     * memory_cache, files_id, cancel, now_s, warned, part, progress and ctx. progress gets
     * ORL_STAGE_LOAD, then ORL_STAGE_MAPS for skies and sunlight on surfaces, then
     * ORL_STAGE_RENDER. */
    const struct orl_run_env *run;
    /*
     * true: intermediate data are cached in run's store and reused. Another weather file of the
     * same site and times then traces no ray, and more samples trace only the missing ones. The
     * result is bitwise the same. For reuse the sun is sampled at all times of the file. The data
     * take about half a MB per sensor; years of more than reuse_most sensors are not stored (0: no
     * limit).
     */
    bool reuse;
    size_t reuse_most;
    /*
     * Called by the lead thread once the hours are known, before any row. The result's steps and
     * counts are valid from then on. A negative orl_err ends the run. May be NULL.
     */
    int (*begins)(void *ctx, const struct orl_annual_result *result, struct orl_error *err);
    /*
     * Called by the lead thread with each sensor's row, in order; n_columns floats each, valid
     * during the call. If set, the result has no arrays, and memory does not grow with the sensors.
     * A negative orl_err ends the run. NULL: the result has arrays.
     */
    int (*row)(void *ctx, size_t sensor, const float *total, const float *direct, const float *se,
               struct orl_error *err);
    /*
     * For results with arrays. Called by the lead thread before a chunk is computed. Returns true
     * if an earlier run of the same request left the chunk's rows; they are then filled in. May be
     * NULL.
     */
    bool (*restored)(void *ctx, struct orl_annual_chunk *chunk);
    /* Called by the lead thread once a chunk is computed. May be NULL. */
    void (*done)(void *ctx, const struct orl_annual_chunk *chunk);
    uint32_t round; /* index of this run among the runs of one job; passed to restored and done */
    void *ctx;
};

/*
 * Computes the year. Returns 0 and fills ret_result (owned by the caller), or a negative orl_err:
 * ORL_ERR_INVALID, _RANGE, _NOT_FOUND, _SYNTAX, _LIMIT (with file and line), _NOMEM, _CANCELLED.
 * Returns ORL_ERR_UNSUPPORTED, with the surface's name, if sunlight reaches sensors by a path that
 * is not simulated. Such paths are: BSDFs other than windows of a closed building, refraction,
 * curved mirrors, mirrors of several planes, and mirrors beside BSDF windows unless they are panes.
 */
int orl_annual_run(const struct orl_annual_request *request, const struct orl_annual_env *env,
                   struct orl_annual_result *ret_result, struct orl_error *err);

#endif
