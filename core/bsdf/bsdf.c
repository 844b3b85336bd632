/*
 * The front: turns the file's sides into the surface's frame, fills a missing transmission by
 * reciprocity, drops a dummy one, and offers one contract over trees and matrices.
 *
 * The pdf of a draw is f |cos| over its integral, computed from the very leaf that eval reads; a
 * sample's weight is therefore the albedo. (f is the file's there: where R + T is above 1, values
 * are divided by it when they are read, which leaves the pdf of a draw given the incident direction
 * as it is, and puts the quotient into the weight of a draw given the other one.) The descent that
 * makes the draw follows float means, so it realises that pdf to about 1e-6 relative, with no
 * region of positive f left out.
 */
#include <oriel/bsdf.h>

#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "bsdf/front.h"
#include "bsdf/shirley.h"

/* Which of the component's directions plays the role. */
static enum orl_axis axis_of(const struct orl_view *view, enum orl_role role)
{
    return (role == ORL_ROLE_OUT) != view->transposed ? ORL_AXIS_B : ORL_AXIS_A;
}

/* A direction in the coordinates of the data, found once however many components are asked. */
struct place {
    struct orl_square square; /* trees of rank 4 */
    struct orl_round round;   /* trees of rank 3 */
    struct orl_polar polar;   /* matrices */
};

static struct place place_of(const struct orl_bsdf *bsdf, struct orl_vec3 direction)
{
    struct place place = {{0, 0}, {0, 0}, {0, 0}};
    if (bsdf->document.structure == ORL_STRUCTURE_TREE4)
        place.square = orl_disk_to_square(direction.x, direction.y);
    else if (bsdf->document.structure == ORL_STRUCTURE_TREE3)
        place.round = orl_round_of(direction);
    else
        place.polar = orl_polar_of(direction);
    return place;
}

static double view_eval(const struct orl_bsdf *bsdf, const struct orl_view *view,
                        struct orl_vec3 in, struct orl_vec3 out)
{
    const struct orl_component *c = view->component;
    struct place a, b;
    if (!c)
        return 0;
    a = place_of(bsdf, view->transposed ? out : in);
    b = place_of(bsdf, view->transposed ? in : out);
    if (bsdf->document.structure == ORL_STRUCTURE_TREE4)
        return orl_tree_eval(&c->tree, a.square, b.square);
    if (bsdf->document.structure == ORL_STRUCTURE_TREE3)
        return orl_iso_eval(&c->iso, a.round, b.round);
    return orl_matrix_eval(&c->matrix, a.polar, b.polar);
}

static double view_total(const struct orl_bsdf *bsdf, const struct orl_view *view,
                         enum orl_role role, const struct place *place)
{
    const enum orl_axis given = axis_of(view, role);
    const struct orl_component *c = view->component;
    if (!c)
        return 0;
    if (bsdf->document.structure == ORL_STRUCTURE_TREE4)
        return orl_tree_total(&c->tree, given, place->square);
    if (bsdf->document.structure == ORL_STRUCTURE_TREE3)
        return orl_iso_total(&c->iso, given, place->round);
    return orl_matrix_total(&c->matrix, given, place->polar);
}

static double view_draw(const struct orl_bsdf *bsdf, const struct orl_view *view,
                        enum orl_role role, const struct place *place, const double u[2],
                        struct orl_vec3 *ret_other)
{
    const enum orl_axis given = axis_of(view, role);
    const struct orl_component *c = view->component;
    if (bsdf->document.structure == ORL_STRUCTURE_TREE4)
        return orl_tree_draw(&c->tree, given, place->square, u, ret_other);
    if (bsdf->document.structure == ORL_STRUCTURE_TREE3)
        return orl_iso_draw(&c->iso, given, place->round, u, ret_other);
    return orl_matrix_draw(&c->matrix, given, place->polar, u, ret_other);
}

/* ---- Loading --------------------------------------------------------------------------------- */

static void set_views(struct orl_bsdf *bsdf)
{
    const struct orl_component *parts = bsdf->document.parts;
    memset(bsdf->views, 0, sizeof bsdf->views);
    for (int front = 0; front < 2; front++) {
        /* The file's Front is the exterior: our back. */
        const struct orl_component *reflection =
            &parts[front ? ORL_PART_REFLECTION_BACK : ORL_PART_REFLECTION_FRONT];
        const struct orl_component *own =
            &parts[front ? ORL_PART_TRANSMISSION_BACK : ORL_PART_TRANSMISSION_FRONT];
        const struct orl_component *other =
            &parts[front ? ORL_PART_TRANSMISSION_FRONT : ORL_PART_TRANSMISSION_BACK];
        bsdf->info.has[front][0] = reflection->present;
        bsdf->info.has[front][1] = own->present;
        if (reflection->present)
            bsdf->views[front][0].component = reflection;
        if (own->present)
            bsdf->views[front][1].component = own;
        else if (other->present && bsdf->document.structure != ORL_STRUCTURE_TREE3)
            bsdf->views[front][1] = (struct orl_view){other, true};
    }
}

