/*
 * The field of view: what each pixel of a picture covers of the hemisphere before an eye.
 *
 * Made once for a view and a line of sight, and read for every picture of it. A pixel counts where
 * its middle lies before the eye and all its corners see something; its solid angle is that of the
 * two spherical triangles between its corners (van Oosterom and Strackee 1983). Parallel views have
 * no eye.
 *
 * Axes: the eye's own, x to the right, y up, z along the line of sight; unit vectors.
 * Pixels are counted from the top left, row by row, as in films.
 */
#ifndef ORL_METRICS_FIELD_H
#define ORL_METRICS_FIELD_H

#include <stddef.h>
#include <stdint.h>

#include <oriel/error.h>
#include <oriel/vec.h>

#include "render/film/view.h"

struct orl_field {
    uint32_t width, height;
    struct orl_view view;
    struct orl_frame eye;      /* u to the right, v up, n along the line of sight */
    float (*direction)[3];     /* of a pixel's middle; owned */
    float *solid_angle;        /* 0: it does not count; owned */
    double all_sr, all_cos_sr; /* of all that count; the second weighted by cosines */
};

/* turned_deg: of the line of sight from the view's, about its up, to the left. ORL_ERR_UNSUPPORTED:
 * a parallel view; ORL_ERR_NOMEM. orl_field_done in either case. */
int orl_field_init(struct orl_field *field, const struct orl_view *view, uint32_t width,
                   uint32_t height, double turned_deg, struct orl_error *err);
void orl_field_done(struct orl_field *field);

static inline struct orl_vec3 orl_field_direction(const struct orl_field *field, size_t pixel)
{
    const float *d = field->direction[pixel];
    return orl_v3((double)d[0], (double)d[1], (double)d[2]);
}

/* To a place of the picture, in pixels from its left and its upper edge; where the view sees
 * nothing there, along the line of sight. */
struct orl_vec3 orl_field_towards(const struct orl_field *field, double x, double y);

#endif
