/*
 * Reference of the office: its sensors and its view (OFFICE_VIEW) by backward, in two independent
 * halves (compare.h), computed once on all cores and stored in the build folder. The file name
 * holds the scene, the size and the samples; remove the file to compute it again.
 */
#ifndef ORL_TESTS_BENCH_REFERENCE_H
#define ORL_TESTS_BENCH_REFERENCE_H

#include "bench/compare.h"
#include "bench/office.h"

struct office_reference {
    /* Inputs: */
    uint32_t width, height;                 /* size of the image; 0: none */
    uint32_t sensor_samples, pixel_samples; /* samples of each half */
    uint32_t edge_samples;                  /* samples per pixel of each half in images of edges */
    /* Outputs: */
    struct bench_reference sensors, image;
};

/* Pixels darker than that share of the mean are not counted: RGBE stores them, but they are
 * invisible. */
#define OFFICE_DARKEST 0.01

/*
 * Computes one half with its seed. The caller below reads two halves of n values from the stored
 * file of that name, or computes and stores them.
 */
typedef void bench_reference_half(const void *ctx, uint64_t seed, double *ret_values);
void bench_reference_find(const char *name, size_t n, bench_reference_half *make, const void *ctx,
                          double *ret_values);

void office_reference_make(const struct office *office, struct office_reference *reference);
void office_reference_done(struct office_reference *reference);

#endif
