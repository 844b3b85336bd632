/*
 * Where photons start. The light of the scene is divided into strata (a port and the domes seen
 * from it, a port and a sun, a local emitter, and in open scenes the domes and suns themselves);
 * an emission picks a stratum by its flux, then a place and a direction by importance, and carries
 * flux / probability, so that all photons weigh about the same.
 *
 * From a port: a point uniform over the pane, a direction outwards from a table of the light that
 * arrives there (made by a pilot of exterior paths, mixed with a tenth of cosine-weighted
 * directions so that nothing the pilot missed is lost), the radiance that really comes from there
 * along a path, then the pane's own transmission. Suns, their images in flat mirrors outside, and
 * lamps outside: a point on the disc or lamp and one shadow ray.
 *
 * Caustic photons start where on the pane a mirror, a lens or a lobe is to be met, when that is a
 * small part of it (caustic_targets.h).
 *
 * From a local emitter: a point uniform by area, a direction by the cosine or, for narrow
 * spotlights, uniform over the cone.
 *
 * From the open sky: a direction by the domes' radiance, a place on the scene's box by a guide.
 *
 * The first five random numbers of an emission and its fate are a scrambled Sobol point by its
 * index. Each batch (index mod 16) has a sequence of its own, independent of the others', so that
 * the spread of batches tells the error of their mean.
 */
#ifndef ORL_PHOTON_FLIGHT_EMIT_H
#define ORL_PHOTON_FLIGHT_EMIT_H

#include "base/sobol.h"
#include "light/exterior.h"
#include "scene/material/passage.h"

enum orl_stratum_kind {
    ORL_STRATUM_PORT_DOME,
    ORL_STRATUM_PORT_SUN,
    ORL_STRATUM_PORT_IMAGE, /* a sun's image in mirrors outside */
    ORL_STRATUM_PORT_LAMP,  /* one lamp outside, or all of them: port_lamp.h */
    ORL_STRATUM_EMITTER,
    ORL_STRATUM_OPEN_DOME,
    ORL_STRATUM_OPEN_SUN,
};

/* A distribution over the unit square, piecewise constant, row by row. */
struct orl_table {
    uint32_t side_x, side_y;
    double *weight;     /* per cell: its probability */
    double *row_below;  /* running sums of rows, side_y + 1 */
    double *cell_below; /* running sums within each row, side_y * (side_x + 1) */
    double mean;        /* of the values it was made from */
};

struct orl_stratum {
    enum orl_stratum_kind kind;
    uint32_t port;       /* or emitter */
    uint32_t sun, image; /* of world.images */
    uint32_t lamp;       /* seen from a port: an emitter, or ORL_ANY_LAMP */
    double flux_w;       /* luma, estimated */
    double worth;        /* of the open sky: the mean of its guides; else 1 */
    double reflected;    /* albedo that its light meets first, where that leaves nothing:
                            first_reflection.h */
    double share;        /* probability for global photons */
    double share_caustic;
    double below, below_caustic; /* running sums before it */
    struct orl_table place; /* of a sun in a port: where caustic photons start; caustic_targets.h */
    /* Of a sun in a port, by port_sun.h: */
    struct orl_shades *shades;         /* owned; NULL: anything may be in the way anywhere */
    const struct orl_passage *passage; /* borrowed; NULL: none */
};

/* What global photons are for: to be stored where they land, or to be virtual lamps, which are
 * worth what they send on. */
enum orl_photon_use { ORL_PHOTONS_FOR_MAPS, ORL_PHOTONS_FOR_LAMPS };

struct orl_emission {
    const struct orl_world *world; /* borrowed */
    enum orl_photon_use use;
    struct orl_sobol sobol;
    struct orl_stratum *strata;
    size_t n_strata;
    struct orl_table *port_tables; /* per port: over the outer hemisphere's Shirley-Chiu square */
    struct orl_table dome_table;   /* open scenes: over the sphere, equal-area cylinder */
    struct orl_table *sun_guides, *sun_caustic_guides, *dome_guides; /* open scenes: guide.h */
    struct orl_passage **passages; /* owned: through ports, for suns */
    size_t n_passages;
    uint32_t *lamps_outside; /* emitters that ports may see */
    size_t n_lamps_outside;
    bool has_caustics; /* a pilot found a way for them, or the planner something lit that may */
};

