/* Tone mapping for display: foveal samples, histogram adjustment, blur to visual acuity, and the
 * pictures themselves. */
#ifndef ORL_RENDER_PICTURE_DISPLAY_H
#define ORL_RENDER_PICTURE_DISPLAY_H

#include <stdbool.h>

#include <oriel/job/picture.h>

#include "render/film/film.h"

/*
 * Foveal samples of a film: averages over a degree, the size of the fovea. They give the adaptation
 * luminance and the veiling luminance by light scattered in the eye.
 *
 * Ward Larson, Rushmeier and Piatko 1997, "A visibility matching tone reproduction operator for
 * high dynamic range scenes" (IEEE TVCG 3, 4), sections 3.1 and 4.2; the weight of scattered light
 * is that of Moon and Spencer 1945.
 *
 * In views wider than ORL_FOVEA_SIDE degrees a sample covers more than one degree.
 */

enum { ORL_FOVEA_SIDE = 120 };

struct orl_fovea {
    uint32_t width, height;
    float (*pixels)[3];  /* from the top left, row by row, W/sr/m2; owned */
    float (*veiling)[3]; /* veiling luminance, W/sr/m2; NULL: not requested; owned */
};

/* Makes the samples. Returns 0 or ORL_ERR_NOMEM; call orl_fovea_done in either case. */
int orl_fovea_init(struct orl_fovea *fovea, const struct orl_film *film,
                   const struct orl_view *view);
void orl_fovea_done(struct orl_fovea *fovea);

/* Computes the veiling luminance and mixes it into the samples as orl_fovea_mix_veiling does.
 * Returns 0 or ORL_ERR_NOMEM. */
int orl_fovea_add_veiling(struct orl_fovea *fovea, const struct orl_view *view);

/* Adds the veiling luminance to a pixel of the film; x and y as shares of the picture, 0..1 from
 * the top left. */
void orl_fovea_mix_veiling(const struct orl_fovea *fovea, double x, double y, float rgb[3]);

/* Interpolates the samples at a place. */
void orl_fovea_at(const struct orl_fovea *fovea, double x, double y, float ret_rgb[3]);

/* Returns a view's width and height in degrees, at its centre. A parallel one counts as 40 degrees
 * wide. */
void orl_view_degrees(const struct orl_view *view, double *ret_width, double *ret_height);

/*
 * Tone mapping by histogram adjustment, which keeps the visibility of contrasts as in the real
 * scene.
 *
 * The ceiling of the histogram is human contrast sensitivity: Ward Larson, Rushmeier and Piatko
 * 1997, sections 3 and 4.1, with the thresholds of Ferwerda, Pattanaik, Shirley and Greenberg 1996.
 * The display has a range of 100 to 1, up to 100 cd/m2. If the scene's range is no larger, or
 * nothing must be trimmed, the mapping is linear.
 *
 * The histogram is in logarithms of luminance. Foveal samples and pixels enter with equal total
 * weight, so that small bright things are represented.
 */

enum { ORL_TONEMAP_BINS = 100 };

struct orl_tonemap {
    double factor;    /* factor of luminance; if above 0 the mapping is linear */
    double low, high; /* range of the bins, logarithms of luminance in cd/m2 */
    /* Share of the display's range, logarithmic, below each bin. */
    double share[ORL_TONEMAP_BINS + 1];
};

void orl_tonemap_make(struct orl_tonemap *tonemap, const struct orl_film *film,
                      const struct orl_fovea *fovea);

/*
 * A histogram shared by several pictures, so that equal luminances look alike. Every picture is
 * read twice: by orl_tonemap_histogram_extend for the range and by orl_tonemap_histogram_add for
 * the bins. Zero at first.
 */
struct orl_tonemap_histogram {
    double least, most; /* range of luminance, valid if any */
    bool any;
    double low, high, bins[ORL_TONEMAP_BINS], total, sum; /* sum: of logarithms */
};
void orl_tonemap_histogram_extend(struct orl_tonemap_histogram *histogram,
                                  const struct orl_film *film, const struct orl_fovea *fovea);
void orl_tonemap_histogram_add(struct orl_tonemap_histogram *histogram, const struct orl_film *film,
                               const struct orl_fovea *fovea);
/* Sets the range after orl_tonemap_histogram_extend and before orl_tonemap_histogram_add. Returns
 * false if there is nothing to count. */
bool orl_tonemap_histogram_range(struct orl_tonemap_histogram *histogram);
void orl_tonemap_from_histogram(struct orl_tonemap *tonemap,
                                struct orl_tonemap_histogram *histogram);

/* Returns the display value of a luminance, cd/m2: 0 is its black, 1 its white; a linear mapping
 * may exceed 1. */
