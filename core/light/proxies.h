/*
 * BSDFs that stand for geometry. A BSDF with a thickness is a proxy: slats, prisms or whatever lies
 * within that distance of it, on the side opposite its normal (negative: on that of its normal), is
 * what it was measured from. Light meets the proxy, and views see the geometry.
 *
 * So there are two scenes. In that of light (orl_scene.geometry) a surface that a proxy stands for
 * is not there, and the proxy scatters as any BSDF does, on both sides; rays that leave it to the
 * side of the geometry start beyond it, where surfaces it only partly covers may still be. Of two
 * proxies that stand for the same geometry, one to each side, the first serves both: such are they
 * when they look opposite ways and what the two reach, together, spans what is between them. (In
 * Radiance each scatters only what comes from its outer side, however far apart they are; that is
 * the same. Files have pairs a little further apart than either is thick.) In the scene
 * of views (orl_scene.seen) there are no proxies, and what stands behind them is lit by paths in
 * that very scene: once more, but only for the eye. Nothing is counted twice: photons, gather rays
 * and shadow rays know one scene, views of hidden surfaces the other.
 *
 * A surface is hidden when at least three quarters of it, looking across the proxy's plane, have
 * the proxy within its thickness. A reveal that ends at the proxy's edge is not: the look is a
 * little to all sides. Differs from Radiance, which lets shadow rays pass proxies to the geometry.
 */
#ifndef ORL_LIGHT_PROXIES_H
#define ORL_LIGHT_PROXIES_H

#include "light/scene.h"

/*
 * Parts the geometry of a scene just made; without proxies nothing changes. Returns 0,
 * ORL_ERR_NOMEM, or ORL_ERR_LIMIT for proxies that face more ways than are looked along.
 */
int orl_proxies_part(struct orl_scene *scene, struct orl_error *err);

/* The last port that is a proxy and that a view ray passes within that distance. */
enum orl_crossing orl_proxies_passed(const struct orl_scene *scene, struct orl_vec3 origin,
                                     struct orl_vec3 direction, double distance);

#endif