/* Of a light that the renderer samples directly: its photons may be counted elsewhere. */
static inline bool orl_stratum_is_counted(const struct orl_emission *e, const struct orl_stratum *s)
{
    return s->kind == ORL_STRATUM_PORT_SUN || s->kind == ORL_STRATUM_PORT_IMAGE ||
           s->kind == ORL_STRATUM_PORT_LAMP || s->kind == ORL_STRATUM_OPEN_SUN ||
           (s->kind == ORL_STRATUM_EMITTER && e->world->emitters[s->port].direct);
}

/* What has deflected a photon, other than diffuse surfaces. */
struct orl_deflection {
    bool mirror; /* mirrors, panes' reflections, dielectrics */
    bool lobe;
};

static inline struct orl_deflection orl_deflected(struct orl_deflection way, enum orl_event event)
{
    way.mirror = way.mirror || event == ORL_EVENT_MIRROR || event == ORL_EVENT_REFRACTED;
    way.lobe = way.lobe || event == ORL_EVENT_GLOSSY;
    return way;
}

/* A photon about to fly: just past its port, or at its emitter. */
struct orl_flight {
    struct orl_vec3 origin, direction;
    struct orl_rgb flux;
    bool from_light; /* a sun or light, sampled directly by the renderer, as against a dome or glow
                      */
    struct orl_deflection way; /* already deflected: by the port's BSDF, or a mirror outside */
    bool from_port;
    bool lamp;           /* from_light, and no sun; */
    uint32_t lamp_facet; /* its facet; else */
    uint32_t sun;        /* the sun; */
    int16_t image;       /* and its image in mirrors outside, or -1 */
    bool beam; /* straight from the first sun: of about one direction with others of its kind */
    struct orl_rgb clarity; /* from a port: of what lies behind it (scatter.h) */
    double focus;           /* from a spotlight: see lamp.c of the scene; else 0 */
    double flown;           /* from a port: the distance to the lamp */
    double fate;            /* in [0,1): at what chance of being alive it dies (trace.h) */
    double reflected;       /* of its stratum; until first reflected it has that much more flux */
};

/* Returns 0 or ORL_ERR_NOMEM, ORL_ERR_CANCELLED. */
int orl_emission_new(const struct orl_world *world, enum orl_photon_use use, uint64_t seed,
                     struct orl_crew *crew, struct orl_emission **ret_emission,
                     struct orl_error *err);
void orl_emission_free(struct orl_emission *emission);

/* The Sobol points of the emissions from index on, a multiple of ORL_MAP_BATCHES, one per batch. */
void orl_emission_points(const struct orl_emission *emission, uint64_t seed, uint64_t index,
                         bool caustic, struct orl_sobol_block *ret_points);

enum { ORL_EMISSIONS_AT_ONCE = 128 };

/*
 * The emissions of such points, at most that many, and which of them come to something. randoms:
 * of each, for what Sobol does not serve. Paths that look out of ports are counted into health.
 * All take each step together: those of one kind follow one another, rays and draws go side by
 * side. What becomes of one does not depend on the others.
 */
void orl_emission_sample_many(const struct orl_emission *emission,
                              const double (*points)[ORL_SOBOL_DIMENSIONS], size_t n, bool caustic,
                              struct orl_random *randoms, struct orl_health *health,
                              struct orl_flight *ret_flights, bool *ret_flies);

/* One emission, from one stratum, with probability one and a random fate; point: five numbers in
 * [0,1).
 */
bool orl_emission_from(const struct orl_emission *emission, const struct orl_stratum *stratum,
                       bool caustic, const double *point, struct orl_random *random,
                       struct orl_health *health, struct orl_flight *ret_flight);

#endif
