/*
 * Material properties over a whole surface, for plans, surveys and light set-up before any ray is
 * traced.
 * `_most` is a bound that holds at every point, in the brightest channel, 0..1; `_mean` is the mean
 * by area. The functions of scatter.h at orl_hit_surface_mean give other means. Light arrives at
 * the given cosine and an arbitrary azimuth; for BSDFs a bound holds for that direction only.
 */
#ifndef ORL_SCENE_MATERIAL_BOUNDS_H
#define ORL_SCENE_MATERIAL_BOUNDS_H

#include "scene/material/scatter.h"

/* Bound of orl_material_diffuse. */
double orl_material_max_diffuse(const struct orl_material *material);

/* Bounds of orl_material_albedo and orl_material_mirrored, on that side. */
double orl_material_max_albedo(const struct orl_material *material, bool front, double cosine,
                               enum orl_lobes lobes);
double orl_material_max_mirrored(const struct orl_material *material, bool front, double cosine);

/* Bound of the lobes' albedo for light from that side; for BSDFs from any direction, with the
 * diffuse additions. */
double orl_material_max_lobes(const struct orl_material *material, bool front, double cosine);

/* Returns true if the surface mirrors light at any angle, so that a flat one shows images of the
 * sun. */
bool orl_material_is_mirror(const struct orl_material *material);

/* Mean radiance of an emitter over area, and over direction weighted by the cosine. */
struct orl_rgb orl_material_mean_radiance(const struct orl_material *material);
struct orl_rgb orl_material_max_radiance(const struct orl_material *material);

#endif
