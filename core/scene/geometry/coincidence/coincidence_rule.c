#include "scene/geometry/coincidence/coincident.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* ---- Order ----------------------------------------------------------------------------------- */

int orl_coincidence_class(const struct orl_material *m)
{
    switch (m->kind) {
    case ORL_MATERIAL_TRANS:
    case ORL_MATERIAL_GLASS:
    case ORL_MATERIAL_GLAZING:
    case ORL_MATERIAL_DIELECTRIC:
    case ORL_MATERIAL_PRISM:
        return 1;
    case ORL_MATERIAL_FUNCTION_LOBES:
        return orl_function_lobes_of(m)->shares.transmitted > 0 ? 1 : 2;
    case ORL_MATERIAL_MIXTURE:
        return orl_coincidence_class(&orl_mixture_of(m)->mixed[0]) < 2 ||
                       orl_coincidence_class(&orl_mixture_of(m)->mixed[1]) < 2
                   ? 1
                   : 2;
    case ORL_MATERIAL_BSDF:
        return orl_bsdf_surface_of(m)->peak ? 1 : 2;
    default:
        return 2;
    }
}

int orl_coincidence_compare(const struct orl_parsed_scene *d, const struct orl_surface *a,
                            const struct orl_surface *b)
{
    const int class_a = orl_coincidence_class(&d->materials[a->material]);
    const int class_b = orl_coincidence_class(&d->materials[b->material]);
    if (class_a != class_b)
        return class_a - class_b;
    if (orl_dot(a->normal, b->normal) < 0)
        return 0;
    if (a->modifier_order != b->modifier_order)
        return a->modifier_order > b->modifier_order ? 1 : -1;
    return a > b ? 1 : -1;
}

bool orl_material_is_two_sided(const struct orl_material *m)
{
    if (m->kind == ORL_MATERIAL_MIXTURE)
        return orl_material_is_two_sided(&orl_mixture_of(m)->mixed[0]) &&
               orl_material_is_two_sided(&orl_mixture_of(m)->mixed[1]);
    return m->kind == ORL_MATERIAL_PLASTIC || m->kind == ORL_MATERIAL_METAL ||
           m->kind == ORL_MATERIAL_TRANS || m->kind == ORL_MATERIAL_GLASS ||
           m->kind == ORL_MATERIAL_ASHIKHMIN || m->kind == ORL_MATERIAL_FUNCTION_LOBES;
}

bool orl_surfaces_alike(const struct orl_parsed_scene *d, const struct orl_surface *a,
                        const struct orl_surface *b)
{
    return orl_material_same(&d->materials[a->material], &d->materials[b->material]);
}

bool orl_surface_is_proxy(const struct orl_parsed_scene *d, const struct orl_surface *s)
{
    return orl_material_thickness(&d->materials[s->material]) != 0;
}

bool orl_surface_is_hole(const struct orl_parsed_scene *d, const struct orl_surface *s)
{
    return d->materials[s->material].kind == ORL_MATERIAL_ANTIMATTER;
}

/* Number of warnings that name pairs. Every box on a floor makes an opposed pair, and surfaces of
 * one material are harmless: these kinds share one line. */
static const uint64_t most_named[ORL_COINCIDENCES] = {3, 0, 3, 0, 3};
/* Distance behind a surface at which Radiance starts a ray, in the file's unit (FTINY). */
static const double behind = 1e-6;

static const char *kind_name(const struct orl_surface *s)
{
    static const char *const names[] = {
        [ORL_SURFACE_POLYGON] = "polygon", [ORL_SURFACE_SPHERE] = "sphere",
        [ORL_SURFACE_BUBBLE] = "bubble",   [ORL_SURFACE_CYLINDER] = "cylinder",
        [ORL_SURFACE_TUBE] = "tube",       [ORL_SURFACE_CONE] = "cone",
        [ORL_SURFACE_CUP] = "cup",         [ORL_SURFACE_RING] = "ring"};
    return names[s->kind];
}

static void copy_name(const struct orl_surface *s, char ret_name[200])
{
    snprintf(ret_name, 200, "%s %.60s at %.100s:%d", kind_name(s), s->name, s->file, s->line);
}

