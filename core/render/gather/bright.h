/*
 * Where a sensor's hemisphere is bright: small patches of much light, a sun's on a wall, that few
 * of its even rays meet. The photons of a map, in runs of neighbours, tell where they may be; of a
 * place they make a density of directions, over the square of scene/material/hemisphere.h. Some
 * rays are drawn by it, and all are weighed by how often either way would have drawn them (the
 * balance heuristic of Veach and Guibas 1995), so that it need not be right: what stands between,
 * or what photons have missed, costs rays and no more.
 *
 * Cells of the square are halved where there is light, down to what the runs can tell; those not
 * much brighter than the mean are left to the even rays, and so is everything where these do well.
 */
#ifndef ORL_RENDER_GATHER_BRIGHT_H
#define ORL_RENDER_GATHER_BRIGHT_H

#include <oriel/crew.h>

#include "photon/map/map.h"

enum { ORL_BRIGHT_SPOTS = 2048, ORL_BRIGHT_CELLS = 1024 };

/* A run of neighbouring photons. */
struct orl_bright_spot {
    float at[3], normal[3];
    float half; /* of a square that they fill */
    float flux;
};

struct orl_bright {
    struct orl_bright_spot *spots; /* owned */
    uint32_t count;
};

/* Builds the bright spots of a global map. Returns 0, ORL_ERR_NOMEM or ORL_ERR_CANCELLED. */
int orl_bright_init(struct orl_bright *bright, const struct orl_photon_map *map,
                    struct orl_crew *crew);
void orl_bright_done(struct orl_bright *bright); /* also of one that is all zero */

/* A cell, halved across x and y in turn. */
struct orl_bright_cell {
    float mass;   /* of the density */
    uint32_t low; /* its first half, the other being the next; 0: it is whole */
};

/* As a place sees it. */
struct orl_bright_view {
    bool worth; /* some rays are to be drawn by it */
    uint32_t count;
    struct orl_bright_cell cells[ORL_BRIGHT_CELLS];
};

/* For so many even rays. */
void orl_bright_look(const struct orl_bright *bright, struct orl_vec3 point, struct orl_vec3 normal,
                     uint32_t rays, struct orl_bright_view *ret_view);

/* Draws a point of the square from an even one; the density there, of mean 1. */
void orl_bright_draw(const struct orl_bright_view *view, double u[2]);
double orl_bright_density(const struct orl_bright_view *view, const double u[2]);

#endif
