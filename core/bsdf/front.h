/*
 * Inside core/bsdf: what an orl_bsdf is made of, for bsdf.c, which makes it, values.c, which
 * answers for it, and check.c, which looks it over. Not for anyone else.
 *
 * A view is one component as the surface sees it: the file's sides turned into the surface's, and
 * a transmission that the file lacks seen through the one that it has. Immutable once loaded.
 */
#ifndef ORL_BSDF_FRONT_H
#define ORL_BSDF_FRONT_H

#include <stdatomic.h>

#include <oriel/bsdf.h>

#include "base/sealed.h"
#include "bsdf/document.h"

struct orl_component_view {
    const struct orl_component *component; /* NULL: black */
    bool transposed;                       /* in is the component's B, out its A */
};

struct orl_bsdf {
    atomic_uint references;
    struct orl_document document;
    struct orl_component_view views[2][2]; /* [light comes from the front?][transmitted?] */
    double bound[2]; /* on R + T as filed, of light from the back, the front, in any channel */
    struct orl_bsdf_info info;
    struct orl_sealed_file file; /* a compiled one (compiled.h), which holds all arrays; or none */
};

/* Sets the views, by what parts are present. */
void orl_bsdf_set_views(struct orl_bsdf *bsdf);

enum orl_role { ORL_ROLE_IN, ORL_ROLE_OUT };

/* Which of the component's directions plays the role. */
static inline enum orl_tree_axis orl_view_axis(const struct orl_component_view *view,
                                               enum orl_role role)
{
    return (role == ORL_ROLE_OUT) != view->transposed ? ORL_AXIS_B : ORL_AXIS_A;
}

/* How many incident directions the view's data tell apart at most; 0 when it is black. */
size_t orl_view_cells(const struct orl_bsdf *bsdf, const struct orl_component_view *view);

/* The middle of one of them, for light from that side, and its projected solid angle. */
struct orl_vec3 orl_view_incident(const struct orl_bsdf *bsdf,
                                  const struct orl_component_view *view, size_t cell, bool front,
                                  double *ret_omega_sr);

/* The projected solid angle over which out may roam with f(in, out) being one number. */
double orl_view_omega(const struct orl_bsdf *bsdf, const struct orl_component_view *view,
                      struct orl_vec3 in, struct orl_vec3 out);

/* Directional R and T as the file has them, whatever their sum is. */
void orl_bsdf_filed_totals(const struct orl_bsdf *bsdf, struct orl_vec3 in, double ret_total[2]);
/* The same in colour, summed over the sides asked for. */
struct orl_rgb orl_bsdf_filed_color(const struct orl_bsdf *bsdf, struct orl_vec3 in,
                                    enum orl_bsdf_side sides);

/*
 * Point i of an additive recurrence in up to four dimensions, with the inverse powers of the
 * positive root of x^5 = x + 1 for steps: evenly spread, and in step with no grid of the data.
 */
void orl_even_point(unsigned i, double ret_u[4]);

/*
 * The share of the light that would have to move for f(in, out) = f(out, in): 0 to 1, negative
 * where there is no light. Transmission compares the two ways through.
 */
double orl_bsdf_irreciprocal_reflection(const struct orl_bsdf *bsdf, bool front);
double orl_bsdf_irreciprocal_transmission(const struct orl_bsdf *bsdf);

#endif
