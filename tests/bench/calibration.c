/*
 * Prints the tables of calibration.h that ORIEL_CALIBRATION names ("coverage pixels goals deadlines
 * next", default: all), on the scenes of _SCENES ("lcp glass sphere klems").
 *
 * Environment, each name after ORIEL_CALIBRATION: _SEEDS (of coverage, 30), _GOAL_SEEDS (10),
 * _DEADLINE_SEEDS (1), _NEXT_SEEDS (10 jobs), _PHOTONS (of maps), _BACKWARD_SAMPLES,
 * _GATHER_SAMPLES (per sensor), _REFERENCE_RUNS, _REFERENCE_SAMPLES, _WIDTH (of views),
 * _PIXEL_SAMPLES, _PIXEL_RUNS, _ERRORS ("0.10 0.05 0.02"), _DEADLINES ("5 15 60", seconds),
 * _THREADS, _CPU=1 (processor seconds of all threads, for busy machines; deadlines keep wall time).
 */
#include "bench/calibration.h"

#include <stdio.h>
#include <unistd.h>

static const struct {
    const char *name;
    void (*print)(struct calibration *calibration);
} tables[] = {
    {"coverage", calibration_coverage}, {"pixels", calibration_pixel_errors},
    {"goals", calibration_goals},       {"deadlines", calibration_deadlines},
    {"next", calibration_next},
};

static void read_knobs(struct calibration_knobs *k)
{
    static const struct bench_list errors = {{0.10, 0.05, 0.02}, 3}, deadlines_s = {{5, 15, 60}, 3};
    const long cores = sysconf(_SC_NPROCESSORS_ONLN);
    k->seeds = (uint32_t)bench_number("ORIEL_CALIBRATION_SEEDS", 30);
    k->goal_seeds = (uint32_t)bench_number("ORIEL_CALIBRATION_GOAL_SEEDS", 10);
    k->deadline_seeds = (uint32_t)bench_number("ORIEL_CALIBRATION_DEADLINE_SEEDS", 1);
    k->next_seeds = (uint32_t)bench_number("ORIEL_CALIBRATION_NEXT_SEEDS", 10);
    k->photons = bench_number("ORIEL_CALIBRATION_PHOTONS", 500000);
    k->backward_samples = (uint32_t)bench_number("ORIEL_CALIBRATION_BACKWARD_SAMPLES", 512);
    k->gather_samples = (uint32_t)bench_number("ORIEL_CALIBRATION_GATHER_SAMPLES", 1024);
    k->reference_runs = (uint32_t)bench_number("ORIEL_CALIBRATION_REFERENCE_RUNS", 16);
    k->reference_samples = (uint32_t)bench_number("ORIEL_CALIBRATION_REFERENCE_SAMPLES", 8192);
    k->width = (uint32_t)bench_number("ORIEL_CALIBRATION_WIDTH", 100);
    k->pixel_samples = (uint32_t)bench_number("ORIEL_CALIBRATION_PIXEL_SAMPLES", 32);
    k->pixel_runs = (uint32_t)bench_number("ORIEL_CALIBRATION_PIXEL_RUNS", 16);
    k->errors = bench_numbers("ORIEL_CALIBRATION_ERRORS", &errors);
    k->deadlines_s = bench_numbers("ORIEL_CALIBRATION_DEADLINES", &deadlines_s);
    k->threads =
        (uint32_t)bench_number("ORIEL_CALIBRATION_THREADS", cores > 1 ? (uint64_t)cores : 1);
    k->by_cpu = bench_number("ORIEL_CALIBRATION_CPU", 0) != 0;
    if (k->seeds < 2 || k->reference_runs < 2 || k->pixel_runs < 2 || k->width < 8)
        bench_fail("ORIEL_CALIBRATION: _SEEDS and runs start at 2, _WIDTH at 8", NULL);
}

int main(void)
{
    static struct calibration calibration;
    setvbuf(stdout, NULL, _IOLBF, 0);
    read_knobs(&calibration.knobs);
    calibration_open(&calibration);
    for (size_t i = 0; i < CALIBRATION_SCENES; i++)
        if (bench_lists("ORIEL_CALIBRATION_SCENES", calibration.scenes[i].name))
            calibration.wanted |= UINT64_C(1) << i;
    for (size_t i = 0; i < sizeof tables / sizeof *tables; i++)
        if (bench_lists("ORIEL_CALIBRATION", tables[i].name))
            tables[i].print(&calibration);
    calibration_close(&calibration);
    return 0;
}
