/*
 * The glare of a seat, hour by hour: its picture of each, the sources in it, the sun's disc and its
 * images beside them, and DGP by the light at the eye.
 */
#ifndef ORL_ANNUAL_SEAT_GLARE_H
#define ORL_ANNUAL_SEAT_GLARE_H

#include "annual/seat_view.h"
#include "annual/year.h"

/* Of a year's columns; borrowed. */
struct orl_seat_light {
    const struct orl_year *year;
    const unsigned char *wanted;               /* by column */
    const float *eye, *eye_direct, *eye_error; /* lx, by column */
    const float *places; /* [place of the view][two][column], lx: without what comes straight from
                            the sun, and all */
};

/* Rates all columns that are wanted. ret has room for the year's columns. Returns 0, ORL_ERR_NOMEM
 * or ORL_ERR_CANCELLED. */
int orl_seat_glare_find(const struct orl_seat_view *view, const struct orl_seat_light *light,
                        const struct orl_seat_hours *ret);

#endif
