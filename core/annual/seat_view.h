/*
 * What a seat sees, looked at once for all hours of a year: a fisheye picture whose pixels are sums
 * of the sky's bins, of the light on places of surfaces, and of spots that the sun may light.
 *
 * A pixel's rays go on through panes, mirrors and lobes (seat_rays.h); at each diffuse surface on
 * the way its place adds. Places stand for what lies about them on the same
 * surface, as far as the seat sees it (seat_places.h): sensors of the year say how much light falls
 * on them. A pixel's spot is where its first ray comes to: sunlight there is looked for hour by
 * hour, and so the place's own straight sunlight is left out for such rays.
 *
 * Immutable once made. Angles: the picture is Radiance's -vta of 180 degrees.
 */
#ifndef ORL_ANNUAL_SEAT_VIEW_H
#define ORL_ANNUAL_SEAT_VIEW_H

#include <oriel/annual_glare.h>

#include "annual/scene.h"
#include "annual/seat_places.h"
#include "annual/seat_terms.h"
#include "metrics/field.h"

enum { ORL_SEAT_SIDE = 160, ORL_SEAT_PIXELS = ORL_SEAT_SIDE * ORL_SEAT_SIDE };

/* Terms and spots of a pixel, at most. */
enum { ORL_SEAT_PIXEL_TERMS = 64, ORL_SEAT_PIXEL_SPOTS = 8 };

/* Where the sun may fall on what a pixel sees first but for panes. */
struct orl_seat_spot {
    struct orl_place place; /* on the side that is seen, or beyond, of what light is let by */
    struct orl_hit hit;
    struct orl_vec3 eye;                 /* from there */
    const struct orl_material *material; /* whose lobes send it on; NULL: diffuse */
    struct orl_rgb weight;               /* of what is sent to the eye; of diffuse ones with 1/pi */
    uint32_t pixel;
};

struct orl_seat_view {
    struct orl_field field;
    struct orl_place eye;
    uint32_t *first; /* into terms, by pixel, and one more */
    /* Of bins, 0 to ORL_BINS - 1; behind them by twos of places: of the light there but for what
     * comes straight from the sun, and of all of it. */
    struct orl_seat_term *terms;
    struct orl_seat_spot *spots;
    size_t n_spots;
    struct orl_seat_places places;
    uint64_t n_steps; /* ray segments that it took */
};

/* name: of the seat, for its random numbers. crew: asked before each pixel if the job is cancelled.
 * Returns 0, ORL_ERR_NOMEM, _CANCELLED or _RANGE; orl_seat_view_done in any case. */
int orl_seat_view_init(struct orl_seat_view *view, const struct orl_annual_scene *scene,
                       const struct orl_seat *seat, uint64_t name, const struct orl_crew *crew,
                       struct orl_error *err);
void orl_seat_view_done(struct orl_seat_view *view);

#endif
