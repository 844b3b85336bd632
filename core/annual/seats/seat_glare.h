/*
 * Glare of a seat by hour. Each hour has a picture with its glare sources; the sun's disc and its
 * mirror images are added. DGP uses the vertical illuminance of a sensor at the eye.
 */
#ifndef ORL_ANNUAL_SEATS_SEAT_GLARE_H
#define ORL_ANNUAL_SEATS_SEAT_GLARE_H

#include "annual/seats/seat_view.h"
#include "annual/year/annual_year.h"

/* Light of a year by column; borrowed. */
struct orl_seat_light {
    const struct orl_year *year;
    const unsigned char *wanted;               /* by column */
    const float *eye, *eye_direct, *eye_error; /* lx, by column */
    /* [place of the view][two][column], lx: without direct sunlight, and all. */
    const float *places;
};

/* Rates all wanted columns. ret has room for the year's columns. Returns 0, ORL_ERR_NOMEM or
 * ORL_ERR_CANCELLED. */
int orl_seat_glare_find(const struct orl_seat_view *view, const struct orl_seat_light *light,
                        const struct orl_seat_hours *ret);

#endif
