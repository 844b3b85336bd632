#include "light/exterior.h"

enum { SURE_BOUNCES = 3 };

/* State of a path outdoors. */
struct exterior_path {
    struct orl_eye_path eye; /* first member: visitors cast its address to the exterior_path */
    /* set: the path may pass ports and finds light that has passed ports; NULL: first light only */
    struct orl_building_entry *ret_entry;
    bool diffused;
    struct orl_health *health;
};

/* Returns the light of suns and lamps on one side of the surface: irradiance, or what lobes scatter
 * towards the eye. */
static struct orl_rgb direct_on_side(const struct exterior_path *o, const struct orl_hit *hit,
                                     const struct orl_material *lobes, struct orl_vec3 eye,
                                     struct orl_vec3 side)
{
    const struct orl_lit_scene *lit_scene = o->eye.lit_scene;
    const struct orl_direct_query query = {.point =
                                               orl_hit_ray_origin(lit_scene->geometry, hit, side),
                                           .normal = side,
                                           .through_ports = o->ret_entry != NULL,
                                           .lobes = lobes,
                                           .hit = hit,
                                           .eye = eye,
                                           .mirrored = true};
    return orl_direct_light(lit_scene, &query, o->eye.random);
}

/*
 * Returns true if this path counts light from behind the surface. First light has passed no port,
 * so light through a pane in front of another pane is excluded: that pane emits it.
 */
static bool counts_light_behind(const struct exterior_path *o, const struct orl_hit *hit)
{
    return o->ret_entry || orl_lit_scene_crossing(o->eye.lit_scene, hit) == ORL_CROSSING_NONE;
}

/* Returns the light of suns and lamps that this surface scatters towards the eye. */
static struct orl_rgb scattered_direct(const struct exterior_path *o, const struct orl_hit *hit,
                                       struct orl_vec3 eye)
{
    const struct orl_material *m = orl_lit_scene_material(o->eye.lit_scene, hit);
    const struct orl_vec3 normal = orl_hit_facing(hit);
    const struct orl_rgb diffuse = orl_material_diffuse(m, hit);
    struct orl_rgb sum = orl_gray(0);
    if (orl_rgb_max(diffuse) > 0)
        sum = orl_rgb_mul(orl_rgb_scale(diffuse, 1 / ORL_PI),
                          direct_on_side(o, hit, NULL, eye, normal));
    if (orl_material_has_lobes(m))
        sum = orl_rgb_add(sum, direct_on_side(o, hit, m, eye, normal));
    if (orl_material_transmits_lobes(m) && counts_light_behind(o, hit))
        sum = orl_rgb_add(sum, direct_on_side(o, hit, m, eye, orl_neg(normal)));
    return sum;
}

/*
 * Returns the light of suns by a BSDF port that is met from outside after a diffuse bounce. Its
 * sharp lobes would put the sun on the ground as sparks that hardly any path finds. So their flux
 * is conserved and their shape is not: light is scattered diffusely, by the albedo for its
 * direction of incidence.
 */
static struct orl_rgb diffused_bsdf_direct(const struct exterior_path *o, const struct orl_hit *hit)
{
    const struct orl_lit_scene *lit_scene = o->eye.lit_scene;
    const struct orl_material *m = orl_lit_scene_material(lit_scene, hit);
    const struct orl_vec3 normal = orl_hit_facing(hit);
    struct orl_rgb sum = orl_gray(0);
    for (size_t i = 0; i < lit_scene->n_suns; i++) {
        const struct orl_vec3 sun = lit_scene->suns[i].frame.n;
        const double cosine = orl_dot(sun, normal);
        if (cosine == 0 || (cosine < 0 && !counts_light_behind(o, hit)))
            continue;
        const struct orl_vec3 side = cosine > 0 ? normal : orl_neg(normal);
        const struct orl_rgb albedo = orl_material_albedo(
            m, hit, sun, cosine > 0 ? ORL_LOBE_REFLECTED : ORL_LOBE_TRANSMITTED);
        const struct orl_rgb share =
            orl_transmittance(lit_scene, orl_hit_ray_origin(lit_scene->geometry, hit, side), sun,
                              INFINITY, o->ret_entry != NULL);
        sum = orl_rgb_add(sum, orl_rgb_scale(orl_rgb_mul(orl_rgb_mul(albedo, share),
                                                         lit_scene->suns[i].irradiance),
                                             fabs(cosine) / ORL_PI));
    }
    return sum;
}

