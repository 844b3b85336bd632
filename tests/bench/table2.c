/*
 * `make table2`: the paper's table 2 on the office, one thread: cost and error of each technique.
 * Environment: ORIEL_TABLE2_PHOTONS, _WIDTH, _SENSOR_SAMPLES, _PIXEL_SAMPLES (of backward),
 * _REFERENCE (samples per pixel of each half), _REFERENCE_SENSORS, _RUNS (number of seeds
 * averaged), _RADIANCE=0 to skip its rows, _XXX=1 for Radiance's slowest row.
 */
#include <stdlib.h>
#include <string.h>

#include "bench/table2.h"

struct technique {
    const char *name, *paper;
    enum orl_technique technique;
    bool caustics;
};
/* The first row is the baseline. */
static const struct technique techniques[] = {
    {"backward", "xxx", ORL_TECHNIQUE_BACKWARD, true},
    {"gather", "GCx", ORL_TECHNIQUE_GATHER, true},
    {"precomputed", "xCP", ORL_TECHNIQUE_PRECOMPUTED, true},
    {"precomputed, caustics skipped", "xxP", ORL_TECHNIQUE_PRECOMPUTED, false},
    {"direct", "-", ORL_TECHNIQUE_DIRECT, true},
};
enum { TECHNIQUES = sizeof techniques / sizeof *techniques };

static char view_text[] = OFFICE_VIEW;
static char view_name[] = "view";

/* Runs a job of the sensors and the view; the caller owns the luminances. */
static void run_job(const struct table *table, struct orl_job *job, struct orl_thread_pool *pool,
                    struct orl_result *ret_result, double **ret_luminances)
{
    struct orl_view_request view = {.name = view_name,
                                    .view = view_text,
                                    .width = table->reference.width,
                                    .height = table->reference.height};
    char maps[BENCH_PATH + 8], image[BENCH_PATH + 16];
    snprintf(maps, sizeof maps, "%s/maps", table->office.folder);
    snprintf(image, sizeof image, "%s/%s.hdr", table->office.folder, view_name);
    const struct bench_env env = {.files = &table->office.files,
                                  .pool = pool,
                                  .maps = maps,
                                  .output = table->office.folder,
                                  .now_s = bench_cpu_s};
    job->views = &view;
    job->n_views = 1;
    job->sensors_file = office_sensors;
    job->photons_global = job->photons_caustic = table->photons;
    bench_run(&env, job, ret_result);
    *ret_luminances = bench_read_luminances(image, (int)view.width, (int)view.height);
    bench_remove_folder(maps);
}

static void book_times(const struct orl_result *r, struct table_row *row)
{
    static const char *const kinds[TABLE_KINDS] = {"global", "caustic", "precomputed"};
    row->load_s =
        r->timings_s[ORL_STAGE_LOAD] + r->timings_s[ORL_STAGE_BVH] + r->timings_s[ORL_STAGE_PLAN];
    for (int kind = 0; kind < TABLE_KINDS; kind++) {
        for (size_t i = 0; i < r->n_maps; i++) {
            if (strcmp(r->maps[i].kind, kinds[kind]) != 0)
                continue;
            row->photon_s[kind] = r->maps[i].seconds;
            row->photons[kind] = (double)r->maps[i].stored;
        }
    }
    if (r->n_maps == 0)
        row->photon_s[TABLE_GLOBAL] =
            r->timings_s[ORL_STAGE_PHOTONS] + r->timings_s[ORL_STAGE_MAPS];
    row->image_s = r->views[0].seconds;
    row->sensors_s = r->timings_s[ORL_STAGE_RENDER] - r->views[0].seconds;
}

static void say_what_differs(const struct technique *t, const struct orl_result *r)
{
    if (r->plan.technique != t->technique)
        printf("  (%s was run as %s)\n", t->name, orl_technique_name(r->plan.technique));
    for (size_t i = 0; i < r->n_warnings; i++)
        printf("  (%s: %s)\n", t->name, r->warnings[i]);
}

static void measure_technique(struct table *table, const struct technique *t,
                              struct orl_thread_pool *pool)
{
    struct table_row *row = &table->rows[table->n_rows++];
    *row = (struct table_row){.name = t->name, .paper = t->paper};
    fprintf(stderr, "  %s\n", t->name);
    for (int run = 0; run < table->runs; run++) {
        struct table_row of_run = *row;
        double *luminances;
        struct orl_result r;
        struct orl_job job;
        office_job(&job);
        job.technique = t->technique;
        job.seed = (uint64_t)run + 1;
        job.gather_samples = table->sensor_samples;
        job.pixel_samples = table->pixel_samples;
        if (!t->caustics)
            job.overrides[ORL_EFFECT_CAUSTICS_MIRROR] = job.overrides[ORL_EFFECT_CAUSTICS_BSDF] =
                ORL_OVERRIDE_SKIP;
        run_job(table, &job, pool, &r, &luminances);
        book_times(&r, &of_run);
        table_judge(table, r.illuminance_lx, luminances, &of_run);
        table_merge(row, &of_run, run);
        if (run == 0)
            say_what_differs(t, &r);
        free(luminances);
        orl_result_done(&r);
    }
}

static void read_knobs(struct table *table)
{
    table->photons = bench_number("ORIEL_TABLE2_PHOTONS", ORL_DEFAULT_PHOTONS);
    table->reference.width = (uint32_t)bench_number("ORIEL_TABLE2_WIDTH", 400);
    table->reference.height = table->reference.width * 3 / 4;
    table->sensor_samples =
        (uint32_t)bench_number("ORIEL_TABLE2_SENSOR_SAMPLES", ORL_DEFAULT_GATHER_SAMPLES);
    table->pixel_samples = (uint32_t)bench_number("ORIEL_TABLE2_PIXEL_SAMPLES", 16);
    table->reference.pixel_samples = (uint32_t)bench_number("ORIEL_TABLE2_REFERENCE", 64);
    table->reference.sensor_samples =
        (uint32_t)bench_number("ORIEL_TABLE2_REFERENCE_SENSORS", 1 << 17);
    table->runs = (int)bench_number("ORIEL_TABLE2_RUNS", 1);
    table->radiance = bench_number("ORIEL_TABLE2_RADIANCE", 1) != 0;
    table->radiance_backward = bench_number("ORIEL_TABLE2_XXX", 0) != 0;
    if (table->runs < 1 || table->reference.width < 8)
        bench_fail("ORIEL_TABLE2_RUNS and _WIDTH are too small", NULL);
}

int main(void)
{
    static struct table table;
    char path[BENCH_PATH];
    struct orl_thread_pool *pool = orl_thread_pool_start(1);
    if (!pool)
        bench_fail("out of memory", NULL);
    setvbuf(stdout, NULL, _IOLBF, 0);
    read_knobs(&table);
    office_open(&table.office, NULL);
    table.rate = office_rate(&table.office, pool, 3);
    office_reference_make(&table.office, &table.reference);
    for (int i = 0; i < TECHNIQUES; i++)
        measure_technique(&table, &techniques[i], pool);
    table_add_radiance(&table);
    table_print(&table);
    snprintf(path, sizeof path, "%s/table2.json", bench_build());
    table_write_json(&table, path);
    office_reference_done(&table.reference);
    office_close(&table.office);
    orl_thread_pool_stop(pool);
    return 0;
}