static bool is_black(const struct orl_bsdf *bsdf, const struct orl_component *c)
{
    const struct orl_matrix *m = &c->matrix;
    if (bsdf->document.structure == ORL_STRUCTURE_TREE4)
        return orl_tree_is_leaf(c->tree.root) && !(c->tree.minimum > 0);
    for (int i = 0; i < m->basis[ORL_AXIS_A].n_cells; i++)
        if (m->total[ORL_AXIS_A][i] > 0)
            return false;
    return true;
}

static bool is_same(const struct orl_bsdf *bsdf, const struct orl_component *c,
                    const struct orl_component *d)
{
    if (bsdf->document.structure == ORL_STRUCTURE_TREE4)
        return orl_tree_equal(&c->tree, &d->tree);
    return orl_matrix_equal(&c->matrix, &d->matrix);
}

/* Exact copies whose reverse differs: the one called Back has nothing of its own to say. */
static bool is_senseless_copy(const struct orl_bsdf *bsdf, const struct orl_component *front,
                              const struct orl_component *back)
{
    return is_same(bsdf, front, back) && orl_bsdf_irreciprocal_transmission(bsdf) > 0.02;
}

/* See enum orl_bsdf_dummy. The views must be set, and are set anew. */
static void drop_dummy(struct orl_bsdf *bsdf)
{
    struct orl_component *front = &bsdf->document.parts[ORL_PART_TRANSMISSION_FRONT];
    struct orl_component *back = &bsdf->document.parts[ORL_PART_TRANSMISSION_BACK];
    struct orl_component *dropped;
    enum orl_bsdf_dummy kind = ORL_BSDF_DUMMY_ZERO;
    /* Of rank 3, what is dropped would not be filled in. */
    if (!front->present || !back->present || bsdf->document.structure == ORL_STRUCTURE_TREE3)
        return;
    if (is_black(bsdf, front) != is_black(bsdf, back)) {
        dropped = is_black(bsdf, front) ? front : back;
    } else if (is_senseless_copy(bsdf, front, back)) {
        dropped = back;
        kind = ORL_BSDF_DUMMY_COPY;
    } else {
        return;
    }
    bsdf->info.dummy[dropped == back] = kind;
    orl_tree_done(&dropped->tree);
    orl_matrix_done(&dropped->matrix);
    dropped->present = false;
    set_views(bsdf);
}

static void describe_tree(struct orl_bsdf_info *info, const struct orl_tree *tree)
{
    if (info->resolution < 1 << tree->depth)
        info->resolution = 1 << tree->depth;
    info->values += tree->values;
    info->bytes += tree->n_lines * sizeof *tree->lines;
    info->clamped += tree->clamped;
}

static void describe_iso(struct orl_bsdf_info *info, const struct orl_iso *iso)
{
    if (info->resolution < 2 * (int)iso->half)
        info->resolution = 2 * (int)iso->half;
    info->values += iso->leaves;
    info->bytes += orl_iso_bytes(iso);
    info->clamped += iso->clamped;
}

static void describe_matrix(struct orl_bsdf_info *info, const struct orl_matrix *matrix)
{
    const int cells = matrix->basis[ORL_AXIS_A].n_cells;
    const char *name = matrix->basis[ORL_AXIS_A].name;
    if (info->resolution < cells)
        info->resolution = cells;
    if (!strncasecmp(name, "LBNL/", 5))
        name += 5;
    strncpy(info->kind, name, sizeof info->kind - 1);
    info->values += (size_t)cells * (size_t)matrix->basis[ORL_AXIS_B].n_cells;
    info->bytes += orl_matrix_bytes(matrix);
    info->clamped += matrix->clamped;
}

/* ---- Every direction the data tell apart ----------------------------------------------------- */

size_t orl_view_cells(const struct orl_bsdf *bsdf, const struct orl_view *view)
{
    if (!view->component)
        return 0;
    if (bsdf->document.structure == ORL_STRUCTURE_TREE4)
        return (size_t)1 << 2 * view->component->tree.depth;
    if (bsdf->document.structure == ORL_STRUCTURE_TREE3)
        return view->component->iso.half;
    return (size_t)view->component->matrix.basis[axis_of(view, ORL_ROLE_IN)].n_cells;
}

