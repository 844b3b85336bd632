/* One sample of the backward technique: the light of a place, and the paths that look for it. */
#include "light/proxies.h"
#include "render/backward/backward.h"
#include "scene/material/hemisphere.h"

enum { MOST_BOUNCES = 64, SURE_BOUNCES = 3 };
/* Paths go on for certain from this weight on, and else by lot; those that were aimed from less. */
static const double certain_weight = 0.25, dimmest_aimed = 0.002;
/* Surfaces that they come to are lit from this on: a patch of sun on one is a thousand times as
 * bright as others are, and one that is seen in a pane by a lot of few would be an outlier. */
static const double dimmest_lit = 0.02;

/* A path on its way, from the last place where light was asked for in all its parts. */
struct walk {
    struct orl_tracer *tracer;
    struct orl_vec3 origin, direction;
    struct orl_rgb weight, clarity;
    struct orl_rgb sum;
    double importance;            /* of the walk's start in the sample, at most 1 or about that */
    uint32_t reflections;         /* diffuse ones before that */
    double cos_start, travelled;  /* since that place */
    bool straight;                /* nothing but panes since then */
    struct orl_chance chance;     /* of lamps met now, what is left to count */
    struct orl_image_trail trail; /* since the last lobe or diffuse surface */
    bool outside, been_outside;
    bool clear; /* outside, with nothing but the sky before it */
    bool met;   /* a surface, at hit */
    struct orl_hit hit;
};

/* A place on the way, to be lit. */
struct stop {
    struct orl_place place;
    double importance;
    uint32_t reflections;
    const struct orl_sampling *sampling; /* of the sample's first place; then NULL */
};

static struct orl_rgb light_at(struct orl_tracer *tracer, const struct stop *stop);

static void collect(struct walk *w, struct orl_rgb radiance)
{
    w->sum = orl_rgb_add(w->sum, orl_rgb_mul(w->weight, radiance));
}

/* ---- A path ---------------------------------------------------------------------------------- */

/*
 * Light that a diffuse surface on the way reflects. Virtual lamps stand for it where they see the
 * place that the path set out from; the path takes the share of it that they leave.
 */
static void add_diffuse(struct walk *w, const struct orl_hit *hit, struct orl_rgb albedo)
{
    const struct orl_world *world = w->tracer->backward->world;
    const struct orl_vec3 lit = hit->front ? hit->normal : orl_neg(hit->normal);
    const double left = w->straight ? orl_vpl_left(&w->tracer->backward->vpls, w->cos_start,
                                                   orl_dot(w->direction, hit->normal), w->travelled)
                                    : 1;
    if (!(left > 0) || w->reflections >= world->omit.most_reflections)
        return;
    const double matters = w->importance * left * orl_rgb_max(orl_rgb_mul(w->weight, albedo));
    const double chance = fmin(matters / dimmest_lit, 1);
    if (chance < 1 && !(orl_random_uniform(&w->tracer->random) < chance))
        return;
    const struct stop stop = {
        .place = {.point = orl_hit_leave(world->geometry, hit, lit), .normal = lit},
        .importance = fmin(matters / chance, 1),
        .reflections = w->reflections + 1};
    collect(w, orl_rgb_scale(orl_rgb_mul(albedo, light_at(w->tracer, &stop)),
                             left / (chance * ORL_PI)));
}

/* Suns and lamps in the lobes of a surface, seen from where the path comes from. */
static void add_lobes(struct walk *w, const struct orl_hit *hit, const struct orl_material *m)
{
    collect(w, orl_direct_by_lobes(w->tracer->backward->world, hit, m, orl_neg(w->direction),
                                   &w->tracer->random));
}

/* Beyond all surfaces. A sun's disc counts only where no shadow ray could have looked for it. */
static void escape(struct walk *w)
{
    const struct orl_world *world = w->tracer->backward->world;
    w->weight = orl_rgb_mul(w->weight, orl_clarity_after(w->clarity, INFINITY));
    collect(w, orl_world_dome_radiance(world, w->direction));
    const bool deflected = w->trail.reflections > 0 || w->trail.strange;
    if (!deflected || w->been_outside || isfinite(w->chance.pdf))
        return;
    const struct orl_rgb sun = orl_world_sun_radiance(world, w->direction);
    if (orl_rgb_max(sun) > 0 && !orl_images_cover(world, &w->trail))
        collect(w, sun);
}

/* Dim paths and long ones end by lot. Those that were aimed are not dim for being some of many. */
static bool survives(struct walk *w, int bounce)
{
    const double matters = w->importance * orl_rgb_max(w->weight);
    const double chance =
        fmin(matters / (bounce < SURE_BOUNCES ? dimmest_aimed : certain_weight), 1);
    if (chance < 1 && !(orl_random_uniform(&w->tracer->random) < chance))
        return false;
    w->weight = orl_rgb_scale(w->weight, 1 / chance);
    return true;
}

