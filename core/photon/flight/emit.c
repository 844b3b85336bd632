#include "photon/flight/emit.h"

#include "photon/flight/emit_freely.h"
#include "photon/flight/port_lamp.h"
#include "photon/flight/port_start.h"
#include "photon/flight/port_sun.h"
#include "photon/flight/table.h"
#include "photon/map/map.h"
#include "scene/material/hemisphere.h"

_Static_assert((int)ORL_SOBOL_BLOCK == (int)ORL_MAP_BATCHES, "a point of each batch");

/* Cosine of half an angle: rays of a sun with a smaller angle have about one direction. */
static const double narrow = 0.9999;

/* Returns the port's hit as a path from outside meets it. */
static struct orl_hit port_hit(const struct orl_world *world, const struct orl_port *port,
                               struct orl_vec3 point)
{
    return (struct orl_hit){.point = point,
                            .normal = orl_facet_normal(world->geometry, port->facet),
                            .facet = port->facet,
                            .front = port->outside_is_front};
}

/* Light with a flux that arrives at a port from the direction `outwards`. passage: sampler for
 * the pane, or NULL. */
struct arrival {
    const struct orl_port *port;
    const struct orl_passage *passage;
    struct orl_vec3 point, outwards;
    struct orl_rgb flux;
    /* domes: start of the ray that finds the radiance; measure: flux for radiance 1 */
    struct orl_vec3 start;
    double measure;
    struct orl_hit hit;
};

/* Stage of an emission. */
enum stage { LOST, FLIES, ARRIVES, LOOKS };

/* Sets up the BSDF query for the pane. Returns false if its passage samples it instead. */
static bool set_bsdf_query(const struct orl_world *world, struct arrival *a,
                           struct orl_random *random, double ret_u[3], struct orl_draw *ret_draw)
{
    a->hit = port_hit(world, a->port, a->point);
    ret_u[0] = orl_random_uniform(random);
    ret_u[1] = orl_random_uniform(random);
    ret_u[2] = orl_random_uniform(random);
    *ret_draw = (struct orl_draw){orl_world_material(world, &a->hit), &a->hit, a->outwards,
                                  ORL_TRANSPORT_LIGHT, ORL_LOBE_TRANSMITTED};
    return !a->passage;
}

/* Starts the photon behind the pane in the sampled direction. Returns false if it was absorbed. */
static bool start_flight(const struct orl_world *world, const struct arrival *a,
                         const struct orl_scatter *s, struct orl_flight *ret_flight)
{
    if (s->event == ORL_EVENT_ABSORBED)
        return false;
    ret_flight->origin = orl_hit_leave(world->geometry, &a->hit, s->direction);
    ret_flight->direction = s->direction;
    ret_flight->flux = orl_rgb_mul(a->flux, s->weight);
    ret_flight->way = orl_deflected(ret_flight->way, s->event);
    ret_flight->beam = ret_flight->beam && s->event == ORL_EVENT_STRAIGHT;
    ret_flight->from_port = true;
    ret_flight->clarity = orl_scatter_clarity(orl_world_material(world, &a->hit), s, orl_gray(1));
    return orl_rgb_max(ret_flight->flux) > 0;
}

static enum stage aim_port_dome(const struct orl_emission *e, const struct orl_stratum *stratum,
                                const struct orl_port_start *start, struct arrival *ret)
{
    const struct orl_geometry *g = e->world->geometry;
    const struct orl_port *port = &e->world->ports[stratum->port];
    ret->port = port;
    ret->passage = NULL;
    ret->point = start->point;
    ret->outwards = start->out;
    ret->start = orl_facet_leave(g, port->facet, start->point, orl_facet_normal(g, port->facet),
                                 port->outward);
    /* The square is uniform in projected solid angle, pi in all. */
    ret->measure = ORL_PI * port->area / start->density;
    return LOOKS;
}

/* Sets the flux from the radiance that the ray outwards found. */
static enum stage set_radiance(struct arrival *a, struct orl_rgb radiance)
{
    a->flux = orl_rgb_scale(radiance, a->measure);
    return orl_rgb_max(a->flux) > 0 ? ARRIVES : LOST;
}

