/*
 * Scenes given as text, in the test's own process: parsed into geometry, or run through orl_run
 * into a temporary folder. Everything here fails the test when it does not succeed.
 */
#ifndef ORL_TESTS_SUPPORT_SCENE_TEXT_H
#define ORL_TESTS_SUPPORT_SCENE_TEXT_H

#include <oriel/run.h>

#include "light/world.h"

/* One job: a scene of one text, and at most one file that it mentions. Zero means a default. */
struct scene_run {
    const char *scene;
    const char *resource_name, *resource_text; /* a BSDF, say; or NULL */
    const char *source; /* instead of scene: a folder of files, their names, a sensor file */
    const char *const *names;
    size_t n_names;
    const char *sensors_file;
    const struct orl_sky_request *sky; /* NULL: the scene's */
    const struct orl_sensor *sensors;
    size_t n_sensors;
    const char *view; /* NULL for none; the image is view.hdr, view.png in folder */
    uint32_t width, height;
    uint32_t metrics;             /* of its glare, by usual settings */
    uint32_t formats;             /* its files; 0: the usual ones */
    bool irradiance;              /* of what the view shows */
    uint64_t seed;                /* 0: 1 */
    enum orl_technique technique; /* auto: gather, unless by_plan */
    bool by_plan;
    const enum orl_wish *wishes; /* ORL_EFFECT_COUNT of them, or NULL: all auto */
    uint64_t global, caustic;    /* 0: 20000 and none */
    bool bounded;                /* these: caustics by what they are worth */
    uint32_t samples, threads;   /* 0: Oriel's default; 1 */
    uint32_t pixel_samples;      /* 0: Oriel's default */
    const char *folder;          /* where maps and images stay; NULL: nowhere */
    struct orl_shelf *shelf;     /* between runs; NULL: nothing is kept */
    struct orl_goal goal;        /* set: instead of photons and samples */
    bool dark_is_error;          /* as for users; tests judge numbers by themselves */
    atomic_bool *cancel;         /* NULL: nobody cancels */
    /* NULL: the machine's clock; no one is told. All get ctx. */
    double (*now_s)(void *ctx);
    void (*progress)(void *ctx, enum orl_stage stage, double stage_fraction, double job_fraction,
                     double left_s);
    void (*round_ready)(void *ctx, const struct orl_result *result);
    void *ctx;
};

/* For runs that look at photon maps, whether or not a plan would make them: forces what photons are
 * for, interreflection and caustics. */
extern const enum orl_wish scene_wish_maps[ORL_EFFECT_COUNT];

/* Runs it; the result is the caller's, for orl_result_done. */
struct orl_result scene_run(const struct scene_run *run);

/* The same, for tests that want just the illuminances: ret_lx holds n_sensors. */
void scene_run_lx(const struct scene_run *run, double *ret_lx);

/* The same, whether it fails or not: returns 0 or the error code; results are dropped. */
int scene_run_try(const struct scene_run *run, struct orl_error *ret_err);

/* The same, expecting failure: returns the error code. */
int scene_run_fails(const struct scene_run *run, struct orl_error *ret_err);

/* Parses text, with the one resource or NULL; for orl_description_done. */
struct orl_description scene_parse_text(const char *text, const char *resource_name,
                                        const char *resource_text);

/* Parses bytes as a.rad, from a copy of just their size, so that a read past the end is seen; what
 * comes of it is dropped. Returns 0 or the error's code, and then nothing was filled. */
int scene_parse_bytes(const char *text, size_t size, struct orl_error *ret_err);

/* Text to a world of all it has, for orl_world_free. Ports are found by the crew; NULL: none are.
 */
struct orl_world *scene_world(const char *text, const char *resource_name,
                              const char *resource_text, struct orl_crew *crew);

/* Text to geometry; for orl_geometry_free. Facets are in the text's order when all are polygons. */
struct orl_geometry *scene_geometry(const char *text);

/* The path of the one map of that kind ("global", "caustic") in a run's folder. */
void scene_map_path(const struct orl_result *result, const char *folder, const char *kind,
                    char ret_path[512]);

/* Sum of the photons' fluxes in that map, green channel, in watts, and of their squares. */
double scene_map_flux(const struct orl_result *result, const char *folder, const char *kind,
                      double *ret_squares);

/* A whole file, and a zero behind it; free() it. */
unsigned char *scene_read_bytes(const char *path, size_t *ret_size);

/* A tensor tree that transmits `value` per steradian in every direction, both ways, as XML. */
void scene_uniform_bsdf(double value, char ret_xml[2048]);

#endif