static void note_event(struct walk *w, const struct orl_scatter *s)
{
    if (s->event == ORL_EVENT_STRAIGHT)
        return;
    w->straight = false;
    if (s->event == ORL_EVENT_GLOSSY)
        w->trail = orl_image_trail_from(s->direction);
    else if (s->event == ORL_EVENT_MIRROR)
        orl_image_trail_add(&w->trail, &w->tracer->backward->world->images, w->hit.facet);
    else
        w->trail.strange = true;
}

/* On by mirrors, panes and lobes, to the next hit; false when the path ends. */
static bool scatter(struct walk *w, const struct orl_material *m)
{
    const struct orl_world *world = w->tracer->backward->world;
    const struct orl_scatter s = orl_scatter_sample(
        m, &w->hit, orl_neg(w->direction), ORL_TRANSPORT_EYE,
        (enum orl_lobes)(ORL_LOBE_REFLECTED | ORL_LOBE_TRANSMITTED), &w->tracer->random);
    if (s.event == ORL_EVENT_ABSORBED)
        return false;
    w->weight = orl_rgb_mul(w->weight, s.weight);
    w->clarity = orl_scatter_clarity(m, &s, w->clarity);
    w->chance = orl_chance_after(world, &w->hit, orl_neg(w->direction), &s, w->chance);
    note_event(w, &s);
    if (s.transmitted && !world->open && orl_world_crossing(world, &w->hit) != ORL_CROSSING_NONE)
        w->outside = orl_world_crossing(world, &w->hit) == ORL_CROSSING_OUTWARDS;
    w->clear = w->outside && s.transmitted && orl_world_leaves_clear(world, &w->hit);
    w->origin = orl_hit_leave(world->geometry, &w->hit, s.direction);
    w->direction = s.direction;
    if (!w->outside)
        w->met =
            orl_geometry_intersect(world->geometry, w->origin, w->direction, INFINITY, &w->hit);
    return true;
}

/*
 * Outdoors; true when the path enters a building again. No virtual lamps have been looked for there
 * (vpl.c), but all of the suns that shadow rays to images do.
 */
static bool comes_back(struct walk *w)
{
    const struct orl_world *world = w->tracer->backward->world;
    struct orl_entry entry;
    collect(w, orl_exterior_radiance(world, w->origin, w->direction, w->chance, &w->tracer->random,
                                     w->tracer->health, &entry));
    if (!entry.entered)
        return false;
    w->outside = false;
    w->straight = false;
    w->been_outside = true;
    w->weight = orl_rgb_mul(w->weight, entry.weight);
    w->clarity = entry.clarity;
    w->chance = entry.chance;
    w->origin = entry.origin;
    w->direction = entry.direction;
    w->met = orl_geometry_intersect(world->geometry, w->origin, w->direction, INFINITY, &w->hit);
    return true;
}

/* Follows the path from its first hit to its end; returns what it saw. */
static struct orl_rgb follow(struct walk *w)
{
    const struct orl_world *world = w->tracer->backward->world;
    for (int bounce = 0; bounce < MOST_BOUNCES; bounce++) {
        if (w->clear) {
            collect(w, orl_world_dome_radiance(world, w->direction));
            return w->sum;
        }
        if (w->outside && !comes_back(w))
            return w->sum;
        if (!w->met) {
            escape(w);
            return w->sum;
        }
        const struct orl_material *m = orl_world_material(world, &w->hit);
        const struct orl_rgb albedo = orl_material_diffuse(m);
        w->weight = orl_rgb_mul(w->weight, orl_material_dimming(m, &w->hit, w->clarity));
        w->travelled += w->hit.distance;
        collect(w, orl_shining(world, &w->hit, orl_neg(w->direction), &w->chance));
        if (orl_rgb_max(albedo) > 0)
            add_diffuse(w, &w->hit, albedo);
        if (orl_material_has_lobes(m))
            add_lobes(w, &w->hit, m);
        if (!survives(w, bounce) || !scatter(w, m))
            return w->sum;
    }
    w->tracer->health->paths_capped++;
    return w->sum;
}

struct orl_rgb orl_backward_radiance(struct orl_tracer *tracer, struct orl_vec3 origin,
                                     struct orl_vec3 direction, bool outside,
                                     struct orl_chance chance)
{
    struct walk w = {.tracer = tracer,
                     .origin = origin,
                     .direction = direction,
                     .weight = {1, 1, 1},
                     .clarity = {1, 1, 1},
                     .importance = 1,
                     .chance = chance,
                     .trail = orl_image_trail_from(direction),
                     .outside = outside};
    tracer->health->paths++;
    w.met = !outside && orl_geometry_intersect(tracer->backward->world->geometry, origin, direction,
                                               INFINITY, &w.hit);
    return follow(&w);
}

/* ---- The light of a place -------------------------------------------------------------------- */

/* Which numbers of a sample something takes. */
enum slot { SLOT_SUN, SLOT_LAMPS, SLOT_WAYS };

