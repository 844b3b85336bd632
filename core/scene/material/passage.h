/*
 * A BSDF surface prepared for light from a narrow cone, such as the sun through a window: samples
 * are table look-ups (bsdf/incident.h).
 *
 * Borrows the material. Immutable once made; any number of threads may sample.
 */
#ifndef ORL_SCENE_MATERIAL_PASSAGE_H
#define ORL_SCENE_MATERIAL_PASSAGE_H

#include "scene/material/scatter.h"

struct orl_passage;

/*
 * The cone is about the unit direction towards. *ret_passage is NULL if orl_scatter_sample serves
 * as well: for other materials, or data that tables do not speed up. Returns 0 or ORL_ERR_NOMEM.
 */
int orl_passage_new(const struct orl_material *material, struct orl_vec3 normal,
                    struct orl_vec3 towards, double half_angle_rad,
                    struct orl_passage **ret_passage);
/* Returns true if the passage was made of these arguments. */
bool orl_passage_serves(const struct orl_passage *passage, const struct orl_material *material,
                        struct orl_vec3 normal, struct orl_vec3 towards);
void orl_passage_free(struct orl_passage *passage); /* NULL is allowed */

/* orl_scatter_sample_at for light, with ORL_LOBE_TRANSMITTED. */
struct orl_scatter orl_passage_sample(const struct orl_passage *passage, struct orl_vec3 from,
                                      const double u[3]);

#endif
