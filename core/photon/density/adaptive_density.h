/*
 * Adaptive density estimation: the bandwidth is narrow beside a shadow's edge and wide where light
 * is even. So both the blur of a wide disc (bias) and the scatter of a narrow one (noise) remain
 * small.
 *
 * Three discs around the point (nested_discs.h), each with half the area of the next one, give
 * estimates from noisy to smooth. Starting from a disc of about 512 photons, each ring is compared
 * with the disc inside it. If the two agree within the scatter of that number of photons (at first
 * somewhat more), the estimate moves on to the larger disc. Between clear agreement and clear
 * disagreement it moves part of the way, and a wider disc never has more weight than a narrower
 * one. So the result is a continuous function of the photons' fluxes, and the transitions between
 * bandwidths are not visible. All areas are the footprint's (footprint.h).
 *
 * Beside a wall or an edge a disc is cut, and the rest of it lies to one side of the point. Then
 * the mean over it is biased if light falls off, as in corners. In that case a plane is fitted to
 * the photons. Its value at the point is used, as far as it differs significantly from the mean. It
 * is several times as noisy as a mean (1.9 at a straight edge, 2.9 in a right-angled corner). Discs
 * are compared by it, so they grow wider there.
 *
 * In a dark place surrounded by bright ones even the smallest disc is too wide, because light is
 * curved within it. A curve that three discs (each with twice the area of the one before) agree
 * about is subtracted. Only the part beyond twice its own scatter is, up to a third of the value.
 *
 * References: Lepski 1991, Theory of Probability and its Applications 35 (bandwidths by comparison
 * of nested estimates); Belomestny and Spokoiny 2007, Annals of Statistics 35, 2287 (stagewise
 * aggregation); Schregle 2003, Computer Graphics Forum 22, 729 (bias compensation for photon maps);
 * Jones 1993, Statistics and Computing 3, 135 (linear boundary kernels).
 */
#ifndef ORL_PHOTON_DENSITY_ADAPTIVE_DENSITY_H
#define ORL_PHOTON_DENSITY_ADAPTIVE_DENSITY_H

#include "photon/density/nested_discs.h"

enum { ORL_ADAPTIVE_DENSITY_MOST = 2048 }; /* photons: 2 % standard deviation in even light */

/* Data for such estimates from one map. Immutable once made; borrows the map. */
struct orl_adaptive_density {
    struct orl_leaf_sums sums;
    struct orl_zorder order;
    /*
     * Maximum radius: twice the one that holds ORL_ADAPTIVE_DENSITY_MOST photons at three quarters
     * of the map's own photons, and at most `widest`. Estimates in a dark corner still find
     * photons, and those on a narrow bar do not search the whole scene.
     */
    double reach;
};

/* Builds the data. Returns 0, ORL_ERR_NOMEM or an error of orl_parallel_try. */
int orl_adaptive_density_init(struct orl_adaptive_density *adapt, const struct orl_photon_map *map,
                              double widest, struct orl_thread_pool *pool,
                              struct orl_search *search);
void orl_adaptive_density_done(
    struct orl_adaptive_density *adapt); /* a struct that is all zero is allowed */

/*
 * Estimates density as orl_density_estimate does; radius is the mean of the discs' radii, weighted
 * as in the result. The standard error is by Tukey's jackknife over batches, so it includes the
 * choice of discs. The bias is the difference of wider discs to those used, beyond its scatter,
 * less the part that was subtracted.
 */
struct orl_density orl_adaptive_density_estimate(const struct orl_adaptive_density *adapt,
                                                 const struct orl_density_query *query,
                                                 struct orl_search *search);

#endif
