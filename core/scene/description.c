#include "scene/description.h"

#include <stdlib.h>
#include <string.h>

#include <oriel/error.h>

#include "base/arena.h"
#include "scene/material/pattern.h"
#include "scene/surface_labels.h"

static bool has_corners_of_its_own(const struct orl_surface *surfaces, size_t n)
{
    for (size_t i = 0; i < n; i++)
        if (surfaces[i].has_places || surfaces[i].has_normals)
            return true;
    return false;
}

/* Frees the surfaces and the opposed pairs. Returns true if the surfaces are kept because some have
 * mesh normals or (u, v) coordinates at their corners. */
static bool free_surfaces(struct orl_surface **surfaces, size_t n, struct orl_opposed **opposed)
{
    free(*opposed);
    *opposed = NULL;
    if (has_corners_of_its_own(*surfaces, n))
        return true;
    free(*surfaces);
    *surfaces = NULL;
    return false;
}

int orl_description_let_go(struct orl_description *description)
{
    struct orl_description *const d = description;
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
    orl_sealed_close(&d->file);
    return 0;
}

bool orl_bsdf_up_is_undefined(const struct orl_material *material,
                              const struct orl_surface *surface)
{
    static const double parallel = 1e-6; /* sine of the angle between both */
    const bool flat = orl_surface_kind_is_flat(surface->kind);
    return material->kind == ORL_MATERIAL_BSDF && flat &&
           !(orl_length(orl_cross(orl_normalize(material->up), surface->normal)) > parallel);
}

void orl_description_done(struct orl_description *description)
{
    if (!description)
        return;
    for (size_t i = 0; i < description->n_materials; i++)
        orl_bsdf_unref(description->materials[i].bsdf);
    for (size_t i = 0; i < description->n_patterns; i++)
        orl_pattern_free(description->patterns[i]);
    free(description->patterns);
    for (size_t i = 0; i < description->n_grids; i++)
        orl_grid_free(description->grids[i]);
    free(description->grids);
    free(description->materials);
    free(description->surfaces);
    free(description->opposed);
    orl_surface_labels_free(description->labels);
    for (size_t i = 0; i < description->n_prototypes; i++) {
        free(description->prototypes[i].surfaces);
        free(description->prototypes[i].opposed);
        orl_surface_labels_free(description->prototypes[i].labels);
    }
    free(description->prototypes);
    free(description->placements);
    free(description->distants);
    free(description->skies);
    free(description->files);
    free(description->warnings);
    orl_arena_free(description->arena);
    orl_arena_free(description->outlines);
    orl_sealed_close(&description->file);
    memset(description, 0, sizeof *description);
}
