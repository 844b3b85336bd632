/*
 * Emission of photons. The light of the scene is divided into strata: a port and the domes seen
 * from it, a port and a sun, a local emitter, and in open scenes the domes and suns themselves. An
 * emission samples a stratum by its flux, then a point and a direction by importance. It carries
 * flux / probability, so that all photons have about the same flux.
 *
 * From a port: a point uniform over the pane, and a direction outwards from a distribution of the
 * light that arrives there. A pilot of exterior paths makes the distribution. A tenth of
 * cosine-weighted directions is mixed in, so that light that the pilot missed is not lost. A path
 * finds the radiance that really arrives, then the pane's transmission is sampled. Suns, their
 * images in flat mirrors outside, and lamps outside: a point on the disc or lamp and one shadow
 * ray.
 *
 * If only a small part of the pane leads to a mirror, a lens or a lobe, caustic photons start there
 * (strata/caustic_pilot.c).
 *
 * From a local emitter: a point uniform by area, a direction by the cosine or, for narrow
 * spotlights, uniform over the cone.
 *
 * From the open sky: a direction by the domes' radiance, a point on the scene's box by an
 * importance map (emit_sampling.h).
 *
 * The first five random numbers of an emission and its roulette number are a scrambled Sobol point
 * by its index. Each batch (index mod 16) has its own sequence, independent of the others, so the
 * spread of batches gives the error of their mean.
 */
#ifndef ORL_PHOTON_EMISSION_EMIT_H
#define ORL_PHOTON_EMISSION_EMIT_H

#include "base/sampling/sampling.h"
#include "light/exterior.h"
#include "scene/material/kinds.h"

enum orl_stratum_kind {
    ORL_STRATUM_PORT_DOME,
    ORL_STRATUM_PORT_SUN,
    ORL_STRATUM_PORT_IMAGE, /* a sun's image in mirrors outside */
    ORL_STRATUM_PORT_LAMP,  /* one lamp outside, or all of them (port_emission.h) */
    ORL_STRATUM_EMITTER,
    ORL_STRATUM_OPEN_DOME,
    ORL_STRATUM_OPEN_SUN,
};

/* A piecewise-constant distribution over the unit square, row by row. */
struct orl_distribution_2d {
    uint32_t side_x, side_y;
    double *weight;   /* probability of each cell */
    double *row_cdf;  /* prefix sums of rows, side_y + 1 */
    double *cell_cdf; /* prefix sums within each row, side_y * (side_x + 1) */
    double mean;      /* mean of the values it was made from */
};

struct orl_stratum {
    enum orl_stratum_kind kind;
    uint32_t port;       /* index of the port, or of the emitter */
    uint32_t sun, image; /* indices of the sun and of its node in lit_scene.images */
    uint32_t lamp;       /* a lamp that the port sees: index of the emitter, or ORL_ANY_LAMP */
    double flux_w;       /* luma, estimated */
    double importance;   /* open sky: mean of its importance maps; otherwise 1 */
    /* mean albedo of its first hits, if no photon is stored there (strata/strata.c); otherwise 1 */
    double reflected;
    double share; /* probability for global photons */
    double share_caustic;
    double cdf, cdf_caustic; /* sums of the shares of the strata before it */
    struct orl_distribution_2d
        place; /* sun in a port: start of caustic photons (strata/caustic_pilot.c) */
    /* Data for a sun in a port (port_emission.h). */
    struct orl_shadow_boxes *shadow_boxes; /* owned; NULL: any part of the pane may be in shadow */
    const struct orl_sun_bsdf_table *sun_bsdf_table; /* borrowed; NULL: none */
};

/* Use of global photons: stored where they land, or as virtual point lights, whose importance is
 * the light that they reflect. */
enum orl_photon_use { ORL_PHOTONS_FOR_MAPS, ORL_PHOTONS_FOR_VPLS };

struct orl_emission {
    const struct orl_lit_scene *lit_scene; /* borrowed; NULL: detached */
    size_t n_ports, n_suns;                /* of the lit scene: lengths of the arrays below */
    enum orl_photon_use use;
    uint64_t seed; /* of the pilots */
    struct orl_sobol sobol;
    struct orl_stratum *strata;
    size_t n_strata;
    /* per port: over the Shirley-Chiu square of the outer hemisphere */
    struct orl_distribution_2d *port_distributions;
    /* open scenes: over the sphere, equal-area cylindrical projection */
    struct orl_distribution_2d dome_distribution;
    /* open scenes: importance maps (emit_sampling.h) */
    struct orl_distribution_2d *sun_importance, *sun_caustic_importance, *dome_importance;
    struct orl_sun_bsdf_table *
        *sun_bsdf_tables; /* owned: samplers of transmission through ports, for suns */
    size_t n_sun_bsdf_tables;
    uint32_t *lamps_outside; /* indices of emitters that ports may see */
    size_t n_lamps_outside;
    /* a pilot found caustic photons, or the planner found lit surfaces that may cause them */
    bool has_caustics;
};