double orl_tonemap_apply(const struct orl_tonemap *tonemap, double luminance);

/* Returns the luminance of a pixel, cd/m2; 0 if it is not finite or negative. */
double orl_luminance(const float rgb[3]);

/* Returns the threshold luminance difference for eyes adapted to a luminance; both cd/m2. */
double orl_visible_difference(double luminance);

/* Returns the finest visible pattern for eyes adapted to a luminance, cycles per degree: Shlaer's
 * data of 1937, fitted as in the paper. */
double orl_acuity(double luminance);

/*
 * Blurs a film to visual acuity, which falls with luminance (Ward Larson, Rushmeier and Piatko
 * 1997, section 4.4). Each pixel is interpolated between averages over 1, 2, 4 ... pixels: the two
 * sizes next to the acuity of eyes adapted to the light about it.
 */

enum { ORL_ACUITY_LEVELS = 8 };

struct orl_blur {
    const struct orl_film *film; /* borrowed */
    double pixels_a_degree;
    struct {
        uint32_t width, height;
        float (*pixels)[3]; /* level 0: the film's own; others: owned */
    } levels[ORL_ACUITY_LEVELS];
    int n_levels;
};

/* Builds the levels. Returns 0 or ORL_ERR_NOMEM; call orl_blur_done in either case. */
int orl_blur_init(struct orl_blur *blur, const struct orl_film *film, const struct orl_view *view);
void orl_blur_done(struct orl_blur *blur);

/* Returns a blurred pixel, for the adaptation luminance about it. */
void orl_blur_at(const struct orl_blur *blur, const struct orl_fovea *fovea, uint32_t x, uint32_t y,
                 float ret_rgb[3]);

/*
 * Tone-mapped pictures: a film's radiances converted for a display (methods: oriel/job/picture.h),
 * and written as PNG.
 *
 * Colours keep their hue: a colour outside the display's gamut, with a channel above 1, is mixed
 * with gray of its own brightness until it fits. RGB keeps the film's primaries.
 */

struct orl_tonemapped {
    const struct orl_film *film; /* borrowed */
    struct orl_display how;
    struct orl_fovea fovea; /* only for tone "human", like the next two */
    struct orl_tonemap tonemap;
    struct orl_blur blur;
    double factor; /* for the other tones: factor of luminance, cd/m2 */
};

/* Analyses the film. Returns 0 or ORL_ERR_NOMEM; call orl_tonemapped_done in either case. */
int orl_tonemapped_init(struct orl_tonemapped *tonemapped, const struct orl_film *film,
                        const struct orl_view *view, const struct orl_display *how);
void orl_tonemapped_done(struct orl_tonemapped *tonemapped);

/*
 * A tone mapping shared by several films for comparison, so that equal luminances look alike. Every
 * film is passed to orl_shared_tonemap_add, and once more if orl_shared_tonemap_range returns true.
 * Zero at first, except `how`.
 */
struct orl_shared_tonemap {
    struct orl_display how;
    struct orl_tonemap_histogram histogram;
    double sum, lit; /* sum of logarithms, and number of them */
    bool ranged;
    struct orl_tonemap tonemap;
    double factor;
};
/* Adds a film; again: second pass. Returns 0 or ORL_ERR_NOMEM. */
int orl_shared_tonemap_add(struct orl_shared_tonemap *shared_tonemap, const struct orl_film *film,
                           const struct orl_view *view, bool again);
bool orl_shared_tonemap_range(struct orl_shared_tonemap *shared_tonemap);
void orl_shared_tonemap_finish(struct orl_shared_tonemap *shared_tonemap);
/* Like orl_tonemapped_init, with the shared tone mapping. */
int orl_tonemapped_init_shared(struct orl_tonemapped *tonemapped, const struct orl_film *film,
                               const struct orl_view *view,
                               const struct orl_shared_tonemap *shared_tonemap);

/* Returns the displayed colour of a pixel: 0 to 1 a channel, linear. */
void orl_tonemapped_pixel(const struct orl_tonemapped *tonemapped, uint32_t x, uint32_t y,
                          float ret_rgb[3]);

/* Encodes by sRGB's curve (IEC 61966-2-1); white: the value of white, 255 or 65535. */
uint16_t orl_srgb(double linear, uint16_t white);

/* Returns the picture as bytes, three a pixel, from the top left, row by row. */
void orl_tonemapped_bytes(const struct orl_tonemapped *tonemapped, unsigned char *ret_rgb);

/* Writes a PNG of 8 or 16 bits a channel. Returns 0, ORL_ERR_NOMEM or ORL_ERR_IO. */
int orl_tonemapped_write_png(const struct orl_tonemapped *tonemapped, int bits, const char *path,
                             struct orl_error *err);

#endif