static enum stage aim_port_sun(const struct orl_emission *e, const struct orl_stratum *stratum,
                               const struct orl_port_start *start, struct arrival *ret,
                               struct orl_flight *ret_flight)
{
    const struct orl_world *world = e->world;
    const struct orl_port *port = &world->ports[stratum->port];
    const struct orl_sun *sun = &world->suns[stratum->sun];
    const struct orl_image *image =
        stratum->kind == ORL_STRATUM_PORT_IMAGE ? &world->images.nodes[stratum->image] : NULL;
    const struct orl_vec3 out = start->out;
    const struct orl_vec3 from =
        orl_facet_leave(world->geometry, port->facet, start->point,
                        orl_facet_normal(world->geometry, port->facet), port->outward);
    const struct orl_rgb share =
        image ? orl_image_transmittance(world, from, out, image, false)
        : stratum->shades && !orl_may_be_shaded(stratum->shades, start->point)
            ? orl_gray(1)
            : orl_transmittance(world, from, out, INFINITY, false);
    const double cosine = orl_dot(out, port->outward);
    if (!(cosine > 0) || !(orl_rgb_max(share) > 0))
        return LOST;
    ret_flight->from_light = true;
    ret_flight->way.mirror = image != NULL;
    ret_flight->sun = stratum->sun;
    ret_flight->image = image ? (int16_t)stratum->image : -1;
    ret_flight->beam = !image && stratum->sun == 0 && sun->cos_half_angle > narrow;
    ret->port = port;
    ret->passage = image ? NULL : stratum->passage;
    ret->point = start->point;
    ret->outwards = out;
    ret->flux =
        orl_rgb_scale(orl_rgb_mul(sun->irradiance, share), cosine * port->area / start->density);
    return ARRIVES;
}

static enum stage aim_port_lamp(const struct orl_emission *e, const struct orl_stratum *stratum,
                                const double *u, const struct orl_port_start *start,
                                struct orl_random *random, struct arrival *ret,
                                struct orl_flight *ret_flight)
{
    const struct orl_port *port = &e->world->ports[stratum->port];
    struct orl_lamp_aim aim;
    uint32_t lamp;
    const struct orl_rgb arriving =
        orl_port_lamp_arriving(e, stratum, start->point, u, random, &lamp, &aim);
    if (!(orl_rgb_max(arriving) > 0))
        return LOST;
    ret_flight->from_light = ret_flight->lamp = true;
    ret_flight->lamp_facet = e->world->emitters[lamp].facet;
    ret_flight->focus = orl_emitter_focus(e->world, lamp);
    ret_flight->flown = aim.distance;
    ret->port = port;
    ret->passage = NULL;
    ret->point = start->point;
    ret->outwards = aim.light;
    ret->flux = orl_rgb_scale(arriving, orl_dot(aim.light, port->outward) * port->area);
    return ARRIVES;
}

static bool passes_port(const struct orl_stratum *s)
{
    return s->kind == ORL_STRATUM_PORT_DOME || s->kind == ORL_STRATUM_PORT_SUN ||
           s->kind == ORL_STRATUM_PORT_IMAGE || s->kind == ORL_STRATUM_PORT_LAMP;
}

/* Initialises all of the flight but its start, direction and flux. */
static void init_flight(struct orl_flight *flight, double fate)
{
    flight->from_light = flight->from_port = flight->lamp = flight->beam = false;
    flight->way = (struct orl_deflection){.mirror = false};
    flight->sun = 0;
    flight->image = -1;
    flight->focus = flight->flown = 0;
    flight->fate = fate;
    flight->reflected = 1;
}

/* Starts an emission up to its arrival at a port, or its flight. start: for strata that pass a
 * port; other strata use the numbers in point. */
static enum stage aim_emission(const struct orl_emission *e, const struct orl_stratum *stratum,
                               bool caustic, const double *point,
                               const struct orl_port_start *start, struct orl_random *random,
                               struct arrival *ret_arrival, struct orl_flight *ret_flight)
{
    init_flight(ret_flight, orl_random_uniform(random));
    switch (stratum->kind) {
    case ORL_STRATUM_PORT_DOME:
        return aim_port_dome(e, stratum, start, ret_arrival);
    case ORL_STRATUM_PORT_SUN:
    case ORL_STRATUM_PORT_IMAGE:
        return aim_port_sun(e, stratum, start, ret_arrival, ret_flight);
    case ORL_STRATUM_PORT_LAMP:
        return aim_port_lamp(e, stratum, point + 3, start, random, ret_arrival, ret_flight);
    case ORL_STRATUM_EMITTER:
        return orl_emit_from_lamp(e, stratum, point, ret_flight) ? FLIES : LOST;
    case ORL_STRATUM_OPEN_DOME:
    case ORL_STRATUM_OPEN_SUN:
        return orl_emit_from_sky(e, stratum, caustic, point, ret_flight) ? FLIES : LOST;
    }
    return LOST;
}

