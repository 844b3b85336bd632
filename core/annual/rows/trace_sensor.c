#include "annual/rows/trace_sensor.h"

#include "annual/sun/sunlight.h"
#include "light/eye_path.h"

/* Rays per strategy: at the sensor, at surfaces that a ray hits, and outside a sealed building.
 * Outside, no ray is aimed at the building's windows. */
static const struct orl_effort at_sensors = {{1, 1, 0, 0.5}}, deeper = {{1, 0.5, 0, 0}},
                               outside = {{1, 0, 0}};
/* Thresholds of Russian roulette, as shares of one sample of the sensor. */
static const double dimmest_place = 0.03, dimmest_path = 0.02;

struct tracer {
    const struct orl_annual_scene *scene;
    struct orl_annual_sums *sums;
    struct orl_random random;
    struct orl_health *health;
    uint32_t sequence, index; /* keys of the sample's Sobol points */
};

/* A shading point. Its irradiance contributes to the sensor with this weight. */
struct stop {
    struct orl_place place;
    struct orl_rgb weight;
    uint32_t depth;       /* 0: the sensor */
    int32_t port;         /* first port by which the path left the building; or ORL_NO_PORT */
    const double *evenly; /* three Sobol numbers for its first ray, or NULL */
    bool mapped;          /* true if the map has already added the sun */
    bool known;           /* true if a whole map has already added all indoor light of the map */
};

struct walk {
    struct orl_eye_path eye; /* must come first: callbacks receive it */
    struct tracer *tracer;
    uint32_t depth;
    int32_t port; /* from the stop where the path started, or set at the first crossing outwards */
    bool known;   /* known of the stop where the path started */
    const double *evenly;
    bool bent;          /* true once the path has left its initial direction */
    bool straight_only; /* true if the path ends at surfaces */
};

static void light_at(struct tracer *t, const struct stop *stop);

static struct walk *walk_of(struct orl_eye_path *p)
{
    return (struct walk *)p;
}

/* ---- A path ---------------------------------------------------------------------------------- */

static void add_sky(struct orl_eye_path *p)
{
    const struct walk *w = walk_of(p);
    const struct orl_annual_scene *scene = w->tracer->scene;
    const struct orl_vec3 towards = orl_turn_to_sky(scene->north, p->path.direction);
    orl_annual_add_to_bin(w->tracer->sums, orl_annual_part_of(scene, w->port),
                          orl_bins_find(scene->bins, towards), orl_luma(p->path.weight));
}

static void add_diffuse(struct walk *w, struct orl_rgb albedo)
{
    struct orl_eye_path *p = &w->eye;
    const struct orl_vec3 lit = orl_hit_facing(&p->hit);
    const struct orl_rgb weight = orl_rgb_scale(orl_rgb_mul(p->path.weight, albedo), 1 / ORL_PI);
    const bool mapped = w->tracer->scene->map && !p->outside;
    if (mapped && !w->known)
        orl_sun_map_add(w->tracer->scene->map, &p->hit, weight, w->tracer->sums->beams,
                        w->tracer->sums->lots);
    struct stop stop = {.place = {.point = orl_hit_leave(p->world->geometry, &p->hit, lit),
                                  .normal = lit,
                                  .outside = p->outside},
                        .weight = weight,
                        .mapped = mapped,
                        .known = w->known || (mapped && w->tracer->scene->whole_map),
                        .depth = w->depth + 1,
                        .port = w->port,
                        .evenly = p->bounce == 0 ? w->evenly : NULL};
    const double chance = fmin(orl_rgb_max(stop.weight) / dimmest_place, 1);
    if (chance < 1) {
        if (!(orl_random_uniform(p->random) < chance))
            return;
        stop.weight = orl_rgb_scale(stop.weight, 1 / chance);
    }
    light_at(w->tracer, &stop);
}

/* Adds sunlight by the lobes of the surface hit. sides: 1 for the side of the ray, 2 for both
 * sides. */
