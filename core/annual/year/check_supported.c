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

static bool are_gray(const struct orl_diffuse_parts *diffuse)
{
    return is_gray(diffuse->front) && is_gray(diffuse->back) && is_gray(diffuse->through);
}

static bool is_gray_bsdf(const struct orl_bsdf_surface *surface)
{
    struct orl_bsdf_info info;
    orl_bsdf_describe(surface->bsdf, &info);
    return !info.colored && are_gray(&surface->diffuse);
}

/* Returns true if the colour and its pattern are gray. */
static bool has_gray_color(const struct orl_material *m)
{
    return is_gray(m->color) && !(m->pattern && m->pattern->coloured);
}

/* Returns true if light that the material sends on, other than diffusely, keeps its colour. */
static bool is_colourless(const struct orl_material *m)
{
    switch (m->kind) {
    case ORL_MATERIAL_BSDF:
        return is_gray_bsdf(orl_bsdf_surface_of(m));
    case ORL_MATERIAL_GLASS:
        return is_gray(orl_glass_of(m)->transmissivity) && !(m->pattern && m->pattern->coloured);
    case ORL_MATERIAL_ASHIKHMIN:
        return has_gray_color(m) && is_gray(orl_ashikhmin_of(m)->gloss);
    case ORL_MATERIAL_GLAZING:
        return !orl_glazing_of(m)->angles->coloured && are_gray(&orl_glazing_of(m)->diffuse);
    case ORL_MATERIAL_MIXTURE:
        return is_colourless(&orl_mixture_of(m)->mixed[0]) &&
               is_colourless(&orl_mixture_of(m)->mixed[1]);
    case ORL_MATERIAL_FUNCTION_LOBES:
        return has_gray_color(m);
    case ORL_MATERIAL_TRANS:
    case ORL_MATERIAL_METAL:
    case ORL_MATERIAL_MIRROR:
        return has_gray_color(m) || orl_material_is_matt(m);
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
