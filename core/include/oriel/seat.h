/* Seats: where people sit, with what name, and in which direction they look. */
#ifndef ORIEL_SEAT_H
#define ORIEL_SEAT_H

#include <stddef.h>

#include <oriel/vec.h>

struct orl_seat {
    char *name;                  /* owned */
    struct orl_vec3 at, towards; /* scene units; not unit */
};

/* Seats of a wish; and those whose views are in memory together (annual/seats.c). */
enum { ORL_GLARE_MOST_SEATS = 256, ORL_GLARE_SEATS_AT_ONCE = 4 };
struct orl_seats_wish {
    struct orl_seat *seats; /* owned; none: glare is not asked for */
    size_t n_seats;
};
void orl_seats_wish_done(struct orl_seats_wish *wish); /* zeros are fine */

#endif
