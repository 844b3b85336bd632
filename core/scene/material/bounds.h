/*
 * Materials over all of a surface, for who plans, surveys or sets lamps up before anything is hit.
 * `_most` is a bound that holds wherever it is met, in its brightest channel, 0..1; `_mean` is by
 * area. Other means: any question of scatter.h at orl_hit_anywhere. Light is met at a cosine, in a
 * plane of no particular azimuth: for BSDFs a bound is of that direction alone.
 */
#ifndef ORL_SCENE_MATERIAL_BOUNDS_H
#define ORL_SCENE_MATERIAL_BOUNDS_H

#include "scene/material/scatter.h"

/* orl_material_diffuse. */
double orl_material_diffuse_most(const struct orl_material *material);

/* orl_material_albedo and orl_material_mirrored, on that side. */
double orl_material_albedo_most(const struct orl_material *material, bool front, double cosine,
                                enum orl_lobes lobes);
double orl_material_mirrored_most(const struct orl_material *material, bool front, double cosine);

/* What lobes make of light from that side; of BSDFs from any direction, data and additions. */
double orl_material_lobes_most(const struct orl_material *material, bool front, double cosine);

/* Whether anything is mirrored at any angle: what makes a flat surface show images of the sun. */
bool orl_material_is_mirror(const struct orl_material *material);

/* Of what shines: its radiance, on the whole (by the cosine where it depends on the direction). */
struct orl_rgb orl_material_radiance_mean(const struct orl_material *material);
struct orl_rgb orl_material_radiance_most(const struct orl_material *material);

#endif
