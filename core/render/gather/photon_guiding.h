/*
 * Path guiding for a sensor's hemisphere by photons: small bright patches, such as the sun on a
 * wall, are met by few evenly distributed rays. Runs of neighbouring photons of a map show where
 * such patches may be. For a place they make a density of directions, over the square of
 * scene/material/scatter.h. Some rays are drawn by it, and all are weighed by the balance
 * heuristic (Veach and Guibas 1995). The density need not be right: obstacles and missing photons
 * cost rays and nothing else.
 *
 * Cells of the square are halved where there is light, down to the resolution of the runs. Cells
 * not much brighter than the mean are left to evenly distributed rays, and so is everything if
 * those are accurate enough.
 */
#ifndef ORL_RENDER_GATHER_PHOTON_GUIDING_H
#define ORL_RENDER_GATHER_PHOTON_GUIDING_H

#include <oriel/base/thread_pool.h>

#include "photon/map/map.h"

enum { ORL_GUIDE_PATCHES = 2048, ORL_GUIDE_CELLS = 1024 };

/* A run of neighbouring photons. */
struct orl_guide_patch {
    float at[3], normal[3];
    float half; /* half the side of a square that they fill */
    float flux;
};

struct orl_photon_guide {
    struct orl_guide_patch *patches; /* owned */
    uint32_t count;
};

/* Builds the patches of a global map. Returns 0, ORL_ERR_NOMEM or ORL_ERR_CANCELLED. */
int orl_photon_guide_init(struct orl_photon_guide *guide, const struct orl_photon_map *map,
                          struct orl_thread_pool *pool);
void orl_photon_guide_done(struct orl_photon_guide *guide); /* also accepts an all-zero struct */

/* A cell, halved across x and y in turn. */
struct orl_guide_cell {
    float mass;   /* share of the density */
    uint32_t low; /* index of its first half, which the second follows; 0: not divided */
};

/* The density of directions at a place. */
struct orl_guide_distribution {
    bool useful; /* true if some rays should be drawn by it */
    uint32_t count;
    struct orl_guide_cell cells[ORL_GUIDE_CELLS];
};

/* Builds the distribution of a place; rays: the number of evenly distributed rays. */
void orl_guide_distribution_build(const struct orl_photon_guide *guide, struct orl_vec3 point,
                                  struct orl_vec3 normal, uint32_t rays,
                                  struct orl_guide_distribution *ret_distribution);

/* Draws a point of the square from a uniform one in u. orl_guide_distribution_pdf returns the
 * density there, of mean 1. */
void orl_guide_distribution_sample(const struct orl_guide_distribution *distribution, double u[2]);
double orl_guide_distribution_pdf(const struct orl_guide_distribution *distribution,
                                  const double u[2]);

#endif
