/*
 * Tone-mapped pictures: a film's radiances converted for a display (methods: oriel/job/picture.h),
 * and written as PNG.
 *
 * Colours keep their hue: a colour outside the display's gamut, with a channel above 1, is mixed
 * with gray of its own brightness until it fits. RGB keeps the film's primaries.
 */
#ifndef ORL_RENDER_PICTURE_DISPLAY_H
#define ORL_RENDER_PICTURE_DISPLAY_H

#include <oriel/job/picture.h>

#include "render/picture/acuity.h"
#include "render/picture/tonemap_ward_larson.h"

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
