/* Materials' own functions over their surfaces, before anything is rendered. */
#include "scene/material/own_settle.h"

#include <stdio.h>
#include <stdlib.h>

#include <oriel/crew.h>
#include <oriel/limits.h>

#include "function/ray_names.h"
#include "scene/material/lobed.h"
#include "scene/material/pattern.h"
#include "scene/material/prism.h"

enum { PLACES = 2, MOST_KNOWN = 2 };

/* Shares of light that rounding, and approximations at grazing, may exceed 1 by. */
static const double slack = 0.01;
/* Of a lobe: by so much few cells may be off many. */
static const double narrow = 0.05;
/* Of a prism's ways: so much may lead not back, and is left out; and what is not worth telling. */
static const double most_one_way = 0.05, least_one_way = 1e-3;

static int refuse(const struct orl_pattern *pattern, struct orl_error *err)
{
    orl_error_at(err, pattern->file, pattern->line, pattern->name);
    orl_error_hint(err, "describe it as a BSDF");
    return err->code;
}

static void warn(struct orl_description *d, const struct orl_pattern *pattern, const char *what,
                 double percent)
{
    char text[640];
    snprintf(text, sizeof text, "%.200s:%d: %.100s %.200s: %.3g %%", pattern->file, pattern->line,
             pattern->name, what, percent);
    orl_description_warn(d, text);
}

static int judge_prism(struct orl_description *d, const struct orl_material *m,
                       const struct orl_prism_findings *f, struct orl_error *err)
{
    const double one_way = f->all > 0 ? f->one_way / f->all : 0;
    if (f->most_seen > 1 + slack) {
        orl_error_set(err, ORL_ERR_RANGE, "it lets %.3g of the light through, more than all",
                      f->most_seen);
        return refuse(m->ways, err);
    }
    if (one_way > most_one_way) {
        orl_error_set(err, ORL_ERR_UNSUPPORTED,
                      "its functions lead light and eyes different ways: %.3g %% of what they send "
                      "on would not come back by the way it went",
                      100 * one_way);
        return refuse(m->ways, err);
    }
    if (one_way > least_one_way)
        warn(d, m->ways, "leads not back by the way it came, what is left out of what it sends on",
             100 * one_way);
    if (f->most_sent > 1 + slack)
        warn(d, m->ways, "makes beams wider without being dimmer, most light of what meets it",
             100 * f->most_sent);
    return 0;
}

static int judge_lobes(struct orl_description *d, const struct orl_material *m,
                       const struct orl_lobed_findings *f, struct orl_error *err)
{
    const double unlike = f->all > 0 ? f->unlike / f->all : 0;
    for (int i = 0; i < 2; i++)
        m->lobes->sent[i] = f->sent[i] / (double)f->places;
    m->lobes->narrow = unlike > narrow;
    if (f->most_steep > 1 + slack) {
        orl_error_set(err, ORL_ERR_RANGE,
                      "it returns up to %.3g of the light that meets it, more than all",
                      f->most_steep);
        return refuse(m->lobes, err);
    }
    if (f->most > 1 + slack)
        warn(d, m->lobes, "returns more than all of the light at grazing, the most", 100 * f->most);
    if (m->lobes->narrow)
        warn(d, m->lobes,
             "has lobes narrower than draws are made for: results are noisy, and no accuracy can "
             "be asked for; of its light",
             100 * unlike);
    return 0;
}

/* Tables for the first few normals of flat surfaces, where the place does not matter. */
static int know(const struct orl_geometry *g, const struct orl_material *m, uint32_t facet)
{
    const uint64_t place = (uint64_t)7 << ORL_RAY_PX | (uint64_t)3 << ORL_RAY_LU;
    struct orl_pattern *const lobes = m->lobes;
    const struct orl_facet *const f = &g->facets[facet];
    const uint64_t inputs = orl_function_inputs(lobes->function) |
                            (lobes->values ? orl_function_inputs(lobes->values) : 0);
    const bool flat = f->kind == ORL_SURFACE_POLYGON || f->kind == ORL_SURFACE_RING;
    if (!flat || inputs & place || (m->pattern && inputs >> ORL_RAY_CRP & 7) ||
        lobes->n_known == MOST_KNOWN)
        return 0;
    for (uint32_t i = 0; i < lobes->n_known; i++)
        if (orl_dot(lobes->known[i].normal, f->normal) > 1 - 1e-12)
            return 0;
    if (!lobes->known)
        lobes->known = calloc(MOST_KNOWN, sizeof *lobes->known);
    float *const values = lobes->known ? calloc(ORL_LOBED_KNOWN, sizeof *values) : NULL;
    if (!values)
        return ORL_ERR_NOMEM;
    const struct orl_hit hit = orl_hit_anywhere(f->normal, true);
    orl_lobed_know(m, &hit, values);
    lobes->known[lobes->n_known++] = (struct orl_known_lobes){f->normal, values};
    return 0;
}

