/*
 * Directions into the room that a kind of BSDF pane sends the sun of an hour: samples of its BSDF,
 * for a random point of the sun's disc each. All sensors and panes of the kind share them.
 */
#ifndef ORL_ANNUAL_PANEL_DRAWS_H
#define ORL_ANNUAL_PANEL_DRAWS_H

#include "annual/hours.h"
#include "base/sobol.h"
#include "bsdf/placed.h"
#include "light/direct.h"

enum { ORL_PANEL_DRAWS = 128 /* of a kind of pane, in an hour */ };

struct orl_panel_kind {
    const struct orl_material *material;
    struct orl_vec3 normal, inward;
    struct orl_frame frame; /* of the BSDF */
    bool data_alone;        /* nothing is added to its data, nor taken out of it */
};

/* A direction into the room that a kind of pane sends an hour's sun. */
struct orl_panel_draw {
    float light;   /* what it is worth: radiance over density, of a sun of 1 facing it */
    float density; /* per steradian, of drawing it from that point of the disc */
    float from[2]; /* the point: two numbers for about where in the disc */
};

/* The draws of an hour's sun; their directions by coordinate, for loops over all of them. */
struct orl_panel_draws {
    float towards[3][ORL_PANEL_DRAWS];
    struct orl_panel_draw at[ORL_PANEL_DRAWS];
    bool spans_cells; /* the disc spans cells of the BSDF with different transmittances */
    bool in_one_cell; /* all of the disc is in one cell, which the next one stands for */
    struct orl_bsdf_incidence middle; /* of the disc; if the kind has data alone */
};

static inline struct orl_sun orl_panel_disc(const struct orl_hour_sun *sun)
{
    return (struct orl_sun){.frame = orl_frame_about(sun->towards),
                            .cos_half_angle = cos(0.5 * sun->angle_rad)};
}

static inline struct orl_bsdf_incidence orl_panel_incidence(const struct orl_panel_kind *kind,
                                                            struct orl_vec3 from)
{
    return orl_bsdf_place_incident(kind->material->bsdf, orl_to_local(&kind->frame, from));
}

/* seed: of these draws alone. */
void orl_panel_draws_make(const struct orl_panel_kind *kind, const struct orl_hour_sun *sun,
                          const struct orl_sobol *sobol, uint64_t seed,
                          struct orl_panel_draws *ret_draws);

#endif
