/*
 * BSDF samples of an hour's sun: the directions into the room in which a kind of BSDF pane sends
 * it. Each sample has a random point of the sun's disc. All sensors and panes of the kind share
 * them.
 */
#ifndef ORL_ANNUAL_PANES_BSDF_PANE_SAMPLES_H
#define ORL_ANNUAL_PANES_BSDF_PANE_SAMPLES_H

#include "annual/sky/hours.h"
#include "base/sampling/sobol.h"
#include "bsdf/located_direction.h"
#include "light/direct.h"

enum { ORL_BSDF_PANE_SAMPLES = 128 /* samples per kind of pane and sun */ };

struct orl_bsdf_pane_kind {
    const struct orl_material *material;
    struct orl_vec3 normal, inward;
    struct orl_frame frame; /* local frame of the BSDF */
    /* True if the material is its BSDF data alone, with nothing added or removed. */
    bool data_alone;
};

/* A direction in which a kind of pane sends an hour's sun into the room. */
struct orl_bsdf_pane_sample {
    float light;   /* radiance divided by pdf, for a sun with a normal irradiance of 1 */
    float density; /* pdf of the direction for that point of the disc, per steradian */
    float from[2]; /* sample numbers of the point on the disc */
};

/* Samples of an hour's sun. Directions are stored by coordinate, for vectorised loops. */
struct orl_bsdf_pane_samples {
    float towards[3][ORL_BSDF_PANE_SAMPLES];
    struct orl_bsdf_pane_sample at[ORL_BSDF_PANE_SAMPLES];
    bool spans_cells; /* true if the disc spans cells of the BSDF with different transmittances */
    /* True if the whole disc lies in one cell of the BSDF, which `middle` holds. */
    bool in_one_cell;
    /* Incidence from the centre of the disc; valid if the kind has data alone. */
    struct orl_bsdf_incidence middle;
};

static inline struct orl_sun orl_bsdf_pane_sun_disc(const struct orl_hour_sun *sun)
{
    return (struct orl_sun){.frame = orl_frame_about(sun->towards),
                            .cos_half_angle = cos(0.5 * sun->angle_rad)};
}

static inline struct orl_bsdf_incidence
orl_bsdf_pane_incidence(const struct orl_bsdf_pane_kind *kind, struct orl_vec3 from)
{
    return orl_bsdf_locate_incident(kind->material->bsdf, orl_to_local(&kind->frame, from));
}

/* Samples a kind's BSDF for a sun. seed: for these samples alone. */
void orl_bsdf_pane_samples_make(const struct orl_bsdf_pane_kind *kind,
                                const struct orl_hour_sun *sun, const struct orl_sobol *sobol,
                                uint64_t seed, struct orl_bsdf_pane_samples *ret_samples);

#endif
