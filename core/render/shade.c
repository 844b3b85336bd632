#include "render/shade.h"

enum { MOST_SPLITS = 6, PANE_SAMPLES = 32, GLOSS_SAMPLES = 4 };
static const double dimmest = 0.004; /* branches below this share of the pixel are not followed */

/* One branch of the ray still to be followed. */
struct branch {
    struct orl_vec3 origin, direction;
    struct orl_rgb weight;
    double distance;
    bool outside;
    uint32_t splits;
};

struct look {
    const struct orl_gather *gather;
    struct orl_random *random;
    struct orl_search *search;
    struct orl_sight *sight;
    bool only_vertices;
    struct branch stack[2 * MOST_SPLITS];
    uint32_t depth;
};

static void add(struct look *look, struct orl_rgb weight, struct orl_rgb radiance)
{
    look->sight->rest = orl_rgb_add(look->sight->rest, orl_rgb_mul(weight, radiance));
}

static void follow(struct look *look, const struct branch *from, const struct orl_hit *hit,
                   struct orl_vec3 direction, struct orl_rgb share, bool transmitted)
{
    const struct orl_world *world = look->gather->world;
    struct branch next = {.direction = direction,
                          .weight = orl_rgb_mul(from->weight, share),
                          .distance = from->distance + hit->distance,
                          .outside = from->outside,
                          .splits = from->splits + 1};
    if (orl_rgb_max(next.weight) < dimmest || look->depth >= 2 * MOST_SPLITS ||
        next.splits > MOST_SPLITS)
        return;
    next.origin = orl_hit_leave(world->geometry, hit, direction);
    if (transmitted && !world->open) {
        const enum orl_crossing crossing = orl_world_crossing(world, hit);
        if (crossing != ORL_CROSSING_NONE)
            next.outside = crossing == ORL_CROSSING_OUTWARDS;
    }
    look->stack[look->depth++] = next;
}

static void add_vertex(struct look *look, const struct branch *at, const struct orl_hit *hit,
                       const struct orl_material *m)
{
    const struct orl_vec3 seen = hit->front ? hit->normal : orl_neg(hit->normal);
    if (look->sight->n_vertices >= ORL_SHADE_VERTICES)
        return;
    look->sight->vertices[look->sight->n_vertices++] = (struct orl_vertex){
        .place = {.point = orl_hit_leave(look->gather->world->geometry, hit, seen),
                  .normal = seen,
                  .outside = at->outside},
        .on_surface = hit->point,
        .weight = orl_rgb_scale(orl_rgb_mul(at->weight, orl_material_diffuse(m)), 1 / ORL_PI),
        .distance = at->distance + hit->distance};
}

/* Suns and lights in the lobes of a surface, from one side, averaged over a few shadow rays. */
static struct orl_rgb direct_in_lobes(struct look *look, const struct orl_hit *hit,
                                      const struct orl_material *m, struct orl_vec3 eye,
                                      struct orl_vec3 side, uint32_t samples)
{
    const struct orl_direct_query query = {
        .point = orl_hit_leave(look->gather->world->geometry, hit, side),
        .normal = side,
        .through_ports = true,
        .lobes = m,
        .hit = hit,
        .eye = eye};
    struct orl_rgb sum = orl_gray(0);
    for (uint32_t i = 0; i < samples; i++)
        sum = orl_rgb_add(sum, orl_direct_light(look->gather->world, &query, look->random));
    return orl_rgb_scale(sum, 1.0 / samples);
}

static struct orl_scatter sample_lobes(const struct look *look, const struct orl_hit *hit,
                                       const struct orl_material *m, struct orl_vec3 eye,
                                       uint32_t sample, uint32_t sequence)
{
    const enum orl_lobes lobes = (enum orl_lobes)(ORL_LOBE_REFLECTED | ORL_LOBE_TRANSMITTED);
    double u[3];
    if (!orl_material_transmits_lobes(m))
        return orl_scatter_sample(m, hit, eye, ORL_TRANSPORT_EYE, lobes, look->random);
    orl_sobol_point(&look->gather->sobol, sample, sequence, 3, u);
    return orl_scatter_sample_at(m, hit, eye, ORL_TRANSPORT_EYE, lobes, u);
}