bool orl_emission_from(const struct orl_emission *emission, const struct orl_stratum *stratum,
                       bool caustic, const double *point, struct orl_random *random,
                       struct orl_health *health, struct orl_flight *ret_flight)
{
    const struct orl_world *world = emission->world;
    double u[3];
    struct orl_draw draw;
    struct arrival a;
    struct orl_port_start start;
    if (passes_port(stratum))
        orl_port_starts(emission, stratum, caustic, &point, 1, &start);
    enum stage stage =
        aim_emission(emission, stratum, caustic, point, &start, random, &a, ret_flight);
    if (stage == LOOKS)
        stage =
            set_radiance(&a, orl_port_radiance(world, a.port, a.start, a.outwards, random, health));
    if (stage != ARRIVES)
        return stage == FLIES;
    if (!orl_port_owns(world->geometry, a.port, a.point))
        return false;
    const struct orl_scatter s = set_bsdf_query(world, &a, random, u, &draw)
                                     ? orl_scatter_sample_at(draw.material, &a.hit, a.outwards,
                                                             draw.transport, draw.lobes, u)
                                     : orl_passage_sample(a.passage, a.outwards, u);
    return start_flight(world, &a, &s, ret_flight);
}

static const struct orl_stratum *pick_stratum(const struct orl_emission *e, double u, bool caustic)
{
    size_t low = 0, high = e->n_strata;
    while (high - low > 1) {
        const size_t middle = low + (high - low) / 2;
        const struct orl_stratum *s = &e->strata[middle];
        if ((caustic ? s->below_caustic : s->below) <= u)
            low = middle;
        else
            high = middle;
    }
    return &e->strata[low];
}

void orl_emission_points(const struct orl_emission *emission, uint64_t seed, uint64_t index,
                         bool caustic, struct orl_sobol_block *ret_points)
{
    const uint64_t within = index / ORL_MAP_BATCHES;
    uint32_t sequences[ORL_MAP_BATCHES];
    for (uint64_t batch = 0; batch < ORL_MAP_BATCHES; batch++)
        sequences[batch] =
            (uint32_t)orl_mix64(orl_mix64(seed * 2 + caustic) + batch) + (uint32_t)(within >> 32);
    orl_sobol_block(&emission->sobol, (uint32_t)within, sequences, ret_points);
}

/* ---- Many emissions at once ------------------------------------------------------------------ */

/* Emissions that take each step together. */
struct wave {
    const struct orl_emission *emission;
    struct orl_random *randoms;
    struct orl_flight *flights;
    const struct orl_stratum *strata[ORL_EMISSIONS_AT_ONCE];
    enum stage stages[ORL_EMISSIONS_AT_ONCE];
    struct arrival arrivals[ORL_EMISSIONS_AT_ONCE];
    uint16_t order[ORL_EMISSIONS_AT_ONCE]; /* emissions sorted by stratum, or nearly so */
    size_t n;
};

static void sort_by_stratum(struct wave *w)
{
    enum { KINDS = 64 };
    uint16_t next[KINDS + 1] = {0};
    for (size_t i = 0; i < w->n; i++)
        next[(size_t)(w->strata[i] - w->emission->strata) % KINDS + 1]++;
    for (size_t k = 0; k < KINDS; k++)
        next[k + 1] = (uint16_t)(next[k + 1] + next[k]);
    for (size_t i = 0; i < w->n; i++)
        w->order[next[(size_t)(w->strata[i] - w->emission->strata) % KINDS]++] = (uint16_t)i;
}

static double share_of(const struct orl_stratum *s, bool caustic)
{
    return caustic ? s->share_caustic : s->share;
}

/* Returns the end of a run of emissions of one stratum from `first` on, at most
 * ORL_STARTS_AT_ONCE. */
static size_t end_of_stratum(const struct wave *w, size_t first)
{
    size_t end = first + 1;
    while (end < w->n && end < first + ORL_STARTS_AT_ONCE &&
           w->strata[w->order[end]] == w->strata[w->order[first]])
        end++;
    return end;
}

/* Starts emissions of one stratum. */
static void aim_emissions(struct wave *w, size_t first, size_t end, bool caustic,
                          const double (*points)[ORL_SOBOL_DIMENSIONS])
{
    const struct orl_stratum *stratum = w->strata[w->order[first]];
    const bool shines = share_of(stratum, caustic) > 0;
    struct orl_port_start starts[ORL_STARTS_AT_ONCE];
    const double *u[ORL_STARTS_AT_ONCE];
    for (size_t k = first; k < end; k++)
        u[k - first] = points[w->order[k]];
    if (shines && passes_port(stratum))
        orl_port_starts(w->emission, stratum, caustic, u, end - first, starts);
    for (size_t k = first; k < end; k++) {
        const uint16_t i = w->order[k];
        w->stages[i] =
            !shines ? LOST
                    : aim_emission(w->emission, stratum, caustic, points[i], &starts[k - first],
                                   &w->randoms[i], &w->arrivals[i], &w->flights[i]);
    }
}

