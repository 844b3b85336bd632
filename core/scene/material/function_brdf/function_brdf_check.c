/* Tests the functions of materials over their surfaces before rendering. */
#include "scene/material/function_brdf/function_brdf_check.h"

#include <stdio.h>
#include <stdlib.h>

#include <oriel/base/limits.h>
#include <oriel/base/thread_pool.h>

#include "function/function.h"
#include "scene/material/kinds.h"
#include "scene/material/patterns/pattern.h"

enum { PLACES = 2, MOST_LOBE_TABLES = 2 };

/* Tolerance for albedos above 1, by rounding and by approximations at grazing. */
static const double slack = 0.01;
/* Largest relative error of the coarse cells before lobes count as too narrow. */
static const double narrow = 0.05;
/* Prisms: largest share of irreversible rays, which are ignored; and the share that is worth a
 * warning. */
static const double most_one_way = 0.05, least_one_way = 1e-3;

static int refuse_pattern(const struct orl_pattern *pattern, struct orl_error *err)
{
    orl_error_at(err, pattern->file, pattern->line, pattern->name);
    orl_error_hint(err, "describe it as a BSDF");
    return err->code;
}

static void warn(struct orl_parsed_scene *d, const struct orl_pattern *pattern, const char *what,
                 double percent)
{
    char text[640];
    snprintf(text, sizeof text, "%.200s:%d: %.100s %.200s: %.3g %%", pattern->file, pattern->line,
             pattern->name, what, percent);
    orl_parsed_scene_warn(d, "%s", text);
}

static int judge_prism(struct orl_parsed_scene *d, const struct orl_material *m,
                       const struct orl_prism_statistics *f, struct orl_error *err)
{
    const struct orl_pattern *const rays = orl_prism_of(m)->rays;
    const double irreversible = f->all > 0 ? f->irreversible / f->all : 0;
    if (f->max_seen > 1 + slack) {
        orl_error_set(err, ORL_ERR_RANGE,
                      "it transmits %.3g of the incident light, which is more than 1", f->max_seen);
        return refuse_pattern(rays, err);
    }
    if (irreversible > most_one_way) {
        orl_error_set(err, ORL_ERR_UNSUPPORTED,
                      "its functions are not reversible: %.3g %% of the light would not return "
                      "along the path by which it came",
                      100 * irreversible);
        return refuse_pattern(rays, err);
    }
    if (irreversible > least_one_way)
        warn(
            d, rays,
            "is not reversible; the part of its light that cannot return along its path is ignored",
            100 * irreversible);
    if (f->max_sent > 1 + slack)
        warn(d, rays,
             "widens beams without dimming them; largest ratio of outgoing to incident light",
             100 * f->max_sent);
    return 0;
}

static int judge_lobes(struct orl_parsed_scene *d, const struct orl_material *m,
                       const struct orl_lobe_statistics *f, struct orl_error *err)
{
    struct orl_pattern *const functions = orl_function_lobes_of(m)->functions;
    struct orl_pattern_lobes *const lobes = &functions->as_role.lobes;
    const double coarse_error = f->all > 0 ? f->coarse_error / f->all : 0;
    for (int i = 0; i < 2; i++)
        lobes->integrals[i] = f->integrals[i] / (double)f->n_directions;
    lobes->narrow = coarse_error > narrow;
    lobes->opaque = !(f->integrals[1] > 0);
    if (f->max_steep > 1 + slack) {
        orl_error_set(err, ORL_ERR_RANGE,
                      "it scatters up to %.3g of the incident light, which is more than 1",
                      f->max_steep);
        return refuse_pattern(functions, err);
    }
    if (f->maximum > 1 + slack)
        warn(d, functions, "scatters more light than it receives at grazing angles; maximum",
             100 * f->maximum);
    if (lobes->narrow)
        warn(d, functions,
             "has lobes too narrow to sample reliably: results are noisy, and an accuracy goal "
             "cannot be met; affected share of its light",
             100 * coarse_error);
    return 0;
}

/* Makes tables for the first few normals of flat surfaces, if the functions do not depend on the
 * place. */
