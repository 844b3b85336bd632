/*
 * Small mirrors and lenses as targets of rays. A ball of glass that fills a thousandth of the field
 * of view may bring a tenth of the light at a place. Rays drawn by the cosine meet it a few times
 * at most. Each target is a group of facets with a bounding sphere. Directions towards it are
 * uniform in the cone that the sphere fills (Pharr, Jakob and Humphreys 2016, section 14.2.2), or
 * in all directions if the place is in the sphere.
 *
 * Groups are facets that lie near each other. A set is divided at the middle of its longest axis
 * while the spheres about both parts have less than half the surface of the sphere about the set.
 * Large groups are no targets: other rays meet them often enough.
 */
#ifndef ORL_RENDER_GATHER_TARGETS_H
#define ORL_RENDER_GATHER_TARGETS_H

#include "light/lit_scene.h"

enum { ORL_MOST_TARGETS = 32, ORL_NO_TARGET = 255 };

struct orl_target_sphere {
    struct orl_vec3 center; /* moved coordinates */
    double radius;
};

struct orl_targets {
    struct orl_target_sphere at[ORL_MOST_TARGETS];
    uint32_t n;
    uint8_t *of_facet; /* target of each of the scene's own facets, or ORL_NO_TARGET; NULL: none */
    uint8_t *of_instance; /* target of each placed copy (scene/geometry/instances.h); NULL: none */
};

/* Finds the targets indoors; in a scene that is no building, all of them. Returns 0 or
 * ORL_ERR_NOMEM; call orl_targets_done in either case. */
int orl_targets_init(struct orl_targets *targets, const struct orl_lit_scene *lit_scene);
void orl_targets_done(struct orl_targets *targets); /* also accepts an all-zero struct */

/* Returns the target that a facet belongs to, or ORL_NO_TARGET. */
uint32_t orl_targets_of(const struct orl_targets *targets, const struct orl_geometry *geometry,
                        uint32_t facet);

/* Returns a direction from a point towards a target; u in [0,1)^2. */
struct orl_vec3 orl_target_sample(const struct orl_target_sphere *target, struct orl_vec3 point,
                                  const double u[2]);

/* Returns the density of that direction, per steradian; 0 outside the target's cone. */
double orl_target_pdf(const struct orl_target_sphere *target, struct orl_vec3 point,
                      struct orl_vec3 direction);

#endif
