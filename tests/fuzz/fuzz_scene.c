/*
 * Radiance scene text, commands included. A byte 0x1c (file separator) splits the input: the first
 * part is main.rad, the second part.rad, which main.rad may read by !xform, as scene text or as an
 * argument file. A BSDF, panel.xml, is always available. Accepted text is checked against
 * parsed_scene.h and built into a world, as an upload is (core/light/lit_scene.h).
 */
#include <stdlib.h>
#include <string.h>

#include "fuzz/fuzz.h"
#include "light/lit_scene.h"
#include "scene/parse/parse.h"

static const char panel[] =
    "<?xml version=\"1.0\"?><WindowElement><FileType>BSDF</FileType><Optical><Layer>"
    "<Material><Name>panel</Name></Material><DataDefinition><IncidentDataStructure>TensorTree4"
    "</IncidentDataStructure></DataDefinition><WavelengthData><Wavelength unit=\"Integral\">Visible"
    "</Wavelength><WavelengthDataBlock><WavelengthDataDirection>Transmission Front"
    "</WavelengthDataDirection><AngleBasis>LBNL/Shirley-Chiu</AngleBasis><ScatteringData>{0.2}"
    "</ScatteringData></WavelengthDataBlock></WavelengthData></Layer></Optical></WindowElement>";

enum { SEPARATOR = 0x1c };

static void check_color(struct orl_rgb c)
{
    FUZZ_PROMISE(orl_rgb_is_finite(c));
}

/* Checks for light from many directions that weights and values are finite and not negative. */
static void check_scatter(const struct orl_material *m)
{
    static const struct orl_vec3 from[] = {{0, 0, 1}, {0.6, 0, 0.8}, {0, -0.8, -0.6}, {1, 0, 1e-9}};
    static const double u[][3] = {{0.3, 0.7, 0.1}, {0.999999, 0, 0.5}, {0, 0.25, 0.999999}};
    const struct orl_hit hit = {.distance = 2, .normal = {0, 0, 1}, .front = true};
    if (m->kind == ORL_MATERIAL_BSDF)
        return; /* the up vector may be perpendicular to this surface */
    for (size_t i = 0; i < sizeof from / sizeof *from; i++) {
        for (size_t k = 0; k < sizeof u / sizeof *u; k++) {
            const struct orl_surface_sample s = orl_material_sample_at(
                m, &hit, from[i], k & 1 ? ORL_TRANSPORT_EYE : ORL_TRANSPORT_LIGHT, ORL_LOBE_ALL,
                u[k]);
            if (s.event == ORL_EVENT_ABSORBED)
                continue;
            check_color(s.weight);
            FUZZ_PROMISE(s.weight.r >= 0 && s.weight.g >= 0 && s.weight.b >= 0);
            fuzz_check_unit(s.direction);
            check_color(orl_material_eval_lobes(m, &hit, from[i], s.direction));
        }
        check_color(orl_material_albedo(m, &hit, from[i], ORL_LOBE_ALL));
        check_color(orl_material_emission(m, &hit, from[i]));
    }
}

static bool is_share(double share)
{
    return share >= 0 && share <= 1;
}

static void check_shares(const struct orl_reflector_shares *shares)
{
    FUZZ_PROMISE(is_share(shares->specular) && is_share(shares->transmitted) &&
                 is_share(shares->transmitted_specular));
}

static void check_reflector(const struct orl_reflector *reflector)
{
    check_shares(&reflector->shares);
    FUZZ_PROMISE(is_share(reflector->roughness[0]) && is_share(reflector->roughness[1]));
    fuzz_check_finite(reflector->anisotropy_axis);
    if (reflector->roughness[0] != reflector->roughness[1])
        fuzz_check_unit(reflector->anisotropy_axis);
}

static void check_diffuse(const struct orl_diffuse_parts *diffuse)
{
    check_color(diffuse->front);
    check_color(diffuse->back);
    check_color(diffuse->through);
}

static void check_medium(const struct orl_medium *medium)
{
    const struct orl_rgb t = medium->transmissivity;
    check_color(t);
    FUZZ_PROMISE(t.r >= 0 && t.g >= 0 && t.b >= 0 && orl_rgb_max(t) <= 1);
    FUZZ_PROMISE(medium->ior >= 1 && medium->ior <= 10);
}

static void check_bsdf(const struct orl_bsdf_surface *surface)
{
    FUZZ_PROMISE(surface->bsdf != NULL && isfinite(surface->thickness));
    fuzz_check_finite(surface->up);
    check_diffuse(&surface->diffuse);
}

