/*
 * A year of daylight at sensors: one set of paths a sensor, shared by all hours of a weather file.
 *
 * The light of an hour at a sensor is the sum of parts that exclude each other: the sky and the
 * ground (paths binned by the direction in which they leave the scene, times the radiance of the
 * hour's sky there), the sun seen from the sensor, straight or through panes (at its own place of
 * every hour, its disc sampled), and the sun by way of surfaces (from nodes in declination and hour
 * angle, interpolated between them).
 *
 * Conventions. Illuminances in lux (179 lm/W). Hours are those of the weather file, at the middle
 * of the interval that a row stands for: the sun of an EPW row of hour 12 (11:00 to 12:00) stands
 * where it does at 11:30, and so does that of its step here. Skies are those of a `render` job with
 * `sky.weather`, the same ground reflectance and sun (oriel/sky.h, ORL_SKY_FLUX). Sensors are in
 * scene units, directions need not be unit. A scene has no distant sources of its own; its lamps
 * are left out, with a warning: what is computed is daylight.
 *
 * Direct. This is the definition of direct sunlight for everything that reads it: ASE, LM-83's
 * blinds and other controls by sun, hours of direct sunlight, .direct.ill. It is sunlight that
 * reaches a sensor after any number of transmissions and no reflection: straight from the disc,
 * through panes of glass, and through a pane described by a BSDF, into whatever direction that
 * sends it (redirected and scattered light count). IES LM-83-12 has ASE by the beam of the sun
 * alone, without light from other surfaces and with shades open, and no rule for glazing that
 * scatters. Radiance's two-phase method with black surfaces, by which Honeybee finds ASE, counts
 * the same. A matrix of Klems' basis spreads the sun over one of its cells, which is 10 to 15
 * degrees wide: the flux of a patch of sun is right, its rim is blurred, and more sensors exceed
 * 1000 lx than behind glass. Of clear panes, aBSDF, a tensor tree or glass keep the rim. What trans
 * and other diffuse surfaces let through is not direct.
 *
 * Errors. se is the standard error of total, by how far independent batches of paths lie apart, and
 * groups of photons, and two ways of interpolating between the sun's nodes; of direct it is
 * included there. Errors of ONE sensor are strongly correlated over hours (all of them
 * are of the same paths): the mean of a year is hardly more certain than an hour. An interval of
 * anything worked out from a sensor's hours is therefore to be had from the whole row moved by a
 * common factor: the metric of value - z se and of value + z se, in every hour at once. Sensors'
 * errors are nearly independent of each other: they share the sunlight on surfaces inside.
 *
 * Results are the same bytes for any crew size. Threads: the calling thread leads env->crew.
 */
#ifndef ORIEL_ANNUAL_H
#define ORIEL_ANNUAL_H

#include <oriel/annual_matrices.h>
#include <oriel/annual_shades.h>
#include <oriel/run.h>

/* ---- The request ----------------------------------------------------------------------------- */

/* Sensors that belong together: a room's work plane. Grids lie one after the other. */
struct orl_annual_grid {
    char *name;
    size_t first, count; /* of the request's sensors */
};

/*
 * How sunlight that has come in goes on. By paths: photons bring it to the first diffuse surfaces
 * inside, and paths from sensors go on from surface to surface. Precomputed: photons of each of the
 * sun's nodes go on until they are absorbed, what they leave on surfaces is kept by node, and paths
 * take it where they first meet one (contribution photons, Schregle, Bauer, Grobe and Wienold
 * 2015: there for 5184 suns and in spheres about places; here for the sun's nodes and in squares of
 * surfaces). Light of the sky, and of the sun by way of what is outside, is found by paths in
 * both. Paths go by chance where light is; photons go where they fall.
 */
enum orl_annual_technique { ORL_ANNUAL_BY_PATHS, ORL_ANNUAL_PRECOMPUTED, ORL_ANNUAL_TECHNIQUES };
const char *orl_annual_technique_name(enum orl_annual_technique technique);

/* Strings and arrays are owned; orl_annual_request_done frees them. */
struct orl_annual_request {
    char **scene_files; /* names for the provider, as of a job */
    size_t n_scene_files;
    char *weather_file;             /* EPW or WEA, for the provider */
    int weather_year;               /* of its rows that count; 0: all do */
    double north_deg;               /* true north, counter-clockwise from +Y */
    double ground_reflectance;      /* of the ground outside, where the scene has none; 0..1 */
    enum orl_sun_method sun_method; /* ORL_SUN_ACCURATE by default */
    struct orl_sensor *sensors;
    size_t n_sensors;
    struct orl_annual_grid *grids; /* may be none; one after the other: no sensor is in two */
    size_t n_grids;
    struct orl_window_group *groups; /* of windows with shades; may be none */
    size_t n_groups;
    struct orl_matrix_term *terms; /* of others' matrices, in place of paths; may be none */
    size_t n_terms;
    uint64_t seed;
    uint32_t samples; /* paths a sensor; 0: ORL_ANNUAL_SAMPLES */
    /* How often the distance between the sun's nodes is halved: four times the nodes each. Where
     * errors of interpolation are more than those of paths, more paths alone gain nothing. */
    uint32_t sun_halvings;
    /* Of a sealed building with windows. Precomputed: no shades, others' matrices or seats. */
    enum orl_annual_technique technique;
    uint32_t photons;  /* that bring sunlight in, of all nodes together; 0: by the scene */
    bool coefficients; /* are wanted, of the result; not of years with shades */
};