static void add_lobes(struct walk *w, const struct orl_material *m, int sides)
{
    struct orl_eye_path *p = &w->eye;
    const struct orl_vec3 seen = orl_hit_facing(&p->hit);
    for (int side = 0; side < sides; side++) {
        const struct orl_vec3 normal = side == 0 ? seen : orl_neg(seen);
        const struct orl_sunlit_query query = {
            .place = {.point = orl_hit_leave(p->world->geometry, &p->hit, normal),
                      .normal = normal,
                      .outside = orl_world_outside_after(p->world, &p->hit, side == 1, p->outside)},
            .weight = p->path.weight,
            .port = w->port,
            .all = w->depth == 0,
            .lobes = m,
            .hit = &p->hit,
            .eye = orl_path_back(&p->path)};
        orl_sunlit_add(w->tracer->scene, &query, p->random, w->tracer->sums);
    }
}

/*
 * The map contains the light that lobes inside throw on surfaces, but not the light they send to
 * the sensor. Light of panels straight to the sensor belongs to bsdf_panes.h. Sunlight that a panel
 * reflects to surfaces outdoors keeps its flux, but not its directional distribution, as on
 * exterior paths. Towards a sensor outdoors it keeps both.
 */
static void add_sun_by_lobes(struct walk *w, const struct orl_material *m)
{
    const bool panel = m->kind == ORL_MATERIAL_BSDF;
    if (!w->tracer->sums->nodes)
        return;
    if (!w->eye.outside && w->tracer->scene->map && w->depth > 0)
        return;
    add_lobes(w, m, orl_material_transmits_lobes(m) && (!panel || w->bent) ? 2 : 1);
}

static bool survives(struct walk *w)
{
    const double matters = orl_rgb_max(w->eye.path.weight) / ORL_PI;
    const double chance = fmin(matters / dimmest_path, 1);
    return !(chance < 1) || orl_path_survives(&w->eye.path, chance, w->eye.random);
}

/* Records a path that ends at a window and returns true. Returns false if paths pass windows or the
 * surface is no window. */
static bool record_exit(const struct walk *w)
{
    const struct orl_eye_path *p = &w->eye;
    struct orl_annual_exits *exits = w->tracer->sums->exits;
    const int32_t port = exits ? orl_world_port_of(p->world, p->hit.facet) : ORL_NO_PORT;
    if (port == ORL_NO_PORT)
        return false;
    const uint32_t window = exits->window_of_port[port];
    const struct orl_vec3 leaving =
        orl_to_local(&exits->frames[window], orl_neg(p->path.direction));
    const int cell = orl_basis_cell(exits->basis, orl_polar_of(leaving), 0);
    if (cell < 0 || !(leaving.z > 0))
        return true;
    const size_t at = (size_t)window * (size_t)exits->basis->n_cells + (size_t)cell;
    const float luma = (float)orl_luma(p->path.weight);
    exits->all[at] += luma;
    if (w->depth == 0 && !w->bent)
        exits->straight[at] += luma;
    return true;
}

static enum orl_lobes handle_hit(struct orl_eye_path *p, const struct orl_material *m)
{
    struct walk *w = walk_of(p);
    const struct orl_rgb albedo = orl_material_diffuse(m, &p->hit);
    w->tracer->health->rays++;
    if (record_exit(w))
        return ORL_LOBE_NONE;
    if (orl_rgb_max(albedo) > 0 && !w->straight_only)
        add_diffuse(w, albedo);
    if (orl_material_is_matt(m))
        return ORL_LOBE_NONE;
    if (orl_material_has_lobes(m))
        add_sun_by_lobes(w, m);
    return survives(w) ? (enum orl_lobes)(ORL_LOBE_REFLECTED | ORL_LOBE_TRANSMITTED)
                       : ORL_LOBE_NONE;
}

static bool handle_scattered(struct orl_eye_path *p, const struct orl_scatter *s)
{
    const bool inside = !p->outside;
    orl_eye_path_cross(p, s);
    p->clear = false;
    if (inside && p->outside && walk_of(p)->port == ORL_NO_PORT)
        walk_of(p)->port = orl_world_port_of(p->world, p->hit.facet);
    walk_of(p)->bent = walk_of(p)->bent || s->event != ORL_EVENT_STRAIGHT;
    return !(walk_of(p)->bent && walk_of(p)->straight_only);
}

static const struct orl_eye_sink sink = {
    .escaped = add_sky, .met = handle_hit, .sent_on = handle_scattered};

/* ---- The light of a place -------------------------------------------------------------------- */

/* Traces one ray sampled by a strategy. u: three numbers for the ray, and three for the surface it
 * hits. */
