/* One sample of the backward technique: the light at a place, and the paths that estimate it. */
#include "light/proxies.h"
#include "render/backward/backward.h"
#include "scene/material/hemisphere.h"

enum { SURE_BOUNCES = 3 };
/* Weights below which paths undergo Russian roulette: in general, and in the first bounces, which
 * were importance sampled. */
static const double certain_weight = 0.25, dimmest_aimed = 0.002;
/*
 * Weight below which surfaces that a path meets are lit only with a probability. It is low because
 * a patch of sun can be a thousand times as bright as its surroundings. If few such paths saw it in
 * a pane, it would be an outlier.
 */
static const double dimmest_lit = 0.02;

/* State of a path since the last place where all parts of the light were estimated. */
struct walk {
    struct orl_eye_path eye; /* must be first: sinks receive a pointer to it */
    struct orl_tracer *tracer;
    double importance;            /* weight of the path's start in the sample, at most about 1 */
    uint32_t reflections;         /* number of diffuse reflections before the start */
    double cos_start, travelled;  /* cosine at that place, and length travelled since */
    bool straight;                /* true if the path has met only panes since then */
    struct orl_image_trail trail; /* mirrors met since the last lobe or diffuse surface */
    bool been_outside;
};

/* A place on a path where light is estimated. */
struct stop {
    struct orl_place place;
    double importance;
    uint32_t reflections;
    const struct orl_sampling *sampling; /* for the sample's first place; NULL at later ones */
};

static struct orl_rgb light_at(struct orl_tracer *tracer, const struct stop *stop);

static struct walk *walk_of(struct orl_eye_path *p)
{
    return (struct walk *)p;
}

/* Returns a new path with weight 1 and no MIS correction. */
static struct walk walk_from(struct orl_tracer *tracer, struct orl_vec3 origin,
                             struct orl_vec3 direction)
{
    return (struct walk){.eye = {.world = tracer->backward->world,
                                 .random = &tracer->random,
                                 .path = orl_path_from(origin, direction)},
                         .tracer = tracer,
                         .importance = 1,
                         .trail = orl_image_trail_from(direction)};
}

/* ---- Paths ----------------------------------------------------------------------------------- */

/*
 * Adds the light that a diffuse surface on the path reflects. Virtual lights account for it if they
 * see the place that the path started from; the path adds the share that they leave (orl_vpl_left).
 */
static void add_diffuse(struct walk *w, struct orl_rgb albedo)
{
    struct orl_eye_path *p = &w->eye;
    const struct orl_world *world = p->world;
    const struct orl_hit *hit = &p->hit;
    const struct orl_vec3 lit = orl_hit_facing(hit);
    const double left = w->straight
                            ? orl_vpl_left(&w->tracer->backward->vpls, w->cos_start,
                                           orl_dot(p->path.direction, hit->normal), w->travelled)
                            : 1;
    if (!(left > 0) || w->reflections >= world->omit.most_reflections)
        return;
    const double matters = w->importance * left * orl_rgb_max(orl_rgb_mul(p->path.weight, albedo));
    const double chance = fmin(matters / dimmest_lit, 1);
    if (chance < 1 && !(orl_random_uniform(p->random) < chance))
        return;
    const struct stop stop = {
        .place = {.point = orl_hit_leave(world->geometry, hit, lit), .normal = lit},
        .importance = fmin(matters / chance, 1),
        .reflections = w->reflections + 1};
    orl_eye_path_see(p, orl_rgb_scale(orl_rgb_mul(albedo, light_at(w->tracer, &stop)),
                                      left / (chance * ORL_PI)));
}

/* Adds a sun's disc only if no shadow ray could have sampled it. */
static void add_sun(struct orl_eye_path *p)
{
    const struct walk *w = walk_of(p);
    const bool deflected = w->trail.reflections > 0 || w->trail.strange;
    if (!deflected || w->been_outside || isfinite(p->chance.pdf))
        return;
    const struct orl_rgb sun = orl_world_sun_radiance(p->world, p->path.direction);
    if (orl_rgb_max(sun) > 0 && !orl_images_cover(p->world, &w->trail))
        orl_eye_path_see(p, sun);
}

/* Applies Russian roulette to dim and to long paths. The threshold of the first bounces is lower,
 * because importance-sampled rays have small weights only for being many. */
