#include "annual/coefficients/trace_sensor.h"

#include "annual/sun/sunlight.h"
#include "light/eye_path.h"

/* Rays per strategy: at the sensor, at surfaces that a ray hits, and outside a sealed building.
 * Outside, no ray is sampled towards the building's windows. */
static const struct orl_strategy_counts at_sensors = {{1, 1, 0, 0.5}}, deeper = {{1, 0.5, 0, 0}},
                                        outside = {{1, 0, 0}};
/* Thresholds of Russian roulette, as shares of one sample of the sensor. */
static const double dimmest_place = 0.03, dimmest_path = 0.02;

struct tracer {
    const struct orl_annual_scene *scene;
    struct orl_path_sums *sums;
    struct orl_random random;
    struct orl_health *health;
    uint32_t sequence, index; /* keys of the sample's Sobol points */
};

/* A shading point. Its irradiance contributes to the sensor with this weight. */
struct shade_point {
    struct orl_shading_point place;
    struct orl_rgb weight;
    uint32_t depth;             /* 0: the sensor */
    int32_t port;               /* first port by which the path left the building; or ORL_NO_PORT */
    const double *evenly;       /* three Sobol numbers for its first ray, or NULL */
    bool mapped;                /* true if the map has already added the sun */
    bool interreflection_added; /* true if a whole map has already added all indoor light of the map
                                 */
};

struct path_state {
    struct orl_eye_path eye; /* must come first: callbacks receive it */
    struct tracer *tracer;
    const struct shade_point *from; /* where the path started */
    int32_t port; /* from the shading point, or set at the first crossing outwards */
    const double *evenly;
    bool bent;          /* true once the path has left its initial direction */
    bool straight_only; /* true if the path ends at surfaces */
};

static void gather_at(struct tracer *t, const struct shade_point *shade_point);

static struct path_state *path_state_of(struct orl_eye_path *p)
{
    return (struct path_state *)p;
}

/* ---- A path ---------------------------------------------------------------------------------- */

static void add_sky(struct orl_eye_path *p)
{
    const struct path_state *w = path_state_of(p);
    const struct orl_annual_scene *scene = w->tracer->scene;
    const struct orl_vec3 towards = orl_sky_rotation_to_sky(scene->north, p->path.direction);
    orl_path_sums_add_bin(w->tracer->sums, orl_annual_window_group_of(scene, w->port),
                          orl_bins_find(scene->bins, towards), orl_luma(p->path.weight));
}

static void add_diffuse(struct path_state *w, struct orl_rgb albedo)
{
    struct orl_eye_path *p = &w->eye;
    const struct orl_vec3 lit = orl_hit_facing(&p->hit);
    const struct orl_rgb weight = orl_rgb_scale(orl_rgb_mul(p->path.weight, albedo), 1 / ORL_PI);
    const bool mapped = w->tracer->scene->map && !p->outside;
    if (mapped && !w->from->interreflection_added)
        orl_sun_map_add(w->tracer->scene->map, &p->hit, weight, w->tracer->sums->beams,
                        w->tracer->sums->photon_batches);
    struct shade_point shade_point = {
        .place = {.point = orl_hit_ray_origin(p->lit_scene->geometry, &p->hit, lit),
                  .normal = lit,
                  .outside = p->outside},
        .weight = weight,
        .mapped = mapped,
        .interreflection_added =
            w->from->interreflection_added || (mapped && w->tracer->scene->map_interreflection),
        .depth = w->from->depth + 1,
        .port = w->port,
        .evenly = p->bounce == 0 ? w->evenly : NULL};
    const double chance = fmin(orl_rgb_max(shade_point.weight) / dimmest_place, 1);
    if (chance < 1) {
        if (!(orl_random_uniform(p->random) < chance))
            return;
        shade_point.weight = orl_rgb_scale(shade_point.weight, 1 / chance);
    }
    gather_at(w->tracer, &shade_point);
}

/* Adds sunlight by the lobes of the surface hit. sides: 1 for the side of the ray, 2 for both
 * sides. */
