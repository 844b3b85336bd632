#include "support/study_data.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/sampling/sampling.h"
#include "study/study_errors.h"

static double draw_normal(struct orl_random *random)
{
    const double u = 1 - orl_random_uniform(random), v = orl_random_uniform(random);
    return sqrt(-2 * log(u)) * cos(2 * ORL_PI * v);
}

void study_grid_points(const struct study_grid *grid, struct orl_study_point *ret_points)
{
    struct orl_random random = orl_random_stream(7, ORL_PURPOSE_REFIT, grid->index);
    struct orl_study_fit truth = {.technique = grid->technique};
    memcpy(truth.terms, grid->terms, sizeof truth.terms);
    for (size_t i = 0; i < grid->n_photons; i++) {
        for (size_t k = 0; k < grid->n_samples; k++) {
            struct orl_study_point *p = &ret_points[i * grid->n_samples + k];
            const double s = grid->spread;
            *p = (struct orl_study_point){
                .setting = {grid->technique, grid->photons[i], grid->samples[k]}, .seeds = 3};
            const double rms = orl_study_fit_predict(&truth, &p->setting);
            /* exp(-s^2/2) makes the mean of the log-normal factor 1. */
            p->rms = rms * sqrt(exp(s * draw_normal(&random) - 0.5 * s * s));
            p->rms_error = 0.5 * s * p->rms;
            p->total_s = 0.3 + 1e-6 * (double)p->setting.photons + 2e-4 * p->setting.samples;
        }
    }
}

struct orl_study study_of_chance(uint64_t index, size_t points, size_t external)
{
    struct orl_random random = orl_random_stream(11, ORL_PURPOSE_REFIT, index);
    struct orl_study study = {.threads = 1, .reference = {.standard_error = 0.004}};
    const size_t techniques = ORL_TECHNIQUE_COUNT - 1;
    study.points = calloc(techniques * points + 1, sizeof *study.points);
    study.external = calloc(external + 1, sizeof *study.external);
    for (size_t i = 0; study.points && i < techniques * points; i++) {
        struct orl_study_point *p = &study.points[study.n_points++];
        const double t = pow(10, 3 * orl_random_uniform(&random) - 1);
        *p =
            (struct orl_study_point){.setting = {(enum orl_technique)(1 + i % techniques),
                                                 100000ULL << (i % 7), 64U << (i % 5)},
                                     .seeds = 3,
                                     .total_s = t,
                                     .total_error_s = 0.05 * t,
                                     .rms = 0.05 * pow(t, -0.4) * exp(orl_random_uniform(&random))};
        p->rms_error = 0.3 * p->rms * orl_random_uniform(&random);
    }
    for (size_t i = 0; study.external && i < external; i++) {
        char name[64];
        snprintf(name, sizeof name, "another program's %s %zu", i % 2 ? "way" : "longer way", i);
        study.external[study.n_external++] =
            (struct orl_study_external){.name = strdup(name),
                                        .here_s = 20 + 8 * orl_random_uniform(&random),
                                        .rms = 0.25 + 0.1 * orl_random_uniform(&random)};
    }
    orl_study_mark_front(study.points, study.n_points);
    return study;
}
