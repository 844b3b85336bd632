/*
 * Contents of an orl_bsdf, shared by bsdf.c (builds it), values.c (evaluates it), cells.c,
 * compiled_bsdf.c, cone_table.c and check/. For core/bsdf only.
 *
 * A view is one component in the surface's frame. A transmission missing in the file is a
 * transposed view of the one that is there. Views are immutable once loaded.
 */
#ifndef ORL_BSDF_BSDF_INTERNAL_H
#define ORL_BSDF_BSDF_INTERNAL_H

#include <stdatomic.h>

#include <oriel/bsdf/bsdf.h>
#include <oriel/bsdf/bsdf_convert.h>

#include "base/io/checked_file.h"
#include "bsdf/document.h"

struct orl_component_view {
    const struct orl_component *component; /* NULL: black */
    bool transposed;                       /* true if in is the component's B, and out its A */
};

struct orl_bsdf {
    atomic_uint references;
    struct orl_document document;
    struct orl_component_view views[2][2]; /* [light comes from the front][transmitted] */
    double bound[2]; /* upper bounds of R + T as filed, any channel: light from back, front */
    struct orl_bsdf_info info;
    struct orl_checked_file file; /* mapped file with all arrays (compiled_bsdf.c), if any */
};

/* Sets the views according to the components present. */
void orl_bsdf_set_views(struct orl_bsdf *bsdf);

enum orl_role { ORL_ROLE_IN, ORL_ROLE_OUT };

/* Returns the component's axis that has the role. */
static inline enum orl_tree_axis orl_view_axis(const struct orl_component_view *view,
                                               enum orl_role role)
{
    return (role == ORL_ROLE_OUT) != view->transposed ? ORL_AXIS_B : ORL_AXIS_A;
}

/* Returns the number of incident directions that the view's data distinguish at most; 0 if
 * black. */
size_t orl_view_cells(const struct orl_bsdf *bsdf, const struct orl_component_view *view);

/* Returns the middle of an incident cell, for light from the given side, and its projected solid
 * angle in sr. */
struct orl_vec3 orl_view_incident(const struct orl_bsdf *bsdf,
                                  const struct orl_component_view *view, size_t cell, bool front,
                                  double *ret_omega_sr);

/* Returns the projected solid angle (sr) around out in which f(in, out) is constant; 0 if black. */
double orl_view_omega(const struct orl_bsdf *bsdf, const struct orl_component_view *view,
                      struct orl_vec3 in, struct orl_vec3 out);

/* Returns directional R and T as filed, even if their sum is above 1. */
void orl_bsdf_filed_totals(const struct orl_bsdf *bsdf, struct orl_vec3 in, double ret_total[2]);
/* Returns the coloured total as filed, summed over the given sides. */
struct orl_rgb orl_bsdf_filed_color(const struct orl_bsdf *bsdf, struct orl_vec3 in,
                                    enum orl_bsdf_side sides);

/* ---- Directions by angles, for check/ -------------------------------------------------------- */

/* Returns the direction at these angles on one side of the surface. */
static inline struct orl_vec3 orl_bsdf_direction_at(double theta_deg, double phi_deg, bool front)
{
    const double theta = theta_deg * ORL_DEG_TO_RAD, phi = phi_deg * ORL_DEG_TO_RAD;
    const double sine = sin(theta), cosine = cos(theta);
    return orl_v3(sine * cos(phi), sine * sin(phi), front ? cosine : -cosine);
}

/* Returns the angles of a direction: theta from its side's normal, phi from 0 to 360. */
static inline struct orl_bsdf_angles orl_bsdf_angles_of(struct orl_vec3 d)
{
    const double phi = atan2(d.y, d.x) / ORL_DEG_TO_RAD;
    return (struct orl_bsdf_angles){acos(fmin(1, fabs(d.z))) / ORL_DEG_TO_RAD,
                                    phi < 0 ? phi + 360 : phi};
}

/*
 * Computes the corners of a beam 0.1 degrees wide. Round angles lie on borders of the data's cells,
 * where rounding would choose the cell of a single direction.
 */
enum { ORL_BSDF_BEAM = 4 };
static inline void orl_bsdf_spread_beam(struct orl_vec3 in, struct orl_vec3 ret_beam[ORL_BSDF_BEAM])
{
    const struct orl_frame frame = orl_frame_about(in);
    const double half = 0.05 * ORL_DEG_TO_RAD;
    for (int k = 0; k < ORL_BSDF_BEAM; k++)
        ret_beam[k] = orl_normalize(
            orl_to_world(&frame, orl_v3(k & 1 ? half : -half, k & 2 ? half : -half, 1)));
}

/*
 * Returns point i of an additive recurrence in up to four dimensions. The steps are the inverse
 * powers of the positive root of x^5 = x + 1. Points are evenly spread and not aligned with any
 * grid of the data.
 */
void orl_r_sequence_point(unsigned i, double ret_u[4]);

/*
 * Returns the share of light that would have to move to make f(in, out) = f(out, in): 0 to 1,
 * negative if there is no light. Transmission compares the two directions through the surface.
 */
double orl_bsdf_irreciprocal_reflection(const struct orl_bsdf *bsdf, bool front);
double orl_bsdf_irreciprocal_transmission(const struct orl_bsdf *bsdf);

/* Fills verdicts and worst of a check from its other fields (check/verdict.c). */
void orl_bsdf_set_verdicts(struct orl_bsdf_check *check);

#endif