enum {
    ORL_ANNUAL_SAMPLES = 2048,
    ORL_ANNUAL_BATCHES = 16,
    ORL_ANNUAL_MOST_SAMPLES = 1 << 20,
    ORL_ANNUAL_MOST_HALVINGS = 2,
    ORL_ANNUAL_MOST_PHOTONS = 200000000,
    ORL_ANNUAL_MOST_MAP_VALUES = 1 << 24 /* that the map of sunlight keeps of its photons */
};

void orl_annual_request_init(struct orl_annual_request *request); /* defaults, nothing else set */
void orl_annual_request_done(
    struct orl_annual_request *request); /* NULL and half-filled are fine */

/* Checks what can be checked without the scene: counts, limits, finite numbers, grids in bounds. */
int orl_annual_validate(const struct orl_annual_request *request, struct orl_error *err);
/* The same of what is there already, before the scene is known or sensors of files are read. */
int orl_annual_validate_numbers(const struct orl_annual_request *request, struct orl_error *err);

/* ---- The result ------------------------------------------------------------------------------ */

#define ORL_ANNUAL_DARK UINT32_MAX

/* Of daylight coefficients: the ground, then Reinhart's sky MF:4 in the order of Radiance's
 * reinhart.cal and gendaymtx, azimuth clockwise from north. */
enum { ORL_ANNUAL_PATCHES = 2306 };

/* A row of the weather file. Steps are in the file's order, unless its year goes on over
 * 31 December: then the rows from 1 January on come first. */
struct orl_annual_step {
    int month, day;
    double hour;     /* the middle of the interval, as the sun stands: 11.5 */
    bool missing;    /* sun and sky were not measured: no value, and not a dark hour either */
    uint32_t column; /* of the arrays, or ORL_ANNUAL_DARK: no light from the sky */
    double sun_altitude_deg, sun_azimuth_deg; /* from south towards west, true; as measured from
                                                 the middle of the disc */
    double direct_normal_lx;                  /* what the sun's disc gives a plane that faces it */
    double diffuse_lx;                        /* the sky alone, horizontal, unobstructed */
    double global_lx;                         /* sky and sun, horizontal, unobstructed */
};

/* What a year is made of, and others can use again: the suns' places among nodes and beams,
 * sunlight on surfaces inside, paths of blocks of sensors, and the sun straight to them. */
enum orl_annual_kept {
    ORL_YEARS_SUNS,
    ORL_YEARS_MAP,
    ORL_YEARS_PATHS,
    ORL_YEARS_SUN,
    ORL_YEARS_KINDS
};
const char *orl_annual_kept_name(enum orl_annual_kept kind); /* "suns", "map", "paths", "sun" */

struct orl_annual_reused {
    uint64_t found, topped_up, made; /* as they are wanted, with fewer samples, not at all */
    uint64_t rays_saved;             /* of paths: those that had been cast before */
};
static inline void orl_annual_reused_add(struct orl_annual_reused *sum,
                                         const struct orl_annual_reused *more)
{
    sum->found += more->found;
    sum->topped_up += more->topped_up;
    sum->made += more->made;
    sum->rays_saved += more->rays_saved;
}

enum orl_annual_stage {
    ORL_ANNUAL_LOAD,  /* the scene, its hierarchy and ports */
    ORL_ANNUAL_SKIES, /* of all hours, and the sun's nodes */
    ORL_ANNUAL_PATHS, /* from sensors */
    ORL_ANNUAL_SUN,   /* straight to sensors, every hour */
    ORL_ANNUAL_HOURS, /* paths times skies */
    ORL_ANNUAL_STAGES
};
const char *orl_annual_stage_name(enum orl_annual_stage stage); /* "load", "skies", ... */