static int make_tables(const struct orl_geometry *g, const struct orl_material *m, uint32_t facet)
{
    const uint64_t place = (uint64_t)7 << ORL_RAY_PX | (uint64_t)3 << ORL_RAY_LU;
    struct orl_pattern *const functions = orl_function_lobes_of(m)->functions;
    const struct orl_pattern_program *const program = &functions->program;
    struct orl_pattern_lobes *const lobes = &functions->as_role.lobes;
    struct orl_facet own;
    const struct orl_facet *const f = orl_facet_get_own(g, facet, &own);
    const uint64_t inputs = orl_function_inputs(program->function) |
                            (program->values ? orl_function_inputs(program->values) : 0);
    const bool flat = orl_surface_kind_is_flat(f->kind);
    if (!flat || inputs & place || (m->pattern && inputs >> ORL_RAY_CRP & 7) ||
        lobes->n_tables == MOST_LOBE_TABLES)
        return 0;
    for (uint32_t i = 0; i < lobes->n_tables; i++)
        if (orl_dot(lobes->tables[i].normal, f->normal) > 1 - 1e-12)
            return 0;
    if (!lobes->tables)
        lobes->tables = calloc(MOST_LOBE_TABLES, sizeof *lobes->tables);
    float *const values = lobes->tables ? calloc(ORL_LOBE_TABLE_VALUES, sizeof *values) : NULL;
    if (!values)
        return ORL_ERR_NOMEM;
    const struct orl_hit hit = orl_hit_surface_mean(f->normal, true);
    orl_lobe_table_fill(m, &hit, values);
    lobes->tables[lobes->n_tables++] = (struct orl_lobe_table){f->normal, values};
    return 0;
}

/* Facets of a material that are tested. */
struct sample {
    size_t all, met, n;
    uint32_t facets[PLACES];
};

/* Makes PLACES test hits on the sample's facets; a single flat surface gets several, because
 * functions may depend on the place. */
static void place_hits(const struct orl_geometry *g, const struct sample *sample,
                       struct orl_hit ret_hits[PLACES])
{
    for (size_t i = 0; i < PLACES; i++) {
        const double u[2] = {fmod(0.5 + 0.7548776662466927 * (double)i, 1),
                             fmod(0.5 + 0.5698402909980532 * (double)i, 1)};
        struct orl_hit hit = {.facet = sample->facets[i % sample->n], .front = true};
        struct orl_facet own;
        hit.triangle = orl_facet_get_own(g, hit.facet, &own)->first_triangle;
        orl_facet_sample(g, hit.facet, u, &hit.point, &hit.normal);
        ret_hits[i] = hit;
    }
}

static int test_prism(struct orl_parsed_scene *d, const struct orl_material *m,
                      const struct orl_hit hits[PLACES], struct orl_error *err)
{
    struct orl_prism_statistics statistics = {0};
    for (size_t i = 0; i < PLACES; i++)
        orl_prism_measure(m, &hits[i], &statistics);
    return judge_prism(d, m, &statistics, err);
}

/* Test directions on both sides. */
enum { COSINES = 4, AZIMUTHS = 2, LOOKS = 2 * COSINES * AZIMUTHS };
static struct orl_vec3 light_of(const struct orl_hit *hit, size_t look)
{
    const struct orl_frame frame = orl_frame_about(hit->normal);
    const int i = (int)look;
    const double cosine = (i % COSINES + 0.5) / COSINES, sine = sqrt(1 - cosine * cosine);
    const double phi = 2 * ORL_PI * (i / COSINES % AZIMUTHS + 0.3) / AZIMUTHS;
    return orl_to_world(&frame, orl_v3(sine * cos(phi), sine * sin(phi),
                                       i < COSINES * AZIMUTHS ? cosine : -cosine));
}

/* Returns true if the material consists of sums only, whose terms all scatter light independently.
 * */
static bool is_sum(const struct orl_material *m)
{
    const struct orl_material *const terms = orl_material_mixed(m);
    if (!terms || orl_mixture_of(m)->share)
        return false;
    for (int i = 0; i < 2; i++)
        if (terms[i].kind == ORL_MATERIAL_MIXTURE && !is_sum(&terms[i]))
            return false;
    return true;
}

/* Albedo of the other terms of a sum for light from that direction. */
static double rest_of(const struct orl_material *whole, const struct orl_material *part,
                      const struct orl_hit *hit, struct orl_vec3 light)
{
    const enum orl_lobes all = ORL_LOBE_ALL;
    if (!is_sum(whole))
        return 0;
    const struct orl_rgb sum = orl_material_albedo(whole, hit, light, all),
                         own = orl_material_albedo(part, hit, light, all);
    return fmax(0, fmax(sum.r - own.r, fmax(sum.g - own.g, sum.b - own.b)));
}

static int test_lobes(struct orl_parsed_scene *d, const struct orl_material *whole,
                      const struct orl_material *part, const struct orl_hit hits[PLACES],
                      struct orl_error *err)
{
    struct orl_lobe_statistics statistics = {0};
    for (size_t k = 0; k < (size_t)PLACES * LOOKS; k++) {
        const struct orl_hit *const hit = &hits[k / LOOKS];
        const struct orl_vec3 light = light_of(hit, k % LOOKS);
        orl_function_lobes_measure(part, hit, light, rest_of(whole, part, hit, light), &statistics);
    }
    return judge_lobes(d, part, &statistics, err);
}

