/* Seats: named positions of people with their view directions. */
#ifndef ORIEL_SEAT_H
#define ORIEL_SEAT_H

#include <stddef.h>

#include <oriel/vec.h>

struct orl_seat {
    char *name;                  /* owned */
    struct orl_vec3 at, towards; /* scene units; `towards` need not be unit */
};

/* Most seats in a request; and seats whose views are in memory together (annual/seats/seats.c). */
enum { ORL_GLARE_MOST_SEATS = 256, ORL_GLARE_SEATS_AT_ONCE = 4 };
struct orl_seats_wish {
    struct orl_seat *seats; /* owned; none: no glare is computed */
    size_t n_seats;
};
void orl_seats_wish_done(struct orl_seats_wish *wish); /* zeros are fine */

#endif
