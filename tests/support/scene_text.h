/*
 * Scenes given as text, in the test's process: parsed into geometry, or run through orl_run into a
 * temporary folder. Everything here fails the test on error.
 */
#ifndef ORL_TESTS_SUPPORT_SCENE_TEXT_H
#define ORL_TESTS_SUPPORT_SCENE_TEXT_H

#include <oriel/job/run.h>

#include "light/lit_scene.h"

/* One job: a scene of one text, and at most one file that it mentions. Zero means a default. */
struct scene_run {
    const char *scene;
    const char *resource_name, *resource_text; /* a file such as a BSDF; or NULL */
    const char *source; /* instead of scene: a folder of files, their names, a sensor file */
    const char *const *names;
    size_t n_names;
    const char *sensors_file;
    const struct orl_sky_request *sky; /* NULL: the scene's sky */
    const struct orl_sensor *sensors;
    size_t n_sensors;
    const char *view; /* NULL: none; the image is view.hdr, view.png in folder */
    uint32_t width, height;
    uint32_t metrics;             /* glare metrics of the view, by default settings */
    uint32_t formats;             /* file formats of the view; 0: default */
    bool irradiance;              /* true: the view shows irradiance */
    uint64_t seed;                /* 0: 1 */
    enum orl_technique technique; /* auto means gather, unless by_plan */
    bool by_plan;
    const enum orl_effect_override *overrides; /* array of ORL_EFFECT_COUNT, or NULL: all auto */
    uint64_t global, caustic;                  /* 0: 20000 and none */
    bool bounded;                          /* true: caustic photons are limited by their yield */
    uint32_t samples, threads;             /* 0: Oriel's default; 1 */
    uint32_t pixel_samples;                /* 0: Oriel's default */
    const char *folder;                    /* folder that keeps maps and images; NULL: none */
    struct orl_memory_cache *memory_cache; /* shared by runs; NULL: no memory cache */
    struct orl_goal goal;                  /* if set, used instead of photons and samples */
    bool dark_is_error;  /* dark results are errors, as for users; false by default, since tests
                            judge the numbers */
    atomic_bool *cancel; /* NULL: no cancellation */
    /* NULL: the machine's clock; no callbacks. All get ctx. */
    double (*now_s)(void *ctx);
    void (*progress)(void *ctx, enum orl_stage stage, double stage_fraction, double job_fraction,
                     double left_s);
    void (*round_ready)(void *ctx, const struct orl_result *result);
    void *ctx;
};

/* For runs that read photon maps, even if the plan would build none: forces the effects that
 * photons compute, interreflection and caustics. */
extern const enum orl_effect_override scene_wish_maps[ORL_EFFECT_COUNT];

/* Runs it; release the result with orl_result_done. */
struct orl_result scene_run(const struct scene_run *run);

/* Runs it for the illuminances only: ret_lx holds n_sensors. */
void scene_run_lx(const struct scene_run *run, double *ret_lx);

/* Runs it and allows failure: returns 0 or the error code; results are dropped. */
int scene_run_try(const struct scene_run *run, struct orl_error *ret_err);

/* Runs it and expects failure: returns the error code. */
int scene_run_fails(const struct scene_run *run, struct orl_error *ret_err);

/* Parses text, with one resource or NULL; release with orl_parsed_scene_done. */
struct orl_parsed_scene scene_parse_text(const char *text, const char *resource_name,
                                         const char *resource_text);

/* Parses bytes as a.rad, from a copy of exactly their size, so that a read past the end is
 * detected; drops the result. Returns 0, or the error's code with the output left empty. */
int scene_parse_bytes(const char *text, size_t size, struct orl_error *ret_err);

/* Builds a lit scene of everything in the text; release with orl_lit_scene_free. The pool finds the
 * ports; NULL: no ports. */
struct orl_lit_scene *build_lit_scene(const char *text, const char *resource_name,
                                      const char *resource_text, struct orl_thread_pool *pool);

/* Builds geometry from text; release with orl_geometry_free. Facets are in the text's order if all
 * are polygons. */
struct orl_geometry *scene_geometry(const char *text);

/* Returns the path of the only map of that kind ("global", "caustic") in a run's folder. */
void scene_map_path(const struct orl_result *result, const char *folder, const char *kind,
                    char ret_path[512]);

/* Returns the sum of the photons' fluxes in that map, green channel, in watts, and of their
 * squares. */
double scene_map_flux(const struct orl_result *result, const char *folder, const char *kind,
                      double *ret_squares);

/* Reads a whole file and appends a zero byte; free() it. */
unsigned char *scene_read_bytes(const char *path, size_t *ret_size);

/*
 * Writes a tensor tree that transmits `value` per steradian in every direction, both ways, as XML.
 */
void scene_uniform_bsdf(double value, char ret_xml[2048]);

#endif
