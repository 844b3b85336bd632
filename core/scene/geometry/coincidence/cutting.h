/*
 * Cuts coincident polygons: the outline of each loser becomes its difference to the original
 * outlines of all winners over it.
 */
#ifndef ORL_SCENE_GEOMETRY_COINCIDENCE_CUTTING_H
#define ORL_SCENE_GEOMETRY_COINCIDENCE_CUTTING_H

#include "scene/geometry/coincidence/coincidence_warnings.h"
#include "scene/geometry/coincidence/coplanar.h"
#include "scene/geometry/coincidence/overlap.h"

/* Ready for orl_cutting_bound when all but the first three fields are zero. */
struct orl_cutting {
    struct orl_parsed_scene *d;
    struct orl_coincidence_warnings *warnings;
    double tolerance;
    struct orl_comparison_budget budget;
    uint64_t most_work; /* limit of the overlap's work; 0: none */
    struct orl_overlap overlap;
    struct orl_box_tree tree;
    bool cut_short; /* a limit was reached: some polygons stayed uncut */
};

/* Sets limits of comparisons and work in proportion to the description's corners. */
void orl_cutting_bound(struct orl_cutting *cutting);

struct orl_outline orl_outline_of(const struct orl_surface *polygon);

/* Sets overlap.shared if two outlines share an area, and computes what remains of the first. When
 * the work is used up, shared is false and cut_short is set. Returns 0 or ORL_ERR_NOMEM. */
int orl_cutting_test(struct orl_cutting *cutting, const struct orl_outline *a,
                     const struct orl_outline *b);

/*
 * Cuts a by b for each pair, and reports pairs that share an area; sorts the pairs. Polygons that
 * are cut away completely get n_vertices 0. Returns 0, ORL_ERR_NOMEM or ORL_ERR_CANCELLED.
 */
int orl_cutting_run(struct orl_cutting *cutting, struct orl_pairs *losses);
void orl_cutting_done(struct orl_cutting *cutting);

#endif
