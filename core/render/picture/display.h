/*
 * Tone-mapped pictures: a film's radiances converted for a display (methods: oriel/picture.h), and
 * written as PNG.
 *
 * Colours keep their hue: a colour outside the display's gamut, with a channel above 1, is mixed
 * with gray of its own brightness until it fits. RGB keeps the film's primaries.
 */
#ifndef ORL_RENDER_PICTURE_DISPLAY_H
#define ORL_RENDER_PICTURE_DISPLAY_H

#include <oriel/picture.h>

#include "render/picture/acuity.h"
#include "render/picture/human.h"

struct orl_shown {
    const struct orl_film *film; /* borrowed */
    struct orl_display how;
    struct orl_fovea fovea; /* only for tone "human", like the next two */
    struct orl_human human;
    struct orl_blur blur;
    double factor; /* for the other tones: factor of luminance, cd/m2 */
};

/* Analyses the film. Returns 0 or ORL_ERR_NOMEM; call orl_shown_done in either case. */
int orl_shown_init(struct orl_shown *shown, const struct orl_film *film,
                   const struct orl_view *view, const struct orl_display *how);
void orl_shown_done(struct orl_shown *shown);

/*
 * A tone mapping shared by several films for comparison, so that equal luminances look alike. Every
 * film is passed to orl_common_look, and once more if orl_common_range returns true. Zero at first,
 * except `how`.
 */
struct orl_common {
    struct orl_display how;
    struct orl_human_tally tally;
    double sum, lit; /* sum of logarithms, and number of them */
    bool ranged;
    struct orl_human human;
    double factor;
};
/* Adds a film; again: second pass. Returns 0 or ORL_ERR_NOMEM. */
int orl_common_look(struct orl_common *common, const struct orl_film *film,
                    const struct orl_view *view, bool again);
bool orl_common_range(struct orl_common *common);
void orl_common_settle(struct orl_common *common);
/* Like orl_shown_init, with the shared tone mapping. */
int orl_shown_init_in_common(struct orl_shown *shown, const struct orl_film *film,
                             const struct orl_view *view, const struct orl_common *common);

/* Returns the displayed colour of a pixel: 0 to 1 a channel, linear. */
void orl_shown_pixel(const struct orl_shown *shown, uint32_t x, uint32_t y, float ret_rgb[3]);

/* Encodes by sRGB's curve (IEC 61966-2-1); white: the value of white, 255 or 65535. */
uint16_t orl_srgb(double linear, uint16_t white);

/* Returns the picture as bytes, three a pixel, from the top left, row by row. */
void orl_shown_bytes(const struct orl_shown *shown, unsigned char *ret_rgb);

/* Writes a PNG of 8 or 16 bits a channel. Returns 0, ORL_ERR_NOMEM or ORL_ERR_IO. */
int orl_shown_write_png(const struct orl_shown *shown, int bits, const char *path,
                        struct orl_error *err);

#endif
