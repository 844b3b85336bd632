/*
 * What is looked for in a prism's functions before anything is rendered; what it does with light
 * is in kinds.h.
 */
#ifndef ORL_SCENE_MATERIAL_PRISM_H
#define ORL_SCENE_MATERIAL_PRISM_H

#include "scene/geometry/geometry.h"

struct orl_prism_findings {
    double all, one_way; /* shares of eyes' rays, summed: all, and of ways that lead not back */
    double most_seen;    /* of radiance, towards an eye */
    double most_sent;    /* of flux, from light */
};

/* Adds what rays from all round find at one place of it. */
void orl_prism_look(const struct orl_material *material, const struct orl_hit *hit,
                    struct orl_prism_findings *findings);

#endif
