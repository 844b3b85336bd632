/*
 * Lobes by functions or data (plasfunc, metfunc, transfunc, plasdata, metdata, transdata, and
 * BRTDfunc, whose functions are the whole BRDF and BTDF of each channel). Light divides as for
 * plastic, metal and trans; light that is not scattered diffusely is scattered by a function of
 * both directions, 1/sr, times its share. The functions are used as given: they are not normalised,
 * and need not be reciprocal.
 *
 * Sampling is by the function, tabulated at the centres of SIDE x SIDE cells of equal projected
 * solid angle, uniform within a cell. A fixed share is sampled by the cosine alone, so that
 * features between the centres are found too. On flat surfaces, for functions that do not depend on
 * the place, the tables are made once before rendering, for as many incident directions
 * (orl_lobe_table_fill). Elsewhere each sample makes one with fewer cells.
 * orl_function_lobes_measure tests whether the cells resolve a lobe.
 */
#include "scene/material/function_brdf/function_brdf_check.h"

#include <string.h>

#include "scene/material/kinds.h"
#include "scene/material/scatter.h"

enum { SIDE = ORL_LOBE_TABLE_SIDE, CELLS = SIDE * SIDE, FEW = 8, FINE = 4 * SIDE };

/* evenly: share sampled by the cosine alone; least: lower bound of a lobe's sampling weight, as a
 * share of its light. */
static const double evenly = 0.15, least = 0.05;

/* Factor of the function's values on one side, and the constant added to them. */
struct scale {
    struct orl_rgb times, plus;
};

static struct scale scale_of(const struct orl_material *m, const struct orl_hit *hit, bool through)
{
    const struct orl_function_lobes *const lobes = orl_function_lobes_of(m);
    const struct orl_reflector_shares *const shares = &lobes->shares;
    const double rest = 1 - shares->specular;
    if (lobes->is_whole_bsdf)
        return (struct scale){orl_gray(1), orl_gray(0)};
    if (!through)
        return (struct scale){lobes->tints_lobes
                                  ? orl_rgb_scale(orl_color_at(m, hit), shares->specular)
                                  : orl_gray(shares->specular),
                              orl_gray(0)};
    if (!(shares->transmitted > 0))
        return (struct scale){orl_gray(0), orl_gray(0)};
    const struct orl_rgb let = orl_rgb_scale(orl_color_at(m, hit), rest * shares->transmitted);
    return (struct scale){orl_rgb_scale(let, shares->transmitted_specular),
                          orl_rgb_scale(let, (1 - shares->transmitted_specular) / ORL_PI)};
}

static bool is_nothing(const struct scale *scale)
{
    return !(orl_rgb_max(scale->times) + orl_rgb_max(scale->plus) > 0);
}

struct orl_rgb orl_function_lobes_diffuse(const struct orl_material *material,
                                          const struct orl_hit *hit)
{
    const struct orl_reflector_shares *const shares = &orl_function_lobes_of(material)->shares;
    return orl_rgb_scale(orl_color_at(material, hit),
                         (1 - shares->specular) * (1 - shares->transmitted));
}

bool orl_function_lobes_transmits(const struct orl_material *material)
{
    const struct orl_function_lobes *const lobes = orl_function_lobes_of(material);
    if (lobes->is_whole_bsdf)
        return !orl_lobe_functions_of(lobes->functions)->opaque;
    return lobes->shares.transmitted > 0 && lobes->shares.specular < 1 &&
           orl_rgb_max(material->color) > 0;
}

bool orl_function_lobes_has_lobes(const struct orl_material *material)
{
    return orl_function_lobes_of(material)->shares.specular > 0 ||
           orl_function_lobes_transmits(material);
}

/* ---- Values -----------------------------------------------------------------------------------
 */

