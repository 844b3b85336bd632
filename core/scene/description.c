#include "scene/description.h"

#include <stdlib.h>
#include <string.h>

#include "base/arena.h"
#include "scene/material/pattern.h"

const struct orl_curved orl_curved_none = {{{0, 0, 0}, {0, 0, 0}}, {0, 0}};

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
    for (size_t i = 0; i < description->n_prototypes; i++) {
        free(description->prototypes[i].surfaces);
        free(description->prototypes[i].opposed);
    }
    free(description->prototypes);
    free(description->placements);
    free(description->distants);
    free(description->skies);
    free(description->files);
    free(description->warnings);
    orl_arena_free(description->arena);
    memset(description, 0, sizeof *description);
}