static bool survives(struct walk *w)
{
    const double matters = w->importance * orl_rgb_max(w->eye.path.weight);
    const double chance =
        fmin(matters / (w->eye.bounce < SURE_BOUNCES ? dimmest_aimed : certain_weight), 1);
    return !(chance < 1) || orl_path_survives(&w->eye.path, chance, w->eye.random);
}

/* Adds the light that the surface emits and reflects. The path continues by mirrors, panes and
 * lobes. */
static enum orl_lobes shade_surface(struct orl_eye_path *p, const struct orl_material *m)
{
    struct walk *w = walk_of(p);
    const struct orl_vec3 eye = orl_path_back(&p->path);
    const struct orl_rgb albedo = orl_material_diffuse(m, &p->hit);
    w->travelled += p->hit.distance;
    orl_eye_path_see(p, orl_shining(p->world, &p->hit, eye, &p->chance));
    if (orl_rgb_max(albedo) > 0)
        add_diffuse(w, albedo);
    if (orl_material_has_lobes(m))
        orl_eye_path_see(p, orl_direct_by_lobes(p->world, &p->hit, m, eye, p->random));
    return survives(w) ? (enum orl_lobes)(ORL_LOBE_REFLECTED | ORL_LOBE_TRANSMITTED)
                       : ORL_LOBE_NONE;
}

static bool note_event(struct orl_eye_path *p, const struct orl_scatter *s)
{
    struct walk *w = walk_of(p);
    p->chance = orl_chance_after(p->world, &p->hit, orl_path_back(&p->path), s, p->chance);
    orl_eye_path_cross(p, s);
    p->clear = p->clear && p->outside;
    if (s->event == ORL_EVENT_STRAIGHT)
        return true;
    w->straight = false;
    if (s->event == ORL_EVENT_GLOSSY)
        w->trail = orl_image_trail_from(s->direction);
    else if (s->event == ORL_EVENT_MIRROR)
        orl_image_trail_add(&w->trail, &p->world->images, p->hit.facet);
    else
        w->trail.strange = true;
    return true;
}

/* Continues the path outdoors, where virtual lights account for nothing (vpl.c). Shadow rays to
 * mirror images account for the suns there. */
static bool continue_outdoors(struct orl_eye_path *p)
{
    struct walk *w = walk_of(p);
    w->straight = false;
    w->been_outside = true;
    return orl_exterior_pass(p, w->tracer->health);
}

/* Handles scattering by mist, where suns and lamps have been sampled already. */
static bool handle_mist_event(struct orl_eye_path *p)
{
    struct walk *w = walk_of(p);
    w->straight = false;
    w->trail = orl_image_trail_from(p->path.direction);
    return survives(w);
}

static const struct orl_eye_sink sink = {.outdoors = continue_outdoors,
                                         .escaped = add_sun,
                                         .met = shade_surface,
                                         .scattered = handle_mist_event,
                                         .sent_on = note_event};

/* Follows the path to its end and returns the radiance that it has collected. */
static struct orl_rgb follow_path(struct walk *w)
{
    orl_eye_path_follow(&w->eye, &sink, w->tracer->health);
    return w->eye.seen;
}

struct orl_rgb orl_backward_radiance(struct orl_tracer *tracer, struct orl_vec3 origin,
                                     struct orl_vec3 direction, bool outside,
                                     struct orl_chance chance)
{
    struct walk w = walk_from(tracer, origin, direction);
    w.eye.chance = chance;
    w.eye.outside = outside;
    tracer->health->paths++;
    return follow_path(&w);
}

/* ---- Light at a place ------------------------------------------------------------------------ */

/* Returns the normal that cosines are measured from. */
static struct orl_vec3 normal_of(const struct stop *stop)
{
    return stop->place.textured ? stop->place.shading : stop->place.normal;
}

/* Dimensions of a sample's sequence, by use. */
enum slot { SLOT_SUN, SLOT_LAMPS, SLOT_WAYS };

/* Returns numbers in [0,1) for the n-th of each sample's draws in that slot. */
static void draw_numbers(struct orl_tracer *tracer, const struct stop *stop, uint32_t slot,
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
                                           .shading =
                                               stop->place.textured ? &stop->place.shading : NULL,
                                           .through_ports = true,
                                           .mirrored = true,
                                           .u = u};
    draw_numbers(tracer, stop, SLOT_SUN, 1, 0, 2, u);
    return orl_direct_light(stop->place.proxied ? orl_world_seen(world) : world, &query,
                            &tracer->random);
}

