/*
 * Density estimates whose bandwidth fits the light: narrow beside a shadow's edge, wide where light
 * is even, so that both what a wide disc blurs (bias) and what a narrow one scatters (noise) stay
 * small.
 *
 * Three discs about the point (nested_discs.h), each of half the next one's area, give estimates
 * from noisy to smooth. From one of about 512 photons on each ring is compared with the disc inside
 * it: as long as the two agree within the scatter of so many photons, or at first somewhat more,
 * the estimate moves on to the larger disc. Between clear agreement and clear disagreement it moves
 * part of the way, and no wider disc is used more than a narrower one: the result is a continuous
 * function of the photons' fluxes, and no pattern shows where one bandwidth takes over from
 * another. All areas are the footprint's (footprint.h).
 *
 * Beside a wall or an edge a disc is cut, and what is left of it lies to one side of the point: the
 * mean over it is off wherever light falls off, as it does in corners. There a plane is fitted to
 * the photons, and its value at the point taken, as far as it differs from the mean by more than
 * chance. It is several times as noisy as a mean (1.9 at a straight edge, 2.9 in a right corner)
 * and discs are compared by it, so that they grow wider there.
 *
 * In a dark place amid bright ones even the smallest disc is too wide: light curves within it. What
 * three discs, each of twice the area of the one before, agree about is taken out, in so far as it
 * is beyond twice its own scatter, and up to a third of what there is.
 *
 * References: Lepski 1991, Theory of Probability and its Applications 35 (bandwidths by comparison
 * of nested estimates); Belomestny and Spokoiny 2007, Annals of Statistics 35, 2287 (stagewise
 * aggregation); Schregle 2003, Computer Graphics Forum 22, 729 (bias compensation for photon maps);
 * Jones 1993, Statistics and Computing 3, 135 (linear boundary kernels).
 */
#ifndef ORL_PHOTON_DENSITY_ADAPTIVE_DENSITY_H
#define ORL_PHOTON_DENSITY_ADAPTIVE_DENSITY_H

#include "photon/density/nested_discs.h"

enum { ORL_ADAPTIVE_DENSITY_MOST = 2048 }; /* photons: 2 % of scatter where light is even */

/* What such estimates from one map need beside it. Immutable once made; borrows the map. */
struct orl_adaptive_density {
    struct orl_leaf_sums sums;
    struct orl_zorder order;
    /*
     * A largest radius for such estimates: twice what that many photons take at most of the map's
     * own, so that an estimate in a dark corner is still one, but on a narrow bar does not search
     * the whole scene. No more than widest.
     */
    double reach;
};

/* Returns 0, ORL_ERR_NOMEM or what orl_crew_try does. */
int orl_adaptive_density_init(struct orl_adaptive_density *adapt, const struct orl_photon_map *map,
                              double widest, struct orl_crew *crew, struct orl_search *search);
void orl_adaptive_density_done(
    struct orl_adaptive_density *adapt); /* also of one that is all zero */

/*
 * As orl_density_estimate; radius is the mean of the discs used, by their weight in the result. The
 * standard error is by leaving batches out (Tukey's jackknife), so that it knows of the choice of
 * discs; the bias is what wider discs have beyond the ones used, past its scatter and what of it
 * was taken out.
 */
struct orl_density orl_adaptive_density_estimate(const struct orl_adaptive_density *adapt,
                                                 const struct orl_density_query *query,
                                                 struct orl_search *search);

#endif
