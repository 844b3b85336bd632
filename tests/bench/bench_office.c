/*
 * Speed on the paper's office, one thread, in ray-times: seconds times the rate at which Embree
 * alone answers incoherent single rays in the same scene, measured in the same run. Ray-times hold
 * on any machine; seconds do not. Medians of several runs.
 *
 * Run from the top of the project, by `make bench`. ORIEL_BENCH_PHOTONS and ORIEL_BENCH_RUNS make
 * it smaller.
 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include <oriel/run.h>

#include "base/random.h"
#include "light/world.h"
#include "photon/facing.h"
#include "photon/leaves.h"
#include "scene/embree.h"
#include "scene/hemisphere.h"
#include "scene/parse.h"

enum { RAYS = 1 << 20, MOST_RUNS = 9 };
static const char office[] = "client/examples/office";
static const char *const scene_files[] = {"materials.rad", "room.rad",    "ground.rad",
                                          "sky.rad",       "glazing.rad", "panel.rad"};
enum { SCENE_FILES = sizeof scene_files / sizeof *scene_files };

struct bench {
    char folder[256];
    struct orl_files files; /* the office's folder, with the panel's XML from ours */
    struct orl_files of_office, of_bench;
    struct orl_crew *crew;
    uint64_t photons;
    int runs;
    double rate;   /* Embree's rays a second */
    char map[512]; /* a global photon map of `photons` */
};

