/* Views and films: rays through pixels, images in memory, and Radiance HDR files. */
#ifndef ORL_RENDER_FILM_FILM_H
#define ORL_RENDER_FILM_FILM_H

#include <stdbool.h>
#include <stdint.h>

#include <oriel/base/error.h>
#include <oriel/base/input_checks.h>
#include <oriel/base/vec.h>

/*
 * Views as Radiance defines them: -vt v (perspective), l (parallel), a (angular fisheye), h
 * (hemispherical fisheye), s (planispheric fisheye: stereographic) and c (cylindrical panorama),
 * with -vp -vd -vu -vh -vv -vs -vl -vo -va; and rpict's -x -y -pa -bv beside them.
 *
 * Image coordinates: x from the left, y from the bottom, both 0..1.
 */
struct orl_view {
    char type;                            /* 'v', 'l', 'a', 'h', 's' or 'c' */
    struct orl_vec3 point, direction, up; /* direction is unit */
    double horizontal, vertical;          /* degrees; scene units for 'l' */
    double shift, lift, fore, aft;
    /* Image axes, scaled to the image's extent; not scaled for 'a', nor h for 'c'. */
    struct orl_vec3 h, v;
    uint32_t x, y;       /* requested pixels; 0: none given */
    double pixel_aspect; /* requested aspect; 0: none given */
    bool backs_unseen;   /* -bv-: rays ignore backs of opaque surfaces */
};

/* Parses "-vtv -vp 0 0 0 ..."; a leading VIEW=, rpict, rvu or rview is skipped. */
int orl_view_parse(const char *text, struct orl_view *ret_view, struct orl_error *err);

/* Returns the ray through (x, y), with a unit direction; false if the view shows nothing there. */
bool orl_view_ray(const struct orl_view *view, double x, double y, struct orl_vec3 *ret_origin,
                  struct orl_vec3 *ret_direction);

/* Returns the distance along the ray through (x, y) at which -va clips it, or INFINITY. */
double orl_view_clip_distance(const struct orl_view *view, double x, double y);

/* Returns the image coordinates of a unit direction for views of the types v, h and a. Returns
 * false if it is outside the view, and for other types. */
bool orl_view_project(const struct orl_view *view, struct orl_vec3 direction, double *ret_x,
                      double *ret_y);

/* Returns the solid angle of a rectangle of the image, given by its lower left corner: that of the
 * two triangles between its corners. Returns 0 if the view shows nothing at a corner. */
double orl_view_solid_angle(const struct orl_view *view, double x, double y, double width,
                            double height);

/* Formats the whole view as options for a VIEW= line, with every parameter. */
void orl_view_format(const struct orl_view *view, char *ret_text, unsigned long size);

/* Returns pixel height over pixel width in an image of that size; 1 is square. */
double orl_view_pixel_aspect(const struct orl_view *view, unsigned width, unsigned height);

/* Reduces one side of an image so that its pixels have that aspect, as rpict does. */
void orl_view_fit(const struct orl_view *view, double pixel_aspect, uint32_t *width,
                  uint32_t *height);

/*
 * Images and their files.
 *
 * HDR files are Radiance's: RGBE, run-length encoded by component, scanlines from the top, the
 * whole VIEW line, so that its tools (and evalglare) read them. Values are W/sr/m2 per channel, no
 * exposure. render/picture makes tone-mapped pictures.
 *
 * A pixel also has the standard error of its luma; render/picture/false_color.h defines and writes
 * it.
 */

struct orl_film {
    uint32_t width, height;
    float (*pixels)[3]; /* from the top left, row by row; owned */
    float *errors;      /* standard errors of their luma, W/sr/m2; NaN: unknown; owned */
};

int orl_film_init(struct orl_film *film, uint32_t width, uint32_t height, struct orl_error *err);
void orl_film_done(struct orl_film *film);

/* A technique's result for a pixel. */
struct orl_pixel {
    struct orl_rgb value;
    double standard_error; /* standard error of its luma; NaN: unknown */
};

/* Sets a pixel. A colour that is no finite float becomes black and is counted. */
void orl_film_set(struct orl_film *film, uint32_t x, uint32_t y, const struct orl_pixel *pixel,
                  struct orl_health *health);

/* Returns true if the errors of all pixels are known. */
bool orl_film_has_errors(const struct orl_film *film);

/* Writes to path.part, then sync and rename, so that the file is complete or absent. */
int orl_film_write_hdr(const struct orl_film *film, const struct orl_view *view, const char *path,
                       struct orl_error *err);

/* Encodes one pixel as RGBE; non-finite and negative parts become zero. */
void orl_rgbe_encode(const float rgb[3], unsigned char ret_rgbe[4]);

#endif