static bool is_pane(const struct orl_material *m)
{
    return orl_coincidence_class(m) == 1 ||
           (m->kind == ORL_MATERIAL_BSDF && orl_material_thickness(m) == 0);
}

static double distance_between(const struct orl_surface *a, const struct orl_surface *b)
{
    return fabs(orl_dot(orl_sub(a->vertices[0], b->vertices[0]), b->normal));
}

bool orl_coincidence_is_double_pane(const struct orl_parsed_scene *parsed_scene,
                                    const struct orl_surface *first,
                                    const struct orl_surface *second)
{
    return first->kind == ORL_SURFACE_POLYGON && second->kind == ORL_SURFACE_POLYGON &&
           first->n_vertices > 0 && second->n_vertices > 0 &&
           is_pane(&parsed_scene->materials[first->material]) &&
           is_pane(&parsed_scene->materials[second->material]) &&
           distance_between(first, second) > behind;
}

void orl_coincidence_warn(struct orl_coincidence_warnings *warnings,
                          struct orl_parsed_scene *parsed_scene, enum orl_coincidence kind,
                          const struct orl_surface *first, const struct orl_surface *second,
                          bool wholly)
{
    char names[2][200];
    if (orl_coincidence_is_double_pane(parsed_scene, first, second))
        kind = ORL_COINCIDENCE_PANES;
    const uint64_t before = warnings->counts[kind]++;
    if (before >= most_named[kind] && (kind != ORL_COINCIDENCE_OPPOSED || before > 0))
        return;
    copy_name(first, names[0]);
    copy_name(second, names[1]);
    if (kind == ORL_COINCIDENCE_OPPOSED && before == 0)
        memcpy(warnings->opposed, names, sizeof names);
    if (before >= most_named[kind])
        return;
    if (kind == ORL_COINCIDENCE_PANES)
        orl_parsed_scene_warn(
            parsed_scene,
            "%s and %s are panes only %.2g apart, which count as one in a scene of this size: "
            "light passes through only one; if both are intended, move them at least %.1g apart",
            names[0], names[1], distance_between(first, second), 2 * warnings->tolerance);
    else if (kind == ORL_COINCIDENCE_RESOLVED)
        orl_parsed_scene_warn(parsed_scene,
                              "%s coincides %swith %s: light hits %.60s there, as in Radiance",
                              names[0], wholly ? "entirely " : "", names[1], second->name);
    else
        orl_parsed_scene_warn(
            parsed_scene,
            "%s and %s coincide: light may hit either, unlike in Radiance; remove one, or move it "
            "away from the other",
            names[0], names[1]);
}

static void warn_of_opposed(const struct orl_coincidence_warnings *warnings,
                            struct orl_parsed_scene *parsed_scene)
{
    const uint64_t n = warnings->counts[ORL_COINCIDENCE_OPPOSED];
    char more[64] = "";
    if (n > 1)
        snprintf(more, sizeof more, " (and %llu more pair%s)", (unsigned long long)n - 1,
                 n == 2 ? "" : "s");
    if (n > 0)
        orl_parsed_scene_warn(
            parsed_scene,
            "%s and %s coincide and face opposite ways%s: light hits each from its front, as in "
            "Radiance; if one is wrongly hidden, reverse it or move it away from the other",
            warnings->opposed[0], warnings->opposed[1], more);
}

void orl_coincidence_warn_totals(struct orl_coincidence_warnings *warnings,
                                 struct orl_parsed_scene *parsed_scene)
{
    static const char *const texts[ORL_COINCIDENCES] = {
        "coincident polygons, where light hits the same one as in Radiance", NULL,
        "coincident surfaces, where light may hit either",
        "coincident surfaces of the same material, where it does not matter which one light hits",
        "panes that count as one, where light passes through only one"};
    warn_of_opposed(warnings, parsed_scene);
    for (int kind = 0; kind < ORL_COINCIDENCES; kind++) {
        const uint64_t left =
            warnings->counts[kind] -
            (warnings->counts[kind] < most_named[kind] ? warnings->counts[kind] : most_named[kind]);
        if (left > 0 && texts[kind])
            orl_parsed_scene_warn(parsed_scene, "%s: %llu %spair%s", texts[kind],
                                  (unsigned long long)left, most_named[kind] > 0 ? "more " : "",
                                  left == 1 ? "" : "s");
    }
}
