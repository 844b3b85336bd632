#include "scene/parsed_scene.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <oriel/base/error.h>

#include "base/memory/memory.h"
#include "scene/material/patterns/pattern.h"
#include "scene/surfaces.h"

static bool has_corners_of_its_own(const struct orl_surface *surfaces, size_t n)
{
    for (size_t i = 0; i < n; i++)
        if (surfaces[i].has_uv || surfaces[i].has_normals)
            return true;
    return false;
}

/* Frees the surfaces and the opposed pairs. Returns true if the surfaces stay because some have
 * mesh normals or (u, v) coordinates at their corners. */
static bool free_surfaces(struct orl_surface **surfaces, size_t n,
                          struct orl_opposed_pair **opposed)
{
    free(*opposed);
    *opposed = NULL;
    if (has_corners_of_its_own(*surfaces, n))
        return true;
    free(*surfaces);
    *surfaces = NULL;
    return false;
}

int orl_parsed_scene_free_surfaces(struct orl_parsed_scene *parsed_scene)
{
    struct orl_parsed_scene *const d = parsed_scene;
    d->labels = orl_surface_labels_new(d->surfaces, d->n_surfaces);
    if (!d->labels)
        return ORL_ERR_NOMEM;
    for (size_t i = 0; i < d->n_prototypes; i++) {
        struct orl_prototype *const p = &d->prototypes[i];
        p->labels = orl_surface_labels_new(p->surfaces, p->n_surfaces);
        if (!p->labels)
            return ORL_ERR_NOMEM;
    }
    bool meshed = false; /* patterns read the corners of some surfaces */
    for (size_t i = 0; i < d->n_prototypes; i++)
        meshed |= free_surfaces(&d->prototypes[i].surfaces, d->prototypes[i].n_surfaces,
                                &d->prototypes[i].opposed);
    meshed |= free_surfaces(&d->surfaces, d->n_surfaces, &d->opposed);
    if (meshed)
        return 0;
    orl_arena_free(d->outlines);
    d->outlines = NULL;
    orl_checked_file_close(&d->file);
    return 0;
}

bool orl_bsdf_up_is_undefined(const struct orl_material *material,
                              const struct orl_surface *surface)
{
    static const double parallel = 1e-6; /* sine of the angle between both */
    const bool flat = orl_surface_kind_is_flat(surface->kind);
    if (material->kind != ORL_MATERIAL_BSDF || !flat)
        return false;
    const struct orl_vec3 up = orl_normalize(orl_bsdf_surface_of(material)->up);
    return !(orl_length(orl_cross(up, surface->normal)) > parallel);
}

void orl_parsed_scene_done(struct orl_parsed_scene *parsed_scene)
{
    if (!parsed_scene)
        return;
    for (size_t i = 0; i < parsed_scene->n_materials; i++)
        orl_bsdf_unref(orl_material_bsdf(&parsed_scene->materials[i]));
    for (size_t i = 0; i < parsed_scene->n_patterns; i++)
        orl_pattern_free(parsed_scene->patterns[i]);
    free(parsed_scene->patterns);
    for (size_t i = 0; i < parsed_scene->n_grids; i++)
        orl_grid_free(parsed_scene->grids[i]);
    free(parsed_scene->grids);
    free(parsed_scene->materials);
    free(parsed_scene->surfaces);
    free(parsed_scene->opposed);
    orl_surface_labels_free(parsed_scene->labels);
    for (size_t i = 0; i < parsed_scene->n_prototypes; i++) {
        free(parsed_scene->prototypes[i].surfaces);
        free(parsed_scene->prototypes[i].opposed);
        orl_surface_labels_free(parsed_scene->prototypes[i].labels);
    }
    free(parsed_scene->prototypes);
    free(parsed_scene->placements);
    free(parsed_scene->distant_sources);
    free(parsed_scene->skies);
    free(parsed_scene->files);
    free(parsed_scene->warnings);
    orl_arena_free(parsed_scene->arena);
    orl_arena_free(parsed_scene->outlines);
    orl_checked_file_close(&parsed_scene->file);
    memset(parsed_scene, 0, sizeof *parsed_scene);
}

int orl_parsed_scene_add_material(struct orl_parsed_scene *parsed_scene,
                                  const struct orl_material *material, uint32_t *ret_index)
{
    struct orl_material *const grown =
        realloc(parsed_scene->materials, (parsed_scene->n_materials + 1) * sizeof *grown);
    if (grown)
        parsed_scene->materials = grown;
    if (!grown)
        return ORL_ERR_NOMEM;
    *ret_index = (uint32_t)parsed_scene->n_materials++;
    grown[*ret_index] = *material;
    return 0;
}

void orl_parsed_scene_warn(struct orl_parsed_scene *parsed_scene, const char *format, ...)
{
    char text[640];
    va_list args;
    va_start(args, format);
    vsnprintf(text, sizeof text, format, args);
    va_end(args);
    char *copy = orl_arena_copy_text(parsed_scene->arena, text, strlen(text));
    char **grown = realloc(parsed_scene->warnings,
                           (parsed_scene->n_warnings + 1) * sizeof *parsed_scene->warnings);
    if (grown)
        parsed_scene->warnings = grown;
    if (grown && copy)
        grown[parsed_scene->n_warnings++] = copy;
}
