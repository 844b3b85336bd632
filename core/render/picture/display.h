/*
 * Pictures to look at: a film's radiances as what a display is to show (oriel/picture.h says by
 * which ways), and that as PNG.
 *
 * Colours keep their hue: one that no display has, since a channel would be above 1, is mixed with
 * as much gray of its own brightness as it takes. RGB stays with the film's primaries.
 */
#ifndef ORL_RENDER_PICTURE_DISPLAY_H
#define ORL_RENDER_PICTURE_DISPLAY_H

#include <oriel/picture.h>

#include "render/picture/acuity.h"
#include "render/picture/human.h"

struct orl_shown {
    const struct orl_film *film; /* borrowed */
    struct orl_display how;
    struct orl_fovea fovea; /* of the tone "human", as the next two */
    struct orl_human human;
    struct orl_blur blur;
    double factor; /* of the other tones: of luminance, cd/m2 */
};

/* Looks at the film. Returns 0 or ORL_ERR_NOMEM; orl_shown_done in either case. */
int orl_shown_init(struct orl_shown *shown, const struct orl_film *film,
                   const struct orl_view *view, const struct orl_display *how);
void orl_shown_done(struct orl_shown *shown);

/*
 * Of several films that are to be compared: the same luminance looks alike in all of them. Each is
 * looked at, then, where orl_common_range says so, once more; all zero but `how` at first.
 */
struct orl_common {
    struct orl_display how;
    struct orl_human_tally tally;
    double sum, lit; /* of logarithms, and how many */
    bool ranged;
    struct orl_human human;
    double factor;
};
/* Returns 0 or ORL_ERR_NOMEM. */
int orl_common_look(struct orl_common *common, const struct orl_film *film,
                    const struct orl_view *view, bool again);
bool orl_common_range(struct orl_common *common);
void orl_common_settle(struct orl_common *common);
/* In place of orl_shown_init. */
int orl_shown_init_in_common(struct orl_shown *shown, const struct orl_film *film,
                             const struct orl_view *view, const struct orl_common *common);

/* What the display shows of a pixel: 0 to 1 a channel, linear. */
void orl_shown_pixel(const struct orl_shown *shown, uint32_t x, uint32_t y, float ret_rgb[3]);

/* sRGB's curve (IEC 61966-2-1), to so much for white: 255 or 65535. */
uint16_t orl_srgb(double linear, uint16_t white);

/* The picture as bytes, three a pixel, from the top left, row by row. */
void orl_shown_bytes(const struct orl_shown *shown, unsigned char *ret_rgb);

/* As PNG of 8 or 16 bits a channel. Returns 0, ORL_ERR_NOMEM or ORL_ERR_IO. */
int orl_shown_write_png(const struct orl_shown *shown, int bits, const char *path,
                        struct orl_error *err);

#endif
