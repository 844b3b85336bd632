/*
 * Values, integrals and sampling of a BSDF through its views.
 *
 * The pdf of a sample is f |cos| over its integral, by luminance, computed from the same leaf as
 * eval. A sample's weight is therefore the albedo times the tint of that leaf. f is here the value
 * as filed. If R + T is above 1, values are divided by it when read. Given the incident direction,
 * that leaves the pdf unchanged. Given the exitant direction, the quotient is part of the weight.
 * Sampling descends by float means, so it realises the pdf to about 1e-6 relative and leaves out no
 * region of positive f.
 */
#include <oriel/bsdf/bsdf.h>

#include "bsdf/bsdf_internal.h"
#include "bsdf/loaded_bsdf.h"

enum { ABREAST = 16 }; /* samples whose tree descents are interleaved */

/* ---- One pair of directions ------------------------------------------------------------------ */

struct pair {
    const struct orl_component *component; /* NULL: black */
    struct orl_coords a, b;
    double value; /* 1/sr, as filed */
};

/* Returns the view of a pair of directions. A direction in the surface counts as the back. */
static const struct orl_component_view *view_between(const struct orl_bsdf *bsdf,
                                                     struct orl_vec3 in, struct orl_vec3 out)
{
    const bool in_front = in.z > 0, out_front = out.z > 0;
    return &bsdf->views[in_front][in_front != out_front];
}

static inline struct pair pair_of(const struct orl_bsdf *bsdf, struct orl_vec3 in,
                                  struct orl_vec3 out)
{
    const enum orl_structure structure = bsdf->document.structure;
    const struct orl_component_view *view = view_between(bsdf, in, out);
    struct pair p = {.component = view->component};
    if (!p.component)
        return p;
    p.a = orl_coords_of(structure, view->transposed ? out : in);
    p.b = orl_coords_of(structure, view->transposed ? in : out);
    p.value = orl_component_eval(structure, p.component, &p.a, &p.b);
    return p;
}

/* Returns the coloured value of a luminance that is part of the pair's value. */
static inline struct orl_rgb color_of(const struct orl_bsdf *bsdf, const struct pair *p,
                                      double luminance)
{
    if (!p->component || !p->component->chroma.present) /* most data are grey */
        return orl_gray(luminance);
    return orl_tinted(orl_chroma_tint(bsdf->document.structure, p->component, &p->a, &p->b),
                      luminance);
}

/* Returns the straight part of the pair's value: 0 to 1. */
static double straight_share(const struct orl_bsdf *bsdf, const struct pair *p)
{
    if (!(p->value > 0))
        return 0;
    return orl_peak_part(bsdf->document.structure, p->component, &p->a, &p->b, p->value) / p->value;
}

double orl_bsdf_straight_part(const struct orl_bsdf *bsdf, struct orl_vec3 in, struct orl_vec3 out)
{
    struct pair p;
    if ((in.z > 0) == (out.z > 0))
        return 0;
    p = pair_of(bsdf, in, out);
    return straight_share(bsdf, &p);
}

/* ---- Integrals ------------------------------------------------------------------------------- */

/* Returns the view of a direction in a role, for reflection or transmission. */
static const struct orl_component_view *view_for(const struct orl_bsdf *bsdf, enum orl_role role,
                                                 bool front, bool transmitted)
{
    return &bsdf->views[role == ORL_ROLE_IN ? front : front != transmitted][transmitted];
}

static bool includes_side(enum orl_bsdf_side sides, bool transmitted)
{
    return sides & (transmitted ? ORL_BSDF_TRANSMIT : ORL_BSDF_REFLECT);
}

/* Computes reflected and transmitted totals of a direction; zero for a side not in `sides`. */
static void compute_totals(const struct orl_bsdf *bsdf, enum orl_role role, bool front,
                           const struct orl_coords *coords, enum orl_bsdf_side sides,
                           double ret_total[2])
{
    for (int t = 0; t < 2; t++) {
        const struct orl_component_view *view = view_for(bsdf, role, front, t);
        ret_total[t] = includes_side(sides, t) && view->component
                           ? orl_component_total(bsdf->document.structure, view->component,
                                                 orl_view_axis(view, role), coords)
                           : 0;
    }
}

void orl_bsdf_filed_totals(const struct orl_bsdf *bsdf, struct orl_vec3 in, double ret_total[2])
{
    const struct orl_coords coords = orl_coords_of(bsdf->document.structure, in);
    compute_totals(bsdf, ORL_ROLE_IN, in.z > 0, &coords, ORL_BSDF_BOTH, ret_total);
}