static double now_s(void *ctx)
{
    struct timespec t;
    (void)ctx;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static void fail(const char *what, const struct orl_error *err)
{
    char text[1024] = "";
    if (err)
        orl_error_format(err, text, sizeof text);
    fprintf(stderr, "bench: %s: %s\n", what, text);
    exit(1);
}

static int compare(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static double median(double *values, int n)
{
    qsort(values, (size_t)n, sizeof *values, compare);
    return values[n / 2];
}

static int open_file(void *ctx, const char *name, struct orl_file *ret_file, struct orl_error *err)
{
    struct bench *b = ctx;
    const struct orl_files *from = strstr(name, ".xml") ? &b->of_bench : &b->of_office;
    return from->open(from->ctx, name, ret_file, err);
}

static void close_file(void *ctx, struct orl_file *file)
{
    struct bench *b = ctx;
    b->of_office.close(b->of_office.ctx, file);
}

/* ---- Embree alone ---------------------------------------------------------------------------- */

struct ray {
    struct orl_vec3 origin, direction;
};

/* Rays as light takes them: from random surfaces of the room, cosine-weighted. */
static void make_rays(const struct orl_geometry *g, struct ray *rays)
{
    struct orl_random random = orl_random_stream(1, ORL_PURPOSE_BENCH, 0);
    size_t n = 0;
    while (n < RAYS) {
        struct orl_vec3 point = orl_v3(0, 0, 0), direction = orl_v3(0, 1, 0);
        struct orl_hit hit;
        for (int bounce = 0; bounce < 8 && n < RAYS; bounce++) {
            const double u = orl_random_uniform(&random), v = orl_random_uniform(&random);
            if (!orl_geometry_intersect(g, point, direction, INFINITY, &hit))
                break;
            const struct orl_vec3 normal = hit.front ? hit.normal : orl_neg(hit.normal);
            direction = orl_hemisphere_about(normal, u, v);
            point = orl_hit_leave(g, &hit, direction);
            rays[n++] = (struct ray){point, direction};
        }
    }
    /* Neighbours in the array are neighbours on a path; a shuffle makes them strangers. */
    for (size_t i = RAYS - 1; i > 0; i--) {
        const size_t j = orl_random_bits(&random) % (i + 1);
        const struct ray swap = rays[i];
        rays[i] = rays[j];
        rays[j] = swap;
    }
}

static double embree_rate(struct bench *b, const struct orl_geometry *g)
{
    struct ray *rays = malloc(RAYS * sizeof *rays);
    double rates[MOST_RUNS];
    size_t hits = 0;
    if (!rays)
        fail("out of memory", NULL);
    make_rays(g, rays);
    for (int run = 0; run < b->runs; run++) {
        const double started = now_s(NULL);
        for (size_t i = 0; i < RAYS; i++) {
            struct orl_embree_hit hit;
            hits += orl_embree_intersect(g, rays[i].origin, rays[i].direction, INFINITY, &hit);
        }
        rates[run] = RAYS / (now_s(NULL) - started);
    }
    free(rays);
    if (hits == 0)
        fail("no ray hit anything", NULL);
    return median(rates, b->runs);
}

static void measure_rate(struct bench *b)
{
    struct orl_description description = {0};
    struct orl_world *world;
    struct orl_error err = {0};
    if (orl_scene_parse(scene_files, SCENE_FILES, &b->files, &description, &err) < 0 ||
        orl_world_new(&description, &world, &err) < 0)
        fail("loading the office", &err);
    b->rate = embree_rate(b, world->geometry);
    orl_world_free(world);
}

/* ---- Jobs ------------------------------------------------------------------------------------ */

static void run_job(struct bench *b, const char *maps, const struct orl_job *what,
                    struct orl_result *ret_result)
{
    struct orl_folder_store folder;
    struct orl_error err = {0};
    atomic_bool cancel = false;
    snprintf(folder.folder, sizeof folder.folder, "%s/%s", b->folder, maps);
    const struct orl_map_store store = orl_map_store_in_folder(&folder);
    const struct orl_run_env env = {.crew = b->crew,
                                    .files = &b->files,
                                    .store = &store,
                                    .output_folder = b->folder,
                                    .cancel = &cancel,
                                    .now_s = now_s};
    struct orl_job job = *what;
    char *names[SCENE_FILES];
    for (size_t i = 0; i < SCENE_FILES; i++)
        names[i] = (char *)(uintptr_t)scene_files[i];
    job.scene_files = names;
    job.n_scene_files = SCENE_FILES;
    if (orl_run(&job, &env, ret_result, &err) < 0)
        fail("a job", &err);
}

static void row(const struct bench *b, const char *what, double seconds, const char *note)
{
    printf("  %-46s %8.2f s %9.1f M ray-times   %s\n", what, seconds, seconds * b->rate / 1e6,
           note);
}

/* Photons of one kind, distributed and indexed; the sensor is there because a job needs one. */
static void bench_photons(struct bench *b, bool caustic)
{
    struct orl_sensor sensor = {orl_v3(1, 3, 1), orl_v3(0, 0, 1)};
    double seconds[MOST_RUNS];
    char maps[64], what[64];
    struct orl_job job;
    struct orl_result r;
    orl_job_init(&job);
    job.sensors = &sensor;
    job.n_sensors = 1;
    job.gather_samples = 1;
    job.photons_global = caustic ? 1 : b->photons;
    job.photons_caustic = caustic ? b->photons : 0;
    for (int run = 0; run < b->runs; run++) {
        snprintf(maps, sizeof maps, "%s-%d", caustic ? "caustic" : "global", run);
        run_job(b, maps, &job, &r);
        seconds[run] = r.timings_s[ORL_STAGE_PHOTONS] + r.timings_s[ORL_STAGE_MAPS];
        if (run + 1 == b->runs) {
            const struct orl_map_info *m = &r.maps[r.n_maps - 1];
            snprintf(what, sizeof what, "%.2f M %s photons, traced and indexed",
                     (double)m->stored / 1e6, m->kind);
            row(b, what, median(seconds, b->runs),
                caustic ? "(Radiance: about 125 M)" : "(Radiance: about 100 M; wanted <= 40 M)");
            if (!caustic)
                snprintf(b->map, sizeof b->map, "%s/%s/global-%s.opm", b->folder, maps, m->key);
            printf("  %-46s %8.2f bytes\n", "bytes a photon in the file, index included",
                   (double)m->bytes / (double)m->stored);
        }
        orl_result_done(&r);
    }
}

static void bench_image(struct bench *b)
{
    char view[] = "-vtv -vp 0.35 5.6 1.5 -vd 0.25 -1 0.05 -vu 0 0 1 -vh 75.2 -vv 60";
    char name[] = "bench";
    struct orl_view_request request = {name, view, 400, 300};
    struct orl_job job;
    struct orl_result r;
    double seconds[MOST_RUNS];
    orl_job_init(&job);
    job.views = &request;
    job.n_views = 1;
    job.photons_global = job.photons_caustic = b->photons;
    for (int run = 0; run < b->runs; run++) {
        run_job(b, "image", &job, &r);
        seconds[run] = r.views[0].seconds;
        orl_result_done(&r);
    }
    row(b, "400x300 image, gather, maps ready", median(seconds, b->runs),
        "(Radiance: about 105 M)");
}

static void bench_sensors(struct bench *b)
{
    char file[] = "sensors.txt";
    struct orl_job job;
    struct orl_result r;
    double seconds[MOST_RUNS];
    orl_job_init(&job);
    job.sensors_file = file;
    job.photons_global = job.photons_caustic = b->photons;
    for (int run = 0; run < b->runs; run++) {
        run_job(b, "image", &job, &r);
        seconds[run] = r.timings_s[ORL_STAGE_RENDER];
        orl_result_done(&r);
    }
    row(b, "57 sensors, gather, maps ready", median(seconds, b->runs), "(Radiance: about 29 M)");
}

/* From opening the file to the first answered query. */
static void bench_open(struct bench *b)
{
    double seconds[MOST_RUNS], verified[MOST_RUNS];
    struct orl_search *search = calloc(1, sizeof *search);
    struct orl_error err = {0};
    for (int run = 0; run < b->runs; run++) {
        for (int verify = 0; verify < 2; verify++) {
            struct orl_photon_map *map;
            const double started = now_s(NULL);
            if (!search || orl_photon_map_open(b->map, verify, &map, &err) < 0)
                fail("opening a map", &err);
            const struct orl_photon p = orl_photon_map_get(map, 0);
            const struct orl_density_query query = {
                .point = orl_v3(p.position[0], p.position[1], p.position[2]),
                .normal = orl_normal_decode(p.normal),
                .k = 50,
                .max_radius = 1};
            if (orl_density_estimate(map, &query, search).found == 0)
                fail("the first query found nothing", NULL);
            (verify ? verified : seconds)[run] = now_s(NULL) - started;
            orl_photon_map_free(map);
        }
    }
    free(search);
    printf("  %-46s %8.3f ms (%.1f ms with the whole body verified)\n",
           "opening a map, to the first query", 1e3 * median(seconds, b->runs),
           1e3 * median(verified, b->runs));
}

/* ---- The whole ------------------------------------------------------------------------------- */

/* The panel's BSDF, 2^6, by the example's own generator. */
static void make_panel(const struct bench *b)
{
    const char *build = getenv("ORIEL_BUILD");
    char program[512], path[512];
    int status = -1;
    snprintf(program, sizeof program, "%s/oriel-lcp", build ? build : "build");
    snprintf(path, sizeof path, "%s/lcp.xml", b->folder);
    const pid_t child = fork();
    if (child == 0) {
        execl(program, program, "--resolution", "6", "--seed", "1", "-o", path, (char *)NULL);
        _exit(127);
    }
    if (child < 0 || waitpid(child, &status, 0) < 0 || status != 0)
        fail("oriel-lcp did not run; is it built?", NULL);
}

static void remove_folder(const char *folder)
{
    const pid_t child = fork();
    if (child == 0) {
        execlp("rm", "rm", "-rf", folder, (char *)NULL);
        _exit(127);
    }
    if (child > 0)
        waitpid(child, NULL, 0);
}

static uint64_t number_from(const char *variable, uint64_t otherwise)
{
    const char *text = getenv(variable);
    return text ? strtoull(text, NULL, 10) : otherwise;
}

int main(void)
{
    struct bench b = {.folder = "/tmp/oriel-bench-XXXXXX",
                      .photons = number_from("ORIEL_BENCH_PHOTONS", 2000000),
                      .runs = (int)number_from("ORIEL_BENCH_RUNS", 3)};
    if (b.runs < 1 || b.runs > MOST_RUNS)
        b.runs = 3;
    if (!mkdtemp(b.folder))
        fail("no temporary folder", NULL);
    b.files = (struct orl_files){&b, open_file, close_file};
    b.of_office = orl_files_from_folder(office);
    b.of_bench = orl_files_from_folder(b.folder);
    b.crew = orl_crew_start(1);
    if (!b.crew)
        fail("out of memory", NULL);
    make_panel(&b);
    measure_rate(&b);
    printf("Office, laser cut panel 2^6, one thread, medians of %d\n", b.runs);
    printf("  %-46s %8.2f M rays/s\n", "Embree alone, incoherent single rays (R)", b.rate / 1e6);
    bench_photons(&b, false);
    bench_photons(&b, true);
    bench_open(&b);
    bench_sensors(&b);
    bench_image(&b);
    orl_crew_stop(b.crew);
    remove_folder(b.folder);
    return 0;
}