/*
 * Returns the radiance of unobstructed domes and of lights. Surfaces outside transmit or block
 * light, and reflect none.
 */
static struct orl_rgb unreflected_radiance(struct exterior_path *o)
{
    struct orl_eye_path *p = &o->eye;
    const struct orl_lit_scene *lit_scene = p->lit_scene;
    o->health->paths++;
    for (int pane = 0; pane < ORL_MOST_PANES; pane++) {
        o->health->rays++;
        if (!orl_path_intersect(lit_scene, &p->path, &p->hit)) {
            orl_eye_path_add_radiance(p, orl_lit_scene_dome_radiance(lit_scene, p->path.direction));
            return p->seen;
        }
        orl_eye_path_add_radiance(
            p, orl_emitted_radiance(lit_scene, &p->hit, orl_path_back(&p->path), &p->chance));
        if (!orl_path_transmit_straight(&p->path, orl_lit_scene_material(lit_scene, &p->hit),
                                        &p->hit) ||
            !counts_light_behind(o, &p->hit) ||
            orl_lit_scene_crossing(lit_scene, &p->hit) == ORL_CROSSING_INWARDS)
            return p->seen;
        orl_path_skip_surface(&p->path, lit_scene, &p->hit);
    }
    return p->seen;
}

bool orl_port_traces_exterior(const struct orl_lit_scene *lit_scene, const struct orl_port *port)
{
    return !port->clear && !lit_scene->omit.exterior;
}

struct orl_rgb orl_port_radiance(const struct orl_lit_scene *lit_scene, const struct orl_port *port,
                                 struct orl_vec3 origin, struct orl_vec3 direction,
                                 struct orl_random *random, struct orl_health *health)
{
    if (!port->clear)
        return orl_exterior_radiance(lit_scene, origin, direction, orl_mis_pdf_zero_straight(),
                                     random, health, NULL);
    health->paths++;
    return orl_lit_scene_dome_radiance(lit_scene, direction);
}

/* ---- Path tracing ---------------------------------------------------------------------------- */

static struct exterior_path *exterior_path_of(struct orl_eye_path *p)
{
    return (struct exterior_path *)p;
}

static bool is_entry(const struct orl_eye_path *p)
{
    return orl_lit_scene_crossing(p->lit_scene, &p->hit) == ORL_CROSSING_INWARDS;
}

/* Returns true if sunlight is scattered diffusely at the hit (diffused_bsdf_direct). */
static bool is_diffused_bsdf(const struct exterior_path *o, const struct orl_material *m)
{
    return o->diffused && m->kind == ORL_MATERIAL_BSDF && is_entry(&o->eye);
}

static void count_ray(struct orl_eye_path *p)
{
    exterior_path_of(p)->health->rays++;
}

static enum orl_lobes shade_hit(struct orl_eye_path *p, const struct orl_material *m)
{
    const struct exterior_path *o = exterior_path_of(p);
    const struct orl_vec3 eye = orl_path_back(&p->path);
    count_ray(p);
    orl_eye_path_add_radiance(p, orl_emitted_radiance(p->lit_scene, &p->hit, eye, &p->chance));
    orl_eye_path_add_radiance(p, is_diffused_bsdf(o, m) ? diffused_bsdf_direct(o, &p->hit)
                                                        : scattered_direct(o, &p->hit, eye));
    return counts_light_behind(o, &p->hit)
               ? ORL_LOBE_ALL
               : (enum orl_lobes)(ORL_LOBE_REFLECTED | ORL_LOBE_DIFFUSE);
}