struct orl_rgb orl_bsdf_filed_color(const struct orl_bsdf *bsdf, struct orl_vec3 in,
                                    enum orl_bsdf_side sides)
{
    const enum orl_structure structure = bsdf->document.structure;
    const struct orl_coords coords = orl_coords_of(structure, in);
    struct orl_rgb sum = orl_gray(0);
    double total[2];
    compute_totals(bsdf, ORL_ROLE_IN, in.z > 0, &coords, sides, total);
    for (int t = 0; t < 2; t++) {
        const struct orl_component_view *view = view_for(bsdf, ORL_ROLE_IN, in.z > 0, t);
        if (total[t] > 0)
            sum = orl_rgb_add(
                sum, orl_tinted(orl_chroma_total(structure, view->component,
                                                 orl_view_axis(view, ORL_ROLE_IN), &coords),
                                total[t]));
    }
    return sum;
}

/*
 * Returns the divisor of all values for light from in: R + T as filed, in the largest channel, if
 * above 1. The division limits the light that leaves to the light that arrives. Reflection and
 * transmission shrink alike, and samples given the incident direction keep their pdf.
 */
static inline double gain_of(const struct orl_bsdf *bsdf, struct orl_vec3 in)
{
    if (!(bsdf->bound[in.z > 0] > 1))
        return 1;
    return orl_larger(1, orl_rgb_max(orl_bsdf_filed_color(bsdf, in, ORL_BSDF_BOTH)));
}

struct orl_rgb orl_bsdf_eval(const struct orl_bsdf *bsdf, struct orl_vec3 in, struct orl_vec3 out)
{
    const struct pair p = pair_of(bsdf, in, out);
    if (!(p.value > 0))
        return orl_gray(0);
    return color_of(bsdf, &p, p.value / gain_of(bsdf, in));
}

struct orl_rgb orl_bsdf_diffuse(const struct orl_bsdf *bsdf, bool in_front, bool transmitted)
{
    const struct orl_component *component = bsdf->views[in_front][transmitted].component;
    const double gain = orl_larger(1, bsdf->info.max_albedo[in_front]);
    /* Coloured data have no single tint of their constant part. */
    if (!component || component->chroma.present)
        return orl_gray(0);
    if (bsdf->document.structure == ORL_STRUCTURE_TREE4)
        return orl_gray((double)component->tree.minimum / gain);
    if (bsdf->document.structure == ORL_STRUCTURE_TREE3)
        return orl_gray((double)component->iso.minimum / gain);
    return orl_gray((double)component->matrix.minimum / gain);
}

struct orl_rgb orl_bsdf_albedo(const struct orl_bsdf *bsdf, struct orl_vec3 in,
                               enum orl_bsdf_side sides)
{
    return orl_rgb_scale(orl_bsdf_filed_color(bsdf, in, sides), 1 / gain_of(bsdf, in));
}

struct orl_rgb orl_bsdf_straight(const struct orl_bsdf *bsdf, struct orl_vec3 in)
{
    const enum orl_structure structure = bsdf->document.structure;
    const struct orl_component_view *view = &bsdf->views[in.z > 0][1];
    const struct orl_coords coords = orl_coords_of(structure, in);
    if (!view->component || view->component->peak.cells == 0)
        return orl_gray(0);
    return orl_rgb_scale(
        orl_peak_color(structure, view->component, orl_view_axis(view, ORL_ROLE_IN), &coords),
        1 / gain_of(bsdf, in));
}

double orl_bsdf_max_albedo(const struct orl_bsdf *bsdf, bool in_front)
{
    return orl_smaller(1, bsdf->bound[in_front]);
}

double orl_bsdf_total(const struct orl_bsdf *bsdf, struct orl_vec3 given, bool adjoint,
                      enum orl_bsdf_side sides)
{
    const struct orl_coords coords = orl_coords_of(bsdf->document.structure, given);
    double total[2];
    compute_totals(bsdf, adjoint ? ORL_ROLE_OUT : ORL_ROLE_IN, given.z > 0, &coords, sides, total);
    return total[0] + total[1];
}

/* ---- Sampling ------------------------------------------------------------------------------- */

/*
 * Moves a sample within the peak to the straight direction. Given the incident direction, its
 * weight is unchanged. Given the exitant one, the peak is integrated over incident directions, but
 * the straight share over exitant ones. They differ for data that are not reciprocal; the weight
 * corrects for that.
 */