static void check_glass(const struct orl_glass *glass)
{
    check_color(glass->transmissivity);
    FUZZ_PROMISE(isfinite(glass->ior));
}

static void check_spotlight(const struct orl_spotlight *spot)
{
    fuzz_check_unit(spot->beam_axis);
    FUZZ_PROMISE(spot->cos_cone >= -1 && spot->cos_cone <= 1 && spot->focus >= 0 &&
                 isfinite(spot->focus));
}

static void check_illum(const struct orl_parsed_scene *d, const struct orl_illum *illum)
{
    check_glass(&illum->pane);
    FUZZ_PROMISE(illum->seen_as == ORL_SEEN_AS_NOTHING ||
                 (illum->seen_as >= 0 && (size_t)illum->seen_as < d->n_materials &&
                  d->materials[illum->seen_as].kind != ORL_MATERIAL_ILLUM));
}

/* Checks the struct of the material's kind. */
static void check_model(const struct orl_parsed_scene *d, const struct orl_material *m)
{
    if (orl_material_is_reflector(m))
        check_reflector(orl_reflector_of(m));
    if (m->kind == ORL_MATERIAL_FUNCTION_LOBES)
        check_shares(&orl_function_lobes_of(m)->shares);
    if (m->kind == ORL_MATERIAL_ASHIKHMIN)
        fuzz_check_unit(orl_ashikhmin_of(m)->anisotropy_axis);
    if (m->kind == ORL_MATERIAL_GLASS)
        check_glass(orl_glass_of(m));
    if (m->kind == ORL_MATERIAL_GLAZING)
        check_diffuse(&orl_glazing_of(m)->diffuse);
    for (int side = 0; m->kind == ORL_MATERIAL_DIELECTRIC && side < 2; side++)
        check_medium(&orl_interface_of(m)->media[side]);
    if (m->kind == ORL_MATERIAL_BSDF)
        check_bsdf(orl_bsdf_surface_of(m));
    if (m->kind == ORL_MATERIAL_GLOW)
        FUZZ_PROMISE(isfinite(orl_glow_of(m)->max_radius));
    if (m->kind == ORL_MATERIAL_SPOTLIGHT)
        check_spotlight(orl_spotlight_of(m));
    if (m->kind == ORL_MATERIAL_ILLUM)
        check_illum(d, orl_illum_of(m));
    if (m->kind == ORL_MATERIAL_ANTIMATTER)
        for (size_t i = 0; i < orl_antimatter_of(m)->n_cut; i++)
            FUZZ_PROMISE(orl_antimatter_of(m)->cut[i] < d->n_materials);
}

static void check_material(const struct orl_parsed_scene *d, const struct orl_material *m)
{
    FUZZ_PROMISE((unsigned)m->kind < ORL_MATERIAL_KINDS);
    FUZZ_PROMISE(m->name != NULL);
    check_color(m->color);
    check_model(d, m);
    FUZZ_PROMISE(m->copy_of <= d->n_materials);
    check_scatter(m);
    FUZZ_PROMISE(m->sky >= -1 && (m->sky < 0 || (size_t)m->sky < d->n_skies));
}

static void check_round(const struct orl_surface *s)
{
    for (int k = 0; k < 2; k++) {
        fuzz_check_finite(s->quadric->center[k]);
        FUZZ_PROMISE(isfinite(s->quadric->radius[k]) && s->quadric->radius[k] >= 0);
    }
    if (s->kind == ORL_SURFACE_RING) {
        fuzz_check_unit(s->normal);
        FUZZ_PROMISE(s->quadric->radius[0] < s->quadric->radius[1]);
    } else {
        FUZZ_PROMISE(s->quadric->radius[0] > 0 || s->quadric->radius[1] > 0);
    }
}

static void check_surface(const struct orl_parsed_scene *d, const struct orl_surface *s)
{
    bool known = false;
    FUZZ_PROMISE(s->material < d->n_materials && s->name != NULL && s->line > 0);
    for (size_t i = 0; i < d->n_files; i++)
        known |= s->file == d->files[i];
    FUZZ_PROMISE(known);
    if (s->kind != ORL_SURFACE_POLYGON) {
        check_round(s);
        return;
    }
    FUZZ_PROMISE(s->n_vertices >= 3);
    fuzz_check_unit(s->normal);
    for (uint32_t i = 0; i < s->n_vertices; i++)
        fuzz_check_finite(s->vertices[i]);
}

