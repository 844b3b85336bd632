#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "bench/calibration.h"
#include "support/room.h"

static char materials[] = "materials.rad", room[] = "room.rad", ground[] = "ground.rad",
            sky[] = "sky.rad", glazing[] = "glazing.rad", upper[] = "upper_glass.rad",
            scene_name[] = "scene.rad";
static char *const glass_names[] = {materials, room, ground, sky, glazing, upper};
static char *const text_names[] = {scene_name};

/*
 * A lamp of radius a = 0.1 and radiance 100 in a sphere of radius 1 and reflectance 0.5: E = pi L
 * a^2 / (1 - rho (1 - a^2)), because a share a^2 of the light that the wall reflects hits the lamp
 * and is lost.
 */
static const char sphere_text[] =
    "void light l 0 0 3 100 100 100\nl sphere lamp 0 0 4 0 0 0 .1\n"
    "void plastic w 0 0 5 .5 .5 .5 0 0\nw bubble wall 0 0 4 0 0 0 1\n";
static const double sphere_lx = ORL_EFFICACY_LM_PER_W * ORL_PI * 100 * 0.01 / (1 - 0.5 * 0.99);
static const struct orl_sensor sphere_sensors[] = {
    {{0, 0, -1}, {0, 0, 1}},      {{1, 0, 0}, {-1, 0, 0}},      {{0, 1, 0}, {0, -1, 0}},
    {{-1, 0, 0}, {1, 0, 0}},      {{0, 0, 1}, {0, 0, -1}},      {{0, -.6, .8}, {0, .6, -.8}},
    {{.6, .8, 0}, {-.6, -.8, 0}}, {{-.8, 0, .6}, {.8, 0, -.6}}, {{0, .8, -.6}, {0, -.8, .6}},
    {{-.6, 0, -.8}, {.6, 0, .8}},
};

static const char klems_text[] = ROOM_SKY ROOM_SUN ROOM_GREY ROOM_BSDF ROOM_SHELL ROOM_PANE;
static const char klems_source[] = "tests/fixtures", klems_file[] = "bsdf_klems41.xml";
/* On the floor, at a shelf's height above it, on walls and ceiling. */
static const struct orl_sensor klems_sensors[] = {
    {{1, 1, 0}, {0, 0, 1}},    {{2, 1, 0}, {0, 0, 1}},   {{3, 1, 0}, {0, 0, 1}},
    {{1, 3, 0}, {0, 0, 1}},    {{2, 3, 0}, {0, 0, 1}},   {{3, 3, 0}, {0, 0, 1}},
    {{1, 1, .8}, {0, 0, 1}},   {{2, 1, .8}, {0, 0, 1}},  {{3, 1, .8}, {0, 0, 1}},
    {{1, 4, .8}, {0, 0, 1}},   {{2, 4, .8}, {0, 0, 1}},  {{3, 4, .8}, {0, 0, 1}},
    {{2, 4, 1.2}, {0, -1, 0}}, {{0, 3, 1.5}, {1, 0, 0}}, {{4, 3, 1.5}, {-1, 0, 0}},
    {{2, 5, 1.5}, {0, -1, 0}}, {{2, 3, 3}, {0, 0, -1}},  {{2, 1, 3}, {0, 0, -1}},
};

/* Opens a scene of one text, and a file that it mentions under a separate name. */
static void open_text(struct calibration *c, int which, const char *text, const char *mentioned,
                      const struct orl_file *file)
{
    static const char *names[2][2];
    static struct orl_file contents[2][2];
    names[which][0] = scene_name;
    contents[which][0] = (struct orl_file){text, strlen(text), NULL};
    names[which][1] = mentioned;
    if (file)
        contents[which][1] = *file;
    c->texts[which] = (struct orl_memory_files){names[which], contents[which], file ? 2 : 1};
    c->of_texts[which] = orl_files_from_memory(&c->texts[which]);
}

