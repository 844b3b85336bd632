/*
 * Field of view: direction and solid angle of each pixel of a picture in the hemisphere before an
 * eye.
 *
 * It is built once for a view and a line of sight, and used for every picture of the view. A pixel
 * counts if its middle lies before the eye and the view sees something at all its corners. Its
 * solid angle is that of the two spherical triangles between its corners (van Oosterom and Strackee
 * 1983). Parallel views have no eye.
 *
 * Axes: the eye's own, x to the right, y up, z along the line of sight; unit vectors. Pixels are
 * counted from the top left, row by row, as in films.
 */
#ifndef ORL_METRICS_VIEW_FIELD_H
#define ORL_METRICS_VIEW_FIELD_H

#include <stddef.h>
#include <stdint.h>

#include <oriel/base/error.h>
#include <oriel/base/vec.h>

#include "render/film/view.h"

struct orl_view_field {
    uint32_t width, height;
    struct orl_view view;
    struct orl_frame eye;      /* u to the right, v up, n along the line of sight */
    float (*direction)[3];     /* direction of a pixel's middle; owned */
    float *solid_angle;        /* sr; 0: the pixel does not count; owned */
    double all_sr, all_cos_sr; /* sum over pixels that count; the second is weighted by cosines */
};

/* Builds the field. turned_deg: rotation of the line of sight from the view's, about its up, to the
 * left. Returns 0, ORL_ERR_UNSUPPORTED (a parallel view) or ORL_ERR_NOMEM. Call orl_view_field_done
 * in any case. */
int orl_view_field_init(struct orl_view_field *field, const struct orl_view *view, uint32_t width,
                        uint32_t height, double turned_deg, struct orl_error *err);
void orl_view_field_done(struct orl_view_field *field);

static inline struct orl_vec3 orl_view_field_direction(const struct orl_view_field *field,
                                                       size_t pixel)
{
    const float *d = field->direction[pixel];
    return orl_v3((double)d[0], (double)d[1], (double)d[2]);
}

/* Returns the direction of a point of the picture, in pixels from its left and its upper edge. If
 * the view sees nothing there, returns the line of sight. */
struct orl_vec3 orl_view_field_direction_at(const struct orl_view_field *field, double x, double y);

#endif
