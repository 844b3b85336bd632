/*
 * `make bench`: prints the table of speed.h, and writes it as JSON. Environment, each name after
 * ORIEL_BENCH: _ROWS ("global caustic precomputed image_precomputed image_gather sensors_5
 * sensors_1 maps bsdf edges glare", default: all), _RUNS (5; the table shows medians), _THREADS ("1
 * 2"; targets apply to the first), _PHOTONS (2000000), _RADIANCE=0 to skip Radiance's rows,
 * _REFERENCE, _REFERENCE_EDGES and _REFERENCE_SENSORS (samples per pixel, twice, and per sensor, of
 * each half).
 */
#include "bench/speed.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const struct speed_row rows[SPEED_ROWS] = {
    [SPEED_GLOBAL] = {.key = "global",
                      .name = "global photons, distributed and indexed",
                      .target = 8e6},
    [SPEED_CAUSTIC] = {.key = "caustic",
                       .name = "caustic photons, distributed and indexed",
                       .target = 10e6},
    [SPEED_PRECOMPUTED] = {.key = "precomputed",
                           .name = "global photons and irradiance precomputed",
                           .target = 16e6},
    [SPEED_IMAGE_PRECOMPUTED] = {.key = "image_precomputed",
                                 .name = "image 400x300, precomputed, maps ready",
                                 .target = 6e6,
                                 .wanted_error = 0.05,
                                 .judge = SPEED_BY_IMAGE},
    [SPEED_IMAGE_GATHER] = {.key = "image_gather",
                            .name = "image 400x300, gather, maps ready",
                            .target = 12e6,
                            .wanted_error = 0.03,
                            .judge = SPEED_BY_IMAGE},
    [SPEED_SENSORS_5] = {.key = "sensors_5",
                         .name = "57 sensors to 5 %, from nothing",
                         .target = 6e6,
                         .wanted_error = 0.05,
                         .judge = SPEED_BY_SENSORS},
    [SPEED_SENSORS_1] = {.key = "sensors_1",
                         .name = "57 sensors to 1 %, from nothing",
                         .target = 100e6,
                         .wanted_error = 0.01,
                         .judge = SPEED_BY_SENSORS},
};

bool speed_wants(const char *key)
{
    return bench_lists("ORIEL_BENCH_ROWS", key);
}

void speed_merge(struct bench_deviation *pooled, const struct bench_deviation *error, int before)
{
    const double share = 1.0 / (before + 1);
    pooled->rms = sqrt(pooled->rms * pooled->rms * (1 - share) + error->rms * error->rms * share);
    pooled->bias += (error->bias - pooled->bias) * share;
}

struct speed_fact *speed_add_fact(struct speed *speed, const char *key, const char *unit,
                                  double value, double target, const char *name, ...)
{
    if (speed->n_facts >= SPEED_FACTS)
        bench_fail("too many facts", NULL);
    struct speed_fact *fact = &speed->facts[speed->n_facts++];
    *fact = (struct speed_fact){.key = key, .unit = unit, .value = value, .target = target};
    va_list args;
    va_start(args, name);
    vsnprintf(fact->name, sizeof fact->name, name, args);
    va_end(args);
    return fact;
}

/* Sets the number of threads of the following work. */
static void set_threads(struct speed *speed, int at)
{
    const uint32_t threads = (uint32_t)speed->threads.values[at];
    speed->pool = speed->pools[at];
    speed->now_s = bench_pool_s;
    bench_set_pool(threads);
}

/* Runs a row's work once; measures the ray rate before and after it. */
static struct speed_figure run_once(struct speed *speed, enum speed_row_id id, int run, int at)
{
    set_threads(speed, at);
    const double before = office_rate(&speed->office, speed->pool, 3);
    const double seconds = speed_work(speed, id, (uint64_t)run + 1, at == 0 ? run : -1);
    const double rate = 0.5 * (before + office_rate(&speed->office, speed->pool, 3));
    return (struct speed_figure){seconds, rate, seconds * rate};
}

/*
 * Measures a row with every number of threads, in turns, so that other load on the machine affects
 * all alike. Gains are medians over single turns.
 */
