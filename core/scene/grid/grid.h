/*
 * Values on grids, which patterns and textures interpolate: Radiance's data files, and pictures.
 *
 * A grid has one to five axes. Along each its points are spaced evenly from origin to origin +
 * size, or lie where the file says, in falling or rising order. Between points values are linear in
 * each coordinate; beyond the ends they go on as far as one more interval would, and from there
 * fall off to zero as the inverse of the distance, as Radiance has it (calcomp's datavalue).
 *
 * Of a picture the first axis is upwards, from the bottom, the second to the right. The shorter
 * side is 1 long, by the pixels' aspect, and the outermost pixels' middles lie at the ends. Values
 * are what the file holds, without its EXPOSURE, as Radiance takes them. Pictures may be Radiance's
 * RGBE, or, which Radiance does not know, PNG (decoded to linear light by what the file says of
 * itself, sRGB where it says nothing; what is transparent over black), TIFF (the same; floats and
 * LogLuv as they are) and OpenEXR (scan lines, channels R G B, or Y).
 *
 * Bytes may be anybody's: sizes are bounded before memory is asked for. Units: the file's.
 * Ownership: a grid holds all that it needs. Threads: immutable once read.
 * Reference: "Radiance File Formats", data files.
 */
#ifndef ORL_SCENE_GRID_GRID_H
#define ORL_SCENE_GRID_GRID_H

#include <stddef.h>
#include <stdint.h>

#include <oriel/error.h>

enum { ORL_GRID_AXES = 5, ORL_GRID_CHANNELS = 3 };
#define ORL_GRID_VALUES (48UL << 20) /* of one grid, all channels counted */

struct orl_grid_axis {
    double origin, size; /* size is not 0 */
    uint32_t n;          /* at least 2 */
    double *places;      /* NULL: even */
};

struct orl_grid {
    struct orl_grid_axis axes[ORL_GRID_AXES];
    uint32_t n_axes, channels; /* channels: 1, or 3 of pictures */
    float *values;             /* channels change fastest, then the last axis */
    size_t n_values;
    size_t source; /* which of the scene's files it is; its reader's */
};

/* A data file, a luminaire's (ies.h), or a picture of spectra. ORL_ERR_SYNTAX, with file and line;
 * ORL_ERR_LIMIT, _NOMEM.
 */
int orl_grid_read_data(const char *name, const char *text, size_t size, struct orl_grid **ret_grid,
                       struct orl_error *err);

/* A picture, of the kind that its first bytes tell. ORL_ERR_SYNTAX, _UNSUPPORTED, _LIMIT, _NOMEM.
 */
int orl_grid_read_picture(const char *name, const void *data, size_t size,
                          struct orl_grid **ret_grid, struct orl_error *err);

/* An empty picture of that size, pixels of that aspect (height by width), checked against limits.
 */
int orl_grid_new_picture(const char *name, uint32_t width, uint32_t height, double aspect,
                         struct orl_grid **ret_grid, struct orl_error *err);
/* The values of a pixel: from the left, from the top. */
float *orl_grid_pixel(struct orl_grid *grid, uint32_t x, uint32_t y);

/* picture_png.c, picture_exr.c, picture_tiff.c. */
double orl_linear_of_srgb(double value); /* IEC 61966-2-1; picture_png.c */
int orl_grid_read_png(const char *name, const void *data, size_t size, struct orl_grid **ret_grid,
                      struct orl_error *err);
int orl_grid_read_exr(const char *name, const void *data, size_t size, struct orl_grid **ret_grid,
                      struct orl_error *err);
int orl_grid_read_tiff(const char *name, const void *data, size_t size, struct orl_grid **ret_grid,
                       struct orl_error *err);

/* picture_spectra.c: a picture of spectra, as a grid of one channel: to the right, upwards, by
 * wavelength in nm. */
int orl_grid_read_spectra(const char *name, const void *data, size_t size,
                          struct orl_grid **ret_grid, struct orl_error *err);

void orl_grid_free(struct orl_grid *grid); /* NULL is allowed */
size_t orl_grid_bytes(const struct orl_grid *grid);

/* The values of all channels at a place: a coordinate for each axis. */
void orl_grid_at(const struct orl_grid *grid, const double *place,
                 double ret_values[ORL_GRID_CHANNELS]);

#endif
