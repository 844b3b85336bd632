/* Builds and views, each in a separate process, and their results. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "bench/scale.h"

/* ---- In a process of its own ----------------------------------------------------------------- */

static char view_text[] = OFFICE_VIEW, view_name[] = "scale";

struct child {
    struct office office;
    struct orl_thread_pool *pool;
    uint64_t photons;
    const char *maps;
};

static void run_job(struct child *c, struct orl_job *job, struct orl_result *ret_result)
{
    const struct bench_env env = {.files = &c->office.files,
                                  .pool = c->pool,
                                  .maps = c->maps,
                                  .output = c->office.folder,
                                  .now_s = bench_pool_s};
    job->photons_global = c->photons;
    job->overrides[ORL_EFFECT_CAUSTICS_MIRROR] = job->overrides[ORL_EFFECT_CAUSTICS_BSDF] =
        ORL_OVERRIDE_SKIP;
    bench_run(&env, job, ret_result);
}

static void build(struct child *c)
{
    struct orl_sensor sensor = {{1, 3, 1}, {0, 0, 1}};
    struct orl_result r;
    struct orl_job job;
    const double rate = office_rate(&c->office, c->pool, 3);
    office_job(&job);
    job.sensors = &sensor;
    job.n_sensors = 1;
    job.gather_samples = 1;
    run_job(c, &job, &r);
    printf("%.9g %.9g %.9g %.9g\n", r.timings_s[ORL_STAGE_PHOTONS] + r.timings_s[ORL_STAGE_MAPS],
           rate, (double)r.maps[0].stored, (double)r.maps[0].bytes);
    orl_result_done(&r);
}

static void render(struct child *c, double limit_bytes, const char *group, const char *image)
{
    struct orl_view_request view = {
        .name = view_name, .view = view_text, .width = 200, .height = 150};
    char path[BENCH_PATH + 32];
    struct orl_result r;
    struct orl_job job;
    if (*group && !scale_group_join(group))
        bench_fail("the group of limited memory cannot be joined", NULL);
    if (limit_bytes > 0 && !*group)
        scale_start_pager(limit_bytes);
    office_job(&job);
    job.views = &view;
    job.n_views = 1;
    run_job(c, &job, &r);
    if (!r.maps[0].cached)
        bench_fail("the map was made again", NULL);
    snprintf(path, sizeof path, "%s/%s.hdr", c->office.folder, view_name);
    const char *const argv[] = {"mv", path, image, NULL};
    if (bench_spawn(argv, NULL, NULL, NULL, NULL) != 0)
        bench_fail("the image is not there", NULL);
    printf("%.9g %.9g\n", r.total_s, scale_paged());
    orl_result_done(&r);
}

/* Arguments: build PANEL MAPS PHOTONS THREADS, or render PANEL MAPS PHOTONS LIMIT GROUP IMAGE. */
int scale_child(int argc, char **argv)
{
    static struct child c;
    const bool renders = argc == 7 && strcmp(argv[0], "render") == 0;
    if (!renders && !(argc == 5 && strcmp(argv[0], "build") == 0))
        return 2;
    office_open(&c.office, argv[1]);
    c.maps = argv[2];
    c.photons = strtoull(argv[3], NULL, 10);
    c.pool = orl_thread_pool_start(renders ? 1 : (uint32_t)strtoul(argv[4], NULL, 10));
    if (!c.pool)
        bench_fail("out of memory", NULL);
    bench_set_pool(orl_thread_pool_size(c.pool));
    if (renders)
        render(&c, strtod(argv[4], NULL), argv[5], argv[6]);
    else
        build(&c);
    orl_thread_pool_stop(c.pool);
    office_close(&c.office);
    return 0;
}

/* ---- From outside ---------------------------------------------------------------------------- */

/* Runs a child and reads the numbers that it writes. Returns its peak memory. */
static double run_child(const struct office *office, const char *const *argv, double *ret_numbers,
                        int n, const char *group)
{
    char path[BENCH_PATH + 16];
    struct bench_use use;
    snprintf(path, sizeof path, "%s/child.txt", office->folder);
    if (bench_spawn(argv, NULL, NULL, path, &use) != 0) {
        if (*group)
            scale_group_remove(group);
        bench_fail(*group ? "the view did not finish in so little memory (ORIEL_SCALE_LIMIT)"
                          : "a process that builds or renders did not",
                   NULL);
    }
    FILE *in = fopen(path, "r");
    for (int i = 0; i < n; i++)
        if (!in || fscanf(in, "%lf", &ret_numbers[i]) != 1)
            bench_fail("a process told too little", NULL);
    fclose(in);
    return use.peak_bytes;
}

void scale_build(const struct office *office, const char *maps, uint64_t photons, uint32_t threads,
                 struct scale_build *ret_build)
{
    char count[32], pool[16];
    double numbers[4];
    snprintf(count, sizeof count, "%llu", (unsigned long long)photons);
    snprintf(pool, sizeof pool, "%u", threads);
    const char *const argv[] = {"/proc/self/exe", "build", office->panel, maps, count, pool, NULL};
    const double peak = run_child(office, argv, numbers, 4, "");
    *ret_build = (struct scale_build){numbers[0], numbers[1], numbers[2], numbers[3], peak};
}

void scale_render(const struct office *office, const char *maps, uint64_t photons,
                  double limit_bytes, const char *image, struct scale_view *ret_view)
{
    char count[32], most[32], group[BENCH_PATH] = "";
    double numbers[2];
    snprintf(count, sizeof count, "%llu", (unsigned long long)photons);
    snprintf(most, sizeof most, "%.0f", limit_bytes);
    const bool by_kernel = limit_bytes > 0 && scale_group_make(limit_bytes, group);
    if (!by_kernel)
        group[0] = '\0';
    scale_forget_maps(maps);
    const char *const argv[] = {
        "/proc/self/exe", "render", office->panel, maps, count, most, group, image, NULL};
    double peak = run_child(office, argv, numbers, 2, group);
    if (by_kernel) {
        peak = scale_group_peak(group);
        scale_group_remove(group);
    }
    *ret_view = (struct scale_view){numbers[0], peak, numbers[1], by_kernel};
}
