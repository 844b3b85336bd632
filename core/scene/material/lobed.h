/*
 * What is looked for in functions of lobes before anything is rendered; what they do with light is
 * in kinds.h.
 */
#ifndef ORL_SCENE_MATERIAL_LOBED_H
#define ORL_SCENE_MATERIAL_LOBED_H

#include "scene/material/scatter.h"

enum { ORL_LOBED_SIDE = 16 }; /* cells of the table that draws are by, each way */

struct orl_lobed_findings {
    double sent[2];     /* what the function comes to, reflected and transmitted: sums over looks */
    double all, unlike; /* with the shares; and by how much few cells are off many */
    double most;        /* of light that a direction sends on, all parts counted, */
    double cosine;      /* found at; */
    double most_steep;  /* the same above a cosine of 0.4 */
    size_t looks;
};

/* Where in a table known beforehand the cells of a side are, as seen from that cell of the side
 * that something comes from. */
enum { ORL_LOBED_KNOWN = 8 * ORL_LOBED_SIDE * ORL_LOBED_SIDE * ORL_LOBED_SIDE * ORL_LOBED_SIDE };
static inline size_t orl_lobed_place(enum orl_transport transport, bool front, int cell,
                                     bool through)
{
    const size_t cells = (size_t)ORL_LOBED_SIDE * ORL_LOBED_SIDE;
    const size_t from = ((transport == ORL_TRANSPORT_EYE ? 2U : 0U) + front) * cells + (size_t)cell;
    return (2 * from + through) * cells;
}

/* Fills in a table of ORL_LOBED_KNOWN numbers for a normal. */
void orl_lobed_know(const struct orl_material *material, const struct orl_hit *hit, float *ret);

/* Adds what is found of light from one direction at one place; rest: what else of the material
 * sends on of it, 0..1. */
void orl_lobed_look(const struct orl_material *material, const struct orl_hit *hit,
                    struct orl_vec3 light, double rest, struct orl_lobed_findings *findings);

/* Of a material and its parts: the first lobes of which draws do not see all, or NULL; and whether
 * any lets light through. */
const struct orl_pattern *orl_lobed_narrow(const struct orl_material *material);
/* The same of all surfaces. */
const struct orl_pattern *orl_lobed_narrow_of(const struct orl_geometry *geometry,
                                              const struct orl_material *materials);
bool orl_lobed_any_transmits(const struct orl_material *material);

#endif