static void values_of(const struct orl_material *m, const struct orl_hit *hit,
                      const struct scale *scale, const struct orl_lobe_pair *pairs, size_t n,
                      struct orl_rgb *ret_f)
{
    if (orl_rgb_max(scale->times) > 0)
        orl_function_brdf_eval(orl_function_lobes_of(m)->functions, hit, orl_color_at(m, hit),
                               pairs, n, ret_f);
    for (size_t i = 0; i < n; i++)
        ret_f[i] = orl_rgb_max(scale->times) > 0
                       ? orl_rgb_add(orl_rgb_mul(scale->times, ret_f[i]), scale->plus)
                       : scale->plus;
}

struct orl_rgb orl_function_lobes_eval(const struct orl_material *material,
                                       const struct orl_hit *hit, struct orl_vec3 light,
                                       struct orl_vec3 eye)
{
    const double cosines = orl_dot(light, hit->normal) * orl_dot(eye, hit->normal);
    struct orl_rgb f = orl_gray(0);
    if (cosines == 0)
        return f;
    const struct scale scale = scale_of(material, hit, cosines < 0);
    const struct orl_lobe_pair pair = {light, eye};
    values_of(material, hit, &scale, &pair, 1, &f);
    return f;
}

/* ---- Tables -----------------------------------------------------------------------------------
 */

/* Luminances of the cells of one side, seen from one direction, and their integrals. */
struct table {
    struct orl_vec3 axis;
    int side; /* number of cells per axis */
    double value[CELLS];
    double mean;           /* mean of the values */
    struct orl_rgb albedo; /* by midpoint rule over the cells */
    double share;          /* sampling weight of this side; 0: nothing is scattered there */
};

/* Evaluates the function at the centres of side x side cells about an axis. */
static void look_around(const struct orl_material *m, const struct orl_hit *hit,
                        struct orl_vec3 from, enum orl_transport transport, struct orl_vec3 axis,
                        int side, struct orl_rgb *ret_values)
{
    const struct orl_frame frame = orl_frame_about(axis);
    const struct orl_pattern *const functions = orl_function_lobes_of(m)->functions;
    const struct orl_rgb color = orl_color_at(m, hit);
    for (int first = 0; first < side * side; first += ORL_LOBE_PAIRS_MAX) {
        struct orl_lobe_pair pairs[ORL_LOBE_PAIRS_MAX];
        for (int i = 0; i < ORL_LOBE_PAIRS_MAX; i++) {
            const int row = (first + i) / side, column = (first + i) % side;
            const struct orl_vec3 d = orl_to_world(
                &frame, orl_hemisphere_point((column + 0.5) / side, (row + 0.5) / side));
            pairs[i] = transport == ORL_TRANSPORT_EYE ? (struct orl_lobe_pair){d, from}
                                                      : (struct orl_lobe_pair){from, d};
        }
        orl_function_brdf_eval(functions, hit, color, pairs, ORL_LOBE_PAIRS_MAX,
                               ret_values + first);
    }
}

/* Returns the cell that holds a direction above the axis. */
static int cell_of(const struct orl_frame *frame, struct orl_vec3 direction, int side)
{
    const struct orl_vec3 local = orl_to_local(frame, direction);
    const struct orl_square s = orl_disk_to_square(local.x, local.y);
    const int column = (int)orl_smaller(orl_larger((0.5 * s.x + 0.5) * side, 0), side - 1);
    const int row = (int)orl_smaller(orl_larger((0.5 * s.y + 0.5) * side, 0), side - 1);
    return row * side + column;
}

/* Returns the precomputed cells for the direction of a query, or NULL. */
static const float *find_lobe_table(const struct orl_bsdf_query *query, bool through)
{
    const struct orl_pattern_lobes *const lobes =
        orl_lobe_functions_of(orl_function_lobes_of(query->material)->functions);
    const struct orl_vec3 normal = query->hit->normal;
    for (uint32_t i = 0; i < lobes->n_tables; i++) {
        if (!(orl_dot(lobes->tables[i].normal, normal) > 1 - 1e-12))
            continue;
        const bool front = orl_dot(query->from, normal) >= 0;
        const struct orl_frame frame = orl_frame_about(front ? normal : orl_neg(normal));
        return lobes->tables[i].values + orl_lobe_table_offset(query->transport, front,
                                                               cell_of(&frame, query->from, SIDE),
                                                               through);
    }
    return NULL;
}

