/*
 * A BSDF surface prepared for light from a narrow cone: the sun through a window, whose draws are
 * then looks into tables (bsdf/incident.h).
 *
 * Borrows the material. Immutable once made; any number of threads may draw.
 */
#ifndef ORL_SCENE_MATERIAL_PASSAGE_H
#define ORL_SCENE_MATERIAL_PASSAGE_H

#include "scene/material/scatter.h"

struct orl_passage;

/*
 * The cone is about the unit direction towards. *ret_passage is NULL when orl_scatter_sample serves
 * as well: other materials, or data that tables do not help. Returns 0 or ORL_ERR_NOMEM.
 */
int orl_passage_new(const struct orl_material *material, struct orl_vec3 normal,
                    struct orl_vec3 towards, double half_angle_rad,
                    struct orl_passage **ret_passage);
/* Whether it was made of these. */
bool orl_passage_serves(const struct orl_passage *passage, const struct orl_material *material,
                        struct orl_vec3 normal, struct orl_vec3 towards);
void orl_passage_free(struct orl_passage *passage); /* NULL is allowed */

/* As orl_scatter_sample_at, of light, with ORL_LOBE_TRANSMITTED. */
struct orl_scatter orl_passage_sample(const struct orl_passage *passage, struct orl_vec3 from,
                                      const double u[3]);

#endif