static void straighten_draw(const struct orl_bsdf *bsdf, enum orl_role role, struct orl_vec3 given,
                            double sum, struct orl_bsdf_sample_result *draw)
{
    const enum orl_structure structure = bsdf->document.structure;
    draw->straight = true;
    draw->direction = orl_neg(given);
    draw->pdf = 0;
    if (role == ORL_ROLE_OUT) {
        const struct orl_component_view *view = view_for(bsdf, role, given.z > 0, true);
        const struct orl_coords coords = orl_coords_of(structure, given);
        const double left_out =
            orl_peak_total(structure, view->component, orl_view_axis(view, role), &coords);
        draw->weight = orl_rgb_scale(orl_bsdf_straight(bsdf, draw->direction),
                                     left_out > 0 ? sum / left_out : 0);
    }
}

/* State of sampling the direction in the other role, given one in `role`. */
struct drawing {
    enum orl_role role;
    struct orl_coords coords;
    const struct orl_component_view *view;
    double total[2], sum;
    bool front, transmitted;
};

/* Sets the given direction. */
static inline void place_draw(const struct orl_bsdf *bsdf, enum orl_role role,
                              struct orl_vec3 given, struct drawing *d)
{
    d->role = role;
    d->coords = orl_coords_of(bsdf->document.structure, given);
    d->front = given.z > 0;
}

/* Chooses the side; returns false if no light goes to any. */
static inline bool begin_draw(const struct orl_bsdf *bsdf, enum orl_bsdf_side sides, double u,
                              struct drawing *d)
{
    compute_totals(bsdf, d->role, d->front, &d->coords, sides, d->total);
    d->sum = d->total[0] + d->total[1];
    d->transmitted = d->total[1] > 0 && u * d->sum >= d->total[0];
    d->view = view_for(bsdf, d->role, d->front, d->transmitted);
    return d->sum > 0;
}

/* Prefetches the memory that begin_draw will read. */
static inline void prefetch_totals(const struct orl_bsdf *bsdf, enum orl_bsdf_side sides,
                                   const struct drawing *d)
{
    for (int t = 0; t < 2 && bsdf->document.structure == ORL_STRUCTURE_TREE4; t++) {
        const struct orl_component_view *view = view_for(bsdf, d->role, d->front, t);
        if (includes_side(sides, t) && view->component)
            orl_tree_prefetch_total(&view->component->tree, orl_view_axis(view, d->role),
                                    d->coords.square);
    }
}

/* Completes a sample from its value as filed and its direction with z > 0. */
static inline void end_draw(const struct orl_bsdf *bsdf, const struct drawing *d,
                            struct orl_vec3 given, double value, struct orl_vec3 direction,
                            struct orl_bsdf_sample_result *ret)
{
    ret->direction = direction;
    ret->pdf = value * direction.z / d->sum;
    ret->straight = false;
    if (d->front == d->transmitted)
        ret->direction.z = -ret->direction.z;
    ret->weight = orl_gray(d->sum / gain_of(bsdf, d->role == ORL_ROLE_IN ? given : ret->direction));
}

/* Samples the direction in the other role. Samples within a peak go straight. */
static bool draw_other(const struct orl_bsdf *bsdf, enum orl_role role, struct orl_vec3 given,
                       enum orl_bsdf_side sides, const double u[3], bool peaks,
                       struct orl_bsdf_sample_result *ret)
{
    const enum orl_structure structure = bsdf->document.structure;
    struct pair p = {.component = NULL};
    struct orl_vec3 direction;
    struct drawing d;
    place_draw(bsdf, role, given, &d);
    if (!begin_draw(bsdf, sides, u[2], &d))
        return false;
    const struct orl_component *component = d.view->component;
    p.value = orl_component_sample(structure, component, orl_view_axis(d.view, role), &d.coords, u,
                                   &direction);
    end_draw(bsdf, &d, given, p.value, direction, ret);
    if (component->chroma.present || (peaks && component->peak.cells > 0)) {
        const bool is_a = orl_view_axis(d.view, role) == ORL_AXIS_A;
        const struct orl_coords other = orl_coords_of(structure, ret->direction);
        p.component = component;
        p.a = is_a ? d.coords : other;
        p.b = is_a ? other : d.coords;
        ret->weight = color_of(bsdf, &p, ret->weight.g);
    }
    /* The remainder of the number that chose the side is used again. */
    if (peaks && d.transmitted && p.component &&
        (u[2] * d.sum - d.total[0]) / d.total[1] < straight_share(bsdf, &p))
        straighten_draw(bsdf, role, given, d.sum, ret);
    return true;
}

