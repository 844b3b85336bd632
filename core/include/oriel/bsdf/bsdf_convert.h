/*
 * Converts a BSDF to another basis, resolution or cull, and compares two BSDFs.
 *
 * A value of the new file is the mean of the old values over a pair of new cells. It is sampled at
 * points that lie evenly in the cells; between cells of two trees it is exact. Hence for each new
 * incident cell the total reflectance and transmittance are means of the old albedo. Tree cells are
 * merged by cull alone (bsdf/make/trees/tree_builder.h).
 */
#ifndef ORIEL_BSDF_BSDF_CONVERT_H
#define ORIEL_BSDF_BSDF_CONVERT_H

#include <oriel/bsdf/bsdf.h>
#include <oriel/bsdf/bsdf_make.h>

/*
 * Converts. `to` gives basis, symmetry, resolution, cull, color, and a name (NULL: the old name).
 * `source` is the provenance text of the new file. env's files are not used. Errors are those of
 * orl_bsdf_make. Fields of the result about errors and paths are 0.
 */
int orl_bsdf_convert(const struct orl_bsdf *bsdf, const char *source,
                     const struct orl_bsdf_make_request *to, const struct orl_bsdf_make_env *env,
                     struct orl_bsdf_make_result *ret_result, struct orl_error *err);

/* ---- Differences ----------------------------------------------------------------------------- */

struct orl_bsdf_angles {
    double theta_deg, phi_deg; /* direction as in oriel/bsdf/bsdf.h: away from the surface */
};

/* Difference of one component, over light from ORL_BSDF_COMPARED directions, as shares of the
 * incident light. */
enum { ORL_BSDF_COMPARED = 41 };
/* Largest difference in a single channel (red, green or blue): in total, and into a cone two
 * degrees wide; signed. */
struct orl_bsdf_color_difference {
    double albedo_worst, cone_worst;
    struct orl_bsdf_angles albedo_from, cone_from, cone_to;
};
struct orl_bsdf_difference {
    /* Difference of total reflectance or transmittance; signed, b - a. */
    double albedo_worst, albedo_rms;
    struct orl_bsdf_angles albedo_from;
    double cone_worst; /* largest difference in a cone two degrees wide; signed */
    struct orl_bsdf_angles cone_from, cone_to;
    double moved_worst, moved_mean; /* light that would have to change direction to make a and b
                                       equal, by cells of about half a degree */
    struct orl_bsdf_angles moved_from;
    /* For two grey BSDFs equal to the luminance difference. */
    struct orl_bsdf_color_difference color;
};

/* Index 1 is light from the front; then reflected, transmitted. Values are by luminance. */
struct orl_bsdf_comparison {
    bool colored[2]; /* a, b */
    struct orl_bsdf_difference of[2][2];
};

/* Returns 0, ORL_ERR_CANCELLED or ORL_ERR_NOMEM. cancel may be NULL. */
int orl_bsdf_compare(const struct orl_bsdf *a, const struct orl_bsdf *b,
                     struct orl_thread_pool *pool, const atomic_bool *cancel,
                     struct orl_bsdf_comparison *ret_comparison, struct orl_error *err);

/* ---- A cull by the loss it causes ------------------------------------------------------------ */

/*
 * Converts to a tensor tree with as few cells as the bound on the loss allows. Cells are merged if
 * their differences redirect no more than a threshold share of the light. The threshold is found by
 * bisection: the largest one that keeps the file's loss within the share `within` of the incident
 * light. The loss is the comparison's albedo_worst and cone_worst, of any component, and of any
 * colour channel if colour is kept. So cells of faint light are merged however different they are,
 * and peaks stay. to's cull is not used. *ret_unseen: the threshold, which bounds the light that a
 * single cell redirects. *ret_lost: the loss. Returns ORL_ERR_RANGE if the resolution alone loses
 * more.
 */
int orl_bsdf_convert_within(const struct orl_bsdf *bsdf, const char *source,
                            const struct orl_bsdf_make_request *to, double within,
                            const struct orl_bsdf_make_env *env, double *ret_cull_fraction,
                            struct orl_bsdf_make_result *ret_result,
                            struct orl_bsdf_comparison *ret_lost, struct orl_error *err);

#endif
