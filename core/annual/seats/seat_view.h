/*
 * View of a seat, built once for all hours of a year. It is a fisheye picture. Each pixel is a sum
 * of sky bins, of the light on places of surfaces, and of spots that the sun may light.
 *
 * A pixel's rays pass panes, mirrors and lobes (seat_rays.h). At each diffuse surface on the path,
 * the surface's place adds to the pixel. A place represents the visible part of its surface around
 * it (seat_places.h); a sensor of the year gives the light there. A pixel's spot is where its first
 * ray hits. Sunlight there is computed hour by hour, so the place's own direct sunlight is left out
 * for such rays.
 *
 * Immutable once made. The picture has Radiance's projection -vta with 180 degrees.
 */
#ifndef ORL_ANNUAL_SEATS_SEAT_VIEW_H
#define ORL_ANNUAL_SEATS_SEAT_VIEW_H

#include <oriel/annual_glare.h>

#include "annual/seats/seat_places.h"
#include "annual/seats/seat_terms.h"
#include "annual/year/annual_scene.h"
#include "metrics/field.h"

enum { ORL_SEAT_SIDE = 160, ORL_SEAT_PIXELS = ORL_SEAT_SIDE * ORL_SEAT_SIDE };

/* Most terms and spots of a pixel. */
enum { ORL_SEAT_PIXEL_TERMS = 64, ORL_SEAT_PIXEL_SPOTS = 8 };

/* A point seen by a pixel's first ray, directly or through panes, where the sun may shine. */
struct orl_seat_spot {
    struct orl_place place; /* on the visible side; for transmitted light, on the far side */
    struct orl_hit hit;
    struct orl_vec3 eye;                 /* direction from the spot to the eye */
    const struct orl_material *material; /* material whose lobes send the light on; NULL: diffuse */
    /* Factor of the light sent to the eye; includes 1/pi for diffuse surfaces. */
    struct orl_rgb weight;
    uint32_t pixel;
};

struct orl_seat_view {
    struct orl_field field;
    struct orl_place eye;
    uint32_t *first; /* by pixel, and one more: index into terms */
    /* `which` of a term: first the bins, 0 to ORL_BINS - 1; then two per place, its light without
     * direct sunlight, and all of its light. */
    struct orl_seat_term *terms;
    struct orl_seat_spot *spots;
    size_t n_spots;
    struct orl_seat_places places;
    uint64_t n_steps; /* traced ray segments */
};

/* name: the seat's number, for random numbers. Cancellation of the crew is checked before each
 * pixel. Returns 0, ORL_ERR_NOMEM, _CANCELLED or _RANGE; the caller calls orl_seat_view_done in any
 * case. */
int orl_seat_view_init(struct orl_seat_view *view, const struct orl_annual_scene *scene,
                       const struct orl_seat *seat, uint64_t name, const struct orl_crew *crew,
                       struct orl_error *err);
void orl_seat_view_done(struct orl_seat_view *view);

#endif
