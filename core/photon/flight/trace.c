#include "photon/flight/trace.h"

#include <string.h>

#include "light/path.h"
#include "photon/flight/found.h"

/* Parameters of a trace: the scene, and the photons that are wanted. */
struct tracing {
    const struct orl_world *world;
    /* discs in which photons are counted; NULL: photons are deposited */
    const struct orl_discs *discs;
    bool caustic, by_chance;
    enum orl_lobes lobes;
    uint32_t most_reflections;
};

/* State of a photon. */
struct course {
    struct orl_path path; /* its weight is the flux */
    double fate, alive;
    double reflected;            /* value of the flight */
    double focus, flown, spread; /* spotlight's beam, until the photon is scattered */
    struct orl_deflection way;
    bool crossed, outside, lamp;
    uint8_t batch;
    enum orl_photon_class class;
    struct orl_found found; /* used with discs or by_chance */
    uint32_t reflections;
    int bounces, unseen;
};

/*
 * Russian roulette: returns false if the survival probability has fallen to the photon's fate.
 * spared: factor by which the flux is reduced in addition (first_reflection.h); or 1.
 */
static bool survives_roulette(struct course *c, struct orl_rgb weight, double spared)
{
    const double chance = orl_smaller(orl_luma(weight) / spared, 1);
    c->alive *= chance;
    if (!(c->alive > c->fate))
        return false;
    c->path.weight = orl_rgb_scale(orl_rgb_mul(c->path.weight, weight), 1 / chance);
    return true;
}

/*
 * Returns true if roulette ends the photon at a matt surface. The result depends on the albedo
 * only, so it is known before a direction is sampled, and most photons end there.
 */
static bool ends_here(const struct course *c, const struct orl_material *m, struct orl_rgb albedo,
                      double spared, bool caustic)
{
    return orl_material_is_matt(m) &&
           (caustic || !(c->alive * orl_smaller(orl_luma(albedo) / spared, 1) > c->fate));
}

/* Applies the path to a hit: absorption by the medium, and the spread of a spotlight's beam
 * (lamp.c). Returns false if the photon ends. */
static bool attenuate_to_hit(struct course *c, const struct orl_material *m,
                             const struct orl_hit *hit)
{
    if (c->focus > 0) {
        const double before = c->spread;
        c->flown += hit->distance;
        c->spread = fmax(orl_spot_spread(c->focus, c->flown), 1e-12);
        c->path.weight = orl_rgb_scale(c->path.weight, c->spread / before);
    }
    const struct orl_rgb left = orl_material_dimming(m, hit, c->path.clarity);
    return orl_is_clear(left) || survives_roulette(c, left, 1);
}

/* Handles a ray that hits nothing; from inside a sealed building it is counted as a leak. */
static void count_leak(const struct orl_world *world, const struct course *c,
                       struct orl_health *health)
{
    if (world->open || !c->crossed || c->outside)
        return;
    if (health->rays_leaked++ == 0) {
        health->leak_from = c->path.origin;
        health->leak_towards = c->path.direction;
    }
}

static enum orl_photon_class class_after(enum orl_photon_class class, enum orl_event event)
{
    if (event == ORL_EVENT_STRAIGHT || class == ORL_PHOTON_REST)
        return class;
    return event == ORL_EVENT_DIFFUSE ? ORL_PHOTON_REST : ORL_PHOTON_CAUSTIC;
}

/* Returns true for caustic photons by deflections that the plan omits. */
static bool is_left_out(const struct orl_world *world, struct orl_deflection way)
{
    return (way.mirror && world->omit.mirror_caustics) || (way.lobe && world->omit.lobe_caustics);
}

/* Returns true if no other estimator finds the photon in its current state; false outdoors. */
static bool is_sought(const struct tracing *t, const struct course *c)
{
    return !c->outside && orl_found_by_nobody(&c->found, t->world);
}

