#include "support/scene_text.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include <cmocka.h>

#include "photon/map/map.h"
#include "scene/parse/parse.h"
#include "support/cli.h"

static const char scene_name[] = "scene.rad";

struct text_files {
    const char *names[2];
    struct orl_file contents[2];
    struct orl_memory_files memory;
    struct orl_files files;
};

static void text_files_init(struct text_files *t, const char *scene, const char *resource_name,
                            const char *resource_text)
{
    memset(t, 0, sizeof *t);
    t->names[0] = scene_name;
    t->contents[0] = (struct orl_file){scene, strlen(scene), NULL};
    if (resource_name) {
        t->names[1] = resource_name;
        t->contents[1] = (struct orl_file){resource_text, strlen(resource_text), NULL};
    }
    t->memory = (struct orl_memory_files){t->names, t->contents, resource_name ? 2 : 1};
    t->files = orl_files_from_memory(&t->memory);
}

static void fail_with(const struct orl_error *err)
{
    char text[1024];
    orl_error_format(err, text, sizeof text);
    fail_msg("%s", text);
}

/* Results must not depend on a clock; this one only has to advance. */
static double now_s(void *ctx)
{
    struct timespec t;
    (void)ctx;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static void fill_job(const struct scene_run *run, char **names, struct orl_view_request *view,
                     struct orl_job *job)
{
    static char view_name[] = "view";
    orl_job_init(job);
    /* The job owns nothing here, so casts drop const, and orl_job_done is not called. */
    job->scene_files = run->source ? (char **)(uintptr_t)run->names : names;
    job->n_scene_files = run->source ? run->n_names : 1;
    job->sensors_file = (char *)(uintptr_t)run->sensors_file;
    job->seed = run->seed ? run->seed : 1;
    job->technique = run->technique || run->by_plan ? run->technique : ORL_TECHNIQUE_GATHER;
    job->photons_global = run->global ? run->global : 20000;
    job->photons_caustic = run->caustic;
    job->photons_exact = !run->bounded;
    job->gather_samples = run->samples;
    job->pixel_samples = run->pixel_samples;
    job->dark_expected = !run->dark_is_error;
    if (run->goal.relative_error > 0 || run->goal.deadline_s > 0 || run->goal.dgp_error > 0) {
        job->goal = run->goal;
        job->photons_global = job->photons_caustic = ORL_PHOTONS_BY_PLAN;
    }
    if (run->overrides)
        memcpy(job->overrides, run->overrides, sizeof job->overrides);
    if (run->sky)
        job->sky = *run->sky;
    job->sensors = (struct orl_sensor *)(uintptr_t)run->sensors;
    job->n_sensors = run->n_sensors;
    if (run->view) {
        *view = (struct orl_view_request){.name = view_name,
                                          .view = (char *)(uintptr_t)run->view,
                                          .width = run->width,
                                          .height = run->height,
                                          .metrics = run->metrics,
                                          .formats = run->formats,
                                          .irradiance = run->irradiance};
        job->views = view;
        job->n_views = 1;
    }
}

static int run_job(const struct scene_run *run, struct orl_result *ret_result,
                   struct orl_error *err)
{
    char name[sizeof scene_name], folder[64] = "", *names[1] = {name};
    struct text_files text;
    struct orl_job job;
    struct orl_view_request view;
    struct orl_folder_store state;
    atomic_bool cancel;
    memcpy(name, scene_name, sizeof name);
    text_files_init(&text, run->scene ? run->scene : "", run->resource_name, run->resource_text);
    const struct orl_files folder_files = orl_files_from_folder(run->source);
    fill_job(run, names, &view, &job);
    if (!run->folder)
        cli_make_folder(folder);
    const char *output = run->folder ? run->folder : folder;
    snprintf(state.folder, sizeof state.folder, "%s", output);
    const struct orl_map_store store = orl_map_store_in_folder(&state);
    atomic_init(&cancel, false);
    const struct orl_run_env env = {.pool = orl_thread_pool_start(run->threads ? run->threads : 1),
                                    .files = run->source ? &folder_files : &text.files,
                                    .store = &store,
                                    .memory_cache = run->memory_cache,
                                    .output_folder = output,
                                    .cancel = run->cancel ? run->cancel : &cancel,
                                    .now_s = run->now_s ? run->now_s : now_s,
                                    .progress = run->progress,
                                    .round_ready = run->round_ready,
                                    .ctx = run->ctx};
    assert_non_null(env.pool);
    const int code = orl_run(&job, &env, ret_result, err);
    orl_thread_pool_stop(env.pool);
    if (!run->folder)
        cli_remove_folder(folder);
    return code;
}

const enum orl_effect_override scene_wish_maps[ORL_EFFECT_COUNT] = {
    [ORL_EFFECT_INTERREFLECTION] = ORL_OVERRIDE_FORCE,
    [ORL_EFFECT_CAUSTICS_MIRROR] = ORL_OVERRIDE_FORCE,
    [ORL_EFFECT_CAUSTICS_BSDF] = ORL_OVERRIDE_FORCE,
};

struct orl_result scene_run(const struct scene_run *run)
{
    struct orl_result result = {0};
    struct orl_error err = {0};
    if (run_job(run, &result, &err) < 0)
        fail_with(&err);
    if (!run->sensors_file)
        assert_int_equal(result.n_sensors, run->n_sensors);
    return result;
}

void scene_run_lx(const struct scene_run *run, double *ret_lx)
{
    struct orl_result result = scene_run(run);
    memcpy(ret_lx, result.illuminance_lx, run->n_sensors * sizeof *ret_lx);
    orl_result_done(&result);
}

int scene_run_try(const struct scene_run *run, struct orl_error *ret_err)
{
    struct orl_result result = {0};
    const int code = run_job(run, &result, ret_err);
    orl_result_done(&result);
    return code;
}

int scene_run_fails(const struct scene_run *run, struct orl_error *ret_err)
{
    const int code = scene_run_try(run, ret_err);
    assert_true(code < 0);
    return code;
}

struct orl_parsed_scene scene_parse_text(const char *text, const char *resource_name,
                                         const char *resource_text)
{
    const char *const names[1] = {scene_name};
    struct text_files files;
    struct orl_parsed_scene parsed_scene = {0};
    struct orl_error err = {0};
    text_files_init(&files, text, resource_name, resource_text);
    if (orl_scene_parse(names, 1, &files.files, &parsed_scene, &err) < 0)
        fail_with(&err);
    return parsed_scene;
}

int scene_parse_bytes(const char *text, size_t size, struct orl_error *ret_err)
{
    static const char *const names[] = {"a.rad"};
    char *const copy = malloc(size ? size : 1);
    assert_non_null(copy);
    memcpy(copy, text, size);
    const struct orl_file file = {copy, size, NULL};
    struct orl_memory_files memory = {names, &file, 1};
    const struct orl_files files = orl_files_from_memory(&memory);
    struct orl_parsed_scene parsed_scene = {0};
    const int code = orl_scene_parse(names, 1, &files, &parsed_scene, ret_err);
    if (code < 0)
        assert_null(parsed_scene.arena);
    orl_parsed_scene_done(&parsed_scene);
    free(copy);
    return code;
}

struct orl_lit_scene *build_lit_scene(const char *text, const char *resource_name,
                                      const char *resource_text, struct orl_thread_pool *pool)
{
    struct orl_parsed_scene parsed_scene = scene_parse_text(text, resource_name, resource_text);
    struct orl_scene *scene = NULL;
    struct orl_lights *lights = NULL;
    struct orl_lit_scene *lit_scene = NULL;
    struct orl_error err = {0};
    int code = orl_scene_new(&parsed_scene, &scene, &err);
    if (code == 0 && pool)
        code = orl_scene_find_ports(scene, pool, &err);
    if (code == 0)
        code = orl_lights_new(scene, NULL, &lights, &err);
    if (code == 0)
        code = orl_lit_scene_new(lights, NULL, &lit_scene, &err);
    if (code < 0)
        fail_with(&err);
    orl_lights_release(lights);
    orl_scene_release(scene);
    return lit_scene;
}

struct orl_geometry *scene_geometry(const char *text)
{
    struct orl_parsed_scene parsed_scene = scene_parse_text(text, NULL, NULL);
    struct orl_geometry *geometry = NULL;
    struct orl_error err = {0};
    if (orl_geometry_new(&parsed_scene, &geometry, &err) < 0)
        fail_with(&err);
    orl_parsed_scene_done(&parsed_scene);
    return geometry;
}

void scene_map_path(const struct orl_result *result, const char *folder, const char *kind,
                    char ret_path[512])
{
    for (size_t i = 0; i < result->n_maps; i++) {
        if (strcmp(result->maps[i].kind, kind) == 0) {
            snprintf(ret_path, 512, "%s/%s-%s.opm", folder, kind, result->maps[i].key);
            return;
        }
    }
    fail_msg("no %s map", kind);
}

double scene_map_flux(const struct orl_result *result, const char *folder, const char *kind,
                      double *ret_squares)
{
    struct orl_photon_map *map = NULL;
    char path[512];
    double sum = 0;
    scene_map_path(result, folder, kind, path);
    assert_int_equal(orl_photon_map_open(path, true, &map, NULL), 0);
    *ret_squares = 0;
    for (uint64_t i = 0; i < orl_photon_map_header(map)->count; i++) {
        const double flux = orl_photon_map_get(map, i).flux[1];
        sum += flux;
        *ret_squares += flux * flux;
    }
    orl_photon_map_free(map);
    return sum;
}

unsigned char *scene_read_bytes(const char *path, size_t *ret_size)
{
    FILE *file = fopen(path, "rb");
    unsigned char *bytes = NULL;
    long size = 0;
    assert_non_null(file);
    if (fseek(file, 0, SEEK_END) == 0)
        size = ftell(file);
    rewind(file);
    assert_true(size >= 0);
    bytes = calloc(1, (size_t)size + 1);
    assert_non_null(bytes);
    assert_int_equal(fread(bytes, 1, (size_t)size, file), size);
    fclose(file);
    *ret_size = (size_t)size;
    return bytes;
}

void scene_uniform_bsdf(double value, char ret_xml[2048])
{
    snprintf(ret_xml, 2048,
             "<?xml version=\"1.0\"?><WindowElement><WindowElementType>System</WindowElementType>"
             "<FileType>BSDF</FileType><Optical><Layer><Material><Name>uniform</Name></Material>"
             "<DataDefinition><IncidentDataStructure>TensorTree4</IncidentDataStructure>"
             "</DataDefinition><WavelengthData><LayerNumber>System</LayerNumber>"
             "<Wavelength unit=\"Integral\">Visible</Wavelength><WavelengthDataBlock>"
             "<WavelengthDataDirection>Transmission Back</WavelengthDataDirection>"
             "<AngleBasis>LBNL/Shirley-Chiu</AngleBasis>"
             "<ScatteringDataType>BTDF</ScatteringDataType><ScatteringData>{ %.15g }"
             "</ScatteringData></WavelengthDataBlock></WavelengthData></Layer></Optical>"
             "</WindowElement>\n",
             value);
}
