/* Glare indices from the light at the eye and a list of sources: the position index, DGP, and the
 * others. */
#ifndef ORL_METRICS_INDICES_H
#define ORL_METRICS_INDICES_H

#include <oriel/base/vec.h>
#include <oriel/job/glare.h>

/*
 * Position index: the factor by which a source beside the line of sight may be brighter than one on
 * it for the same glare.
 *
 * Above the line of sight it is Guth's (Guth 1963, as fitted in the IES Lighting Handbook). tau is
 * the angle from vertical about the line of sight, and sigma the angle from the line of sight, in
 * degrees:
 *     P = exp((35.2 - 0.31889 tau - 1.22 e^(-2 tau / 9)) 10^-3 sigma
 *           + (21 + 0.26667 tau - 0.002963 tau^2) 10^-5 sigma^2);
 * below it is that of Iwata and Tokura (1998), in the notation of CIE 232:2019, with beta for
 * sigma:
 *     P = exp(6.49 10^-3 beta + 21 10^-5 beta^2),
 *     tan beta = tan sigma sqrt(1 + 0.3225 cos^2 tau).
 * It is at most 16. On the line of sight it is 1, and both formulas agree at eye level.
 */

/* Returns the position index. direction: unit, in the eye's axes (glare_sources.h), in front of the
 * eye. */
double orl_position_index(struct orl_vec3 direction);

/*
 * Daylight glare probability: the probability that a person finds a view disturbing, from the
 * illuminance at the eye and the glare sources in the view.
 *
 *     DGP = c1 Ev + c2 log10(1 + sum L^2 w / (Ev^1.87 P^2)) + c3, clamped to 1
 *
 * Conventions: Ev is the vertical illuminance at the eye in lx, L the luminance of a source in
 * cd/m2, w its solid angle in sr, P its position index after Guth (1 on the line of sight, more
 * beside it). Sources are found elsewhere (glare_sources.h).
 *
 * Constants: the paper's are 5.87e-5, 0.0918 and 0.16; the program evalglare, whose numbers most
 * reports quote, has 5.87e-5, 0.092 and 0.159. The fit is valid from 0.2 to 0.8, above 380 lx.
 *
 * Without light at the eye (Ev = 0) there is no glare. The sum, which would be divided by zero, is
 * left out, and c3 remains. This is also the limit of a view without sources whose Ev goes to 0.
 * The low-light correction multiplies DGP by e^x / (1 + e^x), x = 0.024 Ev - 4, below 1000 lx; as
 * in evalglare it is off by default.
 *
 * Threads: pure functions. Errors: ORL_ERR_RANGE for arguments that are not finite or negative, or
 * a source whose position index is not positive. Results are finite, from 0 to 1.
 *
 * References: Wienold and Christoffersen, "Evaluation methods and development of a new glare
 * prediction model for daylight environments with the use of CCD cameras", Energy and Buildings
 * 38(7), 2006; Wienold, "Dynamic daylight glare evaluation", Building Simulation 2009 (low light).
 */

struct orl_dgp_options {
    enum orl_dgp_constants constants;
    bool low_light; /* true: apply the correction below 1000 lx */
};

int orl_dgp(double eye_lx, const struct orl_glare_source *sources, size_t n_sources,
            const struct orl_dgp_options *options, double *ret_dgp, struct orl_error *err);

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
 * formula is undefined (for a black background), the result is NaN. DGP is above.
 */

struct orl_glare_light {
    double eye_lx, direct_lx, average_cd_m2, background_cd_m2;
};

/* Fills all metrics except DGP. */
void orl_glare_indices(const struct orl_glare_light *light, const struct orl_glare_source *sources,
                       size_t count, double ret_values[ORL_GLARE_METRICS]);

#endif
