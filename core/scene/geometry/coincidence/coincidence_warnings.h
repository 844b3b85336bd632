/*
 * Warnings about coincident surfaces: the first few pairs of every kind by name and line, the
 * others by their number.
 */
#ifndef ORL_SCENE_GEOMETRY_COINCIDENCE_COINCIDENCE_WARNINGS_H
#define ORL_SCENE_GEOMETRY_COINCIDENCE_COINCIDENCE_WARNINGS_H

#include "scene/parsed_scene.h"

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

#endif
