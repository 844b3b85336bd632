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
#ifndef ORL_METRICS_DGP_H
#define ORL_METRICS_DGP_H

#include <oriel/job/glare.h>

struct orl_dgp_options {
    enum orl_dgp_constants constants;
    bool low_light; /* true: apply the correction below 1000 lx */
};

int orl_dgp(double eye_lx, const struct orl_glare_source *sources, size_t n_sources,
            const struct orl_dgp_options *options, double *ret_dgp, struct orl_error *err);

#endif
