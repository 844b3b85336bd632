/*
 * What the office really looks like: its sensors and its view (OFFICE_VIEW) by backward, in two
 * independent halves (compare.h), made by all cores once and kept in the build folder. Their file's
 * name tells the scene, the size and the samples; removing it makes them anew.
 */
#ifndef ORL_TESTS_BENCH_REFERENCE_H
#define ORL_TESTS_BENCH_REFERENCE_H

#include "bench/compare.h"
#include "bench/office.h"

struct office_reference {
    /* Given: */
    uint32_t width, height;                 /* of the image; 0: none */
    uint32_t sensor_samples, pixel_samples; /* of each half */
    uint32_t edge_samples;                  /* a pixel of each half where edges are looked at */
    /* Made: */
    struct bench_reference sensors, image;
};

/* Pixels darker than that share of the mean do not count: rgbe holds them, but nobody sees them. */
#define OFFICE_DARKEST 0.01

/*
 * Values in two halves of n each: read from the file of that name among what is kept, or made, half
 * by half with a seed of its own, and kept.
 */
typedef void bench_reference_half(const void *ctx, uint64_t seed, double *ret_values);
void bench_reference_find(const char *name, size_t n, bench_reference_half *make, const void *ctx,
                          double *ret_values);

void office_reference_make(const struct office *office, struct office_reference *reference);
void office_reference_done(struct office_reference *reference);

#endif