static struct orl_rgb some_lamps(struct orl_tracer *tracer, const struct stop *stop)
{
    double u;
    draw_numbers(tracer, stop, SLOT_LAMPS, 1, 0, 1, &u);
    return orl_vpl_light(&tracer->backward->vpls, tracer->group, u,
                         stop->sampling ? stop->sampling->lamps : 1, stop->place.point,
                         normal_of(stop));
}

/* Reflects a direction about a turned normal that points below the surface back above it. Returns
 * false if the direction is left as it is. */
static bool fold_direction(const struct stop *stop, struct orl_vec3 *direction)
{
    const double cosine = orl_dot(*direction, stop->place.normal);
    if (!stop->place.textured || cosine > 0)
        return false;
    *direction = orl_madd(*direction, stop->place.normal, -2 * cosine);
    return true;
}

/* Returns the contribution of one importance-sampled ray. */
static struct orl_rgb trace_aimed_ray(struct orl_tracer *tracer, const struct stop *stop,
                                      const struct orl_effort *effort, enum orl_way way,
                                      const double u[3])
{
    struct orl_aimed aimed;
    tracer->health->paths++;
    if (!orl_aim_sample(&tracer->backward->aim, effort, way, stop->place.point, normal_of(stop), u,
                        &aimed))
        return orl_gray(0);
    const double cosine = orl_dot(aimed.direction, normal_of(stop));
    const bool folded = fold_direction(stop, &aimed.direction);
    struct walk w = walk_from(tracer, stop->place.point, aimed.direction);
    w.eye.path.weight = orl_gray(aimed.weight / ORL_PI);
    w.importance = stop->importance;
    w.reflections = stop->reflections;
    w.cos_start = cosine;
    w.straight = !folded; /* virtual lights have not accounted for light from there */
    if (!folded)
        orl_eye_path_foresee(&w.eye, aimed.met ? &aimed.hit : NULL);
    return orl_rgb_scale(follow_path(&w), ORL_PI);
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
            draw_numbers(tracer, stop, SLOT_WAYS + (uint32_t)way, each, n, 3, u);
            sum = orl_rgb_add(sum, trace_aimed_ray(tracer, stop, effort, (enum orl_way)way, u));
        }
    }
    return sum;
}

/* Returns the light at places that photons do not reach: outdoors, and on surfaces that a BSDF
 * stands for. */
static struct orl_rgb light_outside(struct orl_tracer *tracer, const struct stop *stop)
{
    const struct orl_world *world = tracer->backward->world;
    double u[3];
    draw_numbers(tracer, stop, SLOT_WAYS, 1, 0, 3, u);
    struct orl_vec3 direction = orl_hemisphere_about(normal_of(stop), u[0], u[1]);
    fold_direction(stop, &direction);
    if (stop->place.proxied)
        return orl_rgb_scale(orl_exterior_radiance(orl_world_seen(world), stop->place.point,
                                                   direction, orl_chance_found(), &tracer->random,
                                                   tracer->health, NULL),
                             ORL_PI);
    struct walk w = walk_from(tracer, stop->place.point, direction);
    w.importance = stop->importance;
    w.reflections = stop->reflections;
    w.eye.outside = true;
    return orl_rgb_scale(follow_path(&w), ORL_PI);
}

static struct orl_rgb light_at(struct orl_tracer *tracer, const struct stop *stop)
{
    const uint32_t most = tracer->backward->world->omit.most_reflections;
    struct orl_rgb sum = direct_light(tracer, stop);
    if (stop->place.outside)
        return orl_rgb_add(sum, light_outside(tracer, stop));
    if (stop->reflections < most && !tracer->backward->world->scene->mist)
        sum = orl_rgb_add(sum, some_lamps(tracer, stop));
    return orl_rgb_add(sum, aimed_light(tracer, stop));
}

struct orl_rgb orl_backward_light(struct orl_tracer *tracer, const struct orl_place *place,
                                  const struct orl_sampling *sampling)
{
    const struct stop stop = {.place = *place, .importance = 1, .sampling = sampling};
    return light_at(tracer, &stop);
}