static void add_lobes(struct path_state *w, const struct orl_material *m, int sides)
{
    struct orl_eye_path *p = &w->eye;
    const struct orl_vec3 seen = orl_hit_facing(&p->hit);
    for (int side = 0; side < sides; side++) {
        const struct orl_vec3 normal = side == 0 ? seen : orl_neg(seen);
        const struct orl_sunlight_query query = {
            .place = {.point = orl_hit_ray_origin(p->lit_scene->geometry, &p->hit, normal),
                      .normal = normal,
                      .outside = orl_lit_scene_outside_after(p->lit_scene, &p->hit, side == 1,
                                                             p->outside)},
            .weight = p->path.weight,
            .port = w->port,
            .all = w->from->depth == 0,
            .lobes = m,
            .hit = &p->hit,
            .eye = orl_path_back(&p->path)};
        orl_sunlight_add(w->tracer->scene, &query, p->random, w->tracer->sums);
    }
}

/*
 * The map contains the light that lobes inside throw on surfaces, but not the light they send to
 * the sensor. Light of BSDF panes straight to the sensor belongs to bsdf_panes.h. Sunlight that a
 * BSDF pane reflects to surfaces outdoors keeps its flux, but not its directional distribution, as
 * on exterior paths. Towards a sensor outdoors it keeps both.
 */
static void add_sun_by_lobes(struct path_state *w, const struct orl_material *m)
{
    const bool is_bsdf = m->kind == ORL_MATERIAL_BSDF;
    if (!w->tracer->sums->nodes)
        return;
    if (!w->eye.outside && w->tracer->scene->map && w->from->depth > 0)
        return;
    add_lobes(w, m, orl_material_transmits_lobes(m) && (!is_bsdf || w->bent) ? 2 : 1);
}

static bool survives(struct path_state *w)
{
    const double matters = orl_rgb_max(w->eye.path.weight) / ORL_PI;
    const double chance = fmin(matters / dimmest_path, 1);
    return !(chance < 1) || orl_path_roulette(&w->eye.path, chance, w->eye.random);
}

/* Records a path that ends at a window and returns true. Returns false if paths pass windows or the
 * surface is no window. */
static bool record_exit(const struct path_state *w)
{
    const struct orl_eye_path *p = &w->eye;
    struct orl_annual_exits *exits = w->tracer->sums->exits;
    const int32_t port = exits ? orl_lit_scene_port_of(p->lit_scene, p->hit.facet) : ORL_NO_PORT;
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
    if (w->from->depth == 0 && !w->bent)
        exits->straight[at] += luma;
    return true;
}

