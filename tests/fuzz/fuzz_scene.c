/*
 * Radiance scene text, commands included. A byte 0x1c (file separator) splits the input: what comes
 * before is main.rad, what comes after is part.rad, which main.rad may read by !xform, as scene
 * text or as an argument file; panel.xml, a BSDF, is always at hand. What parses is checked against
 * description.h and made into geometry, as an upload would be.
 */
#include <stdlib.h>
#include <string.h>

#include "fuzz/fuzz.h"
#include "scene/geometry.h"
#include "scene/parse.h"
#include "scene/quadric.h"

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

static void check_material(const struct orl_description *d, const struct orl_material *m)
{
    FUZZ_PROMISE(m->kind >= ORL_MATERIAL_VOID && m->kind <= ORL_MATERIAL_GLOW);
    FUZZ_PROMISE(m->name != NULL);
    check_color(m->color);
    check_color(m->transmissivity);
    check_color(m->front);
    check_color(m->back);
    check_color(m->transmitted);
    fuzz_check_finite(m->up);
    FUZZ_PROMISE(isfinite(m->specular) && isfinite(m->roughness) && isfinite(m->ior));
    FUZZ_PROMISE(isfinite(m->max_radius) && isfinite(m->thickness));
    FUZZ_PROMISE((m->kind == ORL_MATERIAL_BSDF) == (m->bsdf != NULL));
    FUZZ_PROMISE(m->sky >= -1 && (m->sky < 0 || (size_t)m->sky < d->n_skies));
}

static void check_round(const struct orl_surface *s)
{
    for (int k = 0; k < 2; k++) {
        fuzz_check_finite(s->center[k]);
        FUZZ_PROMISE(isfinite(s->radius[k]) && s->radius[k] >= 0);
    }
    if (s->kind == ORL_SURFACE_RING) {
        fuzz_check_unit(s->normal);
        FUZZ_PROMISE(s->radius[0] < s->radius[1]);
    } else {
        FUZZ_PROMISE(s->radius[0] > 0 || s->radius[1] > 0);
    }
}

static void check_surface(const struct orl_description *d, const struct orl_surface *s)
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

static void check_description(const struct orl_description *d)
{
    for (size_t i = 0; i < d->n_materials; i++)
        check_material(d, &d->materials[i]);
    for (size_t i = 0; i < d->n_surfaces; i++)
        check_surface(d, &d->surfaces[i]);
    for (size_t i = 0; i < d->n_distants; i++) {
        const struct orl_distant *distant = &d->distants[i];
        FUZZ_PROMISE(distant->material < d->n_materials && distant->name != NULL);
        fuzz_check_unit(distant->direction);
        FUZZ_PROMISE(distant->angle_deg > 0 && distant->angle_deg <= 360);
    }
    for (size_t i = 0; i < d->n_skies; i++)
        for (int k = 0; k < d->skies[i].n_args; k++)
            FUZZ_PROMISE(isfinite(d->skies[i].a[k]));
    FUZZ_PROMISE(d->n_main >= 1 && d->n_main <= d->n_files);
}

/* Geometry may be refused (RANGE), but what is built has sound facets and can be shot at. */
static void check_geometry(const struct orl_description *d)
{
    struct orl_geometry *g = NULL;
    struct orl_error err = {0};
    struct orl_hit hit;
    const int code = orl_geometry_new(d, &g, &err);
    if (code < 0) {
        fuzz_check_error(code, &err);
        return;
    }
    FUZZ_PROMISE(g->n_facets == d->n_surfaces);
    fuzz_check_finite(g->low);
    fuzz_check_finite(g->high);
    for (size_t i = 0; i < g->n_facets; i++) {
        const struct orl_facet *f = &g->facets[i];
        FUZZ_PROMISE(isfinite(f->area) && f->area >= 0 && isfinite(f->offset));
        FUZZ_PROMISE((size_t)f->first_triangle + f->n_triangles <= g->n_triangles);
    }
    if (orl_geometry_intersect(g, orl_v3(0.1, 0.2, 0.3), orl_v3(0.6, 0, 0.8), 1e6, &hit))
        FUZZ_PROMISE(hit.facet < g->n_facets);
    orl_geometry_free(g);
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
    struct orl_description description = {0};
    struct orl_error err = {0};
    const int code = orl_scene_parse(names, 1, &files, &description, &err);
    if (code < 0) {
        fuzz_check_error(code, &err);
        FUZZ_PROMISE(err.file[0] != '\0');
        return false;
    }
    check_description(&description);
    check_geometry(&description);
    orl_description_done(&description);
    return true;
}