/* Returns true if the renderer samples the stratum's light directly: its photons may be counted
 * elsewhere. */
static inline bool orl_stratum_is_direct(const struct orl_emission *e, const struct orl_stratum *s)
{
    return s->kind == ORL_STRATUM_PORT_SUN || s->kind == ORL_STRATUM_PORT_IMAGE ||
           s->kind == ORL_STRATUM_PORT_LAMP || s->kind == ORL_STRATUM_OPEN_SUN ||
           (s->kind == ORL_STRATUM_EMITTER && e->lit_scene->emitters[s->port].direct);
}

/* Kinds of deflection of a photon, other than by diffuse surfaces. */
struct orl_deflection {
    bool mirror; /* mirrors, reflection by panes, dielectrics */
    bool lobe;
};

static inline struct orl_deflection orl_deflection_after(struct orl_deflection deflection,
                                                         enum orl_scatter_event event)
{
    deflection.mirror =
        deflection.mirror || event == ORL_EVENT_MIRROR || event == ORL_EVENT_REFRACTED;
    deflection.lobe = deflection.lobe || event == ORL_EVENT_GLOSSY;
    return deflection;
}

/* An emitted photon: just past its port, or at its emitter. */
struct orl_photon_ray {
    struct orl_vec3 origin, direction;
    struct orl_rgb flux;
    /* from a sun or lamp, which the renderer samples directly; not from a dome or glow */
    bool from_light;
    /* deflections so far: by the port's BSDF, or by a mirror outside */
    struct orl_deflection deflection;
    bool from_port;
    bool lamp;           /* from_light, and from a lamp */
    uint32_t lamp_facet; /* lamp: its facet */
    uint32_t sun;        /* from_light without lamp: the sun */
    int16_t image;       /* the sun's image in mirrors outside; -1: none */
    bool parallel;       /* straight from the first sun: its rays have about one direction */
    struct orl_rgb
        medium_transmissivity; /* transmissivity of the medium behind the port (scatter.h) */
    double focus;              /* focus of a spotlight (scene/material/lamp.c); otherwise 0 */
    double lamp_distance;      /* from a port: the distance from the lamp */
    /* roulette number in [0,1): the photon dies when its survival probability falls to it
     * (trace.h) */
    double roulette_u;
    /* stratum's value; until its first reflection the flux is larger by the factor 1 / reflected */
    double reflected;
};

/* Builds the strata and their distributions. Returns 0, ORL_ERR_NOMEM or ORL_ERR_CANCELLED. */
int orl_emission_new(const struct orl_lit_scene *lit_scene, enum orl_photon_use use, uint64_t seed,
                     struct orl_thread_pool *pool, struct orl_emission **ret_emission,
                     struct orl_error *err);
void orl_emission_free(struct orl_emission *emission); /* attached or not; NULL is allowed */

/*
 * orl_emission_detach removes an emission's references to its lit scene between jobs, and returns
 * its size in bytes. orl_emission_attach gives it the lit scene of a later job with the same scene,
 * lights and omissions; returns 0 or ORL_ERR_NOMEM.
 */
uint64_t orl_emission_detach(struct orl_emission *emission);
int orl_emission_attach(struct orl_emission *emission, const struct orl_lit_scene *lit_scene);

/* Computes the Sobol points of the emissions from index on, one per batch; index is a multiple
 * of ORL_MAP_BATCHES. */
void orl_emission_points(const struct orl_emission *emission, uint64_t seed, uint64_t index,
                         bool caustic, struct orl_sobol_block *ret_points);

enum { ORL_EMISSIONS_AT_ONCE = 128 };

/*
 * Samples the emissions for such points, at most ORL_EMISSIONS_AT_ONCE. ret_is_emitted is true for
 * those that emit a photon. randoms: one per emission, for numbers beyond the Sobol point. Paths
 * outwards from ports are counted in health. All emissions take each step together, sorted by
 * stratum, so that rays and samples are processed side by side. Each emission is independent of the
 * others.
 */
void orl_emission_sample_many(const struct orl_emission *emission,
                              const double (*points)[ORL_SOBOL_DIMENSIONS], size_t n, bool caustic,
                              struct orl_random *randoms, struct orl_health *health,
                              struct orl_photon_ray *ret_photon_rays, bool *ret_is_emitted);

/* Samples one emission from one stratum, with probability one and a random roulette number. point:
 * five numbers in [0,1). Returns false if no photon is emitted. */
bool orl_emission_sample_stratum(const struct orl_emission *emission,
                                 const struct orl_stratum *stratum, bool caustic,
                                 const double *point, struct orl_random *random,
                                 struct orl_health *health, struct orl_photon_ray *ret_photon_ray);

#endif
