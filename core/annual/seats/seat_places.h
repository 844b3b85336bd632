/*
 * Places of surfaces that a seat sees, used as sensors of a year. Hits in one cell of directions
 * from the eye, on one side of one surface, form one place. To bound memory, beyond
 * ORL_SEAT_MOST_FOUND places surfaces with a similar orientation share a place per cell. At most
 * ORL_SEAT_MOST_PLACES places are kept. The others, which are seen least, take the light of the
 * most similar place kept: near it as seen from the eye, and facing alike.
 */
#ifndef ORL_ANNUAL_SEATS_SEAT_PLACES_H
#define ORL_ANNUAL_SEATS_SEAT_PLACES_H

#include <oriel/crew.h>

#include "base/random.h"
#include "scene/geometry/geometry.h"

enum { ORL_SEAT_MOST_PLACES = 128, ORL_SEAT_MOST_FOUND = 1 << 17 };

struct orl_seat_found {
    uint64_t name;          /* surface, side and cell */
    struct orl_vec3 point;  /* a randomly chosen hit; relative to the scene's centre */
    struct orl_vec3 facing; /* normal of that hit, unit */
    double worth;           /* sum over its hits */
    uint32_t kept;          /* set by choosing: index of the place whose light it takes */
};

struct orl_seat_place {
    struct orl_vec3 point, facing; /* relative to the scene's centre; facing is unit */
};

struct orl_seat_places {
    struct orl_vec3 eye;
    struct orl_seat_found *found;
    uint32_t *slots; /* hash table by name: index in found, plus one */
    size_t n_found, n_slots;
    uint32_t *kept;                 /* indices in found of the places that are sensors */
    struct orl_seat_place *sensors; /* the kept places */
    size_t n_kept;
};

int orl_seat_places_init(struct orl_seat_places *places, struct orl_vec3 eye);
void orl_seat_places_done(struct orl_seat_places *places);

/* Finds or adds the place of a hit. worth: solid angle times the share of light that it sends.
 * Returns 0 or ORL_ERR_NOMEM. */
int orl_seat_places_add(struct orl_seat_places *places, const struct orl_hit *hit, double worth,
                        struct orl_random *random, uint32_t *ret_found);
/* Chooses the places to keep. Returns 0, ORL_ERR_NOMEM or _CANCELLED. */
int orl_seat_places_choose(struct orl_seat_places *places, const struct orl_crew *crew);
/* Frees everything except the kept places. */
void orl_seat_places_trim(struct orl_seat_places *places);

#endif