/* Counts the photon in the discs on its way to the hit (NULL: none). */
static void count_in_discs(const struct tracing *t, const struct course *c,
                           const struct orl_hit *hit, struct orl_deposits *deposits)
{
    const struct orl_stretch stretch = {.origin = c->path.origin,
                                        .direction = c->path.direction,
                                        .distance = hit ? hit->distance : INFINITY,
                                        .flux = c->path.weight,
                                        .focus = c->focus,
                                        .flown = c->flown,
                                        .spread = c->spread,
                                        .lamp = c->lamp,
                                        .batch = c->batch % ORL_MAP_BATCHES};
    if (is_sought(t, c))
        orl_discs_note(t->discs, &stretch, &deposits->passes);
}

/* Returns the lobes that may scatter the photon: illums transmit light that comes straight from
 * suns and lamps. */
static enum orl_lobes lobes_for(const struct tracing *t, const struct course *c)
{
    const bool straight = c->class == ORL_PHOTON_LIGHT && c->reflections == 0;
    return straight ? (enum orl_lobes)(t->lobes | ORL_LOBE_ILLUM) : t->lobes;
}

static struct tracing tracing_of(const struct orl_world *world, bool caustic)
{
    const uint32_t most = world->omit.most_reflections;
    return (struct tracing){
        .world = world,
        .caustic = caustic,
        .lobes =
            caustic ? (enum orl_lobes)(ORL_LOBE_REFLECTED | ORL_LOBE_TRANSMITTED) : ORL_LOBE_ALL,
        .most_reflections = most < ORL_ALL_REFLECTIONS ? most : UINT32_MAX};
}

/* Initialises a photon. Returns false if it is not wanted. */
static bool init_course(const struct tracing *t, const struct orl_flight *flight, uint8_t batch,
                        struct course *c, struct orl_deposits *deposits)
{
    const struct orl_deflection way = flight->way;
    /* Members are set one by one: clearing the whole struct first takes longer than the rest. */
    c->path.origin = flight->origin;
    c->path.direction = flight->direction;
    c->path.weight = orl_health_keep(&deposits->health, flight->flux);
    c->path.clarity = flight->from_port ? flight->clarity : orl_gray(1);
    c->fate = flight->fate;
    c->alive = 1;
    c->spread = flight->flown > 0 ? fmax(orl_spot_spread(flight->focus, flight->flown), 1e-12) : 1;
    c->reflected = flight->reflected;
    c->focus = flight->focus;
    c->flown = flight->flown;
    c->way = way;
    c->crossed = flight->from_port;
    c->outside = false;
    c->lamp = flight->lamp;
    c->batch = batch;
    c->class = !flight->from_light        ? ORL_PHOTON_REST
               : (way.mirror || way.lobe) ? ORL_PHOTON_CAUSTIC
                                          : ORL_PHOTON_LIGHT;
    c->reflections = 0;
    c->bounces = c->unseen = 0;
    if (t->discs || t->by_chance)
        c->found = orl_found_at_first(t->world, flight, t->by_chance);
    if (t->caustic && is_left_out(t->world, way))
        return false;
    deposits->health.photons++;
    orl_sum_add(&deposits->flux, orl_luma(c->path.weight));
    return true;
}

/* Handles the hit of the photon's ray (NULL: none), and deposits a photon if one is wanted.
 * Returns false if the photon ends. */
static bool handle_hit(const struct tracing *t, struct course *c, const struct orl_hit *hit,
                       struct orl_deposits *deposits)
{
    const struct orl_world *world = t->world;
    const struct orl_deflection way = c->way;
    deposits->health.rays++;
    if (!hit) {
        count_leak(world, c, &deposits->health);
        return false;
    }
    const struct orl_material *m = orl_world_material(world, hit);
    const struct orl_rgb albedo = orl_material_diffuse(m, hit);
    const bool diffuse = orl_rgb_max(albedo) > 0;
    if (!attenuate_to_hit(c, m, hit))
        return false;
    c->unseen++;
    if (diffuse && !c->outside && !t->discs &&
        (t->caustic ? (way.mirror || way.lobe) && (!t->by_chance || is_sought(t, c))
                    : c->reflections < t->most_reflections)) {
        if (t->caustic || !world->omit.counted_light || c->class == ORL_PHOTON_REST)
            orl_deposit(deposits, hit, c->path.weight, c->batch, c->class);
        c->unseen = 0;
    }
    return !ends_here(c, m, albedo, c->class == ORL_PHOTON_REST ? 1 : c->reflected, t->caustic);
}

