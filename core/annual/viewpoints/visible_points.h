/*
 * Points of surfaces that a viewpoint sees, used as sensors of a year. Hits in one cell of
 * directions from the eye, on one side of one surface, form one visible point. To bound memory,
 * beyond ORL_VISIBLE_POINTS_MOST_CLUSTERS visible points surfaces with a similar orientation share
 * a visible point per cell. At most ORL_VISIBLE_POINTS_MOST visible points are kept. The others,
 * which are seen least, take the light of the most similar visible point kept: near it as seen from
 * the eye, and facing alike.
 */
#ifndef ORL_ANNUAL_VIEWPOINTS_VISIBLE_POINTS_H
#define ORL_ANNUAL_VIEWPOINTS_VISIBLE_POINTS_H

#include <oriel/base/thread_pool.h>

#include "base/sampling/random.h"
#include "scene/geometry/geometry.h"

enum { ORL_VISIBLE_POINTS_MOST = 128, ORL_VISIBLE_POINTS_MOST_CLUSTERS = 1 << 17 };

struct orl_hit_cluster {
    uint64_t key;           /* surface, side and cell */
    struct orl_vec3 point;  /* a randomly chosen hit; relative to the scene's centre */
    struct orl_vec3 facing; /* normal of that hit, unit */
    double importance;      /* sum over its hits */
    uint32_t selected;      /* set by choosing: index of the visible point whose light it takes */
};

struct orl_visible_point {
    struct orl_vec3 point, facing; /* relative to the scene's centre; facing is unit */
};

struct orl_visible_points {
    struct orl_vec3 eye;
    struct orl_hit_cluster *found;
    uint32_t *slots; /* hash table by name: index in found, plus one */
    size_t n_found, n_slots;
    uint32_t *selected;                /* indices in found of the visible points that are sensors */
    struct orl_visible_point *sensors; /* the kept visible points */
    size_t n_selected;
};

int orl_visible_points_init(struct orl_visible_points *visible_points, struct orl_vec3 eye);
void orl_visible_points_done(struct orl_visible_points *visible_points);

/* Finds or adds the visible point of a hit. importance: solid angle times the share of light that
 * it sends. Returns 0 or ORL_ERR_NOMEM. */
int orl_visible_points_add(struct orl_visible_points *visible_points, const struct orl_hit *hit,
                           double importance, struct orl_random *random, uint32_t *ret_found);
/* Chooses the visible points to keep. Returns 0, ORL_ERR_NOMEM or _CANCELLED. */
int orl_visible_points_choose(struct orl_visible_points *visible_points,
                              const struct orl_thread_pool *pool);
/* Frees everything except the kept visible points. */
void orl_visible_points_trim(struct orl_visible_points *visible_points);

#endif
