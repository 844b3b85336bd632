/*
 * Cutting of coincident polygons, by boolean operations of coplanar outlines.
 */
#ifndef ORL_SCENE_GEOMETRY_COINCIDENCE_CUTTING_H
#define ORL_SCENE_GEOMETRY_COINCIDENCE_CUTTING_H

#include <stdbool.h>

#include "scene/geometry/coincidence/coincident.h"
#include "scene/geometry/coincidence/coincident_pairs.h"
#include "scene/geometry/triangulation/arrangement.h"

/*
 * Boolean operations of coplanar polygons: a test whether two share an area, and the difference of
 * one to others.
 */

struct orl_outline {
    const struct orl_vec3 *vertices;
    uint32_t n;
    struct orl_vec3 normal; /* unit: the front */
};

/* Scratch and result; a zeroed struct is ready to use. */
struct orl_overlap {
    struct orl_arrangement arrangement;
    struct orl_vec3 *vertices; /* remaining outline: loops joined by seams */
    uint32_t n;                /* 0: nothing remains */
    bool shared;               /* a shares more than a seam's area with one of the others */
    uint64_t work;
    size_t vertices_room;
    void *scratch;
    size_t scratch_room;
};

/* Fast test: returns true if the line through some edge separates the two. */
bool orl_outlines_apart(const struct orl_outline *a, const struct orl_outline *b, double tolerance);

enum { ORL_OVERLAP_LAYERS = 31 };

/*
 * Computes the part of a outside all n others. Each of those has a layer, 0 to ORL_OVERLAP_LAYERS -
 * 1; outlines of one layer must not overlap. Strips narrower than tolerance do not count, neither
 * as shared nor as remaining. Returns 0, ORL_ERR_NOMEM, or ORL_ERR_LIMIT.
 */
int orl_outline_subtract(struct orl_overlap *overlap, const struct orl_outline *a,
                         const struct orl_outline *others, const uint32_t *layers, size_t n,
                         double tolerance);
void orl_overlap_done(struct orl_overlap *overlap);

/*
 * Cuts coincident polygons: the outline of each loser becomes its difference to the original
 * outlines of all winners over it.
 */

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

/* Sets limits of comparisons and work in proportion to the parsed scene's corners. */
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
