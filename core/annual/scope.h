/*
 * What a scene may have for its year to be computed: sunlight that comes in ways that are not
 * followed is refused by name, never left out in silence.
 */
#ifndef ORL_ANNUAL_SCOPE_H
#define ORL_ANNUAL_SCOPE_H

#include "light/world.h"

/* 0, or ORL_ERR_UNSUPPORTED naming a surface. */
int orl_annual_admit(const struct orl_world *world, struct orl_error *err);

/* How many curved surfaces mirror some of the sun, which is left out; the first of them. */
size_t orl_annual_count_curved(const struct orl_world *world, uint32_t *ret_first);

/* Whether nothing that sends light on, but diffusely, colours it. */
bool orl_annual_is_colourless(const struct orl_world *world);

#endif