static struct orl_vec3 tree_incident(const struct orl_tree *tree, size_t cell, double *ret_omega_sr)
{
    const size_t side = (size_t)1 << tree->depth;
    const double width = 2.0 / (double)side;
    *ret_omega_sr = ORL_PI / (double)(side * side);
    return orl_square_to_hemisphere(
        (struct orl_square){((double)(cell >> tree->depth) + 0.5) * width - 1,
                            ((double)(cell & (side - 1)) + 0.5) * width - 1});
}

/* All azimuths are one; this one is along x. */
static struct orl_vec3 iso_incident(const struct orl_iso *iso, size_t ring, double *ret_omega_sr)
{
    const double sine = ((double)ring + 0.5) / iso->half;
    *ret_omega_sr = ORL_PI * (2.0 * (double)ring + 1) / ((double)iso->half * iso->half);
    return orl_v3(sine, 0, sqrt(1 - sine * sine));
}

struct orl_vec3 orl_view_incident(const struct orl_bsdf *bsdf, const struct orl_view *view,
                                  size_t cell, bool front, double *ret_omega_sr)
{
    const enum orl_axis axis = axis_of(view, ORL_ROLE_IN);
    const double sign = axis == ORL_AXIS_A ? -1 : 1;
    const struct orl_basis *basis = &view->component->matrix.basis[axis];
    struct orl_vec3 in;
    if (bsdf->document.structure == ORL_STRUCTURE_TREE4) {
        in = tree_incident(&view->component->tree, cell, ret_omega_sr);
    } else if (bsdf->document.structure == ORL_STRUCTURE_TREE3) {
        in = iso_incident(&view->component->iso, cell, ret_omega_sr);
    } else {
        in = orl_basis_direction(basis, (int)cell, 0.5, 0.5);
        *ret_omega_sr = orl_basis_ring(basis, (int)cell)->omega_sr;
    }
    return orl_v3(sign * in.x, sign * in.y, front ? in.z : -in.z);
}

double orl_view_omega(const struct orl_bsdf *bsdf, const struct orl_view *view, struct orl_vec3 in,
                      struct orl_vec3 out)
{
    const struct orl_component *c = view->component;
    const struct orl_basis *basis;
    struct place a, b;
    int cell;
    if (!c)
        return 0;
    a = place_of(bsdf, view->transposed ? out : in);
    b = place_of(bsdf, view->transposed ? in : out);
    if (bsdf->document.structure == ORL_STRUCTURE_TREE4)
        return ORL_PI /
               (double)((size_t)1 << 2 * orl_tree_leaf_level(&c->tree, a.square, b.square));
    if (bsdf->document.structure == ORL_STRUCTURE_TREE3)
        return ORL_PI / (4.0 * c->iso.half * c->iso.half);
    basis = &c->matrix.basis[axis_of(view, ORL_ROLE_OUT)];
    cell = orl_basis_cell(basis, view->transposed ? a.polar : b.polar, view->transposed);
    return cell < 0 ? 0 : orl_basis_ring(basis, cell)->omega_sr;
}

/*
 * The largest R + T as filed, over all directions that the data tell apart. Where the largest R
 * and the largest T do not add up to more than 1, nothing can, and nobody need look again.
 */
static void find_gain(struct orl_bsdf *bsdf, bool front)
{
    double largest = 0, parts[2] = {0, 0}, omega;
    for (int t = 0; t < 2; t++) {
        const struct orl_view *view = &bsdf->views[front][t];
        for (size_t i = 0; i < orl_view_cells(bsdf, view); i++) {
            const struct orl_vec3 in = orl_view_incident(bsdf, view, i, front, &omega);
            double total[2];
            orl_bsdf_filed_totals(bsdf, in, total);
            largest = fmax(largest, total[0] + total[1]);
            parts[t] = fmax(parts[t], total[t]);
        }
    }
    bsdf->info.max_albedo[front] = largest;
    bsdf->may_gain[front] = parts[0] + parts[1] > 1;
}

