/*
 * Coverage: how often intervals hold the reference, and pixel errors against a converged picture.
 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "bench/calibration.h"

static const enum orl_technique techniques[] = {ORL_TECHNIQUE_BACKWARD, ORL_TECHNIQUE_GATHER,
                                                ORL_TECHNIQUE_PRECOMPUTED};
enum { TECHNIQUES = sizeof techniques / sizeof *techniques };

/* Sums over sensors and seeds. */
struct coverage {
    uint32_t runs;
    double covered, covered2; /* shares of a run's sensors, and their squares */
    double stated2, rms2;     /* mean squares of relative standard error and relative error */
    double bias, reference2;
    double sums[CALIBRATION_MOST_SENSORS],
        squares[CALIBRATION_MOST_SENSORS]; /* sums over the values of each sensor */
    double seconds;
    bool known;
};

/*
 * Returns the share of a run's intervals that hold the reference, widened by the reference's error.
 */
static double share_covered(const struct calibration_scene *scene, const struct orl_result *r)
{
    double covered = 0;
    for (size_t i = 0; i < scene->n_sensors; i++) {
        const double *interval = r->interval_95_lx[i];
        const double half = (interval[1] - interval[0]) / 2;
        const double off = (interval[0] + interval[1]) / 2 - scene->reference_lx[i];
        covered += fabs(off) <= sqrt(half * half + 4 * scene->error_lx[i] * scene->error_lx[i]);
    }
    return covered / (double)scene->n_sensors;
}

static void book(const struct calibration_scene *scene, const struct orl_result *r,
                 struct coverage *c)
{
    const struct calibration_error e = calibration_judge(scene, r->illuminance_lx);
    c->runs++;
    c->rms2 += e.rms * e.rms;
    c->bias += e.bias;
    c->seconds += r->total_s;
    c->known = r->interval_95_lx && r->standard_error_lx;
    for (size_t i = 0; i < scene->n_sensors; i++) {
        const double value = r->illuminance_lx[i];
        const double least = fmax(scene->reference_lx[i], 1e-3 * scene->mean_lx);
        c->sums[i] += value / least;
        c->squares[i] += value * value / (least * least);
        c->reference2 += pow(scene->error_lx[i] / least, 2) / (double)scene->n_sensors;
        if (c->known)
            c->stated2 += pow(r->standard_error_lx[i] / least, 2) / (double)scene->n_sensors;
    }
    if (c->known) {
        const double share = share_covered(scene, r);
        c->covered += share;
        c->covered2 += share * share;
    }
}

/* Returns the standard deviation of sensor values between seeds, rms over sensors. */
static double seed_deviation(const struct coverage *c, size_t n_sensors)
{
    double sum = 0;
    for (size_t i = 0; i < n_sensors; i++)
        sum += fmax(c->squares[i] / c->runs - pow(c->sums[i] / c->runs, 2), 0);
    return sqrt(sum / (double)n_sensors * c->runs / (c->runs - 1));
}

static void print_coverage(const struct calibration_scene *scene, enum orl_technique technique,
                           const struct coverage *c)
{
    const double n = c->runs, share = c->covered / n;
    const double between = sqrt(fmax(c->covered2 / n - share * share, 0) / (n - 1));
    printf("  %-7s %-12s", scene->name, orl_technique_name(technique));
    if (c->known)
        printf(" %6.1f +- %4.1f  %-3s %8.2f", 100 * share, 100 * between,
               share >= 0.92 && share <= 0.98 ? "yes" : "no", 100 * sqrt(c->stated2 / n));
    else
        printf(" %14s  %-3s %8s", "-", "-", "-");
    printf(" %8.2f %8.2f %+8.2f %8.3f %8.2f\n", 100 * seed_deviation(c, scene->n_sensors),
           100 * sqrt(c->rms2 / n), 100 * c->bias / n, 100 * sqrt(c->reference2 / n),
           c->seconds / n);
}

static void cover(struct calibration *calibration, struct calibration_scene *scene,
                  enum orl_technique technique)
{
    const struct calibration_knobs *knobs = &calibration->knobs;
    struct coverage coverage = {.runs = 0};
    for (uint32_t seed = 1; seed <= knobs->seeds; seed++) {
        struct orl_result r;
        struct orl_job job;
        calibration_job(scene, &job);
        job.technique = technique;
        job.seed = seed;
        job.gather_samples =
            technique == ORL_TECHNIQUE_BACKWARD ? knobs->backward_samples : knobs->gather_samples;
        job.photons_global = job.photons_caustic =
            technique == ORL_TECHNIQUE_BACKWARD ? ORL_PHOTONS_BY_PLAN : knobs->photons;
        calibration_run(calibration, scene, &job, &r, NULL);
        book(scene, &r, &coverage);
        orl_result_done(&r);
    }
    print_coverage(scene, technique, &coverage);
}

void calibration_coverage(struct calibration *calibration)
{
    const struct calibration_knobs *k = &calibration->knobs;
    printf("\nCoverage of interval_95_lx: %u seeds, %.2f M photons, %u samples a sensor (backward "
           "%u)\n\n",
           k->seeds, (double)k->photons / 1e6, k->gather_samples, k->backward_samples);
    printf("  %-7s %-12s %14s  %-3s %8s %8s %8s %8s %8s %8s\n", "scene", "technique", "covered %",
           "ok", "stated %", "spread %", "rms %", "bias %", "ref %", "seconds");
    for (size_t i = 0; i < CALIBRATION_SCENES; i++) {
        if (!calibration_wants(calibration, i))
            continue;
        calibration_refer(calibration, &calibration->scenes[i]);
        for (int t = 0; t < TECHNIQUES; t++)
            cover(calibration, &calibration->scenes[i], techniques[t]);
    }
    printf("\n  covered: sensors and seeds whose interval holds the reference, and how well that is"
           " known (seeds\n  are independent, sensors are not); ok: 92 to 98 %%. stated: "
           "standard_error_lx, spread: what values do\n  between seeds, rms: their errors, all as "
           "roots of mean squares; ref: standard error of the reference,\n  by which intervals are "
           "widened.\n");
}
