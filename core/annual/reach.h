/*
 * Which sensors the light of a part of the windows can reach (parts.h). Rooms that share no opening
 * with those windows stay dark, and no path need be traced there.
 *
 * Surfaces are flooded from the windows' inner sides: rays leave points of each side that is
 * reached, and reach the sides that they meet, on both sides where these let light through. A
 * sensor is reached if it sees a point of a window, or a side that is reached. What rays of all
 * surfaces on the way have missed is an opening of a few thousandths of their view: the light
 * through it is below what the paths of a sensor resolve.
 *
 * Depends on the scene alone. Immutable once made.
 */
#ifndef ORL_ANNUAL_REACH_H
#define ORL_ANNUAL_REACH_H

#include "light/world.h"
#include "render/gather/gather.h"

struct orl_reach {
    const struct orl_world *world; /* borrowed */
    bool *sides;                   /* [facet][front, back] */
    bool all;                      /* the scene has objects placed several times: no limits */
};

/* Floods the rooms from the part's ports, which are the world's. Returns 0, ORL_ERR_NOMEM or, where
 * the crew's cancellation is set, ORL_ERR_CANCELLED; orl_reach_done in either case. */
int orl_reach_init(struct orl_reach *reach, const struct orl_world *world,
                   const atomic_bool *cancel);
void orl_reach_done(struct orl_reach *reach);

bool orl_reach_has(const struct orl_reach *reach, const struct orl_place *place);

#endif