/* Applies a scattering event. Returns false if the photon is absorbed, or is not wanted after
 * it. */
static bool apply_scatter(const struct tracing *t, struct course *c, const struct orl_hit *hit,
                          const struct orl_scatter *s, struct orl_deposits *deposits)
{
    const double spared = c->class == ORL_PHOTON_REST ? 1 : c->reflected;
    if (s->event == ORL_EVENT_ABSORBED ||
        !survives_roulette(c, orl_health_keep(&deposits->health, s->weight),
                           s->event == ORL_EVENT_DIFFUSE ? spared : 1))
        return false;
    if (s->transmitted) {
        const enum orl_crossing crossing = orl_world_crossing(t->world, hit);
        /* The port itself emits light that crosses it inwards for the first time. */
        if (crossing == ORL_CROSSING_INWARDS && !c->crossed)
            return false;
        c->crossed = c->crossed || crossing != ORL_CROSSING_NONE;
        c->outside = orl_world_outside_after(t->world, hit, true, c->outside);
    }
    c->way = orl_deflected(c->way, s->event);
    c->reflections += s->event == ORL_EVENT_DIFFUSE;
    if (t->caustic ? is_left_out(t->world, c->way) : c->reflections >= t->most_reflections)
        return false;
    c->class = class_after(c->class, s->event);
    if ((t->discs || t->by_chance) && s->event != ORL_EVENT_STRAIGHT)
        orl_found_next(&c->found, t->world, hit, s->event);
    if (s->event == ORL_EVENT_DIFFUSE || s->event == ORL_EVENT_GLOSSY)
        c->focus = 0;
    orl_path_leave(&c->path, t->world, hit, s);
    if (++c->bounces < ORL_TRACE_MOST_BOUNCES && c->unseen < ORL_TRACE_MOST_UNSEEN)
        return true;
    orl_deposits_give_up(deposits, c->path.weight);
    return false;
}

void orl_trace_photon(const struct orl_world *world, const struct orl_flight *flight, bool caustic,
                      uint8_t batch, struct orl_random *random, struct orl_deposits *deposits)
{
    const struct tracing t = tracing_of(world, caustic);
    struct orl_scatter s;
    struct orl_hit hit;
    struct course c;
    if (!init_course(&t, flight, batch, &c, deposits))
        return;
    do {
        const bool met = orl_path_meet(world, &c.path, &hit);
        if (!handle_hit(&t, &c, met ? &hit : NULL, deposits))
            return;
        s = orl_scatter_sample(orl_world_material(world, &hit), &hit, orl_path_back(&c.path),
                               ORL_TRANSPORT_LIGHT, lobes_for(&t, &c), random);
    } while (apply_scatter(&t, &c, &hit, &s, deposits));
}

/* ---- Many photons at once -------------------------------------------------------------------- */

enum { AT_ONCE = ORL_EMISSIONS_AT_ONCE };
_Static_assert((int)AT_ONCE <= UINT8_MAX + 1, "a photon has its number where its batch will stand");

/* Photons that take each step together. */
struct wave {
    struct tracing tracing;
    struct orl_deposits *deposits;
    struct orl_random *randoms;
    struct course courses[AT_ONCE];
    uint16_t under_way[AT_ONCE];
    size_t n, n_beam; /* number of active photons; those of the beam come first */
    struct orl_ray rays[AT_ONCE];
    struct orl_hit hits[AT_ONCE]; /* hits of the active photons, in their order */
    bool found[AT_ONCE];
    struct orl_draw draws[AT_ONCE];
    double u[AT_ONCE][3];
    /* indices among the active photons, of those that are scattered */
    uint16_t scattered[AT_ONCE];
    struct orl_scatter scatters[AT_ONCE];
};