/* Tests the total albedo of a sum whose terms have no functions. */
static int judge_sum(struct orl_parsed_scene *d, const struct orl_geometry *g,
                     const struct orl_material *m, const struct orl_hit hits[PLACES],
                     struct orl_error *err)
{
    double maximum = 0;
    for (size_t k = 0; k < (size_t)PLACES * LOOKS; k++) {
        const struct orl_hit *const hit = &hits[k / LOOKS];
        const struct orl_vec3 light = light_of(hit, k % LOOKS);
        maximum = fmax(maximum, orl_rgb_max(orl_material_albedo(m, hit, light, ORL_LOBE_ALL)));
    }
    if (!(maximum > 1 + slack))
        return 0;
    const struct orl_surface *const s = &d->surfaces[orl_facet_surface(g, hits[0].facet)];
    orl_error_set(
        err, ORL_ERR_RANGE,
        "its material '%.200s' scatters up to %.3g of the incident light, which is more than 1",
        m->name, maximum);
    orl_error_at(err, s->file, s->line, s->name);
    orl_error_hint(err, "reduce its parts: together they must not exceed 1");
    return ORL_ERR_RANGE;
}

static bool has_function_brdf(const struct orl_material *m)
{
    if (m->kind == ORL_MATERIAL_MIXTURE)
        return orl_mixture_any(m, has_function_brdf);
    return m->kind == ORL_MATERIAL_PRISM || m->kind == ORL_MATERIAL_FUNCTION_LOBES;
}

/* Tests a material, or a term of a sum. */
static int test_material(struct orl_parsed_scene *d, const struct orl_geometry *g,
                         const struct orl_material *whole, const struct orl_material *m,
                         const struct sample *sample, struct orl_error *err)
{
    const struct orl_material *const mixed = orl_material_mixed(m);
    struct orl_hit hits[PLACES];
    int code = 0;
    for (int i = 0; mixed && i < 2 && code == 0; i++)
        code = test_material(d, g, whole, &mixed[i], sample, err);
    const bool sum = m == whole && is_sum(m) && !has_function_brdf(m);
    if (code < 0 ||
        (m->kind != ORL_MATERIAL_PRISM && m->kind != ORL_MATERIAL_FUNCTION_LOBES && !sum))
        return code;
    place_hits(g, sample, hits);
    if (sum)
        return judge_sum(d, g, m, hits, err);
    code = m->kind == ORL_MATERIAL_PRISM ? test_prism(d, m, hits, err)
                                         : test_lobes(d, whole, m, hits, err);
    for (size_t i = 0; i < sample->n && code == 0 && m->kind == ORL_MATERIAL_FUNCTION_LOBES; i++)
        code = make_tables(g, m, sample->facets[i]);
    return code;
}

static bool needs_test(const struct orl_material *m)
{
    return has_function_brdf(m) || is_sum(m);
}

static void choose_facets(const struct orl_parsed_scene *d, const struct orl_geometry *g,
                          struct sample *samples)
{
    for (size_t i = 0; i < g->n_facets; i++)
        samples[orl_facet_material(g, i)].all += orl_facet_area(g, i) > 0;
    for (size_t i = 0; i < g->n_facets; i++) {
        struct sample *const s = &samples[orl_facet_material(g, i)];
        if (needs_test(&d->materials[orl_facet_material(g, i)]) && orl_facet_area(g, i) > 0 &&
            s->n < PLACES && s->met++ % ((s->all + PLACES - 1) / PLACES) == 0)
            s->facets[s->n++] = (uint32_t)i;
    }
}

int orl_function_brdf_check(struct orl_parsed_scene *parsed_scene,
                            const struct orl_geometry *geometry, struct orl_error *err)
{
    size_t n = 0;
    for (size_t i = 0; i < parsed_scene->n_materials; i++)
        n += needs_test(&parsed_scene->materials[i]);
    if (n == 0)
        return 0;
    struct sample *const samples = calloc(parsed_scene->n_materials, sizeof *samples);
    if (!samples)
        return ORL_ERR_NOMEM;
    choose_facets(parsed_scene, geometry, samples);
    int code = 0;
    size_t looked = 0;
    for (size_t i = 0; i < parsed_scene->n_materials && code == 0; i++) {
        if (samples[i].n == 0)
            continue;
        looked += has_function_brdf(&parsed_scene->materials[i]);
        code = looked <= ORL_LIMIT_FUNCTION_BRDFS
                   ? test_material(parsed_scene, geometry, &parsed_scene->materials[i],
                                   &parsed_scene->materials[i], &samples[i], err)
                   : orl_error_set(
                         err, ORL_ERR_LIMIT,
                         "the scene has more than %u materials with functions of both directions",
                         ORL_LIMIT_FUNCTION_BRDFS);
        if (code == 0 && orl_is_cancelled(parsed_scene->cancel))
            code = orl_error_set(err, ORL_ERR_CANCELLED, "cancelled while reading the scene");
    }
    free(samples);
    return code;
}