/* Lobes of a surface: lights directly, all else by a few rays. */
static void add_lobes(struct look *look, const struct branch *at, const struct orl_hit *hit,
                      const struct orl_material *m, uint32_t samples)
{
    const struct orl_world *world = look->gather->world;
    const struct orl_vec3 eye = orl_neg(at->direction);
    const struct orl_vec3 seen = hit->front ? hit->normal : orl_neg(hit->normal);
    const enum orl_crossing crossing = orl_world_crossing(world, hit);
    struct orl_rgb sum = orl_gray(0);
    add(look, at->weight, direct_in_lobes(look, hit, m, eye, seen, 2));
    if (orl_material_transmits_lobes(m))
        add(look, at->weight, direct_in_lobes(look, hit, m, eye, orl_neg(seen), 2));
    const uint32_t sequence = (uint32_t)orl_random_bits(look->random);
    for (uint32_t i = 0; i < samples; i++) {
        const struct orl_scatter s = sample_lobes(look, hit, m, eye, i, sequence);
        bool outside = at->outside;
        if (s.event == ORL_EVENT_ABSORBED)
            continue;
        if (s.transmitted && crossing != ORL_CROSSING_NONE)
            outside = !world->open && crossing == ORL_CROSSING_OUTWARDS;
        const struct orl_rgb seen_there =
            orl_gather_radiance(look->gather, orl_hit_leave(world->geometry, hit, s.direction),
                                s.direction, outside, look->random, look->search);
        sum = orl_rgb_add(sum, orl_rgb_mul(s.weight, seen_there));
    }
    add(look, at->weight, orl_rgb_scale(sum, 1.0 / samples));
}

static void meet(struct look *look, const struct branch *at, const struct orl_hit *hit)
{
    const struct orl_material *m = orl_world_material(look->gather->world, hit);
    const struct orl_vec3 eye = orl_neg(at->direction);
    const double cosine = orl_dot(eye, hit->normal);
    const struct orl_vec3 mirrored = orl_sub(orl_scale(hit->normal, 2 * cosine), eye);
    if (orl_rgb_max(orl_material_diffuse(m)) > 0)
        add_vertex(look, at, hit, m);
    follow(look, at, hit, mirrored, orl_material_mirrored(m, hit, eye), false);
    follow(look, at, hit, at->direction, orl_material_straight(m, hit, eye), true);
    if (orl_material_has_lobes(m) && !look->only_vertices)
        add_lobes(look, at, hit, m, orl_material_transmits_lobes(m) ? PANE_SAMPLES : GLOSS_SAMPLES);
    add(look, at->weight, orl_material_emission(m, hit, eye));
}

void orl_shade_look(const struct orl_gather *gather, struct orl_vec3 origin,
                    struct orl_vec3 direction, bool outside, bool only_vertices,
                    struct orl_random *random, struct orl_search *search,
                    struct orl_sight *ret_sight)
{
    const struct orl_world *world = gather->world;
    struct look look = {.gather = gather,
                        .random = random,
                        .search = search,
                        .sight = ret_sight,
                        .only_vertices = only_vertices};
    ret_sight->n_vertices = 0;
    ret_sight->rest = orl_gray(0);
    look.stack[look.depth++] = (struct branch){origin, direction, orl_gray(1), 0, outside, 0};
    while (look.depth > 0) {
        const struct branch at = look.stack[--look.depth];
        struct orl_hit hit;
        search->health.rays++;
        if (orl_geometry_intersect(world->geometry, at.origin, at.direction, INFINITY, &hit)) {
            meet(&look, &at, &hit);
            continue;
        }
        search->health.rays_leaked += !world->open && !at.outside;
        add(&look, at.weight,
            orl_rgb_add(orl_world_dome_radiance(world, at.direction),
                        orl_world_sun_radiance(world, at.direction)));
    }
}