/* Russian roulette for long paths; hands paths that enter a building back to the caller. */
static bool continue_path(struct orl_eye_path *p, const struct orl_surface_sample *s)
{
    struct exterior_path *o = exterior_path_of(p);
    if (p->bounce >= SURE_BOUNCES &&
        !orl_path_roulette(&p->path, orl_smaller(orl_rgb_max(p->path.weight), 1), p->random))
        return false;
    p->chance =
        is_diffused_bsdf(o, orl_lit_scene_material(p->lit_scene, &p->hit))
            ? orl_mis_pdf_zero()
            : orl_mis_pdf_update(p->lit_scene, &p->hit, orl_path_back(&p->path), s, p->chance);
    o->diffused = o->diffused || s->event == ORL_EVENT_DIFFUSE;
    if (!o->ret_entry || !s->transmitted || !is_entry(p))
        return true;
    orl_path_spawn_ray(&p->path, p->lit_scene, &p->hit, s);
    *o->ret_entry = (struct orl_building_entry){true, p->path, p->chance};
    return false;
}

static const struct orl_path_visitor visitor = {
    .escaped = count_ray, .met = shade_hit, .on_sampled = continue_path};

/* Follows the path to its end, or to where it enters a building. */
static struct orl_rgb trace_path(struct exterior_path *o)
{
    o->health->paths++;
    orl_eye_path_trace(&o->eye, &visitor, o->health);
    return o->eye.seen;
}

/* ---- Entry points ---------------------------------------------------------------------------- */

/* Sets all members but the path. Does not clear the struct first: most of it is the hit, which
 * is written later. */
static void init_exterior_path(struct exterior_path *o, const struct orl_lit_scene *lit_scene,
                               struct orl_mis_pdf chance, struct orl_random *random,
                               struct orl_health *health)
{
    struct orl_eye_path *p = &o->eye;
    p->lit_scene = lit_scene;
    p->random = random;
    p->seen = orl_gray(0);
    p->chance = chance;
    p->bounce = 0;
    p->outside = p->clear = p->next_hit_known = p->met = false;
    o->ret_entry = NULL;
    o->diffused = false;
    o->health = health;
}

struct orl_rgb orl_exterior_radiance_from(const struct orl_lit_scene *lit_scene,
                                          struct orl_vec3 direction, const struct orl_hit *first,
                                          struct orl_mis_pdf chance, struct orl_random *random,
                                          struct orl_health *health)
{
    struct exterior_path exterior_path;
    init_exterior_path(&exterior_path, lit_scene, chance, random, health);
    exterior_path.eye.path = orl_path_from(orl_v3(0, 0, 0), direction);
    orl_eye_path_set_next_hit(&exterior_path.eye, first);
    return trace_path(&exterior_path);
}

struct orl_rgb orl_exterior_radiance(const struct orl_lit_scene *lit_scene, struct orl_vec3 origin,
                                     struct orl_vec3 direction, struct orl_mis_pdf chance,
                                     struct orl_random *random, struct orl_health *health,
                                     struct orl_building_entry *ret_entry)
{
    struct exterior_path exterior_path;
    init_exterior_path(&exterior_path, lit_scene, chance, random, health);
    exterior_path.eye.path = orl_path_from(origin, direction);
    exterior_path.ret_entry = ret_entry;
    if (ret_entry)
        ret_entry->entered = false;
    return lit_scene->omit.exterior ? unreflected_radiance(&exterior_path)
                                    : trace_path(&exterior_path);
}

bool orl_exterior_continue(struct orl_eye_path *p, struct orl_health *health)
{
    struct orl_building_entry entry;
    orl_eye_path_add_radiance(p,
                              orl_exterior_radiance(p->lit_scene, p->path.origin, p->path.direction,
                                                    p->chance, p->random, health, &entry));
    if (!entry.entered)
        return false;
    const struct orl_rgb weight = orl_rgb_mul(p->path.weight, entry.path.weight);
    p->path = entry.path;
    p->path.weight = weight;
    p->chance = entry.chance;
    p->outside = false;
    return true;
}