void calibration_open(struct calibration *c)
{
    const struct orl_files fixtures = orl_files_from_folder(klems_source);
    struct orl_error err = {0};
    struct orl_file klems;
    if (fixtures.open(fixtures.ctx, klems_file, &klems, &err) < 0)
        bench_fail("the BSDF; is this the top folder?", &err);
    office_open(&c->office, NULL);
    open_text(c, 0, sphere_text, NULL, NULL);
    open_text(c, 1, klems_text, "pane.xml", &klems);
    const struct calibration_scene scenes[CALIBRATION_SCENES] = {
        {.name = "lcp",
         .files = &c->office.files,
         .names = office_names,
         .n_names = OFFICE_FILES,
         .sensors_file = office_sensors,
         .n_sensors = OFFICE_SENSORS,
         .view = "-vtv -vp 1.3 2 1.2 -vd 1 -0.6 -0.1 -vu 0 0 1 -vh 90 -vv 73.74"},
        {.name = "glass",
         .files = &c->office.files,
         .names = glass_names,
         .n_names = sizeof glass_names / sizeof *glass_names,
         .sensors_file = office_sensors,
         .n_sensors = OFFICE_SENSORS,
         .view = "-vtv -vp 1.3 2 1.2 -vd 1 -0.6 -0.1 -vu 0 0 1 -vh 90 -vv 73.74"},
        {.name = "sphere",
         .files = &c->of_texts[0],
         .names = text_names,
         .n_names = 1,
         .sensors = sphere_sensors,
         .n_sensors = sizeof sphere_sensors / sizeof *sphere_sensors,
         .known_lx = sphere_lx},
        {.name = "klems",
         .files = &c->of_texts[1],
         .names = text_names,
         .n_names = 1,
         .sensors = klems_sensors,
         .n_sensors = sizeof klems_sensors / sizeof *klems_sensors,
         .view = "-vtv -vp 2 4.8 1.6 -vd 0 -1 -0.2 -vu 0 0 1 -vh 80 -vv 64.4"}};
    memcpy(c->scenes, scenes, sizeof scenes);
    bench_make_folder(c->output);
    snprintf(c->maps, sizeof c->maps, "%s/maps", c->output);
    c->pool = orl_thread_pool_start(c->knobs.threads);
    if (!c->pool)
        bench_fail("out of memory", NULL);
}

void calibration_close(struct calibration *c)
{
    orl_thread_pool_stop(c->pool);
    bench_remove_folder(c->output);
    office_close(&c->office);
}

bool calibration_wants(const struct calibration *c, size_t scene)
{
    return (c->wanted >> scene & 1) != 0;
}

void calibration_job(const struct calibration_scene *scene, struct orl_job *ret_job)
{
    orl_job_init(ret_job);
    ret_job->photons_exact = true;
    ret_job->scene_files = (char **)(uintptr_t)scene->names;
    ret_job->n_scene_files = scene->n_names;
    ret_job->sensors_file = scene->sensors_file;
    if (scene->sensors) {
        ret_job->sensors = (struct orl_sensor *)(uintptr_t)scene->sensors;
        ret_job->n_sensors = scene->n_sensors;
    }
}

/* ---- Runs ------------------------------------------------------------------------------------ */

void calibration_pixels_done(struct calibration_pixels *pixels)
{
    free(pixels->values);
    free(pixels->errors);
    *pixels = (struct calibration_pixels){0};
}

static void take_pixels(void *ctx, size_t index, float (*const pixels)[3], const float *errors,
                        size_t count)
{
    struct calibration_pixels *taken = ctx;
    if (index > 0 || !taken)
        return;
    calibration_pixels_done(taken);
    taken->n = count;
    taken->values = calloc(count, sizeof(double));
    taken->errors = errors ? calloc(count, sizeof(double)) : NULL;
    if (!taken->values || (errors && !taken->errors))
        bench_fail("out of memory", NULL);
    for (size_t i = 0; i < count; i++) {
        const struct orl_rgb color = {pixels[i][0], pixels[i][1], pixels[i][2]};
        taken->values[i] = ORL_EFFICACY_LM_PER_W * orl_luma(color);
        if (errors)
            taken->errors[i] = ORL_EFFICACY_LM_PER_W * (double)errors[i];
    }
}

