#include "scene/geometry/coincidence/covered.h"

#include <math.h>

#include "scene/geometry/coincidence/coincidence_rule.h"

enum { MOST_CORNERS = 16 };

/* Excludes surfaces that antimatter cuts, among others: the search for all pairs decides about
 * them, and may refuse them. */
static bool may_be_covered(const struct orl_parsed_scene *d, const bool *is_cut,
                           const struct orl_surface *s)
{
    return s->kind == ORL_SURFACE_POLYGON && !is_cut[s->material] && !orl_surface_is_hole(d, s) &&
           !orl_surface_is_proxy(d, s) && orl_coincidence_class(&d->materials[s->material]) == 2;
}

/* Returns true if all corners of the loser lie in the winner's plane, on the inner side of each
 * line through its edges. Inside a concave winner the test fails at some such line. */
static bool holds_corners(const struct orl_surface *winner, const struct orl_surface *loser,
                          double tolerance)
{
    for (uint32_t i = 0; i < loser->n_vertices; i++)
        if (!(fabs(orl_dot(orl_sub(loser->vertices[i], winner->vertices[0]), winner->normal)) <=
              tolerance))
            return false;
    for (uint32_t k = 0; k < winner->n_vertices; k++) {
        const struct orl_vec3 from = winner->vertices[k];
        const struct orl_vec3 edge = orl_sub(winner->vertices[(k + 1) % winner->n_vertices], from);
        const struct orl_vec3 inwards = orl_cross(winner->normal, edge);
        for (uint32_t i = 0; i < loser->n_vertices; i++)
            if (orl_dot(orl_sub(loser->vertices[i], from), inwards) < 0)
                return false;
    }
    return true;
}

bool orl_polygon_covers(const struct orl_parsed_scene *parsed_scene, const bool *is_cut,
                        const struct orl_surface *winner, const struct orl_surface *loser,
                        double tolerance)
{
    const struct orl_parsed_scene *const d = parsed_scene;
    return winner != loser && may_be_covered(d, is_cut, winner) &&
           may_be_covered(d, is_cut, loser) && winner->n_vertices <= MOST_CORNERS &&
           orl_coincidence_compare(d, winner, loser) > 0 && holds_corners(winner, loser, tolerance);
}