static void check_description(const struct orl_parsed_scene *d)
{
    for (size_t i = 0; i < d->n_materials; i++)
        check_material(d, &d->materials[i]);
    for (size_t i = 0; i < d->n_surfaces; i++)
        check_surface(d, &d->surfaces[i]);
    for (size_t i = 0; i < d->n_distant_sources; i++) {
        const struct orl_distant_source *distant = &d->distant_sources[i];
        FUZZ_PROMISE(distant->material < d->n_materials && distant->name != NULL);
        fuzz_check_unit(distant->direction);
        FUZZ_PROMISE(distant->angle_deg > 0 && distant->angle_deg <= 360);
    }
    for (size_t i = 0; i < d->n_skies; i++)
        for (int k = 0; k < d->skies[i].n_args; k++)
            FUZZ_PROMISE(isfinite(d->skies[i].a[k]));
    FUZZ_PROMISE(d->source.n_main >= 1 && d->source.n_main <= d->n_files);
}

/* Checks that facets are sound and can be intersected. */
static void check_geometry(const struct orl_geometry *g)
{
    struct orl_hit hit;
    fuzz_check_finite(g->low);
    fuzz_check_finite(g->high);
    for (size_t i = 0; i < g->n_facets; i++) {
        struct orl_facet room;
        const struct orl_facet *f = orl_facet_get_own(g, i, &room);
        FUZZ_PROMISE(isfinite(f->area) && f->area >= 0 && isfinite(f->offset));
        FUZZ_PROMISE(f->n_triangles == 0 ||
                     orl_facet_triangle(f, f->n_triangles - 1) < orl_geometry_triangles_end(g));
    }
    if (orl_geometry_intersect(g, orl_v3(0.1, 0.2, 0.3), orl_v3(0.6, 0, 0.8), 1e6, &hit))
        FUZZ_PROMISE(hit.facet < g->n_facets);
}

/* Builds a lit scene from the parsed scene, as an upload does, and consumes it. The build may
 * refuse some scenes. */
static bool check_lit_scene(struct orl_parsed_scene *d)
{
    static const struct orl_vec3 directions[] = {
        {0, 0, 1}, {0, 0, -1}, {1, 0, 0}, {0, -0.96, 0.28}, {-0.6, 0.64, 0.48}};
    struct orl_scene *scene = NULL;
    struct orl_lights *lights = NULL;
    struct orl_lit_scene *lit_scene = NULL;
    struct orl_error err = {0};
    int code = orl_scene_new(d, &scene, &err);
    if (code == 0)
        code = orl_lights_new(scene, NULL, &lights, &err);
    if (code == 0)
        code = orl_lit_scene_new(lights, NULL, &lit_scene, &err);
    orl_lights_release(lights);
    if (code < 0) {
        orl_scene_release(scene);
        fuzz_check_error(code, &err);
        return false;
    }
    FUZZ_PROMISE(lit_scene->geometry->n_facets == scene->parsed_scene.n_surfaces);
    orl_scene_release(scene);
    check_geometry(lit_scene->geometry);
    for (size_t i = 0; i < sizeof directions / sizeof *directions; i++) {
        const struct orl_rgb dome = orl_lit_scene_dome_radiance(lit_scene, directions[i]);
        check_color(dome);
        FUZZ_PROMISE(dome.r >= 0 && dome.g >= 0 && dome.b >= 0);
        check_color(orl_lit_scene_sun_radiance(lit_scene, directions[i]));
    }
    for (size_t i = 0; i < lit_scene->n_suns; i++)
        check_color(lit_scene->suns[i].irradiance);
    orl_lit_scene_free(lit_scene);
    return true;
}

bool fuzz_scene(const uint8_t *data, size_t size)
{
    static const char *const names[] = {"main.rad", "part.rad", "panel.xml"};
    const uint8_t *cut = size ? memchr(data, SEPARATOR, size) : NULL;
    const size_t head = cut ? (size_t)(cut - data) : size;
    const struct orl_file contents[] = {
        {(const char *)data, head, NULL},
        {cut ? (const char *)cut + 1 : "", cut ? size - head - 1 : 0, NULL},
        {panel, sizeof panel - 1, NULL}};
    struct orl_memory_files memory = {names, contents, 3};
    const struct orl_files files = orl_files_from_memory(&memory);
    struct orl_parsed_scene parsed_scene = {0};
    struct orl_error err = {0};
    const int code = orl_scene_parse(names, 1, &files, &parsed_scene, &err);
    if (code < 0) {
        fuzz_check_error(code, &err);
        FUZZ_PROMISE(err.file[0] != '\0');
        return false;
    }
    check_description(&parsed_scene);
    return check_lit_scene(&parsed_scene);
}
