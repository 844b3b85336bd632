/*
 * A BSDF surface prepared for light from a narrow cone, such as the sun through a window: samples
 * are table look-ups (bsdf/cone_table.h).
 *
 * Borrows the material. Immutable once made; any number of threads may sample.
 */
#ifndef ORL_SCENE_MATERIAL_SUN_BSDF_TABLE_H
#define ORL_SCENE_MATERIAL_SUN_BSDF_TABLE_H

#include "scene/material/scatter.h"

struct orl_sun_bsdf_table;

/*
 * The cone is about the unit direction towards. *ret_passage is NULL if orl_material_sample serves
 * as well: for other materials, or data that tables do not speed up. Returns 0 or ORL_ERR_NOMEM.
 */
int orl_sun_bsdf_table_new(const struct orl_material *material, struct orl_vec3 normal,
                           struct orl_vec3 towards, double half_angle_rad,
                           struct orl_sun_bsdf_table **ret_table);
/* Returns true if the passage was made of these arguments. */
bool orl_sun_bsdf_table_matches(const struct orl_sun_bsdf_table *sun_bsdf_table,
                                const struct orl_material *material, struct orl_vec3 normal,
                                struct orl_vec3 towards);
void orl_sun_bsdf_table_free(struct orl_sun_bsdf_table *sun_bsdf_table); /* NULL is allowed */

/* orl_material_sample_at for light, with ORL_LOBE_TRANSMITTED. */
struct orl_surface_sample orl_sun_bsdf_table_sample(const struct orl_sun_bsdf_table *sun_bsdf_table,
                                                    struct orl_vec3 from, const double u[3]);

#endif
