/*
 * Glare indices, from a view's sources and the illuminance at the eye.
 *
 * L and w are a source's luminance and solid angle, and P is its position index. Lb is the
 * luminance of the background, F the mean luminance of the view. Ev is the illuminance at the eye,
 * Ed the sources' part of it, and n the number of sources.
 *
 *     DGPs = 6.22e-5 Ev + 0.184                                            (Wienold 2007)
 *     DGI  = 10 log10 sum 0.478 L^1.6 W^0.8 / (Lb + 0.07 w^0.5 L),  W = w / P^2
 *            (Hopkinson 1972, Chauvel et al. 1982; W as in evalglare)
 *     UGR  = 8 log10 (0.25 / Lb sum L^2 w / P^2)                           (CIE 117-1995)
 *     CGI  = 8 log10 (2 (1 + Ed / 500) / Ev sum L^2 w / P^2)               (Einhorn 1979)
 *     UGP  = 0.26 log10 (0.25 / Lb sum L^2 w / P^2)                        (Hirning et al. 2014)
 *     DGR  = (sum 0.5 L Q / (P F^0.44))^(n^-0.0914),  Q = 20.4 w + 1.52 w^0.2 - 0.075
 *     VCP  = 50 erf((6.374 - 1.3227 ln DGR) / sqrt 2) + 50,
 *            100 below a DGR of 20, 0 above 750                            (IESNA 1984)
 *
 * Without sources there is no glare: DGI, UGR, CGI and UGP are 0, VCP is 100, as in evalglare. If a
 * formula is undefined (for a black background), the result is NaN. DGP is in dgp.h.
 */
#ifndef ORL_METRICS_INDICES_H
#define ORL_METRICS_INDICES_H

#include <oriel/job/glare.h>

struct orl_glare_light {
    double eye_lx, direct_lx, average_cd_m2, background_cd_m2;
};

/* Fills all metrics except DGP. */
void orl_glare_indices(const struct orl_glare_light *light, const struct orl_glare_source *sources,
                       size_t count, double ret_values[ORL_GLARE_METRICS]);

#endif
