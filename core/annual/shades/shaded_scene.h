/* The scene of a year with its window groups in given states: its files, and material
 * overrides. */
#ifndef ORL_ANNUAL_SHADES_SHADED_SCENE_H
#define ORL_ANNUAL_SHADES_SHADED_SCENE_H

#include <oriel/annual/annual.h>

#include "scene/material_override.h"

struct orl_shaded_scene {
    /* The year's request with other scene_files and no groups; the rest is borrowed. */
    struct orl_annual_request request;
    char **files;                        /* owned array; names are borrowed */
    struct orl_material_override *items; /* one per group */
    struct orl_material_overrides material_overrides;
};

/* Builds the scene. states: one per group. parted: light can be split by group (scene/override.h).
 * Borrows the request, and contains pointers to itself, so it must not be moved. Returns 0,
 * ORL_ERR_NOMEM or ORL_ERR_INVALID (no file is left); the caller calls orl_shaded_scene_done in
 * either case. */
int orl_shaded_scene_init(struct orl_shaded_scene *shaded_scene,
                          const struct orl_annual_request *request, const unsigned char *states,
                          bool by_window_group, struct orl_error *err);
void orl_shaded_scene_done(struct orl_shaded_scene *shaded_scene);

#endif