static void tabulate(const struct orl_bsdf_query *query, bool through, struct table *t)
{
    const struct scale scale = scale_of(query->material, query->hit, through);
    const struct orl_vec3 normal = query->hit->normal;
    const bool front = orl_dot(query->from, normal) >= 0;
    t->share = t->mean = 0;
    t->albedo = orl_gray(0);
    if (is_nothing(&scale))
        return;
    const float *const lobe_table = find_lobe_table(query, through);
    struct orl_rgb values[CELLS] = {{0}};
    t->axis = front != through ? normal : orl_neg(normal);
    t->side = lobe_table ? SIDE : FEW;
    const int n = t->side * t->side;
    if (!lobe_table)
        look_around(query->material, query->hit, query->from, query->transport, t->axis, t->side,
                    values);
    for (int i = 0; i < n; i++) {
        const struct orl_rgb f = orl_rgb_add(
            orl_rgb_mul(scale.times, lobe_table ? orl_gray((double)lobe_table[i]) : values[i]),
            scale.plus);
        t->value[i] = orl_luma(f);
        t->mean += t->value[i] / n;
        t->albedo = orl_rgb_add(t->albedo, orl_rgb_scale(f, ORL_PI / n));
    }
    t->share = orl_larger(ORL_PI * t->mean,
                          least * (orl_luma(scale.times) + ORL_PI * orl_luma(scale.plus)));
}

/* Density on the unit square, relative to uniform. */
static double density_of(const struct table *t, int cell)
{
    return t->mean > 0 ? evenly + (1 - evenly) * t->value[cell] / t->mean : 1;
}

static double density_towards(const struct table *t, struct orl_vec3 towards)
{
    const struct orl_frame frame = orl_frame_about(t->axis);
    return density_of(t, cell_of(&frame, towards, t->side));
}

/* Chooses one of n cells by their densities; u is rescaled to [0,1) for reuse. */
static int pick_cell(const double *densities, int n, double *u)
{
    double sum = 0, left;
    int i = 0;
    for (int k = 0; k < n; k++)
        sum += densities[k];
    left = *u * sum;
    for (; i + 1 < n && left >= densities[i]; i++)
        left -= densities[i];
    *u = orl_smaller(left / densities[i], 1 - 0x1p-53);
    return i;
}

static struct orl_vec3 draw_from(const struct table *t, const double u[2])
{
    const struct orl_frame frame = orl_frame_about(t->axis);
    /* Written so that the compiler sees that the arrays are filled. */
    const int side = t->side == SIDE ? SIDE : FEW;
    double rows[SIDE] = {1}, cells[SIDE] = {1}, x = u[0], y = u[1];
    for (int row = 0; row < side; row++) {
        rows[row] = 0;
        for (int column = 0; column < side; column++)
            rows[row] += density_of(t, row * side + column);
    }
    const int row = pick_cell(rows, side, &y);
    for (int column = 0; column < side; column++)
        cells[column] = density_of(t, row * side + column);
    const int column = pick_cell(cells, side, &x);
    return orl_to_world(&frame, orl_hemisphere_point((column + x) / side, (row + y) / side));
}

/* ---- Sampling -------------------------------------------------------------------------------- */

struct parts {
    struct table sides[2]; /* reflected, transmitted */
    struct orl_rgb diffuse;
    double diffuse_share, sum;
};

static void divide_light(const struct orl_bsdf_query *query, struct parts *p)
{
    memset(p, 0, sizeof *p);
    p->diffuse = query->lobes & ORL_LOBE_DIFFUSE
                     ? orl_function_lobes_diffuse(query->material, query->hit)
                     : orl_gray(0);
    p->diffuse_share = orl_luma(p->diffuse);
    if (query->lobes & ORL_LOBE_REFLECTED)
        tabulate(query, false, &p->sides[0]);
    if (query->lobes & ORL_LOBE_TRANSMITTED)
        tabulate(query, true, &p->sides[1]);
    p->sum = p->diffuse_share + p->sides[0].share + p->sides[1].share;
}