static void trace_ray(struct tracer *t, const struct stop *stop, const struct orl_effort *effort,
                      enum orl_way way, const double u[6], bool evenly)
{
    struct orl_aimed aimed;
    t->health->paths++;
    if (!orl_aim_sample(&t->scene->aim, effort, way, stop->place.point, stop->place.normal, u,
                        &aimed))
        return;
    struct walk w = {.eye = {.world = t->scene->world,
                             .random = &t->random,
                             .path = orl_path_from(stop->place.point, aimed.direction),
                             .outside = stop->place.outside},
                     .tracer = t,
                     .depth = stop->depth,
                     .port = stop->port,
                     .known = stop->known,
                     .evenly = evenly ? u + 3 : NULL};
    w.eye.path.weight = orl_rgb_scale(stop->weight, aimed.weight);
    orl_eye_path_foresee(&w.eye, aimed.met ? &aimed.hit : NULL);
    orl_eye_path_follow(&w.eye, &sink, t->health);
}

static void trace_strategy(struct tracer *t, const struct stop *stop,
                           const struct orl_effort *effort, enum orl_way way)
{
    const double wanted = effort->rays[way];
    const bool evenly = stop->depth == 0;
    double u[6];
    if (!(wanted > 0) || (wanted < 1 && !(orl_random_uniform(&t->random) < wanted)))
        return;
    if (evenly)
        orl_sobol_point(&t->scene->sobol, t->index, t->sequence + (uint32_t)way * 0x9e3779b9U, 6,
                        u);
    for (int i = 0; i < 3 && !evenly; i++)
        u[i] = stop->evenly && way == ORL_WAY_COSINE ? stop->evenly[i]
                                                     : orl_random_uniform(&t->random);
    trace_ray(t, stop, effort, way, u, evenly);
}

static void light_at(struct tracer *t, const struct stop *stop)
{
    const struct orl_effort effort = orl_aim_effort(&t->scene->aim, stop->place.outside ? outside
                                                                    : stop->depth == 0  ? at_sensors
                                                                                        : deeper);
    if (t->sums->nodes && stop->depth > 0 &&
        (!stop->mapped || t->scene->mirrors.beyond.count > 0)) {
        const struct orl_sunlit_query query = {.place = stop->place,
                                               .weight = stop->weight,
                                               .port = stop->port,
                                               .mapped = stop->mapped};
        orl_sunlit_add(t->scene, &query, &t->random, t->sums);
    }
    trace_strategy(t, stop, &effort, ORL_WAY_COSINE);
    trace_strategy(t, stop, &effort, ORL_WAY_PORT);
    trace_strategy(t, stop, &effort, ORL_WAY_TARGET);
}

void orl_annual_trace(const struct orl_annual_scene *scene, const struct orl_place *place,
                      const struct orl_annual_batch *batch, struct orl_annual_sums *sums,
                      struct orl_health *health)
{
    const uint64_t name = batch->sensor * ORL_ANNUAL_BATCHES + batch->batch;
    const struct stop stop = {.place = *place, .weight = orl_gray(1), .port = ORL_NO_PORT};
    for (uint32_t i = batch->first; i < batch->samples; i++) {
        if (batch->crew && orl_crew_cancelled(batch->crew))
            return;
        struct tracer tracer = {
            .scene = scene,
            .sums = sums,
            .random = orl_random_stream(batch->seed, ORL_PURPOSE_ANNUAL, (name << 24) + i),
            .health = health,
            .sequence = (uint32_t)orl_mix64(batch->seed ^ orl_mix64(name + 1)),
            .index = i};
        light_at(&tracer, &stop);
    }
}

void orl_annual_trace_out(const struct orl_annual_scene *scene, struct orl_vec3 from,
                          struct orl_vec3 direction, struct orl_random random, bool straight,
                          struct orl_annual_sums *sums, struct orl_health *health)
{
    struct tracer tracer = {.scene = scene, .sums = sums, .random = random, .health = health};
    struct walk w = {.eye = {.world = scene->world,
                             .random = &tracer.random,
                             .path = orl_path_from(from, direction),
                             .outside = true},
                     .tracer = &tracer,
                     .port = ORL_NO_PORT,
                     .straight_only = straight};
    health->paths++;
    orl_eye_path_follow(&w.eye, &sink, health);
}
