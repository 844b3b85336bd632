/*
 * Error maps against a converged picture. For every pixel, z = (x - r) / sqrt(s^2 + s_r^2), with s
 * its stated error and s_r that of the reference. For normal and correctly stated errors the median
 * of |z| is 0.674, and |z| is below 2 at 95.4 % of pixels.
 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "bench/calibration.h"

static const enum orl_technique techniques[] = {ORL_TECHNIQUE_BACKWARD, ORL_TECHNIQUE_GATHER,
                                                ORL_TECHNIQUE_DIRECT, ORL_TECHNIQUE_PRECOMPUTED};
static char view_name[] = "view";

/* A converged picture: means, and standard errors of the means. */
struct picture {
    double *means, *errors; /* cd/m2; owned */
    size_t n;
    double mean;
};

static double *allocate(size_t n)
{
    double *values = calloc(n, sizeof *values);
    if (!values)
        bench_fail("out of memory", NULL);
    return values;
}

static void render(const struct calibration *c, const struct calibration_scene *scene,
                   enum orl_technique technique, uint64_t seed, struct calibration_pixels *ret)
{
    struct orl_view_request view = {.name = view_name,
                                    .view = (char *)(uintptr_t)scene->view,
                                    .width = c->knobs.width,
                                    .height = c->knobs.width * 3 / 4};
    struct orl_result r;
    struct orl_job job;
    calibration_job(scene, &job);
    job.sensors_file = NULL;
    job.n_sensors = 0;
    job.views = &view;
    job.n_views = 1;
    job.technique = technique;
    job.seed = seed;
    job.pixel_samples = c->knobs.pixel_samples;
    if (technique != ORL_TECHNIQUE_BACKWARD)
        job.photons_global = job.photons_caustic = c->knobs.photons;
    calibration_run(c, scene, &job, &r, ret);
    orl_result_done(&r);
}

static void make_picture(const struct calibration *c, const struct calibration_scene *scene,
                         struct picture *ret)
{
    const uint32_t runs = c->knobs.pixel_runs;
    const double started = bench_wall_s(NULL);
    const size_t n = (size_t)c->knobs.width * (c->knobs.width * 3 / 4);
    *ret = (struct picture){.means = allocate(n), .errors = allocate(n), .n = n};
    for (uint32_t run = 0; run < runs; run++) {
        struct calibration_pixels p;
        render(c, scene, ORL_TECHNIQUE_BACKWARD, 1000001 + run, &p);
        for (size_t i = 0; i < n; i++) {
            ret->means[i] += p.values[i] / runs;
            ret->errors[i] += p.values[i] * p.values[i] / runs;
        }
        calibration_pixels_done(&p);
    }
    for (size_t i = 0; i < n; i++) {
        const double square = ret->errors[i] - ret->means[i] * ret->means[i];
        ret->errors[i] = sqrt(fmax(square, 0) / (runs - 1));
        ret->mean += ret->means[i] / (double)n;
    }
    fprintf(stderr, "  %s: picture in %.0f s\n", scene->name, bench_wall_s(NULL) - started);
}

static void print_pixels(const struct calibration_scene *scene, enum orl_technique technique,
                         const struct picture *picture, const struct calibration_pixels *p)
{
    double *z = allocate(p->n), *sizes = allocate(p->n), *stated = allocate(p->n);
    double within = 0, stated2 = 0, off2 = 0;
    for (size_t i = 0; i < p->n; i++) {
        const double off = p->values[i] - picture->means[i];
        const double error = hypot(p->errors[i], picture->errors[i]);
        const double least = fmax(picture->means[i], 0.1 * picture->mean);
        z[i] = error > 0 ? fabs(off) / error : off == 0 ? 0 : INFINITY;
        within += z[i] < 2;
        sizes[i] = fabs(off) / least;
        stated[i] = error / least;
        off2 += pow(off / least, 2) / (double)p->n;
        stated2 += pow(error / least, 2) / (double)p->n;
    }
    printf("  %-7s %-12s %10.2f %10.1f %10.2f %10.2f %10.2f %10.2f\n", scene->name,
           orl_technique_name(technique), calibration_percentile(z, p->n, 0.5),
           100 * within / (double)p->n, 100 * calibration_percentile(stated, p->n, 0.5),
           100 * calibration_percentile(sizes, p->n, 0.5), 100 * sqrt(stated2), 100 * sqrt(off2));
    free(z);
    free(sizes);
    free(stated);
}

void calibration_pixel_errors(struct calibration *c)
{
    const struct calibration_knobs *k = &c->knobs;
    printf("\nError maps of views: %u x %u, backward by %u samples a pixel, the others by %.2f M "
           "photons;\nreference: %u runs of backward\n\n",
           k->width, k->width * 3 / 4, k->pixel_samples, (double)k->photons / 1e6, k->pixel_runs);
    printf("  %-7s %-12s %10s %10s %10s %10s %10s %10s\n", "", "", "median z", "z < 2, %",
           "median s %", "median e %", "rms s %", "rms e %");
    for (size_t i = 0; i < CALIBRATION_SCENES; i++) {
        const struct calibration_scene *scene = &c->scenes[i];
        struct picture picture;
        if (!calibration_wants(c, i) || !scene->view)
            continue;
        make_picture(c, scene, &picture);
        for (size_t t = 0; t < sizeof techniques / sizeof *techniques; t++) {
            struct calibration_pixels p;
            render(c, scene, techniques[t], 1, &p);
            if (p.errors)
                print_pixels(scene, techniques[t], &picture, &p);
            else
                printf("  %-7s %-12s errors are not known\n", scene->name,
                       orl_technique_name(techniques[t]));
            calibration_pixels_done(&p);
        }
        free(picture.means);
        free(picture.errors);
    }
    printf("\n  z: |difference| over the error stated, that of the reference included. Rightly "
           "stated and normal: median\n  0.67, 95.4 %% below 2. s: what is stated, e: what it is, "
           "both in %% of the pixel, or of a tenth of the\n  mean where that is more.\n");
}
