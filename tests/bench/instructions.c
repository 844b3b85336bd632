/*
 * Fixed small jobs for `make check-perf`, which counts their instructions (tests/bench/check_perf).
 * They run on one thread, read only the project's files, and depend on no clock or core count.
 * Usage: instructions photons | view | sensors
 */
#include <stdio.h>
#include <string.h>

#include "bench/office.h"

static char view_name[] = "view", view_text[] = OFFICE_VIEW;

/* Requests photons of both kinds, traced, sorted and written, with almost no use of them. */
static void ask_photons(struct orl_job *job)
{
    static struct orl_sensor sensor = {{1, 3, 1}, {0, 0, 1}};
    job->sensors = &sensor;
    job->n_sensors = 1;
    job->gather_samples = 1;
    job->photons_global = job->photons_caustic = 60000;
}

/* Requests precomputed irradiance and a view that reads it. */
static void ask_view(struct orl_job *job)
{
    static struct orl_view_request view = {
        .name = view_name, .view = view_text, .width = 20, .height = 15};
    job->technique = ORL_TECHNIQUE_PRECOMPUTED;
    job->photons_global = job->photons_caustic = 40000;
    job->views = &view;
    job->n_views = 1;
}

/* Requests sensors by final gathering that look photons up. */
static void ask_gather(struct orl_job *job)
{
    job->sensors_file = office_sensors;
    job->photons_global = job->photons_caustic = 5000;
    job->gather_samples = 64;
}

static void ask_backward(struct orl_job *job)
{
    job->technique = ORL_TECHNIQUE_BACKWARD;
    job->sensors_file = office_sensors;
    job->gather_samples = 32;
}

static const struct {
    const char *name;
    void (*ask[2])(struct orl_job *job); /* jobs run one after the other */
} jobs[] = {
    {"photons", {ask_photons}}, {"view", {ask_view}}, {"sensors", {ask_gather, ask_backward}}};
enum { JOBS = sizeof jobs / sizeof *jobs };

static void run_request(const struct office *office, void (*ask)(struct orl_job *job))
{
    struct orl_thread_pool *pool = orl_thread_pool_start(1);
    char maps[BENCH_PATH + 8];
    struct orl_result result;
    struct orl_job job;
    if (!pool)
        bench_fail("out of memory", NULL);
    snprintf(maps, sizeof maps, "%s/maps", office->folder);
    const struct bench_env env = {.files = &office->files,
                                  .pool = pool,
                                  .maps = maps,
                                  .output = office->folder,
                                  .now_s = bench_wall_s};
    office_job(&job);
    ask(&job);
    bench_run(&env, &job, &result);
    orl_result_done(&result);
    bench_remove_folder(maps);
    orl_thread_pool_stop(pool);
}

int main(int argc, char **argv)
{
    struct office office;
    int found = -1;
    for (int i = 0; i < JOBS && argc == 2; i++)
        if (strcmp(argv[1], jobs[i].name) == 0)
            found = i;
    if (found < 0) {
        fprintf(stderr, "usage: instructions photons | view | sensors\n");
        return 2;
    }
    office_open(&office, "tests/fixtures/bsdf_lcp8.xml");
    for (int i = 0; i < 2 && jobs[found].ask[i]; i++)
        run_request(&office, jobs[found].ask[i]);
    office_close(&office);
    return 0;
}
