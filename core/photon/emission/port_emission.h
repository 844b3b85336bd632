/*
 * Light that enters by ports: starts of emissions on the pane, lamps outside, and suns with their
 * shadow boxes and BSDF tables.
 */
#ifndef ORL_PHOTON_EMISSION_PORT_EMISSION_H
#define ORL_PHOTON_EMISSION_PORT_EMISSION_H

#include "light/direct.h"
#include "photon/emission/emit.h"

/*
 * Sampling of points on a port and directions of their light, for emissions of one stratum: the
 * part of an emission (emit.h) that traces no rays. Several at once take hardly longer than one,
 * because their table look-ups overlap.
 */

enum { ORL_STARTS_AT_ONCE = 16 };

struct orl_port_start {
    struct orl_vec3 point, out; /* point: on the pane; out: unit, towards the light */
    /* pdf relative to uniform by area, and for domes to projected solid angle */
    double pdf;
};

/*
 * Samples starts for a stratum whose light passes a port; u: for each, five numbers in [0,1) as for
 * orl_emission_sample_stratum; n: at most ORL_STARTS_AT_ONCE.
 */
void orl_port_starts(const struct orl_emission *emission, const struct orl_stratum *stratum,
                     bool caustic, const double *const *u, size_t n,
                     struct orl_port_start *ret_starts);

/*
 * Lamps outside as ports see them: photons that start on the pane, with the radiance of a point of
 * the lamp times the transmittance between the two. Paths outwards from a port omit such lamps
 * (orl_port_radiance). Shadow rays from inside count them where the pane transmits straight: their
 * photons are of class ORL_PHOTON_DIRECT, or caustic behind a BSDF.
 *
 * A stratum is a pair of port and lamp. With more than ORL_MOST_PORT_LAMPS pairs a stratum is a
 * port, and each emission chooses one of the lamps with equal probability.
 */

enum { ORL_MOST_PORT_LAMPS = 8192 };
#define ORL_ANY_LAMP UINT32_MAX

/* Lists the lamps before ports that are outside (lamps_outside), in ascending order; in open
 * scenes all lamps before ports. Returns 0, ORL_ERR_NOMEM or ORL_ERR_CANCELLED. */
int orl_port_lamps_find(struct orl_emission *emission, const struct orl_thread_pool *pool);
/* Returns the maximum number of strata for them. */
size_t orl_port_lamp_count_strata(const struct orl_emission *emission);
/* Returns true if that emitter is in lamps_outside. */
bool orl_port_lamp_is_outside(const struct orl_emission *emission, size_t emitter);

/* Returns one estimate of the flux on the pane, W of luma, without occlusion; u: four numbers in
 * [0,1). choice: selects the lamp for ORL_ANY_LAMP. */
double orl_port_lamp_unoccluded_flux(const struct orl_emission *emission,
                                     const struct orl_stratum *stratum, uint32_t choice,
                                     const double u[4]);

/* Returns radiance times solid angle that arrives at a point of the port from a sampled point of
 * the lamp, zero if none; u: two numbers in [0,1). */
struct orl_rgb orl_port_lamp_arriving(const struct orl_emission *emission,
                                      const struct orl_stratum *stratum, struct orl_vec3 point,
                                      const double *u, struct orl_random *random,
                                      uint32_t *ret_lamp, struct orl_light_sample *ret_sample);

/* Returns the focus of a spotlight's beam; 0: it has none. */
double orl_emitter_focus(const struct orl_lit_scene *lit_scene, uint32_t emitter);

/*
 * Precomputed data for a sun in a port. Shadow boxes: parts of the pane where objects outside may
 * block the sun, so that emissions from other parts need no shadow ray. Sun BSDF tables: the
 * directions to which the pane scatters the sun's light (scene/material/kinds.h).
 *
 * Facets beyond the pane's plane are projected onto it along the sun's rays, from all over its
 * disc. The bounding boxes of projections on the pane are stored. This is exact geometry, not a
 * sampled test: outside the boxes a shadow ray would hit nothing.
 */

enum { ORL_MOST_SHADOW_BOXES = 32 };

/* Boxes in the plane of a pane, with two axes in moved coordinates. */
struct orl_shadow_boxes {
    struct orl_vec3 axis[2];
    size_t count;
    struct orl_shadow_box {
        double low[2], high[2];
    } box[ORL_MOST_SHADOW_BOXES];
};

static inline bool orl_shadow_boxes_contain(const struct orl_shadow_boxes *shadow_boxes,
                                            struct orl_vec3 point)
{
    const double x = orl_dot(point, shadow_boxes->axis[0]),
                 y = orl_dot(point, shadow_boxes->axis[1]);
    for (size_t i = 0; i < shadow_boxes->count; i++) {
        const struct orl_shadow_box *b = &shadow_boxes->box[i];
        /* One combined branch: each single comparison is unpredictable, all together are mostly
         * false. */
        if ((x >= b->low[0]) & (x <= b->high[0]) & (y >= b->low[1]) & (y <= b->high[1]))
            return true;
    }
    return false;
}

/* Builds the data for all strata of suns in ports. Returns 0, ORL_ERR_NOMEM or, if the pool is
 * cancelled, ORL_ERR_CANCELLED. */
int orl_port_sun_prepare(struct orl_emission *emission, const struct orl_thread_pool *pool);
void orl_port_sun_done(struct orl_emission *emission);

/* The tables of orl_stratum.sun_bsdf_table, the part of that data that refers to the lit scene.
 * make: returns 0 or ORL_ERR_NOMEM. */
int orl_sun_bsdf_tables_make(struct orl_emission *emission);
void orl_sun_bsdf_tables_free(struct orl_emission *emission);

#endif
