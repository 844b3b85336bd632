#include "annual/year/annual_scene.h"

#include "scene/geometry/instances.h"
#include "scene/material/function_brdf/function_brdf_check.h"
#include "scene/material/patterns/pattern.h"
#include "scene/material/scatter.h"

/* Reflectance above which a mirror, stronger than panes, would need second reflections. */
static const double strong = 0.25;

static int refuse_surface(const struct orl_lit_scene *lit_scene, uint32_t facet,
                          struct orl_error *err, const char *what)
{
    const struct orl_surface_label label = orl_scene_label_of(lit_scene->scene, facet);
    orl_error_set(err, ORL_ERR_UNSUPPORTED, "annual jobs do not support %s yet (surface '%.100s')",
                  what, label.name);
    orl_error_at(err, label.file, label.line, NULL);
    orl_error_hint(err, "simulate it hour by hour: use a job with a list of skies");
    return ORL_ERR_UNSUPPORTED;
}

static int refuse_mist(const struct orl_lit_scene *lit_scene, struct orl_error *err)
{
    uint32_t facet = 0;
    while (!(orl_facet_area(lit_scene->scene->mist, facet) > 0))
        facet++;
    return refuse_surface(lit_scene, facet, err, "light through mist");
}

int orl_annual_check_supported(const struct orl_lit_scene *lit_scene, struct orl_error *err)
{
    int class = -1;
    if (lit_scene->scene->mist)
        return refuse_mist(lit_scene, err);
    bool has_bsdf_panes = false;
    uint32_t mirror = UINT32_MAX;
    for (struct orl_facet_iterator walk = orl_facet_iterator(lit_scene->geometry);
         orl_facet_iterator_next(&walk);) {
        const uint32_t i = walk.facet;
        struct orl_facet room;
        const struct orl_facet *facet = orl_facet_get(lit_scene->geometry, i, &room);
        const struct orl_material *m = &lit_scene->materials[facet->material];
        if (!(facet->area > 0))
            continue;
        const int32_t port = orl_lit_scene_port_of(lit_scene, i);
        if (m->kind == ORL_MATERIAL_BSDF && (lit_scene->open || port == ORL_NO_PORT))
            return refuse_surface(lit_scene, i, err,
                                  "sunlight on BSDFs that are not windows of a closed building");
        has_bsdf_panes = has_bsdf_panes || m->kind == ORL_MATERIAL_BSDF;
        if (orl_function_lobes_any_transmits(m))
            return refuse_surface(lit_scene, i, err, "transmission by functions or data");
        if (orl_material_deviates(m))
            return refuse_surface(lit_scene, i, err, "refracted sunlight");
        if (!(orl_material_max_mirrored(m, true, 0.5) > strong))
            continue;
        const int here =
            lit_scene->images.class_of ? orl_virtual_suns_class(&lit_scene->images, i) : -1;
        if (here < 0)
            return refuse_surface(lit_scene, i, err, "sunlight off curved mirrors");
        if (class >= 0 && here != class)
            return refuse_surface(lit_scene, i, err, "sunlight between mirrors in several planes");
        class = here;
        mirror = i;
    }
    /* Sunlight from a mirror onto a BSDF pane is not followed. */
    if (has_bsdf_panes && mirror != UINT32_MAX)
        return refuse_surface(lit_scene, mirror, err,
                              "sunlight off mirrors where windows are BSDFs");
    return 0;
}

size_t orl_annual_count_curved(const struct orl_lit_scene *lit_scene, uint32_t *ret_first)
{
    size_t n = 0;
    for (struct orl_facet_iterator walk = orl_facet_iterator(lit_scene->geometry);
         orl_facet_iterator_next(&walk);) {
        struct orl_facet room;
        const struct orl_facet *facet = orl_facet_get(lit_scene->geometry, walk.facet, &room);
        const bool flat = orl_surface_kind_is_flat(facet->kind);
        const bool textured = lit_scene->materials[facet->material].texture != NULL;
        if ((flat && !textured) || !orl_material_is_mirror(&lit_scene->materials[facet->material]))
            continue;
        if (n == 0)
            *ret_first = walk.facet;
        n += walk.places;
    }
    return n;
}

/* ---- Colour ---------------------------------------------------------------------------------- */

static bool is_gray(struct orl_rgb color)
{
    return color.r == color.g && color.g == color.b;
}

/* Returns true if light that the material sends on, other than diffusely, keeps its colour. */
static bool is_colourless(const struct orl_material *m)
{
    const bool patterned = m->pattern && m->pattern->coloured;
    const bool gray_sides = is_gray(m->front) && is_gray(m->back) && is_gray(m->through);
    struct orl_bsdf_info info;
    switch (m->kind) {
    case ORL_MATERIAL_BSDF:
        orl_bsdf_describe(m->bsdf, &info);
        return !info.colored && gray_sides;
    case ORL_MATERIAL_GLASS:
        return is_gray(m->transmissivity) && !patterned;
    case ORL_MATERIAL_ASHIKHMIN:
        return is_gray(m->color) && is_gray(m->gloss) && !patterned;
    case ORL_MATERIAL_GLAZING:
        return !m->angles->coloured && gray_sides;
    case ORL_MATERIAL_MIXTURE:
        return is_colourless(&m->mixed[0]) && is_colourless(&m->mixed[1]);
    case ORL_MATERIAL_FUNCTION_LOBES:
        return is_gray(m->color) && !patterned;
    case ORL_MATERIAL_TRANS:
    case ORL_MATERIAL_METAL:
    case ORL_MATERIAL_MIRROR:
        return (is_gray(m->color) && !patterned) || orl_material_is_matt(m);
    default: /* plastic's specular reflection is white */
        return true;
    }
}

bool orl_annual_is_colourless(const struct orl_lit_scene *lit_scene)
{
    for (size_t i = 0; i < lit_scene->n_materials; i++)
        if (!is_colourless(&lit_scene->materials[i]))
            return false;
    return true;
}
