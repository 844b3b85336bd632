/*
 * Views as Radiance defines them: -vt v (perspective), l (parallel), a (angular fisheye), h
 * (hemispherical fisheye), s (planispheric fisheye: stereographic) and c (cylindrical panorama),
 * with -vp -vd -vu -vh -vv -vs -vl -vo -va; and rpict's -x -y -pa -bv beside them.
 *
 * Image coordinates: x from the left, y from the bottom, both 0..1.
 */
#ifndef ORL_RENDER_FILM_VIEW_H
#define ORL_RENDER_FILM_VIEW_H

#include <stdbool.h>
#include <stdint.h>

#include <oriel/error.h>
#include <oriel/vec.h>

struct orl_view {
    char type;                            /* 'v', 'l', 'a', 'h', 's' or 'c' */
    struct orl_vec3 point, direction, up; /* direction is unit */
    double horizontal, vertical;          /* degrees; scene units for 'l' */
    double shift, lift, fore, aft;
    struct orl_vec3 h, v; /* image axes, scaled to the image's extent, but for 'a' and of 'c' h */
    uint32_t x, y;        /* pixels asked for; 0: not said */
    double pixel_aspect;  /* likewise */
    bool backs_unseen;    /* -bv-: backs of opaque surfaces are not there for its rays */
};

/* Parses "-vtv -vp 0 0 0 ..."; a leading VIEW=, rpict, rvu or rview is passed over. */
int orl_view_parse(const char *text, struct orl_view *ret_view, struct orl_error *err);

/* The ray through (x, y), false where the view sees nothing. ret_direction is unit. */
bool orl_view_ray(const struct orl_view *view, double x, double y, struct orl_vec3 *ret_origin,
                  struct orl_vec3 *ret_direction);

/* How far the ray through (x, y) goes until it is cut off by -va; INFINITY: for ever. */
double orl_view_reach(const struct orl_view *view, double x, double y);

/* Where a view of the types v, h and a has a unit direction; false where it has not, and of others.
 */
bool orl_view_place(const struct orl_view *view, struct orl_vec3 direction, double *ret_x,
                    double *ret_y);

/* Solid angle of a rectangle of the image, from its lower left corner: that of the two triangles
 * between its corners. 0 where a corner sees nothing. */
double orl_view_solid_angle(const struct orl_view *view, double x, double y, double width,
                            double height);

/* The whole view as options, for a VIEW= line: every parameter written out. */
void orl_view_format(const struct orl_view *view, char *ret_text, unsigned long size);

/* Pixel height over pixel width in an image of that size; 1 is square. */
double orl_view_pixel_aspect(const struct orl_view *view, unsigned width, unsigned height);

/* Makes one side of an image smaller so that its pixels have that aspect, as rpict does. */
void orl_view_fit(const struct orl_view *view, double pixel_aspect, uint32_t *width,
                  uint32_t *height);

#endif
