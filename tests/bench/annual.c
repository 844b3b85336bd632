/*
 * Annual daylight of the office, with clear glass and with its panel, at its 57 sensors, compared
 * with backward for some hours. Writes a table and build/annual.json.
 *
 * Environment, each name after ORIEL_ANNUAL: _WEATHER (an EPW or WEA file; default: a made-up
 * year), _SCENES ("glass panel"), _SAMPLES (paths per sensor, a list: "512 2048"), _SEED, _RUNS
 * (3), _TRUTH_SAMPLES (8192), _TRUTH_HOURS (24), _ROWS ("sensors precomputed glare reuse"),
 * _EYE_SIDE (400 pixels), _EYE_SAMPLES (32), _EYE_HOURS (24). Backward's results are stored in
 * build/bench.
 *
 * Errors are relative, over sensors and hours: rms, median, 95th percentile, bias of the sum. z is
 * the rms error over the stated errors of both. cover is the share within 2.13 of these, 95 % for
 * Student's t with 15 degrees of freedom. own is the rms of the years' standard errors. Ray-times
 * are as in make bench.
 */
#include "bench/annual.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct errors {
    double rms, median, high, bias, z, worst, covered, own;
};

static int by_size(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static struct errors compare_year(const struct annual_truth *truth,
                                  const struct orl_annual_result *year)
{
    const size_t n = truth->n_hours * OFFICE_SENSORS;
    double *sizes = malloc(n * sizeof *sizes);
    double squares = 0, zs = 0, sum = 0, real = 0;
    double own = 0;
    size_t covered = 0;
    if (!sizes)
        bench_fail("out of memory", NULL);
    for (size_t i = 0; i < n; i++) {
        const size_t sensor = i % OFFICE_SENSORS;
        const uint32_t column = year->steps[truth->steps[i / OFFICE_SENSORS]].column;
        const double lx = truth->lx[i];
        const double found = (double)orl_annual_row(year, year->total, sensor)[column];
        const double se = (double)orl_annual_row(year, year->se, sensor)[column];
        const double off = found / lx - 1;
        const double z = (found - lx) / hypot(se, truth->error_lx[i]);
        sizes[i] = fabs(off);
        squares += off * off;
        zs += z * z;
        own += se * se / (lx * lx);
        covered += fabs(z) < 2.13;
        sum += found;
        real += lx;
        if (getenv("ORIEL_ANNUAL_LIST"))
            printf("%3zu %5zu %9.1f %9.1f %+7.2f%% z %+6.2f direct %8.1f\n", sensor,
                   truth->steps[i / OFFICE_SENSORS], lx, found, 100 * off, z,
                   (double)orl_annual_row(year, year->direct, sensor)[column]);
    }
    qsort(sizes, n, sizeof *sizes, by_size);
    const struct errors e = {.rms = sqrt(squares / (double)n),
                             .median = sizes[n / 2],
                             .high = sizes[n * 95 / 100],
                             .bias = sum / real - 1,
                             .z = sqrt(zs / (double)n),
                             .worst = sizes[n - 1],
                             .covered = (double)covered / (double)n,
                             .own = sqrt(own / (double)n)};
    free(sizes);
    return e;
}

static const struct {
    const char *word, *title, *target;
} scenes[ANNUAL_SCENES] = {
    [ANNUAL_GLASS] = {"glass", "clear glass", "12 M ray-times at rms 4 %, median 2 %"},
    [ANNUAL_PANEL] = {"panel", "laser cut panel 2^6",
                      "60 M ray-times at rms 5 %, median 2.5 %, none off by 30 %"},
};

static void print_row(FILE *json, bool first, const struct annual_bench *bench,
                      const struct orl_annual_result *year, const struct errors *e, double seconds,
                      double rate)
{
    printf("%8u %8.3f %9.2f %8.2f %8.2f %8.2f %+8.2f %6.2f %8.1f %8.1f %8.2f\n", year->samples,
           seconds, seconds * rate / 1e6, 100 * e->rms, 100 * e->median, 100 * e->high,
           100 * e->bias, e->z, 100 * e->worst, 100 * e->covered, 100 * e->own);
    fprintf(
        json,
        "%s\n    {\"scene\": \"%s\", \"technique\": \"%s\", \"samples\": %u, \"seconds\": %.4f, "
        "\"ray_times_m\": %.3f, \"rms\": %.5f, \"median\": %.5f, \"p95\": %.5f, "
        "\"bias\": %.5f, \"z\": %.3f, \"worst\": %.4f, \"covered\": %.4f}",
        first ? "" : ",", scenes[bench->scene].title, orl_annual_technique_name(bench->technique),
        year->samples, seconds, seconds * rate / 1e6, e->rms, e->median, e->high, e->bias, e->z,
        e->worst, e->covered);
}

static void print_stages(const struct orl_annual_result *year)
{
    printf("  of that, the last run:");
    for (int i = 0; i < ORL_ANNUAL_STAGES; i++)
        printf(" %s %.3f s", orl_annual_stage_name((enum orl_annual_stage)i), year->timings_s[i]);
    printf("; %zu columns, %zu nodes of the sun, %.1f M rays of paths\n", year->n_columns,
           year->n_nodes, (double)year->health.rays / 1e6);
}

/* Prints a row: the median of several runs of the bench's technique. */
static void print_samples(struct annual_bench *bench, FILE *json, double rate, bool *first,
                          uint32_t samples, struct orl_annual_result *ret_year)
{
    const int runs = (int)bench_number("ORIEL_ANNUAL_RUNS", 3);
    double seconds[BENCH_MOST_RUNS];
    for (int k = 0; k < runs && k < BENCH_MOST_RUNS; k++) {
        orl_annual_done(ret_year);
        seconds[k] = annual_run(bench, samples, ret_year);
    }
    annual_need_truth(bench, ret_year);
    const struct errors e = compare_year(&bench->truth, ret_year);
    print_row(json, *first, bench, ret_year, &e, bench_median(seconds, runs), rate);
    *first = false;
    print_stages(ret_year);
}

/* Prints the rows of all path counts. Returns the year of the last one; the caller owns it. */
static void print_sensors(struct annual_bench *bench, FILE *json, double rate, bool *first,
                          struct orl_annual_result *ret_year)
{
    static const struct bench_list usual = {{ORL_ANNUAL_SAMPLES}, 1};
    const struct bench_list samples = bench_numbers("ORIEL_ANNUAL_SAMPLES", &usual);
    const char *title = scenes[bench->scene].title;
    printf("A year of light, 57 sensors, %s; target: %s\n", title, scenes[bench->scene].target);
    printf(" samples  seconds ray-times    rms %%  median     95 %%    bias      z    worst    "
           "cover    own %%\n");
    for (int i = 0; i < samples.n; i++)
        print_samples(bench, json, rate, first, (uint32_t)samples.values[i], ret_year);
    if (bench_lists("ORIEL_ANNUAL_ROWS", "precomputed")) {
        struct orl_annual_result year = {.n_steps = 0};
        printf(
            "The same by precomputed photons (contribution photons), the last number of paths\n");
        bench->technique = ORL_ANNUAL_PRECOMPUTED;
        print_samples(bench, json, rate, first, (uint32_t)samples.values[samples.n - 1], &year);
        bench->technique = ORL_ANNUAL_BY_PATHS;
        orl_annual_done(&year);
    }
    annual_tell_hours(bench, rate);
    annual_forget_truth(bench);
}

static void print_scene(struct annual_bench *bench, FILE *json, double rate, bool *first)
{
    const char *title = scenes[bench->scene].title;
    struct orl_annual_result year = {.n_steps = 0};
    if (bench_lists("ORIEL_ANNUAL_ROWS", "sensors"))
        print_sensors(bench, json, rate, first, &year);
    else
        annual_run(bench, ORL_ANNUAL_SAMPLES, &year);
    if (bench_lists("ORIEL_ANNUAL_ROWS", "glare"))
        annual_print_glare(bench, json, first, title, rate, &year);
    if (bench_lists("ORIEL_ANNUAL_ROWS", "reuse"))
        annual_print_reuse(bench, json, first, title, &year);
    orl_annual_done(&year);
}

int main(void)
{
    struct annual_bench bench;
    char path[BENCH_PATH];
    bool first = true;
    setvbuf(stdout, NULL, _IOLBF, 0);
    annual_open(&bench);
    const double rate =
        office_rate(&bench.office, bench.pool, (int)bench_number("ORIEL_ANNUAL_RUNS", 3));
    snprintf(path, sizeof path, "%s/annual.json", bench_build());
    FILE *json = fopen(path, "w");
    if (!json)
        bench_fail("build/annual.json cannot be written", NULL);
    fprintf(json, "{\n  \"rows\": [");
    printf("Embree alone: %.2f M rays a second\n", rate / 1e6);
    for (int scene = 0; scene < ANNUAL_SCENES; scene++) {
        bench.scene = (enum annual_scene)scene;
        if (bench_lists("ORIEL_ANNUAL_SCENES", scenes[scene].word))
            print_scene(&bench, json, rate, &first);
    }
    fprintf(json, "\n  ]\n}\n");
    fclose(json);
    annual_close(&bench);
    return 0;
}
