/* Finds the classes of paths (oriel/job/paths.h) of a scene. */
#include <oriel/job/paths.h>

#include "plan/decide.h"
#include "scene/material/function_brdf/function_lobes.h"

/* Largest tolerable share of lamps' mirrored light without virtual images. */
static const double tolerable_left_out = 0.02;

static uint32_t set_if(bool present, enum orl_path_class class)
{
    return present ? 1U << class : 0;
}

/* Returns true if there are lights that only rays can hit: skies and glow sources. */
static bool has_wide_lights(const struct orl_lit_scene *lit_scene)
{
    bool wide = lit_scene->n_domes > 0;
    for (size_t i = 0; i < lit_scene->n_emitters; i++)
        wide = wide || !lit_scene->emitters[i].direct;
    return wide;
}

static uint32_t light_classes(const struct orl_lit_scene *lit_scene)
{
    bool direct = lit_scene->n_suns > 0;
    for (size_t i = 0; i < lit_scene->n_emitters; i++)
        direct = direct || lit_scene->emitters[i].direct;
    return set_if(has_wide_lights(lit_scene), ORL_PATHS_SKY) | set_if(direct, ORL_PATHS_DIRECT);
}

static uint32_t mirror_classes(const struct orl_lit_scene *lit_scene,
                               const struct orl_lit_specular *lit)
{
    const bool flat = lit->classes[ORL_LIT_FLAT].lit, wide = has_wide_lights(lit_scene);
    return set_if(flat, ORL_PATHS_FLAT_MIRRORS) |
           set_if(lit->classes[ORL_LIT_CURVED].lit, ORL_PATHS_CURVED) |
           set_if(wide && lit->classes[ORL_LIT_CURVED].facets > 0, ORL_PATHS_SKY_CURVED) |
           set_if(flat && lit_scene->n_suns > 0 && lit_scene->images.n_left_out > 0,
                  ORL_PATHS_MANY_SUN_MIRRORS) |
           set_if(lit_scene->virtual_lamps.left_out > tolerable_left_out,
                  ORL_PATHS_MANY_LAMP_MIRRORS) |
           set_if(orl_virtual_lamps_omit_pairs(&lit_scene->virtual_lamps),
                  ORL_PATHS_TWO_LAMP_MIRRORS);
}

static uint32_t lobe_classes(const struct orl_lit_scene *lit_scene,
                             const struct orl_lit_specular *lit)
{
    if (!lit->classes[ORL_LIT_LOBE].lit)
        return 0;
    return set_if(true, ORL_PATHS_LOBES) |
           set_if(orl_find_narrow_lobes(lit_scene->geometry, lit_scene->materials) != NULL,
                  ORL_PATHS_NARROW_LOBES);
}

uint32_t orl_find_path_set(const struct orl_plan_survey *survey, const struct orl_lit_specular *lit)
{
    const struct orl_lit_scene *lit_scene = survey->lit_scene;
    return light_classes(lit_scene) | mirror_classes(lit_scene, lit) |
           lobe_classes(lit_scene, lit) | set_if(survey->rho_diffuse > 0, ORL_PATHS_DIFFUSE) |
           set_if(lit_scene->scene->mist != NULL, ORL_PATHS_VOLUME);
}

uint32_t orl_path_set_without_mirrors(uint32_t set)
{
    return set & ~(1U << ORL_PATHS_FLAT_MIRRORS | 1U << ORL_PATHS_CURVED |
                   1U << ORL_PATHS_MANY_SUN_MIRRORS | 1U << ORL_PATHS_MANY_LAMP_MIRRORS |
                   1U << ORL_PATHS_TWO_LAMP_MIRRORS);
}
