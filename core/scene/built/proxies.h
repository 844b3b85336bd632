/*
 * BSDFs that stand for geometry. A BSDF with a thickness is a proxy: it was measured from the
 * slats, prisms or other surfaces within that distance, on the side opposite its normal (negative
 * thickness: on the side of its normal). Light meets the proxy, and views see the geometry.
 *
 * So there are two scenes. In the scene of light (orl_scene.geometry) the surfaces that a proxy
 * stands for are removed. There the proxy scatters as any BSDF does, on both sides. Rays that leave
 * it to the side of the geometry start beyond it, because partly covered surfaces may remain there.
 *
 * If two proxies stand for the same geometry, one to each side, the first serves both. They
 * are such a pair if they face opposite ways and their two thicknesses together span the distance
 * between them. (In Radiance each scatters only light from its outer side, at any distance, with
 * the same result. Files have pairs a little further apart than either is thick.)
 *
 * In the scene of views (orl_scene.seen) there are no proxies. The surfaces behind them are lit by
 * paths in that scene, which are separate and only for view rays. No light is counted twice:
 * photons, gather rays and shadow rays use one scene, views of hidden surfaces the other.
 *
 * A surface is hidden if at least three quarters of it, seen across the proxy's plane, have the
 * proxy within its thickness. A reveal that ends at the proxy's edge is not hidden, because the
 * directions spread a little to all sides. Radiance differs: it lets shadow rays pass proxies to
 * the geometry.
 */
#ifndef ORL_SCENE_BUILT_PROXIES_H
#define ORL_SCENE_BUILT_PROXIES_H

#include "scene/built/scene.h"

/*
 * Splits the geometry of a new scene into the two; without proxies nothing changes. Returns 0,
 * ORL_ERR_NOMEM, or ORL_ERR_LIMIT if proxies have more orientations than are searched.
 */
int orl_proxies_split(struct orl_scene *scene, struct orl_error *err);

/* Returns the crossing of the last port that is a proxy and that a view ray passes within a
 * distance. */
enum orl_port_crossing orl_proxies_last_crossing(const struct orl_scene *scene,
                                                 struct orl_vec3 origin, struct orl_vec3 direction,
                                                 double distance);

#endif