void calibration_run(const struct calibration *c, const struct calibration_scene *scene,
                     const struct orl_job *job, struct orl_result *ret_result,
                     struct calibration_pixels *ret_pixels)
{
    const bool by_cpu = c->knobs.by_cpu && !(job->goal.deadline_s > 0);
    const struct bench_env env = {.files = scene->files,
                                  .pool = c->pool,
                                  .maps = c->maps,
                                  .output = c->output,
                                  .now_s = by_cpu ? bench_cpu_s : bench_wall_s,
                                  .view_ready = take_pixels,
                                  .ctx = ret_pixels};
    if (ret_pixels)
        *ret_pixels = (struct calibration_pixels){0};
    bench_run(&env, job, ret_result);
    bench_remove_folder(c->maps);
    if (!scene->sensors_file && ret_result->n_sensors != job->n_sensors)
        bench_fail("a job has lost sensors", NULL);
}

/* ---- References ------------------------------------------------------------------------------ */

/* Computes means and standard errors of the means from sums and sums of squares over n runs. */
static void compute_means(struct calibration_scene *scene, const double *sums,
                          const double *squares, uint32_t n)
{
    for (size_t i = 0; i < scene->n_sensors; i++) {
        const double mean = sums[i] / n;
        scene->reference_lx[i] = mean;
        scene->error_lx[i] = sqrt(fmax(squares[i] / n - mean * mean, 0) / (n - 1));
    }
}

static void run_reference(const struct calibration *c, struct calibration_scene *scene)
{
    double sums[CALIBRATION_MOST_SENSORS] = {0}, squares[CALIBRATION_MOST_SENSORS] = {0};
    for (uint32_t run = 0; run < c->knobs.reference_runs; run++) {
        struct orl_result r;
        struct orl_job job;
        calibration_job(scene, &job);
        job.technique = ORL_TECHNIQUE_BACKWARD;
        job.gather_samples = c->knobs.reference_samples;
        job.seed = 1000001 + run;
        calibration_run(c, scene, &job, &r, NULL);
        for (size_t i = 0; i < scene->n_sensors; i++) {
            sums[i] += r.illuminance_lx[i];
            squares[i] += r.illuminance_lx[i] * r.illuminance_lx[i];
        }
        orl_result_done(&r);
    }
    compute_means(scene, sums, squares, c->knobs.reference_runs);
}

void calibration_refer(const struct calibration *c, struct calibration_scene *scene)
{
    const double started = bench_wall_s(NULL);
    double squares = 0;
    if (scene->referred)
        return;
    if (scene->known_lx > 0)
        for (size_t i = 0; i < scene->n_sensors; i++)
            scene->reference_lx[i] = scene->known_lx;
    else
        run_reference(c, scene);
    scene->referred = true;
    for (size_t i = 0; i < scene->n_sensors; i++) {
        scene->mean_lx += scene->reference_lx[i] / (double)scene->n_sensors;
        squares += pow(scene->error_lx[i] / scene->reference_lx[i], 2) / (double)scene->n_sensors;
    }
    fprintf(stderr, "  %s: reference in %.0f s, its own standard error %.3f %%\n", scene->name,
            bench_wall_s(NULL) - started, 100 * sqrt(squares));
}

static int compare_doubles(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

double calibration_percentile(double *values, size_t n, double share)
{
    qsort(values, n, sizeof *values, compare_doubles);
    const double at = ceil(share * (double)n) - 1;
    return values[at > 0 ? (size_t)at : 0];
}

struct calibration_error calibration_judge(const struct calibration_scene *scene,
                                           const double *illuminance_lx)
{
    double sizes[CALIBRATION_MOST_SENSORS];
    struct calibration_error e = {0};
    for (size_t i = 0; i < scene->n_sensors; i++) {
        const double off = (illuminance_lx[i] - scene->reference_lx[i]) /
                           fmax(scene->reference_lx[i], 1e-3 * scene->mean_lx);
        sizes[i] = fabs(off);
        e.rms += off * off / (double)scene->n_sensors;
        e.bias += off / (double)scene->n_sensors;
    }
    e.rms = sqrt(e.rms);
    e.p95 = calibration_percentile(sizes, scene->n_sensors, 0.95);
    return e;
}
