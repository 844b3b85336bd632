/*
 * Values on grids, which patterns and textures interpolate: Radiance's data files, and pictures.
 *
 * A grid has one to five axes. The points of an axis are spaced evenly from origin to origin +
 * size, or lie at given coordinates in rising or falling order. Interpolation is multilinear.
 * Beyond the ends values are extrapolated for one more interval. Then they fall off to zero as the
 * inverse of the distance, as in Radiance (calcomp's datavalue).
 *
 * The first axis of a picture points up from the bottom, the second to the right. The shorter side
 * is 1 long, by the pixels' aspect; the centres of the outermost pixels lie at the ends. Values are
 * those of the file without its EXPOSURE, as in Radiance.
 * Formats: Radiance's RGBE and spectra. Radiance does not read the others:
 *   PNG (decoded to linear light as the file says, by default sRGB; transparent pixels over black),
 *   TIFF (as PNG; floats and LogLuv unchanged),
 *   OpenEXR (scan lines, channels R G B, or Y).
 *
 * Input is untrusted: sizes are bounded before memory is allocated. Units: the file's.
 * Ownership: a grid owns all its memory. Threads: immutable once read.
 * Reference: "Radiance File Formats", data files.
 */
#ifndef ORL_SCENE_GRID_GRID_H
#define ORL_SCENE_GRID_GRID_H

#include <stddef.h>
#include <stdint.h>

#include <oriel/base/error.h>

enum { ORL_GRID_AXES = 5, ORL_GRID_CHANNELS = 3 };
#define ORL_GRID_VALUES (48UL << 20) /* limit of one grid, over all channels */

struct orl_grid_axis {
    double origin, size; /* size is not 0 */
    uint32_t n;          /* at least 2 */
    double *places;      /* NULL: evenly spaced */
};

struct orl_grid {
    struct orl_grid_axis axes[ORL_GRID_AXES];
    uint32_t n_axes, channels; /* channels: 1, or 3 for pictures */
    float *values;             /* channels change fastest, then the last axis */
    size_t n_values;
    size_t source; /* index of its file among the scene's; set by the reader */
};

/* Reads a data file, a luminaire's file (ies.h), or a picture of spectra. Returns 0, ORL_ERR_SYNTAX
 * with file and line, ORL_ERR_LIMIT or _NOMEM. */
int orl_grid_read_data(const char *name, const char *text, size_t size, struct orl_grid **ret_grid,
                       struct orl_error *err);

/* Reads a picture, whose format its first bytes identify. Returns 0, ORL_ERR_SYNTAX, _UNSUPPORTED,
 * _LIMIT or _NOMEM. */
int orl_grid_read_picture(const char *name, const void *data, size_t size,
                          struct orl_grid **ret_grid, struct orl_error *err);

/* Creates a grid of zeros without axes; NULL if out of memory. */
struct orl_grid *orl_grid_new(size_t n_values, uint32_t channels);

/* Creates an empty picture, checked against limits. aspect: height by width of a pixel. */
int orl_grid_new_picture(const char *name, uint32_t width, uint32_t height, double aspect,
                         struct orl_grid **ret_grid, struct orl_error *err);
/* Returns the values of a pixel; x counts from the left, y from the top. */
float *orl_grid_pixel(struct orl_grid *grid, uint32_t x, uint32_t y);

/* Fills err with what is wrong with a picture. Returns code. */
int orl_grid_fail(const char *name, int code, struct orl_error *err, const char *what);

/* picture_png.c, picture_exr.c, picture_tiff.c. */
double orl_linear_of_srgb(double value); /* IEC 61966-2-1; picture_png.c */
void orl_linear_of_srgb_bytes(float ret_linear[256]);
int orl_grid_read_png(const char *name, const void *data, size_t size, struct orl_grid **ret_grid,
                      struct orl_error *err);
int orl_grid_read_exr(const char *name, const void *data, size_t size, struct orl_grid **ret_grid,
                      struct orl_error *err);
int orl_grid_read_tiff(const char *name, const void *data, size_t size, struct orl_grid **ret_grid,
                       struct orl_error *err);

/* picture.c: reads a picture of spectra as a grid of one channel. Axes: to the right, up,
 * wavelength in nm. */
int orl_grid_read_spectra(const char *name, const void *data, size_t size,
                          struct orl_grid **ret_grid, struct orl_error *err);

void orl_grid_free(struct orl_grid *grid); /* NULL is allowed */
size_t orl_grid_bytes(const struct orl_grid *grid);

/* Interpolates all channels at a place, which has one coordinate per axis. */
void orl_grid_at(const struct orl_grid *grid, const double *place,
                 double ret_values[ORL_GRID_CHANNELS]);

#endif