/* Completes samples of grey trees of rank 4 together; their descents take most of the time. */
static void draw_from_trees(const struct orl_bsdf_sample_request *requests,
                            const struct drawing *drawings, const size_t *which, size_t n,
                            struct orl_bsdf_sample_result *ret)
{
    struct orl_tree_sample draws[ABREAST];
    for (size_t i = 0; i < n; i++) {
        const struct orl_bsdf_sample_request *request = &requests[which[i]];
        const struct drawing *d = &drawings[which[i]];
        draws[i].tree = &d->view->component->tree;
        draws[i].given = orl_view_axis(d->view, d->role);
        draws[i].place = d->coords.square;
        draws[i].u[0] = request->u[0];
        draws[i].u[1] = request->u[1];
    }
    orl_tree_sample_many(draws, n);
    for (size_t i = 0; i < n; i++) {
        const struct orl_bsdf_sample_request *request = &requests[which[i]];
        end_draw(request->bsdf, &drawings[which[i]], request->given, draws[i].value,
                 draws[i].direction, &ret[which[i]]);
    }
}

/* Processes up to ABREAST requests. */
static void draw_abreast(const struct orl_bsdf_sample_request *requests, size_t n,
                         struct orl_bsdf_sample_result *ret, bool *ret_found)
{
    struct drawing drawings[ABREAST];
    size_t which[ABREAST], trees = 0;
    for (size_t i = 0; i < n; i++) {
        const enum orl_role role = requests[i].adjoint ? ORL_ROLE_OUT : ORL_ROLE_IN;
        place_draw(requests[i].bsdf, role, requests[i].given, &drawings[i]);
        prefetch_totals(requests[i].bsdf, requests[i].sides, &drawings[i]);
    }
    for (size_t i = 0; i < n; i++) {
        const struct orl_bsdf_sample_request *request = &requests[i];
        struct drawing *d = &drawings[i];
        ret_found[i] = begin_draw(request->bsdf, request->sides, request->u[2], d);
        if (!ret_found[i])
            continue;
        if (request->bsdf->document.structure == ORL_STRUCTURE_TREE4 &&
            !d->view->component->chroma.present)
            which[trees++] = i;
        else
            draw_other(request->bsdf, d->role, request->given, request->sides, request->u, false,
                       &ret[i]);
    }
    draw_from_trees(requests, drawings, which, trees, ret);
}

static double pdf_of(const struct orl_bsdf *bsdf, enum orl_role role, struct orl_vec3 given,
                     enum orl_bsdf_side sides, struct orl_vec3 other)
{
    const bool transmitted = (given.z > 0) != (other.z > 0);
    const struct orl_vec3 in = role == ORL_ROLE_IN ? given : other;
    const struct orl_vec3 out = role == ORL_ROLE_IN ? other : given;
    struct pair p;
    if (!includes_side(sides, transmitted))
        return 0;
    p = pair_of(bsdf, in, out);
    if (!(p.value > 0))
        return 0;
    return p.value * fabs(other.z) / orl_bsdf_total(bsdf, given, role == ORL_ROLE_OUT, sides);
}

static bool draw_plain(const struct orl_bsdf *bsdf, enum orl_role role, struct orl_vec3 given,
                       enum orl_bsdf_side sides, const double u[3], struct orl_vec3 *ret_other,
                       struct orl_rgb *ret_weight, double *ret_pdf)
{
    struct orl_bsdf_sample_result draw;
    if (!draw_other(bsdf, role, given, sides, u, false, &draw))
        return false;
    *ret_other = draw.direction;
    *ret_weight = draw.weight;
    *ret_pdf = draw.pdf;
    return true;
}

bool orl_bsdf_sample(const struct orl_bsdf *bsdf, struct orl_vec3 in, enum orl_bsdf_side sides,
                     const double u[3], struct orl_vec3 *ret_out, struct orl_rgb *ret_weight,
                     double *ret_pdf)
{
    return draw_plain(bsdf, ORL_ROLE_IN, in, sides, u, ret_out, ret_weight, ret_pdf);
}

