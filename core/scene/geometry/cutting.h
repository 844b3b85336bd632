/*
 * Polygons cut away where others lie in their place: the outline of each that loses leaves out
 * those of all that win over it, as these were before any was cut.
 */
#ifndef ORL_SCENE_GEOMETRY_CUTTING_H
#define ORL_SCENE_GEOMETRY_CUTTING_H

#include "scene/geometry/coincident_words.h"
#include "scene/geometry/coplanar.h"
#include "scene/geometry/overlap.h"

/* Zeroed but for the first three it is ready for orl_cutting_bound. */
struct orl_cutting {
    struct orl_description *d;
    struct orl_coincidence_words *words;
    double tolerance;
    struct orl_looks looks;
    uint64_t most_work; /* of the overlap; 0: none */
    struct orl_overlap overlap;
    struct orl_box_tree tree;
    bool cut_short; /* the work was bounded: something stayed as it was */
};

/* Bounds looks and work in proportion to the description's corners. */
void orl_cutting_bound(struct orl_cutting *cutting);

struct orl_outline orl_outline_of(const struct orl_surface *polygon);

/* Whether two outlines share an area, which sets overlap.shared and what is left of the first. When
 * work is used up they do not, and cut_short is set. Returns 0 or ORL_ERR_NOMEM. */
int orl_cutting_look(struct orl_cutting *cutting, const struct orl_outline *a,
                     const struct orl_outline *b);

/*
 * Cuts a by b for each pair, which it puts in order, and tells those that do share an area. Of
 * polygons of which nothing is left n_vertices is 0. Returns 0, ORL_ERR_NOMEM or ORL_ERR_CANCELLED.
 */
int orl_cutting_run(struct orl_cutting *cutting, struct orl_pairs *losses);
void orl_cutting_done(struct orl_cutting *cutting);

#endif
