/*
 * Places of surfaces that a seat sees, as sensors of a year: those that fall into one cell of
 * directions from the eye and lie on one side of one surface are one. Beyond
 * ORL_SEAT_MOST_FOUND of these, surfaces that face alike share a place in each cell, so that memory
 * is bounded. Of more than ORL_SEAT_MOST_PLACES the ones that are seen least take the light of
 * those most like them: near each other as the eye sees them, and facing alike.
 */
#ifndef ORL_ANNUAL_SEAT_PLACES_H
#define ORL_ANNUAL_SEAT_PLACES_H

#include <oriel/crew.h>

#include "base/random.h"
#include "scene/geometry/geometry.h"

enum { ORL_SEAT_MOST_PLACES = 128, ORL_SEAT_MOST_FOUND = 1 << 17 };

struct orl_seat_found {
    uint64_t name;          /* surface, side and cell */
    struct orl_vec3 point;  /* of one that was seen, by lot; moved, as scenes have it */
    struct orl_vec3 facing; /* unit */
    double worth;           /* of all */
    uint32_t kept;          /* after choosing: the place whose light it takes */
};

struct orl_seat_place {
    struct orl_vec3 point, facing; /* moved, as scenes have it; unit */
};

struct orl_seat_places {
    struct orl_vec3 eye;
    struct orl_seat_found *found;
    uint32_t *slots; /* by name: where it stands, plus one */
    size_t n_found, n_slots;
    uint32_t *kept;                 /* those that are sensors, of found */
    struct orl_seat_place *sensors; /* these */
    size_t n_kept;
};

int orl_seat_places_init(struct orl_seat_places *places, struct orl_vec3 eye);
void orl_seat_places_done(struct orl_seat_places *places);

/* The place of a hit that is worth so much (solid angle times what it sends). ORL_ERR_NOMEM. */
int orl_seat_places_add(struct orl_seat_places *places, const struct orl_hit *hit, double worth,
                        struct orl_random *random, uint32_t *ret_found);
/* Chooses those to keep. Returns 0, ORL_ERR_NOMEM or _CANCELLED. */
int orl_seat_places_choose(struct orl_seat_places *places, const struct orl_crew *crew);
/* Frees all but those that are kept. */
void orl_seat_places_trim(struct orl_seat_places *places);

#endif