static void measure_row(struct speed *speed, enum speed_row_id id)
{
    struct speed_row *row = &speed->rows[id];
    struct speed_figure figures[SPEED_MOST_THREADS][BENCH_MOST_RUNS];
    double values[BENCH_MOST_RUNS];
    const int n = speed->runs;
    for (int run = 0; run < n; run++)
        for (int at = 0; at < speed->threads.n; at++)
            figures[at][run] = run_once(speed, id, run, at);
    for (int at = 0; at < speed->threads.n; at++) {
        for (int run = 0; run < n; run++)
            values[run] = figures[at][run].seconds;
        row->by_threads[at].seconds = bench_median(values, n);
        for (int run = 0; run < n; run++)
            values[run] = figures[at][run].rays_per_s;
        row->by_threads[at].rays_per_s = bench_median(values, n);
        for (int run = 0; run < n; run++)
            values[run] = figures[at][run].ray_times;
        row->by_threads[at].ray_times = bench_median(values, n);
        for (int run = 0; run < n; run++)
            values[run] = speed->threads.values[at] / speed->threads.values[0] *
                          figures[0][run].ray_times / figures[at][run].ray_times;
        row->gains[at] = bench_median_error(values, n, &row->gain_errors[at]);
    }
}

/* Measures all rows; the facts use the first number of threads. */
static void measure_all(struct speed *speed)
{
    for (int at = 0; at < speed->threads.n; at++) {
        speed->pools[at] = orl_thread_pool_start((uint32_t)speed->threads.values[at]);
        if (!speed->pools[at])
            bench_fail("out of memory", NULL);
    }
    for (int id = 0; id < SPEED_ROWS; id++) {
        if (!speed_wants(speed->rows[id].key))
            continue;
        fprintf(stderr, "  %s\n", speed->rows[id].name);
        set_threads(speed, 0);
        speed_prepare(speed, (enum speed_row_id)id);
        measure_row(speed, (enum speed_row_id)id);
        set_threads(speed, 0);
        if (speed->rows[id].judge == SPEED_BY_SENSORS)
            speed_measure_goal(speed, &speed->rows[id]);
    }
    set_threads(speed, 0);
    if (speed_wants("maps"))
        speed_measure_maps(speed);
    if (speed_wants("bsdf"))
        speed_measure_bsdf(speed);
    if (speed_wants("edges"))
        speed_measure_edges(speed);
    if (speed_wants("glare"))
        speed_measure_glare(speed);
    for (int at = 0; at < speed->threads.n; at++)
        orl_thread_pool_stop(speed->pools[at]);
    speed->pool = NULL;
}

static void read_knobs(struct speed *speed)
{
    static const struct bench_list threads = {{1, 2}, 2};
    speed->photons = bench_number("ORIEL_BENCH_PHOTONS", 2000000);
    speed->runs = (int)bench_number("ORIEL_BENCH_RUNS", 5);
    speed->threads = bench_numbers("ORIEL_BENCH_THREADS", &threads);
    speed->radiance = bench_number("ORIEL_BENCH_RADIANCE", 1) != 0;
    speed->reference.width = 400;
    speed->reference.height = 300;
    speed->reference.pixel_samples = (uint32_t)bench_number("ORIEL_BENCH_REFERENCE", 64);
    speed->reference.edge_samples = (uint32_t)bench_number("ORIEL_BENCH_REFERENCE_EDGES", 512);
    speed->reference.sensor_samples =
        (uint32_t)bench_number("ORIEL_BENCH_REFERENCE_SENSORS", 1 << 17);
    if (speed->runs < 1 || speed->runs > BENCH_MOST_RUNS)
        bench_fail("ORIEL_BENCH_RUNS is from 1 to 9", NULL);
    if (speed->threads.n > SPEED_MOST_THREADS)
        bench_fail("ORIEL_BENCH_THREADS: three numbers at most", NULL);
    for (int i = 0; i < speed->threads.n; i++)
        if (!(speed->threads.values[i] >= 1 && speed->threads.values[i] <= BENCH_MOST_THREADS))
            bench_fail("ORIEL_BENCH_THREADS: not so many", NULL);
}

int main(int argc, char **argv)
{
    static struct speed speed;
    char path[BENCH_PATH];
    if (argc == 5 && strcmp(argv[1], "load") == 0)
        return speed_load_bsdf(argv[2], argv[3], strcmp(argv[4], "known") == 0);
    if (argc > 5 && strcmp(argv[1], "peak") == 0)
        return speed_measure_peak(argv[2], argv[3], argv[4], (const char *const *)argv + 5);
    setvbuf(stdout, NULL, _IOLBF, 0);
    memcpy(speed.rows, rows, sizeof rows);
    read_knobs(&speed);
    office_open(&speed.office, NULL);
    snprintf(speed.maps, sizeof speed.maps, "%s/maps", speed.office.folder);
    office_reference_make(&speed.office, &speed.reference);
    measure_all(&speed);
    speed_add_radiance(&speed);
    speed_print(&speed);
    snprintf(path, sizeof path, "%s/bench.json", bench_build());
    speed_write_json(&speed, path);
    office_reference_done(&speed.reference);
    office_close(&speed.office);
    return 0;
}
