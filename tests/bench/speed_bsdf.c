/* A large BSDF: time to load it from its XML, and from the data that an earlier job stored. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/stat.h>

#include "bench/speed.h"

enum { RESOLUTION = 7 };

int speed_load_bsdf(const char *panel, const char *store_folder, bool known)
{
    struct orl_folder_store folder;
    struct orl_error err = {0};
    struct orl_result r;
    struct orl_job job;
    struct office office;
    atomic_bool cancel = false;
    struct orl_thread_pool *pool = orl_thread_pool_start(1);
    office_open(&office, panel);
    if (known)
        office_learn_digest(&office);
    snprintf(folder.folder, sizeof folder.folder, "%s", store_folder);
    const struct orl_map_store store = orl_map_store_in_folder(&folder);
    const struct orl_run_env env = {.pool = pool,
                                    .files = &office.files,
                                    .store = &store,
                                    .output_folder = office.folder,
                                    .cancel = &cancel,
                                    .now_s = bench_own_s};
    office_job(&job);
    job.sensors_file = office_sensors;
    if (!pool || orl_plan_job(&job, &env, &r, &err) < 0)
        bench_fail("planning a job", &err);
    printf("%.6f %.0f\n", r.timings_s[ORL_STAGE_LOAD], bench_peak_bytes());
    orl_result_done(&r);
    office_close(&office);
    orl_thread_pool_stop(pool);
    return 0;
}

/* Runs the load stage of a job in a separate process, and measures that process's peak memory. */
static double load(const struct speed *s, const char *panel, const char *store, bool known,
                   double *ret_peak_bytes)
{
    const char *const argv[] = {
        "/proc/self/exe", "load", panel, store, known ? "known" : "unknown", NULL};
    char path[BENCH_PATH + 16];
    double seconds, peak_bytes;
    snprintf(path, sizeof path, "%s/load.txt", s->office.folder);
    if (bench_spawn(argv, NULL, NULL, path, NULL) != 0)
        bench_fail("a process that loads a BSDF did not", NULL);
    FILE *in = fopen(path, "r");
    if (!in || fscanf(in, "%lf %lf", &seconds, &peak_bytes) != 2)
        bench_fail("a process that loads a BSDF told no time", NULL);
    fclose(in);
    *ret_peak_bytes = fmax(*ret_peak_bytes, peak_bytes);
    return seconds;
}

/* The peak of a spawned program includes its parent's memory (bench.h), so this parent is a small
 * process. */
int speed_measure_peak(const char *result, const char *input, const char *output,
                       const char *const *argv)
{
    struct bench_use use;
    if (bench_spawn(argv, NULL, input, output, &use) != 0)
        return 1;
    FILE *out = fopen(result, "w");
    return out && fprintf(out, "%.0f\n", use.peak_bytes) > 0 && fclose(out) == 0 ? 0 : 1;
}

/* Measures Radiance: one ray that meets the panel, less the same ray with glass in place of the
 * panel. */
static double load_by_radiance(const struct radiance *r)
{
    const struct bench_use glass =
        radiance_run(r, "ray.txt", "ray.out", "rtrace -h -ab 0 glass.oct");
    const struct bench_use panel =
        radiance_run(r, "ray.txt", "ray.out", "rtrace -h -ab 0 office.oct");
    return panel.cpu_s - glass.cpu_s;
}

static double peak_by_radiance(const struct radiance *r)
{
    char path[BENCH_PATH + 64];
    double peak_bytes;
    radiance_run(r, NULL, NULL,
                 "/proc/self/exe peak peak.txt ray.txt ray.out rtrace -h -ab 0 office.oct");
    snprintf(path, sizeof path, "%s/peak.txt", r->folder);
    FILE *in = fopen(path, "r");
    if (!in || fscanf(in, "%lf", &peak_bytes) != 1)
        bench_fail("Radiance's peak of memory was not told", NULL);
    fclose(in);
    return peak_bytes;
}

static void write_ray(const struct radiance *r)
{
    char path[BENCH_PATH + 64];
    snprintf(path, sizeof path, "%s/ray.txt", r->folder);
    FILE *out = fopen(path, "w");
    if (!out || fputs("1 3 2.7 0 -1 0\n", out) < 0 || fclose(out) != 0)
        bench_fail("cannot write a ray for Radiance", NULL);
}

static void compare_loads(struct speed *s, const char *panel, struct speed_fact *seconds,
                          struct speed_fact *peak)
{
    double of_runs[BENCH_MOST_RUNS];
    struct radiance radiance;
    struct office office;
    if (!s->radiance || radiance_missing())
        return;
    office_open(&office, panel);
    radiance_open(&radiance, &office, "radiance");
    radiance_octree(&radiance, "upper_glass.rad", "glass.oct");
    write_ray(&radiance);
    for (int run = 0; run < s->runs; run++)
        of_runs[run] = load_by_radiance(&radiance);
    peak->radiance = peak_by_radiance(&radiance) / 1e6;
    office_close(&office);
    seconds->radiance = bench_median(of_runs, s->runs);
    seconds->target = seconds->radiance / 3;
    peak->target = peak->radiance / 2;
}

void speed_measure_bsdf(struct speed *s)
{
    double first[BENCH_MOST_RUNS], later[BENCH_MOST_RUNS], known[BENCH_MOST_RUNS];
    double first_peak = 0, later_peak = 0;
    char panel[BENCH_PATH], store[BENCH_PATH + 16];
    struct stat st;
    fprintf(stderr, "  a BSDF of 2^%d\n", RESOLUTION);
    office_make_panel(RESOLUTION, panel);
    snprintf(store, sizeof store, "%s/bsdfs", s->office.folder);
    if (stat(panel, &st) != 0)
        bench_fail("the panel's BSDF", NULL);
    for (int run = 0; run < s->runs; run++) {
        bench_remove_folder(store);
        first[run] = load(s, panel, store, false, &first_peak);
        later[run] = load(s, panel, store, false, &later_peak);
        known[run] = load(s, panel, store, true, &later_peak);
    }
    struct speed_fact *time =
        speed_add_fact(s, "bsdf_first_s", "s", bench_median(first, s->runs), 0,
                       "a scene with a BSDF of 2^%d, %.0f MB of XML, loaded", RESOLUTION,
                       (double)st.st_size / 1e6);
    speed_add_fact(s, "bsdf_later_ms", "ms", 1e3 * bench_median(later, s->runs), 20,
                   "the same by a later job of the command, which hashes the XML");
    speed_add_fact(s, "bsdf_known_ms", "ms", 1e3 * bench_median(known, s->runs), 20,
                   "the same by a later job of a daemon, which knows its hash");
    struct speed_fact *peak = speed_add_fact(s, "bsdf_peak_mb", "MB", first_peak / 1e6, 0,
                                             "the peak of memory of a job that plans with it");
    speed_add_fact(s, "bsdf_later_peak_mb", "MB", later_peak / 1e6, 0, "the same of a later job");
    compare_loads(s, panel, time, peak);
}
