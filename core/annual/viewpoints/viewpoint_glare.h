/*
 * Glare of a viewpoint by hour. Each hour has a picture with its glare sources; the sun's disc and
 * its mirror images are added. DGP uses the vertical illuminance of a sensor at the eye.
 */
#ifndef ORL_ANNUAL_VIEWPOINTS_VIEWPOINT_GLARE_H
#define ORL_ANNUAL_VIEWPOINTS_VIEWPOINT_GLARE_H

#include "annual/viewpoints/viewpoint_image.h"
#include "annual/year/annual_year.h"

/* Light of a year by column; borrowed. */
struct orl_viewpoint_light {
    const struct orl_year *year;
    const unsigned char *wanted;               /* by column */
    const float *eye, *eye_direct, *eye_error; /* lx, by column */
    /* [place of the view][two][column], lx: without direct sunlight, and all. */
    const float *visible_points;
};

/* Rates all wanted columns. ret has room for the year's columns. Returns 0, ORL_ERR_NOMEM or
 * ORL_ERR_CANCELLED. */
int orl_viewpoint_glare_compute(const struct orl_viewpoint_image *view,
                                const struct orl_viewpoint_light *light,
                                const struct orl_viewpoint_hours *ret);

#endif