struct orl_rgb orl_function_lobes_albedo(const struct orl_material *material,
                                         const struct orl_hit *hit, struct orl_vec3 light,
                                         enum orl_lobes lobes)
{
    const struct orl_bsdf_query query = {material, hit, light, ORL_TRANSPORT_LIGHT, lobes};
    if (!orl_hit_is_surface_mean(hit)) {
        struct parts p;
        divide_light(&query, &p);
        struct orl_rgb sum = p.diffuse;
        for (int i = 0; i < 2; i++)
            if (p.sides[i].share > 0)
                sum = orl_rgb_add(sum, p.sides[i].albedo);
        return sum;
    }
    const double *const integrals =
        orl_lobe_functions_of(orl_function_lobes_of(material)->functions)->integrals;
    struct orl_rgb sum =
        lobes & ORL_LOBE_DIFFUSE ? orl_function_lobes_diffuse(material, hit) : orl_gray(0);
    for (int i = 0; i < 2; i++) {
        const struct scale scale = scale_of(material, hit, i == 1);
        if (lobes & (i == 0 ? ORL_LOBE_REFLECTED : ORL_LOBE_TRANSMITTED))
            sum = orl_rgb_add(sum, orl_rgb_add(orl_rgb_scale(scale.times, integrals[i]),
                                               orl_rgb_scale(scale.plus, ORL_PI)));
    }
    return sum;
}

struct orl_surface_sample orl_function_lobes_sample(const struct orl_bsdf_query *query,
                                                    const double u[3])
{
    const struct orl_vec3 normal = query->hit->normal;
    struct orl_surface_sample s = {.event = ORL_EVENT_ABSORBED};
    struct parts p;
    divide_light(query, &p);
    if (!(p.sum > 0))
        return s;
    const double chosen = u[2] * p.sum;
    if (chosen < p.diffuse_share) {
        s.event = ORL_EVENT_DIFFUSE;
        s.direction = orl_hemisphere_about(
            orl_dot(query->from, normal) >= 0 ? normal : orl_neg(normal), u[0], u[1]);
        s.weight = orl_rgb_scale(p.diffuse, p.sum / p.diffuse_share);
        return s;
    }
    const bool through = p.sides[1].share > 0 &&
                         (!(p.sides[0].share > 0) || chosen >= p.diffuse_share + p.sides[0].share);
    const struct table *const t = &p.sides[through];
    s.direction = draw_from(t, u);
    s.transmitted = through;
    const struct orl_rgb f =
        query->transport == ORL_TRANSPORT_EYE
            ? orl_function_lobes_eval(query->material, query->hit, s.direction, query->from)
            : orl_function_lobes_eval(query->material, query->hit, query->from, s.direction);
    s.weight = orl_rgb_scale(f, ORL_PI / density_towards(t, s.direction) * p.sum / t->share);
    if (orl_rgb_max(s.weight) > 0)
        s.event = ORL_EVENT_GLOSSY;
    return s;
}

double orl_function_lobes_pdf(const struct orl_bsdf_query *query, struct orl_vec3 towards)
{
    const double cosine = orl_dot(towards, query->hit->normal);
    const bool through = cosine * orl_dot(query->from, query->hit->normal) < 0;
    struct parts p;
    divide_light(query, &p);
    if (!(p.sum > 0))
        return 0;
    double sum = through ? 0 : p.diffuse_share;
    if (p.sides[through].share > 0)
        sum += p.sides[through].share * density_towards(&p.sides[through], towards);
    return sum / p.sum * fabs(cosine) / ORL_PI;
}

/* ---- Tests before rendering ------------------------------------------------------------------ */

/* Integral of the function alone over one side, by midpoints of side x side cells. */
static double integral(const struct orl_material *m, const struct orl_hit *hit,
                       struct orl_vec3 light, bool through, int side)
{
    struct orl_rgb values[FINE * FINE];
    const bool front = orl_dot(light, hit->normal) >= 0;
    double sum = 0;
    look_around(m, hit, light, ORL_TRANSPORT_LIGHT,
                front != through ? hit->normal : orl_neg(hit->normal), side, values);
    for (int i = 0; i < side * side; i++)
        sum += orl_rgb_max(values[i]);
    return sum * ORL_PI / (side * side);
}

