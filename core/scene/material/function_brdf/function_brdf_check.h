/*
 * Tests and tables of material functions before rendering: prisms, lobes. Scattering itself is in
 * kinds.h.
 */
#ifndef ORL_SCENE_MATERIAL_FUNCTION_BRDF_FUNCTION_BRDF_CHECK_H
#define ORL_SCENE_MATERIAL_FUNCTION_BRDF_FUNCTION_BRDF_CHECK_H

#include "scene/geometry/geometry.h"
#include "scene/material/scatter.h"

/* Findings of tests of a prism's functions. */
struct orl_prism_statistics {
    double all, irreversible; /* sums of eye rays' shares: all, and of irreversible rays */
    double max_seen;          /* largest sum of radiance shares, for an eye ray */
    double max_sent;          /* largest sum of flux shares, for light */
};

/* Adds the findings of rays from all directions at one place. */
void orl_prism_measure(const struct orl_material *material, const struct orl_hit *hit,
                       struct orl_prism_statistics *statistics);

/*
 * Tests and tables of lobe functions.
 */

enum { ORL_LOBE_TABLE_SIDE = 16 }; /* cells per axis of the sampling tables */

struct orl_lobe_statistics {
    double integrals[2]; /* integrals of the function, reflected and transmitted: sums over
                            directions */
    /* sums over directions, scaled by shares: integrals, and errors of the coarse cells */
    double all, coarse_error;
    double maximum;   /* largest albedo of a direction, over all kinds of scattering */
    double cosine;    /* cosine at which `maximum` was found */
    double max_steep; /* largest albedo above a cosine of 0.4 */
    size_t n_directions;
};

/* Returns the offset in a precomputed table of the cells of one outgoing side, for an incident
 * direction in `cell` of its side. */
enum {
    ORL_LOBE_TABLE_VALUES =
        8 * ORL_LOBE_TABLE_SIDE * ORL_LOBE_TABLE_SIDE * ORL_LOBE_TABLE_SIDE * ORL_LOBE_TABLE_SIDE
};
static inline size_t orl_lobe_table_offset(enum orl_transport transport, bool front, int cell,
                                           bool through)
{
    const size_t cells = (size_t)ORL_LOBE_TABLE_SIDE * ORL_LOBE_TABLE_SIDE;
    const size_t from = ((transport == ORL_TRANSPORT_EYE ? 2U : 0U) + front) * cells + (size_t)cell;
    return (2 * from + through) * cells;
}

/* Fills a table of ORL_LOBE_TABLE_VALUES numbers for a normal. */
void orl_lobe_table_fill(const struct orl_material *material, const struct orl_hit *hit,
                         float *ret);

/* Adds the findings for light from one direction at one place; rest: the albedo of the material's
 * other scattering, 0..1. */
void orl_function_lobes_measure(const struct orl_material *material, const struct orl_hit *hit,
                                struct orl_vec3 light, double rest,
                                struct orl_lobe_statistics *statistics);

/* Returns the first lobes among all surfaces' materials that are too narrow for the sampling
 * tables, or NULL. */
const struct orl_pattern *orl_find_narrow_lobes(const struct orl_geometry *geometry,
                                                const struct orl_material *materials);
/* Returns true if any component of the material has lobes that transmit light. */
bool orl_function_lobes_any_transmits(const struct orl_material *material);

/*
 * Stores the integrals of lobes, warns, and refuses materials that would give wrong results: prisms
 * whose rays differ between light and eye, lobes with an albedo above 1. Returns 0, or
 * ORL_ERR_RANGE or _UNSUPPORTED with file and line; ORL_ERR_LIMIT (too many such materials),
 * _CANCELLED or _NOMEM.
 */
int orl_function_brdf_check(struct orl_parsed_scene *parsed_scene,
                            const struct orl_geometry *geometry, struct orl_error *err);

#endif