bool orl_bsdf_sample_adjoint(const struct orl_bsdf *bsdf, struct orl_vec3 out,
                             enum orl_bsdf_side sides, const double u[3], struct orl_vec3 *ret_in,
                             struct orl_rgb *ret_weight, double *ret_pdf)
{
    return draw_plain(bsdf, ORL_ROLE_OUT, out, sides, u, ret_in, ret_weight, ret_pdf);
}

void orl_bsdf_sample_many(const struct orl_bsdf_sample_request *requests, size_t n,
                          struct orl_bsdf_sample_result *ret_samples, bool *ret_found)
{
    for (size_t i = 0; i < n; i += ABREAST)
        draw_abreast(requests + i, n - i < ABREAST ? n - i : ABREAST, ret_samples + i,
                     ret_found + i);
}

bool orl_bsdf_sample_split(const struct orl_bsdf *bsdf, struct orl_vec3 given, bool adjoint,
                           enum orl_bsdf_side sides, const double u[3],
                           struct orl_bsdf_sample_result *ret_sample)
{
    return draw_other(bsdf, adjoint ? ORL_ROLE_OUT : ORL_ROLE_IN, given, sides, u, true,
                      ret_sample);
}

double orl_bsdf_pdf(const struct orl_bsdf *bsdf, struct orl_vec3 in, enum orl_bsdf_side sides,
                    struct orl_vec3 out)
{
    return pdf_of(bsdf, ORL_ROLE_IN, in, sides, out);
}

double orl_bsdf_pdf_adjoint(const struct orl_bsdf *bsdf, struct orl_vec3 out,
                            enum orl_bsdf_side sides, struct orl_vec3 in)
{
    return pdf_of(bsdf, ORL_ROLE_OUT, out, sides, in);
}

/* ---- Precomputed directions ----------------------------------------------------------------- */

struct orl_bsdf_direction orl_bsdf_locate(const struct orl_bsdf *bsdf, struct orl_vec3 direction)
{
    return (struct orl_bsdf_direction){direction,
                                       orl_coords_of(bsdf->document.structure, direction)};
}

struct orl_bsdf_incidence orl_bsdf_locate_incident(const struct orl_bsdf *bsdf, struct orl_vec3 in)
{
    struct orl_bsdf_incidence incidence = {.from = orl_bsdf_locate(bsdf, in),
                                           .gain = gain_of(bsdf, in)};
    double total[2];
    compute_totals(bsdf, ORL_ROLE_IN, in.z > 0, &incidence.from.coords, ORL_BSDF_TRANSMIT, total);
    incidence.transmitted = total[1];
    return incidence;
}

struct orl_rgb orl_bsdf_transmit(const struct orl_bsdf *bsdf, const struct orl_bsdf_incidence *in,
                                 const struct orl_bsdf_direction *out, double *ret_pdf)
{
    const enum orl_structure structure = bsdf->document.structure;
    const struct orl_component_view *view = view_between(bsdf, in->from.at, out->at);
    struct pair p = {.component = view->component};
    *ret_pdf = 0;
    if (!p.component)
        return orl_gray(0);
    p.a = view->transposed ? out->coords : in->from.coords;
    p.b = view->transposed ? in->from.coords : out->coords;
    p.value = orl_component_eval(structure, p.component, &p.a, &p.b);
    if (!(p.value > 0))
        return orl_gray(0);
    *ret_pdf = p.value * fabs(out->at.z) / in->transmitted;
    return color_of(bsdf, &p, p.value / in->gain);
}

bool orl_bsdf_in_one_cell(const struct orl_bsdf *bsdf, const struct orl_bsdf_incidence *a,
                          const struct orl_bsdf_incidence *b)
{
    const bool front = a->from.at.z > 0;
    const struct orl_component_view *view = &bsdf->views[front][1];
    const struct orl_component *c = view->component;
    const enum orl_tree_axis axis = orl_view_axis(view, ORL_ROLE_IN);
    if (!c || c->chroma.present || front != (b->from.at.z > 0) || a->gain != b->gain)
        return false;
    if (bsdf->document.structure == ORL_STRUCTURE_MATRIX)
        return orl_matrix_cell(&c->matrix, axis, a->from.coords.polar) ==
               orl_matrix_cell(&c->matrix, axis, b->from.coords.polar);
    return bsdf->document.structure == ORL_STRUCTURE_TREE4 &&
           orl_square_cell(axis, a->from.coords.square, c->tree.depth) ==
               orl_square_cell(axis, b->from.coords.square, c->tree.depth);
}
