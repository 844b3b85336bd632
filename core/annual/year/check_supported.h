/*
 * Check that a year of the scene can be computed. Sunlight on paths that are not followed is
 * refused with the surface's name, never left out silently.
 */
#ifndef ORL_ANNUAL_YEAR_CHECK_SUPPORTED_H
#define ORL_ANNUAL_YEAR_CHECK_SUPPORTED_H

#include "light/lit_scene.h"

/* Returns 0, or ORL_ERR_UNSUPPORTED naming a surface. */
int orl_annual_check_supported(const struct orl_lit_scene *lit_scene, struct orl_error *err);

/* Counts curved surfaces that reflect some sunlight, which is left out; *ret_first is the first
 * one. */
size_t orl_annual_count_curved(const struct orl_lit_scene *lit_scene, uint32_t *ret_first);

/* Returns true if materials colour light by diffuse scattering only. */
bool orl_annual_is_colourless(const struct orl_lit_scene *lit_scene);

#endif
