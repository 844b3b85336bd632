/*
 * Suns and small lamps seen directly, or through panes that do not deflect them. Their light in a
 * picture is their luminance times their solid angle, for any pixel size.
 *
 * A sun's disc is half a degree wide, about a pixel of a fisheye. Pixel rays hit or miss it by
 * chance, as they do a bulb across a room; between rays at fixed positions it disappears. If a sun
 * or a lamp is small compared to pixels, pixel rays therefore ignore it (ORL_SUNS_EXCLUDED,
 * orl_shader.lamps_apart). Rays of its own go to evenly spaced points of it. Each ray's light is
 * added to the pixel that it passes through, weighted by that pixel's solid angle. Lights that
 * cover many pixels, and those seen in mirrors, are left to pixel rays.
 */
#ifndef ORL_RENDER_IMAGE_SMALL_LIGHTS_H
#define ORL_RENDER_IMAGE_SMALL_LIGHTS_H

#include "render/image/paint.h"
#include "render/image/shade.h"

/* Lights that pixel rays ignore. */
struct orl_small_lights {
    enum orl_sun_visibility suns;
    bool *lamps; /* by facet, owned; NULL: none */
};

/* Chooses the small lights of a view. Returns 0 or ORL_ERR_NOMEM; call orl_small_lights_done in
 * either case. */
int orl_small_lights_init(struct orl_small_lights *small_lights,
                          const struct orl_lit_scene *lit_scene,
                          const struct orl_painting *painting);
void orl_small_lights_done(struct orl_small_lights *small_lights);

/* Adds the small lights to a picture that was painted without them. outside: true if the eye is
 * outside. */
void orl_small_lights_paint(const struct orl_small_lights *small_lights,
                            const struct orl_shader *shader, const struct orl_painting *painting,
                            bool outside);

#endif
