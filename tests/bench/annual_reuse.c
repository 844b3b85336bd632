/*
 * A second weather file of the same place and times: its time as a share of the first year's, with
 * the cache of the first year in place, and the number of rays.
 */
#include <stdio.h>
#include <stdlib.h>

#include "bench/annual.h"

/* Writes the same rows with less sun and more sky. */
static char *make_other(const struct orl_annual_result *year, size_t *ret_size)
{
    char *text = NULL;
    FILE *file = open_memstream(&text, ret_size);
    if (!file)
        bench_fail("out of memory", NULL);
    fprintf(file,
            "place other\nlatitude %.9g\nlongitude %.9g\ntime_zone %.9g\nsite_elevation 0\n"
            "weather_data_file_units 1\n",
            year->site.latitude_deg, -year->site.longitude_deg, -15 * year->site.time_zone_h);
    for (size_t i = 0; i < year->n_steps; i++) {
        const struct orl_annual_step *s = &year->steps[i];
        const bool lit = s->column != ORL_ANNUAL_DARK;
        fprintf(file, "%d %d %.3f %.0f %.0f\n", s->month, s->day, s->hour,
                lit ? s->direct_normal_lx / 150 : 0, lit ? 10 + s->diffuse_lx / 110 : 0);
    }
    fclose(file);
    return text;
}

struct reuse_run {
    double seconds, stages[ORL_ANNUAL_STAGES];
    uint64_t rays;
};

static struct reuse_run run_kept(struct annual_bench *bench, struct orl_folder_store *folder)
{
    struct orl_annual_result year = {.n_steps = 0};
    struct orl_error err = {0};
    const struct orl_map_store store = orl_map_store_in_folder(folder);
    const struct orl_run_env run = annual_run_env(bench, &store);
    const struct orl_annual_env env = {.run = &run, .reuse = true};
    const struct orl_annual_request request =
        annual_request(bench, ORL_ANNUAL_SAMPLES, bench->sensors, OFFICE_SENSORS);
    const double started = bench_own_s(NULL);
    if (orl_annual_run(&request, &env, &year, &err) < 0)
        bench_fail("the year did not run", &err);
    struct reuse_run done = {.seconds = bench_own_s(NULL) - started, .rays = year.health.rays};
    for (int i = 0; i < ORL_ANNUAL_STAGES; i++)
        done.stages[i] = year.timings_s[i];
    orl_annual_done(&year);
    return done;
}

void annual_print_reuse(struct annual_bench *bench, FILE *json, bool *first, const char *title,
                        const struct orl_annual_result *year)
{
    const struct orl_file own = bench->weather;
    const int runs = (int)bench_number("ORIEL_ANNUAL_RUNS", 3);
    struct orl_folder_store folder;
    double firsts[BENCH_MOST_RUNS], others[BENCH_MOST_RUNS];
    struct reuse_run other = {.seconds = 0};
    size_t size = 0;
    char *text = make_other(year, &size);
    for (int k = 0; k < runs && k < BENCH_MOST_RUNS; k++) {
        bench_make_folder(folder.folder);
        firsts[k] = run_kept(bench, &folder).seconds;
        bench->weather = (struct orl_file){.data = text, .size = size};
        other = run_kept(bench, &folder);
        others[k] = other.seconds;
        bench->weather = own;
        bench_remove_folder(folder.folder);
    }
    const double once = bench_median(firsts, runs), again = bench_median(others, runs);
    printf("Another weather file, %s: %.1f %% of the first (%.3f of %.3f s), %llu rays; target: 5 "
           "%%, none\n  of that:",
           title, 100 * again / once, again, once, (unsigned long long)other.rays);
    for (int i = 0; i < ORL_ANNUAL_STAGES; i++)
        printf(" %s %.3f s", orl_annual_stage_name((enum orl_annual_stage)i), other.stages[i]);
    printf("\n");
    fprintf(json,
            "%s\n    {\"scene\": \"%s\", \"other_weather\": %.4f, \"seconds\": %.4f, \"rays\": "
            "%llu}",
            *first ? "" : ",", title, again / once, again, (unsigned long long)other.rays);
    *first = false;
    free(text);
}