static enum orl_lobes handle_hit(struct orl_eye_path *p, const struct orl_material *m)
{
    struct path_state *w = path_state_of(p);
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

static bool handle_scattered(struct orl_eye_path *p, const struct orl_surface_sample *s)
{
    const bool inside = !p->outside;
    orl_eye_path_cross_port(p, s);
    p->clear = false;
    if (inside && p->outside && path_state_of(p)->port == ORL_NO_PORT)
        path_state_of(p)->port = orl_lit_scene_port_of(p->lit_scene, p->hit.facet);
    path_state_of(p)->bent = path_state_of(p)->bent || s->event != ORL_EVENT_STRAIGHT;
    return !(path_state_of(p)->bent && path_state_of(p)->straight_only);
}

static const struct orl_path_visitor visitor = {
    .escaped = add_sky, .met = handle_hit, .on_sampled = handle_scattered};

/* ---- The light of a place -------------------------------------------------------------------- */

/* Traces one ray sampled by a strategy. u: three numbers for the ray, and three for the surface it
 * hits. */
static void trace_ray(struct tracer *t, const struct shade_point *shade_point,
                      const struct orl_strategy_counts *ray_counts, enum orl_strategy strategy,
                      const double u[6], bool evenly)
{
    struct orl_direction_sample ray_sample;
    t->health->paths++;
    if (!orl_direction_sample_traced(&t->scene->sampler, ray_counts, strategy,
                                     shade_point->place.point, shade_point->place.normal, u,
                                     &ray_sample))
        return;
    struct path_state w = {
        .eye = {.lit_scene = t->scene->lit_scene,
                .random = &t->random,
                .path = orl_path_from(shade_point->place.point, ray_sample.direction),
                .outside = shade_point->place.outside},
        .tracer = t,
        .from = shade_point,
        .port = shade_point->port,
        .evenly = evenly ? u + 3 : NULL};
    w.eye.path.weight = orl_rgb_scale(shade_point->weight, ray_sample.weight);
    orl_eye_path_set_next_hit(&w.eye, ray_sample.met ? &ray_sample.hit : NULL);
    orl_eye_path_trace(&w.eye, &visitor, t->health);
}

static void trace_strategy(struct tracer *t, const struct shade_point *shade_point,
                           const struct orl_strategy_counts *ray_counts, enum orl_strategy strategy)
{
    const double wanted = ray_counts->rays[strategy];
    const bool evenly = shade_point->depth == 0;
    double u[6];
    if (!(wanted > 0) || (wanted < 1 && !(orl_random_uniform(&t->random) < wanted)))
        return;
    if (evenly)
        orl_sobol_point(&t->scene->sobol, t->index, t->sequence + (uint32_t)strategy * 0x9e3779b9U,
                        6, u);
    for (int i = 0; i < 3 && !evenly; i++)
        u[i] = shade_point->evenly && strategy == ORL_SAMPLE_COSINE
                   ? shade_point->evenly[i]
                   : orl_random_uniform(&t->random);
    trace_ray(t, shade_point, ray_counts, strategy, u, evenly);
}

static void gather_at(struct tracer *t, const struct shade_point *shade_point)
{
    const struct orl_strategy_counts ray_counts =
        orl_direction_sampler_counts(&t->scene->sampler, shade_point->place.outside ? outside
                                                         : shade_point->depth == 0  ? at_sensors
                                                                                    : deeper);
    if (t->sums->nodes && shade_point->depth > 0 &&
        (!shade_point->mapped || t->scene->mirrors.beyond.count > 0)) {
        const struct orl_sunlight_query query = {.place = shade_point->place,
                                                 .weight = shade_point->weight,
                                                 .port = shade_point->port,
                                                 .mapped = shade_point->mapped};
        orl_sunlight_add(t->scene, &query, &t->random, t->sums);
    }
    trace_strategy(t, shade_point, &ray_counts, ORL_SAMPLE_COSINE);
    trace_strategy(t, shade_point, &ray_counts, ORL_SAMPLE_PORT);
    trace_strategy(t, shade_point, &ray_counts, ORL_SAMPLE_TARGET);
}

void orl_annual_trace(const struct orl_annual_scene *scene, const struct orl_shading_point *place,
                      const struct orl_annual_batch *batch, struct orl_path_sums *sums,
                      struct orl_health *health)
{
    const uint64_t name = batch->sensor * ORL_ANNUAL_BATCHES + batch->batch;
    const struct shade_point shade_point = {
        .place = *place, .weight = orl_gray(1), .port = ORL_NO_PORT};
    for (uint32_t i = batch->first; i < batch->samples; i++) {
        if (batch->pool && orl_thread_pool_cancelled(batch->pool))
            return;
        struct tracer tracer = {
            .scene = scene,
            .sums = sums,
            .random = orl_random_stream(batch->seed, ORL_PURPOSE_ANNUAL, (name << 24) + i),
            .health = health,
            .sequence = (uint32_t)orl_mix64(batch->seed ^ orl_mix64(name + 1)),
            .index = i};
        gather_at(&tracer, &shade_point);
    }
}

void orl_annual_trace_outdoors(const struct orl_annual_scene *scene, struct orl_vec3 from,
                               struct orl_vec3 direction, struct orl_random random, bool straight,
                               struct orl_path_sums *sums, struct orl_health *health)
{
    static const struct shade_point anywhere = {.depth = 0};
    struct tracer tracer = {.scene = scene, .sums = sums, .random = random, .health = health};
    struct path_state w = {.eye = {.lit_scene = scene->lit_scene,
                                   .random = &tracer.random,
                                   .path = orl_path_from(from, direction),
                                   .outside = true},
                           .tracer = &tracer,
                           .from = &anywhere,
                           .port = ORL_NO_PORT,
                           .straight_only = straight};
    health->paths++;
    orl_eye_path_trace(&w.eye, &visitor, health);
}