/* Facets of a material that are looked at. */
struct sample {
    size_t all, met, n;
    uint32_t facets[PLACES];
};

static int look(struct orl_description *d, const struct orl_geometry *g,
                const struct orl_material *m, const struct sample *sample, struct orl_error *err)
{
    struct orl_prism_findings prism = {0};
    struct orl_lobed_findings lobed = {0};
    for (size_t i = 0; i < PLACES; i++) {
        /* One flat surface may have functions of the place, too. */
        const double u[2] = {fmod(0.5 + 0.7548776662466927 * (double)i, 1),
                             fmod(0.5 + 0.5698402909980532 * (double)i, 1)};
        struct orl_hit hit = {.facet = sample->facets[i % sample->n], .front = true};
        hit.triangle = g->facets[hit.facet].first_triangle;
        orl_facet_sample(g, hit.facet, u, &hit.point, &hit.normal);
        if (m->kind == ORL_MATERIAL_PRISM)
            orl_prism_look(m, &hit, &prism);
        else
            orl_lobed_look(m, &hit, &lobed);
    }
    int code = m->kind == ORL_MATERIAL_PRISM ? judge_prism(d, m, &prism, err)
                                             : judge_lobes(d, m, &lobed, err);
    for (size_t i = 0; i < sample->n && code == 0 && m->kind == ORL_MATERIAL_LOBED; i++)
        code = know(g, m, sample->facets[i]);
    return code;
}

static bool has_own(const struct orl_material *m)
{
    return m->kind == ORL_MATERIAL_PRISM || m->kind == ORL_MATERIAL_LOBED;
}

static void choose(const struct orl_description *d, const struct orl_geometry *g,
                   struct sample *samples)
{
    for (size_t i = 0; i < g->n_facets; i++)
        samples[g->facets[i].material].all += g->facets[i].area > 0;
    for (size_t i = 0; i < g->n_facets; i++) {
        struct sample *const s = &samples[g->facets[i].material];
        if (has_own(&d->materials[g->facets[i].material]) && g->facets[i].area > 0 &&
            s->n < PLACES && s->met++ % ((s->all + PLACES - 1) / PLACES) == 0)
            s->facets[s->n++] = (uint32_t)i;
    }
}

int orl_own_settle(struct orl_description *description, const struct orl_geometry *geometry,
                   struct orl_error *err)
{
    size_t n = 0;
    for (size_t i = 0; i < description->n_materials; i++)
        n += has_own(&description->materials[i]);
    if (n == 0)
        return 0;
    struct sample *const samples = calloc(description->n_materials, sizeof *samples);
    if (!samples)
        return ORL_ERR_NOMEM;
    choose(description, geometry, samples);
    int code = 0;
    size_t looked = 0;
    for (size_t i = 0; i < description->n_materials && code == 0; i++) {
        if (samples[i].n == 0)
            continue;
        code = looked++ < ORL_LIMIT_OWN_FUNCTIONS
                   ? look(description, geometry, &description->materials[i], &samples[i], err)
                   : orl_error_set(err, ORL_ERR_LIMIT,
                                   "more than %u materials of a scene are by functions of both "
                                   "directions",
                                   ORL_LIMIT_OWN_FUNCTIONS);
        if (code == 0 && orl_is_cancelled(description->cancel))
            code = orl_error_set(err, ORL_ERR_CANCELLED, "cancelled while reading the scene");
    }
    free(samples);
    return code;
}