static void describe(struct orl_bsdf *bsdf)
{
    struct orl_bsdf_info *info = &bsdf->info;
    memcpy(info->name, bsdf->document.name, sizeof info->name);
    info->thickness_m = bsdf->document.thickness_m;
    info->colored = bsdf->document.colored;
    info->bytes = sizeof *bsdf;
    strncpy(info->kind,
            bsdf->document.structure == ORL_STRUCTURE_TREE3 ? "TensorTree3" : "TensorTree4",
            sizeof info->kind - 1);
    for (int i = 0; i < ORL_PART_COUNT; i++) {
        const struct orl_component *part = &bsdf->document.parts[i];
        if (!part->present)
            continue;
        if (bsdf->document.structure == ORL_STRUCTURE_TREE4)
            describe_tree(info, &part->tree);
        else if (bsdf->document.structure == ORL_STRUCTURE_TREE3)
            describe_iso(info, &part->iso);
        else
            describe_matrix(info, &part->matrix);
    }
    for (int front = 0; front < 2; front++)
        find_gain(bsdf, front);
}

int orl_bsdf_load_xml(const char *name, const char *xml, size_t size, struct orl_bsdf **ret_bsdf,
                      struct orl_error *err)
{
    struct orl_bsdf *bsdf = calloc(1, sizeof *bsdf);
    int code;
    if (!bsdf) {
        code = orl_error_set(err, ORL_ERR_NOMEM, "out of memory for the BSDF");
        orl_error_at(err, name, 0, NULL);
        return code;
    }
    atomic_init(&bsdf->references, 1);
    code = orl_document_read(name, xml, size, &bsdf->document, err);
    if (code < 0) {
        orl_bsdf_unref(bsdf);
        return code;
    }
    set_views(bsdf);
    drop_dummy(bsdf);
    describe(bsdf);
    *ret_bsdf = bsdf;
    return 0;
}

struct orl_bsdf *orl_bsdf_ref(struct orl_bsdf *bsdf)
{
    atomic_fetch_add_explicit(&bsdf->references, 1, memory_order_relaxed);
    return bsdf;
}

void orl_bsdf_unref(struct orl_bsdf *bsdf)
{
    if (!bsdf || atomic_fetch_sub_explicit(&bsdf->references, 1, memory_order_acq_rel) > 1)
        return;
    orl_document_done(&bsdf->document);
    free(bsdf);
}

void orl_bsdf_describe(const struct orl_bsdf *bsdf, struct orl_bsdf_info *ret_info)
{
    *ret_info = bsdf->info;
}

/* ---- Values ---------------------------------------------------------------------------------- */

/* The view for light from in to out. A direction in the surface itself counts as the back. */
static const struct orl_view *view_between(const struct orl_bsdf *bsdf, struct orl_vec3 in,
                                           struct orl_vec3 out)
{
    const bool in_front = in.z > 0, out_front = out.z > 0;
    return &bsdf->views[in_front][in_front != out_front];
}

struct orl_rgb orl_bsdf_diffuse(const struct orl_bsdf *bsdf, bool in_front, bool transmitted)
{
    const struct orl_component *component = bsdf->views[in_front][transmitted].component;
    const double gain = fmax(1, bsdf->info.max_albedo[in_front]);
    if (!component)
        return orl_gray(0);
    if (bsdf->document.structure == ORL_STRUCTURE_TREE4)
        return orl_gray((double)component->tree.minimum / gain);
    if (bsdf->document.structure == ORL_STRUCTURE_TREE3)
        return orl_gray((double)component->iso.minimum / gain);
    return orl_gray((double)component->matrix.minimum / gain);
}

/* The view that a direction in its role takes part in, by reflection or by transmission. */
static const struct orl_view *view_for(const struct orl_bsdf *bsdf, enum orl_role role, bool front,
                                       bool transmitted)
{
    return &bsdf->views[role == ORL_ROLE_IN ? front : front != transmitted][transmitted];
}

/* Reflected and transmitted totals for a direction, zero for a side that is not asked for. */
static void totals(const struct orl_bsdf *bsdf, enum orl_role role, bool front,
                   const struct place *place, enum orl_bsdf_side sides, double ret_total[2])
{
    for (int t = 0; t < 2; t++) {
        const bool wanted = sides & (t ? ORL_BSDF_TRANSMIT : ORL_BSDF_REFLECT);
        ret_total[t] = wanted ? view_total(bsdf, view_for(bsdf, role, front, t), role, place) : 0;
    }
}

void orl_bsdf_filed_totals(const struct orl_bsdf *bsdf, struct orl_vec3 in, double ret_total[2])
{
    const struct place place = place_of(bsdf, in);
    totals(bsdf, ORL_ROLE_IN, in.z > 0, &place, ORL_BSDF_BOTH, ret_total);
}

