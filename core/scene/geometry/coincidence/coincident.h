/*
 * Coincident polygons: decides which of them rays hit, before geometry is built.
 *
 * The rule is Radiance's (rayreject). A surface with a material wins over one without; opaque
 * materials win over glass, trans and the like; a front wins over a back; then the modifier that
 * was defined later wins. A polygon that loses from both sides is cut (cutting.h): the winner's
 * outline is subtracted from its own. Two that face opposite ways, as walls of neighbouring rooms
 * do, are each hit from their front: they stay whole, and are listed for geometry.c to choose by
 * the side that a ray comes from.
 *
 * All this is reported by warnings, except where it has no effect: pairs of one material are only
 * counted, and for two-sided materials the orientation does not matter.
 *
 * Surfaces coincide within 1e-6 of the files' unit, as in Radiance, or within what rays can
 * resolve, 2^-21 of the scene's size. Quadrics and rings, and BSDFs that represent geometry and
 * face the same way, are left as they are: rays hit either, and a warning says so. Exact duplicates
 * are dropped first, in n log n. Work on pairs is bounded in proportion to the scene's corners; a
 * warning reports what remains.
 */
#ifndef ORL_SCENE_GEOMETRY_COINCIDENCE_COINCIDENT_H
#define ORL_SCENE_GEOMETRY_COINCIDENCE_COINCIDENT_H

#include <stdbool.h>

#include <oriel/base/error.h>

#include "scene/parsed_scene.h"

/* Changes outlines, drops surfaces, adds warnings and opposed pairs. Returns 0, ORL_ERR_NOMEM or
 * ORL_ERR_CANCELLED. */
int orl_coincident_resolve(struct orl_parsed_scene *parsed_scene, struct orl_error *err);

/*
 * The rule for two coincident surfaces: which of them rays hit.
 */

/* Returns 1 for materials that transmit light, else 2. A BSDF counts as 2 unless it is an aBSDF. */
int orl_coincidence_class(const struct orl_material *m);

/*
 * Compares two coincident polygons of one parsed scene. Positive: rays hit a from both sides;
 * negative: b; 0: each is hit from its front. The order is transitive.
 */
int orl_coincidence_compare(const struct orl_parsed_scene *d, const struct orl_surface *a,
                            const struct orl_surface *b);

/* Returns true if light scatters alike from both sides of the material. */
bool orl_material_is_two_sided(const struct orl_material *m);

/* Returns true if light scatters alike from both surfaces' materials. */
bool orl_surfaces_alike(const struct orl_parsed_scene *d, const struct orl_surface *a,
                        const struct orl_surface *b);

/* Returns true if the surface is a BSDF that represents geometry (with a thickness). */
bool orl_surface_is_proxy(const struct orl_parsed_scene *d, const struct orl_surface *s);

/* Returns true if the surface bounds antimatter, where it need not be present. */
bool orl_surface_is_hole(const struct orl_parsed_scene *d, const struct orl_surface *s);

/*
 * Warnings about coincident surfaces: the first few pairs of every kind by name and line, the
 * others by their number.
 */

enum orl_coincidence {
    ORL_COINCIDENCE_RESOLVED,      /* rays hit the second, from either side */
    ORL_COINCIDENCE_OPPOSED,       /* rays hit each from its front */
    ORL_COINCIDENCE_AMBIGUOUS,     /* rays may hit either */
    ORL_COINCIDENCE_SAME_MATERIAL, /* rays may hit either: both have the same material */
    ORL_COINCIDENCE_PANES, /* two panes closer than can be resolved: light passes only one */
    ORL_COINCIDENCES
};

/* A zeroed struct is ready to use. */
struct orl_coincidence_warnings {
    double tolerance; /* distance below which surfaces coincide */
    uint64_t counts[ORL_COINCIDENCES];
    char opposed[2][200]; /* names of the first opposed pair */
};

/* Returns true if both are panes that Radiance's rays would pass one after the other. */
bool orl_coincidence_is_double_pane(const struct orl_parsed_scene *parsed_scene,
                                    const struct orl_surface *first,
                                    const struct orl_surface *second);

/* Adds a warning about two surfaces. kind is ORL_COINCIDENCE_PANES for double panes. wholly: the
 * whole area of the first surface lies on the second. */
void orl_coincidence_warn(struct orl_coincidence_warnings *warnings,
                          struct orl_parsed_scene *parsed_scene, enum orl_coincidence kind,
                          const struct orl_surface *first, const struct orl_surface *second,
                          bool wholly);
/* Adds warnings with the number of pairs that were not named. */
void orl_coincidence_warn_totals(struct orl_coincidence_warnings *warnings,
                                 struct orl_parsed_scene *parsed_scene);

/*
 * Drops exact duplicates, surfaces with the same numbers as another, in n log n. This precedes the
 * search for coincident pairs, which n duplicates would make quadratic.
 *
 * Polygons with the same corners, wherever the outline begins and in either direction, form a
 * group. By orl_coincidence_compare all of a group lose to the winners of the two orientations, at
 * most two, and would be cut away. A winner cuts all that its losers would cut. Quadrics and rings
 * are dropped if they have the same kind and the same two-sided material.
 */

/*
 * Drops the duplicates, each with a warning or a count, and keeps the order of the others. is_cut:
 * by material, true if antimatter cuts it; a pane that coincides with such a surface is left for
 * the search for pairs to refuse. Returns 0, ORL_ERR_NOMEM or ORL_ERR_CANCELLED.
 */
int orl_duplicates_drop(struct orl_parsed_scene *parsed_scene, const bool *is_cut,
                        struct orl_coincidence_warnings *warnings);

#endif
