/*
 * A scan's light as lobes that can be moved: Gaussians with a mass each, the share of the incident
 * light that they carry away.
 *
 * Three parts, which add up to the interpolant (knots.h): what is the same in all directions out;
 * what is broad (what a disc of 8 degrees can follow: the interpolant's opening, as image
 * morphology has it, less the first); and what stands out of that. Each changes from one incident
 * direction to the next in its own way, so each is transported by itself: light of a sharp peak
 * would otherwise be cheaper to fill up from what lies about than to move.
 *
 * Lobes are the leaves of a quadtree (square.h) that goes on where leaving off would misplace more
 * than a ten thousandth or so of the light. Clusters are what transport plans are of: stretches of
 * lobes with no more than a share of the mass.
 *
 * Immutable once made. Ownership: the caller's, orl_fit_shape_done.
 */
#ifndef ORL_FIT_SHAPE_H
#define ORL_FIT_SHAPE_H

#include "fit/knots.h"

enum orl_fit_kind { ORL_FIT_BROAD, ORL_FIT_NARROW, ORL_FIT_KINDS };

struct orl_fit_lobe {
    float x, y, z, mass, sigma_rad;
    uint32_t cluster, code, level;
    float aim; /* 1/sr: what all lobes together are to be in its middle, above the floor */
};

struct orl_fit_cluster {
    float x, y, z, mass, sigma_rad; /* sigma: how far its light lies about */
};

struct orl_fit_part {
    struct orl_fit_lobe *lobes;       /* in the order of codes; owned */
    struct orl_fit_cluster *clusters; /* owned */
    size_t n_lobes, n_clusters, room, cluster_room;
    double mass;
};

struct orl_fit_shape {
    struct orl_vec3 in;
    double floor; /* 1/sr, in all directions; its mass is pi times that */
    struct orl_fit_part parts[ORL_FIT_KINDS];
    double total, total_error; /* share of the light, and its standard error */
    struct orl_vec3 peak;
    double peak_value;
};

/* levels: of lobes where it is bright, at most 7, and of the smallest. 0, ORL_ERR_NOMEM or
 * ORL_ERR_CANCELLED. */
int orl_fit_shape_make(const struct orl_fit_knots *knots, struct orl_vec3 in,
                       const unsigned levels[2], const atomic_bool *cancel,
                       struct orl_fit_shape *ret_shape, struct orl_error *err);
void orl_fit_shape_done(struct orl_fit_shape *shape);

/* Gaussians blur what they are to stand for: masses are changed until the sum of them has the
 * values that it is to have, as Richardson (1972) and Lucy (1974) do it, which leaves none
 * negative. The light stays the same. False: no memory. */
bool orl_fit_sharpen(struct orl_fit_shape *shape);

/* The same under a mirror in x (bit 0), y (bit 1), or both. False: no memory. */
bool orl_fit_shape_mirror(const struct orl_fit_shape *shape, unsigned mirror,
                          struct orl_fit_shape *ret_shape);

#endif
