/*
 * A BSDF in another basis, resolution or cull, and what two BSDFs differ by.
 *
 * A value of the new file is the mean of the old one's over a pair of the new cells, by points that
 * lie evenly in them: exactly where cells of one tree are made of those of another. For each new
 * incident cell what is reflected and transmitted in all is then the mean of the old albedo. Trees
 * are joined by cull alone (goniometer/forest.h).
 */
#ifndef ORIEL_BSDF_CONVERT_H
#define ORIEL_BSDF_CONVERT_H

#include <oriel/bsdf.h>
#include <oriel/bsdf_make.h>

/*
 * to: basis, symmetry, resolution, cull, color, and a name (NULL: the old one's); source: what the
 * new file says of where it comes from. env's files are not used. Errors as of orl_bsdf_make; what
 * is told of errors and paths is 0.
 */
int orl_bsdf_convert(const struct orl_bsdf *bsdf, const char *source,
                     const struct orl_bsdf_make_request *to, const struct orl_bsdf_make_env *env,
                     struct orl_bsdf_made *ret_made, struct orl_error *err);

/* ---- Differences ----------------------------------------------------------------------------- */

struct orl_bsdf_place {
    double theta_deg, phi_deg; /* as in oriel/bsdf.h: away from the surface */
};

/* Of one part, over light from ORL_BSDF_COMPARED directions. Shares of the light that comes. */
enum { ORL_BSDF_COMPARED = 41 };
/* The largest of red, green and blue, by itself: in all, and into a cone two degrees across;
 * signed. */
struct orl_bsdf_color_difference {
    double albedo_worst, cone_worst;
    struct orl_bsdf_place albedo_from, cone_from, cone_to;
};
struct orl_bsdf_difference {
    double albedo_worst, albedo_rms; /* of what is reflected or transmitted in all; signed, b - a */
    struct orl_bsdf_place albedo_from;
    double cone_worst; /* of what goes into a cone two degrees across; signed */
    struct orl_bsdf_place cone_from, cone_to;
    double moved_worst, moved_mean; /* that would have to go elsewhere for them to be the same,
                                       by cells of about half a degree */
    struct orl_bsdf_place moved_from;
    struct orl_bsdf_color_difference color; /* of two that are grey it is that of luminance */
};

/* Index 1 is light from the front; then reflected, transmitted. By luminance. */
struct orl_bsdf_comparison {
    bool colored[2]; /* a, b */
    struct orl_bsdf_difference of[2][2];
};

/* ORL_ERR_CANCELLED, ORL_ERR_NOMEM. cancel may be NULL. */
int orl_bsdf_compare(const struct orl_bsdf *a, const struct orl_bsdf *b, struct orl_crew *crew,
                     const atomic_bool *cancel, struct orl_bsdf_comparison *ret_comparison,
                     struct orl_error *err);

/* ---- A cull by what it loses ------------------------------------------------------------------
 */

/*
 * Converts into a tensor tree, with as few cells as it may have: those become one whose difference
 * sends no more light elsewhere than a share that is found by bisection, the largest that keeps
 * what the file loses (the comparison's albedo_worst and cone_worst, of any part, and of any color
 * where it is kept) `within` that
 * share of the light that comes. So cells of faint light are joined however unlike they are, and
 * peaks are left alone. to's cull is not used. *ret_unseen: what a cell alone may send elsewhere.
 * *ret_lost: what is lost. ORL_ERR_RANGE where the resolution alone loses more.
 */
int orl_bsdf_convert_within(const struct orl_bsdf *bsdf, const char *source,
                            const struct orl_bsdf_make_request *to, double within,
                            const struct orl_bsdf_make_env *env, double *ret_unseen,
                            struct orl_bsdf_made *ret_made, struct orl_bsdf_comparison *ret_lost,
                            struct orl_error *err);

#endif
