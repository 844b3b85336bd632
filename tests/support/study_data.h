/*
 * Synthetic studies: points from a model whose parameters are known.
 */
#ifndef ORL_TESTS_SUPPORT_STUDY_DATA_H
#define ORL_TESTS_SUPPORT_STUDY_DATA_H

#include <oriel/job/study.h>

/* Points of a technique at every photon count and every number of samples; rms follows these terms
 * (NaN: absent). Each rms^2 is log-normal with that relative spread; index selects the random
 * sample. */
struct study_grid {
    enum orl_technique technique;
    const uint64_t *photons;
    size_t n_photons;
    const uint32_t *samples;
    size_t n_samples;
    double terms[ORL_FIT_TERMS];
    double spread;
    uint64_t index;
};
void study_grid_points(const struct study_grid *grid, struct orl_study_point *ret_points);

/* Returns a random study of that many points per technique and given points; the arrays are owned,
 * for orl_study_done. */
struct orl_study study_of_chance(uint64_t index, size_t points, size_t external);

#endif
