/* Glare sources in a picture: the field of view, groups of pixels, the sources and their
 * smoothing. */
#ifndef ORL_METRICS_GLARE_SOURCES_H
#define ORL_METRICS_GLARE_SOURCES_H

#include <stdatomic.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <oriel/base/error.h>
#include <oriel/base/vec.h>
#include <oriel/job/glare.h>

#include "render/film/film.h"

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

struct orl_view_field {
    uint32_t width, height;
    struct orl_view view;
    struct orl_frame eye;  /* u to the right, v up, n along the line of sight */
    float (*direction)[3]; /* direction of a pixel's middle; owned */
    float *solid_angle;    /* sr; 0: the pixel does not count; owned */
    double all_sr;         /* sum over pixels that count */
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

/*
 * Groups pixels by distance: any two pixels of a group are connected by steps of at most some
 * angle, and no two groups are.
 *
 * Neighbours in the picture are joined first. After that only pixels at the edges of groups can
 * connect groups. They are sorted into spatial cubes of the unit sphere, so small that all pixels
 * within one are close. Cubes within reach of each other are searched for a close pair unless they
 * already belong to one group. The cost is that of sorting the edge pixels and of testing pairs in
 * separate cubes, with a bounded number of cubes each: in practice linear.
 */

/*
 * Groups `count` pixels, given in ascending order. ret_group: group of each, from 0 on, in the
 * order of first pixels; ret_groups: number of groups. Returns 0 or ORL_ERR_NOMEM.
 */
int orl_pixels_cluster(const struct orl_view_field *field, const uint32_t *pixels, size_t count,
                       double angle_rad, uint32_t *ret_group, uint32_t *ret_groups);

/*
 * Finds glare sources in a picture. Pixels above a threshold are grouped if the gap between them is
 * at most half the search radius (evalglare's -r is an opening angle, in spite of its manual). With
 * `smooth`, pixels are added if a source fills more than a fifth of a disc around them. Peaks,
 * pixels above a second threshold, are removed from their source and grouped in the same way.
 *
 * A source's position in the picture is the mean of its pixels' positions, weighted by luminance
 * and solid angle. Its position index is that of the direction there. Sources are sorted by their
 * contribution to DGP, largest first; equal ones by their first pixels.
 *
 * The disc for smoothing has the same size in the whole picture: the radius in pixels at the
 * picture's middle, divided by 1.75, as in evalglare. A pixel that two sources claim goes to the
 * one with the larger part of the disc.
 *
 * Reference for the behaviour: Wienold, evalglare's manual (Radiance), versions 2.10 and 3.06.
 */

/* Luminances in cd/m2, one for each pixel of the field. */
struct orl_luminances {
    const struct orl_view_field *field;
    const float *cd_m2;
    const atomic_bool *cancel; /* borrowed; may be NULL */
};

struct orl_glare_source_rule {
    double threshold_cd_m2;
    double radius_rad;
    bool smooth, at_whole_pixels;
    double peak_cd_m2; /* INFINITY: none */
};

/* Finds the sources. Returns 0, ORL_ERR_NOMEM or ORL_ERR_CANCELLED; *ret_sources is owned. */
int orl_glare_sources_find(const struct orl_luminances *picture,
                           const struct orl_glare_source_rule *rule,
                           struct orl_glare_source **ret_sources, size_t *ret_count,
                           struct orl_error *err);

/* Smooths sources: adds pixels that a source surrounds to that source, as described above. label:
 * for each pixel, 0 or a source, from 1 to n_labels. Of the picture only field and cancel
 * are used. cancel is polled per pixel, since a disc may be as wide as the picture. Returns 0,
 * ORL_ERR_NOMEM or ORL_ERR_CANCELLED. */
int orl_glare_sources_smooth(const struct orl_luminances *picture, double radius_rad,
                             uint32_t n_labels, uint32_t *label);

#endif