/* Finds the light of domes: traces paths outwards from the ports. */
static void find_port_radiance(struct wave *w, struct orl_health *health)
{
    const struct orl_world *world = w->emission->world;
    struct orl_ray rays[ORL_EMISSIONS_AT_ONCE];
    struct orl_hit hits[ORL_EMISSIONS_AT_ONCE];
    bool found[ORL_EMISSIONS_AT_ONCE];
    uint16_t whose[ORL_EMISSIONS_AT_ONCE];
    size_t n = 0;
    for (size_t k = 0; k < w->n; k++) {
        const uint16_t i = w->order[k];
        struct arrival *a = &w->arrivals[i];
        if (w->stages[i] != LOOKS)
            continue;
        if (!orl_port_looks(world, a->port)) {
            w->stages[i] = set_radiance(a, orl_port_radiance(world, a->port, a->start, a->outwards,
                                                             &w->randoms[i], health));
            continue;
        }
        whose[n] = i;
        rays[n++] = (struct orl_ray){a->start, a->outwards};
    }
    orl_geometry_intersect_many(world->geometry, rays, n, false, hits, found);
    for (size_t k = 0; k < n; k++) {
        struct arrival *a = &w->arrivals[whose[k]];
        w->stages[whose[k]] = set_radiance(
            a,
            orl_exterior_radiance_from(world, a->outwards, found[k] ? &hits[k] : NULL,
                                       orl_chance_found_straight(), &w->randoms[whose[k]], health));
    }
}

/* Samples the transmission of the panes. */
static void pass_ports(struct wave *w)
{
    const struct orl_world *world = w->emission->world;
    struct orl_draw draws[ORL_EMISSIONS_AT_ONCE];
    struct orl_scatter scatters[ORL_EMISSIONS_AT_ONCE];
    double u[ORL_EMISSIONS_AT_ONCE][3];
    uint16_t whose[ORL_EMISSIONS_AT_ONCE];
    size_t n = 0;
    for (size_t k = 0; k < w->n; k++) {
        const uint16_t i = w->order[k];
        struct arrival *a = &w->arrivals[i];
        if (w->stages[i] != ARRIVES)
            continue;
        w->stages[i] = LOST;
        if (!orl_port_owns(world->geometry, a->port, a->point))
            continue;
        if (set_bsdf_query(world, a, &w->randoms[i], u[n], &draws[n])) {
            whose[n++] = i;
            continue;
        }
        const struct orl_scatter s = orl_passage_sample(a->passage, a->outwards, u[n]);
        if (start_flight(world, a, &s, &w->flights[i]))
            w->stages[i] = FLIES;
    }
    orl_scatter_sample_many(draws, (const double(*)[3])u, n, scatters);
    for (size_t k = 0; k < n; k++)
        if (start_flight(world, &w->arrivals[whose[k]], &scatters[k], &w->flights[whose[k]]))
            w->stages[whose[k]] = FLIES;
}

void orl_emission_sample_many(const struct orl_emission *emission,
                              const double (*points)[ORL_SOBOL_DIMENSIONS], size_t n, bool caustic,
                              struct orl_random *randoms, struct orl_health *health,
                              struct orl_flight *ret_flights, bool *ret_flies)
{
    struct wave w;
    w.emission = emission;
    w.randoms = randoms;
    w.flights = ret_flights;
    w.n = emission->n_strata > 0 ? n : 0;
    for (size_t i = 0; i < w.n; i++)
        w.strata[i] = pick_stratum(emission, points[i][0], caustic);
    sort_by_stratum(&w);
    for (size_t first = 0, end; first < w.n; first = end) {
        end = end_of_stratum(&w, first);
        aim_emissions(&w, first, end, caustic, points);
    }
    find_port_radiance(&w, health);
    pass_ports(&w);
    for (size_t i = 0; i < n; i++) {
        struct orl_flight *flight = &ret_flights[i];
        ret_flies[i] = i < w.n && w.stages[i] == FLIES;
        if (!ret_flies[i])
            continue;
        flight->flux = orl_rgb_scale(flight->flux, 1 / share_of(w.strata[i], caustic));
        flight->fate = points[i][5];
        flight->reflected = caustic ? 1 : w.strata[i]->reflected;
    }
}