struct orl_annual_result {
    uint64_t seed;
    uint32_t threads, samples;
    double latitude_deg, longitude_deg, time_zone_h; /* of the weather file; both east */
    int first_weekday; /* of 1 January by the file: 0 Monday ... 6 Sunday; -1: not said */
    size_t n_moved;    /* steps from 1 January on that are the file's last rows (below) */
    char **scene_read; /* names of the files that the scene was read from, now or before */
    size_t n_scene_read;
    struct orl_annual_step *steps; /* all rows of the file */
    size_t n_steps;
    size_t n_columns; /* steps with light: of the arrays below */
    uint32_t *step_of_column;
    size_t n_sensors;
    /*
     * [sensor * n_columns + column], lx. NULL where rows went to whoever asked (orl_annual_env).
     * total has direct (below), too; but where there are shades, total is of the states of the
     * hour, and direct of groups that all are open.
     */
    float *total, *direct, *se;
    /* Of each sensor, lx: under the CIE's overcast sky of ORL_OVERCAST_LX on a level plane, and the
     * ground beneath it, shades being open; and standard errors. */
    float *overcast, *overcast_se;
    /* Coherence of each sensor's errors, 0 to 1: the standard error of the sum of relative errors
     * over all hours with sun, divided by the sum of the relative standard errors of these hours.
     * Under the sky alone it is near 1. With shades it is the largest of the runs. NULL: not
     * known. */
    float *coherence;
    /*
     * Daylight coefficients [sensor * ORL_ANNUAL_PATCHES + patch], sr, where they were asked for:
     * irradiance by a patch whose radiance is 1, all ways by surfaces included. The sky of an hour
     * makes the light of total but for the sun's, which has no patch of its own here.
     */
    float *coefficients;
    size_t n_nodes;          /* of the sun */
    unsigned char *states;   /* [group * n_steps + step]; NULL: no groups */
    size_t n_groups, n_runs; /* those of shades: runs that the year was put together of */
    bool summed;             /* light of groups was added up (oriel/annual_shades.h) */
    struct {
        bool asked;
        struct orl_annual_reused of[ORL_YEARS_KINDS];
    } reuse; /* what came from a store */
    double timings_s[ORL_ANNUAL_STAGES], total_s;
    struct orl_health health; /* of what this run did */
    char **warnings;
    size_t n_warnings;
};
void orl_annual_done(struct orl_annual_result *result); /* NULL and half-filled are fine */

/* The place of a step's row in the weather file, of the rows that count; from 0. */
static inline size_t orl_annual_row_of_step(const struct orl_annual_result *result, size_t step)
{
    return (step + result->n_steps - result->n_moved) % result->n_steps;
}

static inline size_t orl_annual_step_of_row(const struct orl_annual_result *result, size_t row)
{
    return (row + result->n_moved) % result->n_steps;
}

/* The three of a sensor's row; of a result that holds arrays. */
static inline const float *orl_annual_row(const struct orl_annual_result *result,
                                          const float *array, size_t sensor)
{
    return array + sensor * result->n_columns;
}

/* ---- Running --------------------------------------------------------------------------------- */

/* Rows of sensors that follow each other: [count][n_columns] each, in the result's arrays. */
struct orl_annual_block {
    uint32_t round; /* the env's */
    size_t first, count, n_columns;
    float *total, *direct, *se;
    float *overcast, *overcast_se, *coherence; /* [count] */
};

struct orl_annual_env {
    /* Of its members crew, files, store (for BSDFs, and as reuse says), shelf, files_id, cancel,
     * now_s, warned, part and progress are heeded, the last with ORL_STAGE_LOAD, then
     * ORL_STAGE_MAPS for skies and sunlight on surfaces, then ORL_STAGE_RENDER; and ctx. */
    const struct orl_run_env *run; /* borrowed */
    /*
     * What the year is made of is kept in run's store, and taken from there: another weather file
     * of the site and times takes no ray, more samples only those that are not there. The result is
     * the same, to the bit. For that, the sun is looked for at all times of the file. It takes
     * about half a MB a sensor: years of more than reuse_most sensors are left out (0: none is).
     */
    bool reuse;
    size_t reuse_most;
    /*
     * Called by the lead thread once the hours are known, before any row: result's steps and
     * counts are valid from then on. May be NULL. A negative orl_err ends the run.
     */
    int (*begins)(void *ctx, const struct orl_annual_result *result, struct orl_error *err);
    /*
     * Called by the lead thread with each sensor's row, in order; n_columns floats each, valid
     * during the call. Then no arrays are kept, and memory does not grow with the sensors. NULL:
     * they are kept. A negative orl_err ends the run.
     */
    int (*row)(void *ctx, size_t sensor, const float *total, const float *direct, const float *se,
               struct orl_error *err);
    /*
     * Where arrays are kept. Called by the lead thread before a block is computed: has an earlier
     * run of the same request left its rows? True: they are filled in. May be NULL.
     */
    bool (*kept)(void *ctx, struct orl_annual_block *block);
    /* Likewise once a block is computed. May be NULL. */
    void (*done)(void *ctx, const struct orl_annual_block *block);
    uint32_t round; /* which of several runs for one job this is, for those two */
    void *ctx;
};

/*
 * Computes the year. Returns 0 and fills ret_result (owned by the caller), or a negative orl_err:
 * ORL_ERR_INVALID, _RANGE, _NOT_FOUND, _SYNTAX, _LIMIT (with file and line), _NOMEM, _CANCELLED;
 * ORL_ERR_UNSUPPORTED, naming a surface, where the sun reaches sensors in a way that is not
 * followed: BSDFs that are no windows of a closed building, refraction, curved mirrors, mirrors of
 * several planes, or beside BSDF windows, that are more than panes are.
 */
int orl_annual_run(const struct orl_annual_request *request, const struct orl_annual_env *env,
                   struct orl_annual_result *ret_result, struct orl_error *err);

#endif