/* Numbers in [0,1): of the n-th of each sample's such draws. */
static void numbers(struct orl_tracer *tracer, const struct stop *stop, uint32_t slot,
                    uint32_t each, uint32_t n, uint32_t count, double *ret_u)
{
    const struct orl_sampling *s = stop->sampling;
    if (s)
        orl_sobol_point(&tracer->backward->sobol, s->index * each + n,
                        s->sequence + slot * 0x9e3779b9U, count, ret_u);
    else
        for (uint32_t i = 0; i < count; i++)
            ret_u[i] = orl_random_uniform(&tracer->random);
}

static struct orl_rgb direct_light(struct orl_tracer *tracer, const struct stop *stop)
{
    const struct orl_world *world = tracer->backward->world;
    double u[2];
    const struct orl_direct_query query = {.point = stop->place.point,
                                           .normal = stop->place.normal,
                                           .through_ports = true,
                                           .mirrored = true,
                                           .u = u};
    numbers(tracer, stop, SLOT_SUN, 1, 0, 2, u);
    return orl_direct_light(stop->place.proxied ? orl_world_seen(world) : world, &query,
                            &tracer->random);
}

static struct orl_rgb some_lamps(struct orl_tracer *tracer, const struct stop *stop)
{
    double u;
    numbers(tracer, stop, SLOT_LAMPS, 1, 0, 1, &u);
    return orl_vpl_light(&tracer->backward->vpls, tracer->group, u,
                         stop->sampling ? stop->sampling->lamps : 1, stop->place.point,
                         stop->place.normal);
}

/* What one aimed ray adds. */
static struct orl_rgb look(struct orl_tracer *tracer, const struct stop *stop,
                           const struct orl_effort *effort, enum orl_way way, const double u[3])
{
    struct orl_aimed aimed;
    tracer->health->paths++;
    if (!orl_aim_sample(&tracer->backward->aim, effort, way, stop->place.point, stop->place.normal,
                        u, &aimed))
        return orl_gray(0);
    struct walk w = {.tracer = tracer,
                     .origin = stop->place.point,
                     .direction = aimed.direction,
                     .weight = orl_gray(aimed.weight / ORL_PI),
                     .clarity = {1, 1, 1},
                     .importance = stop->importance,
                     .reflections = stop->reflections,
                     .cos_start = orl_dot(aimed.direction, stop->place.normal),
                     .straight = true,
                     .trail = orl_image_trail_from(aimed.direction),
                     .met = aimed.met,
                     .hit = aimed.hit};
    return orl_rgb_scale(follow(&w), ORL_PI);
}

static struct orl_rgb aimed_light(struct orl_tracer *tracer, const struct stop *stop)
{
    const struct orl_effort *effort =
        stop->sampling ? &stop->sampling->effort : &tracer->backward->deep;
    struct orl_rgb sum = orl_gray(0);
    for (int way = 0; way < ORL_WAYS; way++) {
        const double wanted = effort->rays[way], whole = floor(wanted);
        const bool more = wanted > whole && orl_random_uniform(&tracer->random) < wanted - whole;
        const uint32_t rays = (uint32_t)whole + more, each = (uint32_t)ceil(wanted);
        for (uint32_t n = 0; n < rays; n++) {
            double u[3];
            numbers(tracer, stop, SLOT_WAYS + (uint32_t)way, each, n, 3, u);
            sum = orl_rgb_add(sum, look(tracer, stop, effort, (enum orl_way)way, u));
        }
    }
    return sum;
}

/* Places that photons do not come to: outside, and what a BSDF stands for. */
static struct orl_rgb light_outside(struct orl_tracer *tracer, const struct stop *stop)
{
    const struct orl_world *world = tracer->backward->world;
    double u[3];
    numbers(tracer, stop, SLOT_WAYS, 1, 0, 3, u);
    const struct orl_vec3 direction = orl_hemisphere_about(stop->place.normal, u[0], u[1]);
    if (stop->place.proxied)
        return orl_rgb_scale(orl_exterior_radiance(orl_world_seen(world), stop->place.point,
                                                   direction, orl_chance_found(), &tracer->random,
                                                   tracer->health, NULL),
                             ORL_PI);
    struct walk w = {.tracer = tracer,
                     .origin = stop->place.point,
                     .direction = direction,
                     .weight = {1, 1, 1},
                     .clarity = {1, 1, 1},
                     .importance = stop->importance,
                     .reflections = stop->reflections,
                     .trail = orl_image_trail_from(direction),
                     .outside = true};
    return orl_rgb_scale(follow(&w), ORL_PI);
}

static struct orl_rgb light_at(struct orl_tracer *tracer, const struct stop *stop)
{
    const uint32_t most = tracer->backward->world->omit.most_reflections;
    struct orl_rgb sum = direct_light(tracer, stop);
    if (stop->place.outside)
        return orl_rgb_add(sum, light_outside(tracer, stop));
    if (stop->reflections < most)
        sum = orl_rgb_add(sum, some_lamps(tracer, stop));
    return orl_rgb_add(sum, aimed_light(tracer, stop));
}

struct orl_rgb orl_backward_light(struct orl_tracer *tracer, const struct orl_place *place,
                                  const struct orl_sampling *sampling)
{
    const struct stop stop = {.place = *place, .importance = 1, .sampling = sampling};
    return light_at(tracer, &stop);
}
