/*
 * Sunlight at a place: straight, through panes, and by way of one flat mirror (a pane among them);
 * of the sun's nodes for paths, and at a sensor of every hour's own sun.
 *
 * What comes by several mirrors one after the other is left out; scenes in which that is more than
 * panes' faint second reflections are refused (scope.h).
 */
#ifndef ORL_ANNUAL_SUNLIGHT_H
#define ORL_ANNUAL_SUNLIGHT_H

#include "annual/scene.h"
#include "annual/sums.h"
#include "annual/sun_rows.h"

/* A place, and what its irradiance counts; with lobes not NULL what these send towards eye. */
struct orl_sunlit_query {
    struct orl_place place;
    struct orl_rgb weight;
    int32_t port; /* by which the path to the place has first left the building; or ORL_NO_PORT */
    bool all;     /* of nodes, not some by lot: where a sensor looks at the place itself */
    bool mapped;  /* what the map of the sun has is not asked for: mirrors outside alone */
    const struct orl_material *lobes;
    const struct orl_hit *hit;
    struct orl_vec3 eye;
};

/* Adds to the nodes of each part, for a sun that gives 1 to what faces it. */
void orl_sunlit_add(const struct orl_annual_scene *scene, const struct orl_sunlit_query *query,
                    struct orl_random *random, const struct orl_annual_sums *sums);

/*
 * Irradiance at a sensor by the discs of all suns that are wanted, of each as if it gave 1 to what
 * faces it: straight (and through panes), and by mirrors. The crew is asked before each sun,
 * straight and by each pane, if the job is cancelled, and then the rest is left out; NULL: it never
 * is.
 */
void orl_sunlit_hours_find(const struct orl_annual_scene *scene, const struct orl_year_suns *suns,
                           const struct orl_place *place, uint64_t name,
                           const struct orl_crew *crew, const struct orl_sun_rows *rows);

#endif