static void trace_rays(struct wave *w)
{
    const struct orl_geometry *g = w->tracing.world->geometry;
    for (size_t i = 0; i < w->n; i++) {
        const struct orl_path *path = &w->courses[w->under_way[i]].path;
        w->rays[i] = (struct orl_ray){path->origin, path->direction};
    }
    orl_geometry_intersect_many(g, w->rays, w->n_beam, true, w->hits, w->found);
    orl_geometry_intersect_many(g, w->rays + w->n_beam, w->n - w->n_beam, false,
                                w->hits + w->n_beam, w->found + w->n_beam);
    w->n_beam = 0;
}

/* Handles the hits of all active photons, and samples scattering for those that do not end. */
static size_t scatter_all(struct wave *w)
{
    size_t n = 0;
    for (size_t i = 0; i < w->n; i++) {
        const struct orl_hit *hit = &w->hits[i];
        struct course *c = &w->courses[w->under_way[i]];
        struct orl_random *random = &w->randoms[w->under_way[i]];
        if (w->tracing.discs)
            count_in_discs(&w->tracing, c, w->found[i] ? hit : NULL, w->deposits);
        if (!handle_hit(&w->tracing, c, w->found[i] ? hit : NULL, w->deposits))
            continue;
        for (int k = 0; k < 3; k++)
            w->u[n][k] = orl_random_uniform(random);
        w->draws[n] = (struct orl_draw){orl_world_material(w->tracing.world, hit), hit,
                                        orl_path_back(&c->path), ORL_TRANSPORT_LIGHT,
                                        lobes_for(&w->tracing, c)};
        w->scattered[n++] = (uint16_t)i;
    }
    orl_scatter_sample_many(w->draws, (const double(*)[3])w->u, n, w->scatters);
    return n;
}

static void advance_wave(struct wave *w)
{
    size_t left = 0;
    trace_rays(w);
    const size_t n = scatter_all(w);
    for (size_t k = 0; k < n; k++) {
        const uint16_t i = w->scattered[k], photon = w->under_way[i];
        if (apply_scatter(&w->tracing, &w->courses[photon], &w->hits[i], &w->scatters[k],
                          w->deposits))
            w->under_way[left++] = photon;
    }
    w->n = left;
}

/* Sorts the wave's deposits by photon, as if each had been traced alone, and sets their batches. */
static void sort_deposits(struct orl_deposits *deposits, size_t first)
{
    const size_t n = deposits->count - first;
    size_t next[AT_ONCE + 1] = {0};
    if (n == 0 || !orl_deposits_reserve(deposits, n))
        return;
    struct orl_photon *left = deposits->photons + first, *sorted = left + n;
    for (size_t i = 0; i < n; i++)
        next[left[i].batch + 1]++;
    for (size_t k = 0; k < AT_ONCE; k++)
        next[k + 1] += next[k];
    for (size_t i = 0; i < n; i++) {
        struct orl_photon *p = &sorted[next[left[i].batch]++];
        *p = left[i];
        p->batch %= ORL_MAP_BATCHES;
    }
    memcpy(left, sorted, n * sizeof *left);
}

void orl_trace_many(const struct orl_world *world, const struct orl_flight *flights,
                    const bool *flies, size_t n, bool caustic, struct orl_random *randoms,
                    struct orl_deposits *deposits)
{
    const size_t first = deposits->count;
    struct wave w;
    w.tracing = tracing_of(world, caustic);
    w.tracing.discs = deposits->discs;
    w.tracing.by_chance = deposits->by_chance;
    w.deposits = deposits;
    w.randoms = randoms;
    w.n = w.n_beam = 0;
    uint16_t others[AT_ONCE];
    size_t n_others = 0;
    for (size_t i = 0; i < n; i++) {
        if (!flies[i] || !init_course(&w.tracing, &flights[i], (uint8_t)i, &w.courses[i], deposits))
            continue;
        if (flights[i].beam)
            w.under_way[w.n_beam++] = (uint16_t)i;
        else
            others[n_others++] = (uint16_t)i;
    }
    memcpy(w.under_way + w.n_beam, others, n_others * sizeof *others);
    w.n = w.n_beam + n_others;
    while (w.n > 0)
        advance_wave(&w);
    sort_deposits(deposits, first);
}