void orl_lobe_table_fill(const struct orl_material *material, const struct orl_hit *hit, float *ret)
{
    struct orl_rgb values[CELLS] = {{0, 0, 0}};
    for (int k = 0; k < 2 * 2 * CELLS; k++) {
        const enum orl_transport transport =
            k < 2 * CELLS ? ORL_TRANSPORT_LIGHT : ORL_TRANSPORT_EYE;
        const bool front = k / CELLS % 2 == 1;
        const int cell = k % CELLS, row = cell / SIDE, column = cell % SIDE;
        const struct orl_vec3 axis = front ? hit->normal : orl_neg(hit->normal);
        const struct orl_frame frame = orl_frame_about(axis);
        const struct orl_vec3 from =
            orl_to_world(&frame, orl_hemisphere_point((column + 0.5) / SIDE, (row + 0.5) / SIDE));
        for (int through = 0; through < (orl_function_lobes_transmits(material) ? 2 : 1);
             through++) {
            float *const at = ret + orl_lobe_table_offset(transport, front, cell, through);
            look_around(material, hit, from, transport, through ? orl_neg(axis) : axis, SIDE,
                        values);
            for (int i = 0; i < CELLS; i++)
                at[i] = (float)orl_luma(values[i]);
        }
    }
}

void orl_function_lobes_measure(const struct orl_material *material, const struct orl_hit *hit,
                                struct orl_vec3 light, double rest,
                                struct orl_lobe_statistics *statistics)
{
    const double cosine = fabs(orl_dot(light, hit->normal));
    double all = rest + orl_rgb_max(orl_function_lobes_diffuse(material, hit));
    for (int way = 0; way < 2; way++) {
        const struct scale scale = scale_of(material, hit, way == 1);
        all += ORL_PI * orl_rgb_max(scale.plus);
        if (!(orl_rgb_max(scale.times) > 0))
            continue;
        const double fine = integral(material, hit, light, way == 1, FINE);
        const double coarse = integral(material, hit, light, way == 1, SIDE);
        statistics->integrals[way] += fine;
        statistics->coarse_error += fabs(fine - coarse) * orl_rgb_max(scale.times);
        statistics->all += fine * orl_rgb_max(scale.times);
        all += fine * orl_rgb_max(scale.times);
    }
    if (all > statistics->maximum) {
        statistics->maximum = all;
        statistics->cosine = cosine;
    }
    if (cosine > 0.4)
        statistics->max_steep = fmax(statistics->max_steep, all);
    statistics->n_directions++;
}

/* Returns the first lobes among a material's components that are too narrow for the sampling
 * tables, or NULL. */
static const struct orl_pattern *narrow_lobes_of(const struct orl_material *material)
{
    const struct orl_material *const mixed = orl_material_mixed(material);
    const struct orl_pattern *found = NULL;
    if (material->kind == ORL_MATERIAL_FUNCTION_LOBES &&
        orl_lobe_functions_of(orl_function_lobes_of(material)->functions)->narrow)
        return orl_function_lobes_of(material)->functions;
    for (int i = 0; mixed && i < 2 && !found; i++)
        found = narrow_lobes_of(&mixed[i]);
    return found;
}

const struct orl_pattern *orl_find_narrow_lobes(const struct orl_geometry *geometry,
                                                const struct orl_material *materials)
{
    const struct orl_pattern *found = NULL;
    for (size_t i = 0; i < geometry->n_facets && !found; i++)
        found = narrow_lobes_of(&materials[orl_facet_material(geometry, i)]);
    return found;
}

bool orl_function_lobes_any_transmits(const struct orl_material *material)
{
    if (material->kind == ORL_MATERIAL_MIXTURE)
        return orl_mixture_any(material, orl_function_lobes_any_transmits);
    return material->kind == ORL_MATERIAL_FUNCTION_LOBES && orl_function_lobes_transmits(material);
}
