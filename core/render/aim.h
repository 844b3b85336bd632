/*
 * Rays from a place, towards where light may come from. A ray is drawn in one of three ways:
 *   by the cosine;
 *   at a port: a point uniform over one of them;
 *   along a beam: against a direction into which the lobes of a port's material send a sun.
 * Where several ways could have made a ray it weighs by the sum of their densities, the balance
 * heuristic of Veach and Guibas 1995; the last two count only when the ray first meets what it was
 * aimed at, so that no density of a port behind a wall is needed.
 */
#ifndef ORL_RENDER_AIM_H
#define ORL_RENDER_AIM_H

#include "light/world.h"

enum { ORL_MOST_BEAMS = 32 };

/* A sun in a kind of pane: panes of one material that face alike send it the same ways. */
struct orl_beam {
    const struct orl_material *material; /* borrowed from the world */
    struct orl_vec3 normal, sun;
    uint32_t facet; /* one of the panes */
};

struct orl_aim {
    const struct orl_world *world; /* borrowed */
    struct orl_beam beams[ORL_MOST_BEAMS];
    uint32_t n_beams; /* those beyond the most are left to the other ways: noise, not bias */
    double by_cosine, at_ports, along_beams; /* probabilities */
};

void orl_aim_init(struct orl_aim *aim, const struct orl_world *world);

struct orl_aimed {
    struct orl_vec3 direction;
    double weight; /* cosine over density: times radiance it is an estimate of irradiance */
    bool met;      /* a surface: hit */
    struct orl_hit hit;
};

/* False when the ray counts for nothing. u: three numbers in [0,1). */
bool orl_aim_sample(const struct orl_aim *aim, struct orl_vec3 point, struct orl_vec3 normal,
                    const double u[3], struct orl_aimed *ret_aimed);

#endif