/*
 * What every value for light from there is divided by, lest more light leaves than came: R + T
 * where the file has more than 1 for it. Both reflection and transmission shrink alike, and draws
 * given the incident direction keep their pdf.
 */
static double gain_of(const struct orl_bsdf *bsdf, struct orl_vec3 in)
{
    double total[2];
    if (!bsdf->may_gain[in.z > 0])
        return 1;
    orl_bsdf_filed_totals(bsdf, in, total);
    return fmax(1, total[0] + total[1]);
}

struct orl_rgb orl_bsdf_eval(const struct orl_bsdf *bsdf, struct orl_vec3 in, struct orl_vec3 out)
{
    const double value = view_eval(bsdf, view_between(bsdf, in, out), in, out);
    return orl_gray(value > 0 ? value / gain_of(bsdf, in) : 0);
}

struct orl_rgb orl_bsdf_albedo(const struct orl_bsdf *bsdf, struct orl_vec3 in,
                               enum orl_bsdf_side sides)
{
    const struct place place = place_of(bsdf, in);
    double total[2];
    totals(bsdf, ORL_ROLE_IN, in.z > 0, &place, sides, total);
    return orl_gray((total[0] + total[1]) / gain_of(bsdf, in));
}

/* ---- Draws ----------------------------------------------------------------------------------- */

/* Given a direction in its role, draws the one in the other role. */
static bool draw(const struct orl_bsdf *bsdf, enum orl_role role, struct orl_vec3 given,
                 enum orl_bsdf_side sides, const double u[3], struct orl_vec3 *ret_other,
                 struct orl_rgb *ret_weight, double *ret_pdf)
{
    const struct place place = place_of(bsdf, given);
    const bool front = given.z > 0;
    double total[2], sum, value;
    bool transmitted;
    totals(bsdf, role, front, &place, sides, total);
    sum = total[0] + total[1];
    if (!(sum > 0))
        return false;
    transmitted = total[1] > 0 && u[2] * sum >= total[0];
    value = view_draw(bsdf, view_for(bsdf, role, front, transmitted), role, &place, u, ret_other);
    *ret_pdf = value * ret_other->z / sum;
    if (front == transmitted)
        ret_other->z = -ret_other->z;
    *ret_weight = orl_gray(sum / gain_of(bsdf, role == ORL_ROLE_IN ? given : *ret_other));
    return true;
}

static double pdf(const struct orl_bsdf *bsdf, enum orl_role role, struct orl_vec3 given,
                  enum orl_bsdf_side sides, struct orl_vec3 other)
{
    const bool transmitted = (given.z > 0) != (other.z > 0);
    const struct orl_vec3 in = role == ORL_ROLE_IN ? given : other;
    const struct orl_vec3 out = role == ORL_ROLE_IN ? other : given;
    struct place place;
    double total[2], value;
    if (!(sides & (transmitted ? ORL_BSDF_TRANSMIT : ORL_BSDF_REFLECT)))
        return 0;
    value = view_eval(bsdf, view_between(bsdf, in, out), in, out);
    if (!(value > 0))
        return 0;
    place = place_of(bsdf, given);
    totals(bsdf, role, given.z > 0, &place, sides, total);
    return value * fabs(other.z) / (total[0] + total[1]);
}

bool orl_bsdf_sample(const struct orl_bsdf *bsdf, struct orl_vec3 in, enum orl_bsdf_side sides,
                     const double u[3], struct orl_vec3 *ret_out, struct orl_rgb *ret_weight,
                     double *ret_pdf)
{
    return draw(bsdf, ORL_ROLE_IN, in, sides, u, ret_out, ret_weight, ret_pdf);
}

bool orl_bsdf_sample_adjoint(const struct orl_bsdf *bsdf, struct orl_vec3 out,
                             enum orl_bsdf_side sides, const double u[3], struct orl_vec3 *ret_in,
                             struct orl_rgb *ret_weight, double *ret_pdf)
{
    return draw(bsdf, ORL_ROLE_OUT, out, sides, u, ret_in, ret_weight, ret_pdf);
}

double orl_bsdf_pdf(const struct orl_bsdf *bsdf, struct orl_vec3 in, enum orl_bsdf_side sides,
                    struct orl_vec3 out)
{
    return pdf(bsdf, ORL_ROLE_IN, in, sides, out);
}

double orl_bsdf_pdf_adjoint(const struct orl_bsdf *bsdf, struct orl_vec3 out,
                            enum orl_bsdf_side sides, struct orl_vec3 in)
{
    return pdf(bsdf, ORL_ROLE_OUT, out, sides, in);
}
