#include "annual/sun/sunlight.h"

#include <string.h>

#include "base/sampling/sampling.h"
#include "light/direct.h"
#include "light/path.h"

enum { FIRST_POINTS = 7, MIRROR_POINTS = 4, MOST_PANES = 64 };
enum { MOST_WINDOW_GROUPS = ORL_SHADES_MOST_GROUPS + 1 };

/* Least probability that a vertex of a path searches for mirrored suns. */
static const double least_survival = 0.125;

static double disc_radius(double angle_rad)
{
    return tan(0.5 * angle_rad);
}

/* Returns a point on a disc of that radius around a frame's n, not normalised; at: position in the
 * unit disc. */
static inline struct orl_vec3 disc_point(const struct orl_frame *frame, double radius,
                                         const double at[2])
{
    return orl_madd(orl_madd(frame->n, frame->u, radius * at[0]), frame->v, radius * at[1]);
}

static struct orl_vec3 on_disc(const struct orl_frame *frame, double radius, const double at[2])
{
    return orl_normalize(disc_point(frame, radius, at));
}

/* ---- Straight -------------------------------------------------------------------------------- */

/* Returns false if no sunlight from that direction can reach the place. Inside a building, all
 * sunlight passes a window. */
static bool may_come_from(const struct orl_annual_scene *scene,
                          const struct orl_shading_point *place, struct orl_vec3 towards,
                          double slack)
{
    return place->outside ||
           orl_port_rects_passed(&scene->ports, place->point, towards, slack, INFINITY);
}

/* ---- Nodes ----------------------------------------------------------------------------------- */

/* Returns the cosine, or what the lobes send towards the eye. */
static struct orl_rgb response(const void *ctx, struct orl_vec3 light)
{
    const struct orl_sunlight_query *query = ctx;
    const double cosine = orl_dot(light, query->place.normal);
    if (!(cosine > 0))
        return orl_gray(0);
    if (!query->lobes)
        return orl_gray(cosine);
    if (query->lobes->kind == ORL_MATERIAL_BSDF && query->place.outside && !query->all)
        return orl_rgb_scale(
            orl_material_albedo(query->lobes, query->hit, light, ORL_LOBE_REFLECTED),
            cosine / ORL_PI);
    return orl_rgb_scale(orl_material_eval_lobes(query->lobes, query->hit, light, query->eye),
                         cosine);
}

/* Adds light of every other node of a circle. Each neighbour in between gets half of it, so it
 * becomes the mean of its two neighbours. */
static void add_coarsely(const struct orl_path_sums *sums, uint32_t window_group,
                         uint32_t nodes_per_circle, size_t node, double light)
{
    const size_t at = node % nodes_per_circle;
    orl_path_sums_add_node(sums, window_group, node, light);
    if (at > 0)
        orl_path_sums_add_node(sums, window_group, node - 1, 0.5 * light);
    if (at + 1 < nodes_per_circle)
        orl_path_sums_add_node(sums, window_group, node + 1, 0.5 * light);
}

/* Random choices of a vertex: a point of the disc, and a subset of the nodes. */
struct sun_sample {
    const struct orl_annual_scene *scene;
    const struct orl_sunlight_query *query;
    const struct orl_path_sums *sums;
    double radius, at[2];
    bool coarse; /* true if only every other node of a circle is sampled */
    size_t stride, first;
};

static struct sun_sample draw_sun_sample(const struct orl_annual_scene *scene,
                                         const struct orl_sunlight_query *query,
                                         struct orl_random *random,
                                         const struct orl_path_sums *sums)
{
    const double far = sqrt(orl_random_uniform(random));
    const struct orl_sincos circle = orl_sincos_turn(orl_random_uniform(random));
    struct sun_sample sun_sample = {.scene = scene,
                                    .query = query,
                                    .sums = sums,
                                    .radius = disc_radius(ORL_SUN_DIAMETER_DEG * ORL_DEG_TO_RAD),
                                    .at = {far * circle.cosine, far * circle.sine},
                                    .coarse = query->place.outside && !query->all};
    sun_sample.stride = query->all          ? 1
                        : sun_sample.coarse ? ORL_SUN_SUBSETS_OUTSIDE
                                            : ORL_SUN_SUBSETS_INSIDE;
    sun_sample.first = (size_t)(orl_random_uniform(random) * (double)sun_sample.stride);
    return sun_sample;
}

static const struct orl_direction_tree *tree_of(const struct sun_sample *sun_sample)
{
    const struct orl_sun_grid_subsets *subsets = &sun_sample->scene->subsets;
    return sun_sample->stride == 1 ? &subsets->all
           : sun_sample->coarse    ? &subsets->outside[sun_sample->first]
                                   : &subsets->inside[sun_sample->first];
}

/* port: the first port by which the light's path, followed back, leaves the building. */
static void add_to_node(const struct sun_sample *sun_sample, size_t node, struct orl_rgb light,
                        int32_t port, double share)
{
    if (!(orl_rgb_max(light) > 0))
        return;
    const uint32_t window_group = orl_annual_window_group_of(sun_sample->scene, port);
    const double luma = orl_luma(orl_rgb_mul(sun_sample->query->weight, light)) *
                        (double)sun_sample->stride * share;
    if (sun_sample->coarse)
        add_coarsely(sun_sample->sums, window_group, sun_sample->scene->nodes_per_circle, node,
                     luma);
    else
        orl_path_sums_add_node(sun_sample->sums, window_group, node, luma);
}

static void add_straight(const struct sun_sample *sun_sample)
{
    const struct orl_annual_scene *scene = sun_sample->scene;
    const struct orl_shading_point *place = &sun_sample->query->place;
    const size_t nodes_per_circle =
        sun_sample->coarse ? (scene->nodes_per_circle + 1) / 2 : scene->nodes_per_circle;
    const size_t count = scene->nodes_per_circle > 0
                             ? scene->n_nodes / scene->nodes_per_circle * nodes_per_circle
                             : 0;
    for (size_t i = sun_sample->first; i < count; i += sun_sample->stride) {
        const size_t k = sun_sample->coarse ? i / nodes_per_circle * scene->nodes_per_circle +
                                                  i % nodes_per_circle * 2
                                            : i;
        const struct orl_vec3 sun =
            disc_point(&scene->nodes[k], sun_sample->radius, sun_sample->at);
        /* Half of all suns are behind the place, and are skipped before any other test. */
        if (!(orl_dot(sun, place->normal) > 0))
            continue;
        const struct orl_vec3 towards = orl_normalize(sun);
        /* The windows are tested first, because a BSDF takes longer to evaluate. */
        if (!may_come_from(scene, place, towards, 0))
            continue;
        const struct orl_rgb seen = response(sun_sample->query, towards);
        int32_t port = sun_sample->query->port;
        if (!(orl_rgb_max(seen) > 0))
            continue;
        const struct orl_rgb share =
            orl_transmittance_to_infinity(scene->lit_scene, place->point, towards, &port);
        add_to_node(sun_sample, k, orl_rgb_mul(seen, share), port, 1);
    }
}

/* ---- Nodes by mirrors ------------------------------------------------------------------------ */

/* A pane in which the place may see suns. */
struct mirrored {
    const struct sun_sample *sun_sample;
    const struct orl_mirror_set *set;
    uint32_t item;
    double survival; /* probability that the vertex searches for mirrored suns */
    double share;    /* reciprocal of the pane's probability */
};

static void add_mirrored_node(void *ctx, uint32_t node)
{
    const struct mirrored *m = ctx;
    const struct sun_sample *sun_sample = m->sun_sample;
    const struct orl_vec3 towards =
        on_disc(&sun_sample->scene->nodes[node], sun_sample->radius, sun_sample->at);
    int32_t port = sun_sample->query->port;
    const struct orl_rgb light = orl_mirrors_light_of(&sun_sample->scene->mirrors, m->set, m->item,
                                                      &sun_sample->query->place, towards, response,
                                                      sun_sample->query, &port);
    add_to_node(sun_sample, node, light, port, m->share);
}

/* Adds the suns that a pane may mirror. Its cone is widened by the radius of the sun's disc. */
static void add_by_pane(void *ctx, uint32_t item, double probability)
{
    struct mirrored *m = ctx;
    const struct orl_annual_scene *scene = m->sun_sample->scene;
    const struct orl_cone cone = orl_cone_widened(
        orl_mirrors_cone(&scene->mirrors, m->set, item, m->sun_sample->query->place.point),
        1.01 * m->sun_sample->radius);
    m->item = item;
    m->share = 1 / (probability * m->survival);
    orl_direction_tree_find(tree_of(m->sun_sample), &cone, add_mirrored_node, m);
}

void orl_sunlight_add(const struct orl_annual_scene *scene, const struct orl_sunlight_query *query,
                      struct orl_random *random, const struct orl_path_sums *sums)
{
    const struct sun_sample sun_sample = draw_sun_sample(scene, query, random, sums);
    struct mirrored m = {.sun_sample = &sun_sample,
                         .set = query->mapped ? &scene->mirrors.beyond : &scene->mirrors.everywhere,
                         .survival = 1};
    /* Russian roulette with a probability proportional to the vertex's weight. */
    if (!query->all)
        m.survival = fmin(fmax(ORL_PI * orl_rgb_max(query->weight), least_survival), 1);
    if (!query->mapped)
        add_straight(&sun_sample);
    if (m.set->count > 0 && (m.survival >= 1 || orl_random_uniform(random) < m.survival))
        orl_pane_bvh_sample(&m.set->tree, query->place.point, query->place.normal, random,
                            add_by_pane, &m);
}

/* ---- Hours ----------------------------------------------------------------------------------- */

/* Returns a point of the unit disc by its number. The first are its centre and six points near its
 * rim; then follow `points` points spread evenly over it. */
static void point_of_disc(uint32_t n, uint32_t points, double turn, double ret_at[2])
{
    const bool first = n < FIRST_POINTS;
    const double k = first ? n : n - FIRST_POINTS;
    const double far = first ? (n == 0 ? 0 : 0.985) : sqrt((k + 0.5) / points);
    const double angle = first ? k / (FIRST_POINTS - 1) : k * 0.3819660112501051;
    const double whole = turn + angle;
    const struct orl_sincos circle = orl_sincos_turn(whole - floor(whole));
    ret_at[0] = far * circle.cosine;
    ret_at[1] = far * circle.sine;
}

struct disc {
    struct orl_frame frame;
    double radius, turn;
    uint32_t points; /* samples, used if an edge crosses the disc */
};

/* Transmittance towards a point of the disc, its cosine, and the window group through which its
 * light comes in. */
struct point {
    double share, cosine;
    uint32_t window_group;
};

static struct point sample_disc_point(const struct orl_annual_scene *scene,
                                      const struct orl_shading_point *place,
                                      const struct disc *disc, uint32_t n)
{
    double at[2];
    point_of_disc(n, disc->points, disc->turn, at);
    const struct orl_vec3 towards = on_disc(&disc->frame, disc->radius, at);
    const double cosine = orl_dot(towards, place->normal);
    if (!(cosine > 0))
        return (struct point){0, 0, 0};
    int32_t port = ORL_NO_PORT;
    if (!may_come_from(scene, place, towards, 0))
        return (struct point){0, cosine, 0};
    const double share =
        orl_luma(orl_transmittance_to_infinity(scene->lit_scene, place->point, towards, &port));
    return (struct point){share, cosine, share > 0 ? orl_annual_window_group_of(scene, port) : 0};
}

/* Returns the facet that blocks a ray to the sun; UINT32_MAX: none. */
static uint32_t blocker_of(const struct orl_annual_scene *scene,
                           const struct orl_shading_point *place, struct orl_vec3 towards)
{
    const struct orl_lit_scene *lit_scene = scene->lit_scene;
    struct orl_path path = orl_path_from(place->point, towards);
    for (int pane = 0; pane < MOST_PANES; pane++) {
        struct orl_hit hit;
        if (!orl_path_intersect(lit_scene, &path, &hit))
            return UINT32_MAX;
        if (!orl_path_transmit_straight(&path, orl_lit_scene_material(lit_scene, &hit), &hit))
            return hit.facet;
        orl_path_skip_surface(&path, lit_scene, &hit);
    }
    return UINT32_MAX;
}

/* Returns true if one surface covers all first points of the disc. There may be a slit between
 * several surfaces. */
static bool is_covered(const struct orl_annual_scene *scene, const struct orl_shading_point *place,
                       const struct disc *disc)
{
    uint32_t by = UINT32_MAX;
    for (uint32_t n = 0; n < FIRST_POINTS; n++) {
        double at[2];
        point_of_disc(n, disc->points, disc->turn, at);
        const struct orl_vec3 towards = on_disc(&disc->frame, disc->radius, at);
        if (!(orl_dot(towards, place->normal) > 0))
            continue;
        const uint32_t facet = blocker_of(scene, place, towards);
        if (by != UINT32_MAX && facet != by)
            return false;
        by = facet;
    }
    return true;
}

/* Light from a disc's points that comes in through one window group. */
struct group_light {
    uint32_t window_group;
    double sum, squares;
};

static struct group_light *find_group_light(struct group_light *group_lights, uint32_t *n,
                                            uint32_t window_group)
{
    uint32_t i = 0;
    while (i < *n && group_lights[i].window_group != window_group)
        i++;
    if (i == *n)
        group_lights[(*n)++] = (struct group_light){.window_group = window_group};
    return &group_lights[i];
}

/* Samples many points of a disc that an edge crosses, or where there may be a slit. */
static void add_points_of_disc(const struct orl_annual_scene *scene,
                               const struct orl_shading_point *place, const struct disc *disc,
                               size_t sun, const struct orl_sensor_sunlight *sunlight)
{
    struct group_light group_lights[MOST_WINDOW_GROUPS];
    uint32_t n_group_lights = 0;
    for (uint32_t n = 0; n < disc->points; n++) {
        const struct point p = sample_disc_point(scene, place, disc, FIRST_POINTS + n);
        const double light = p.share * p.cosine;
        if (!(light > 0))
            continue;
        struct group_light *of = find_group_light(group_lights, &n_group_lights, p.window_group);
        of->sum += light / disc->points;
        of->squares += light * light / disc->points;
    }
    /* The error of such even points falls with their number to the power of -3/4, if edges are
     * straight (Beck and Chen 1987, irregularities of distribution). */
    const double share = pow(disc->points, -0.75);
    for (uint32_t i = 0; i < n_group_lights; i++) {
        const struct group_light *of = &group_lights[i];
        const double unsure = sqrt(fmax(of->squares - of->sum * of->sum, 0)) * share;
        orl_sensor_sunlight_add(sunlight, of->window_group, ORL_SUNLIGHT_DIRECT, sun, of->sum);
        orl_sensor_sunlight_add(sunlight, of->window_group, ORL_SUNLIGHT_VARIANCE, sun,
                                unsure * unsure);
    }
}

/* Adds the light of a disc. If rim and centre have the same transmittance, no more points are
 * needed. */
static void add_disc(const struct orl_annual_scene *scene, const struct orl_shading_point *place,
                     const struct disc *disc, size_t sun,
                     const struct orl_sensor_sunlight *sunlight)
{
    const struct point middle = sample_disc_point(scene, place, disc, 0);
    double least = middle.share, most = middle.share;
    bool alike = true;
    for (uint32_t n = 1; n < FIRST_POINTS; n++) {
        const struct point p = sample_disc_point(scene, place, disc, n);
        least = fmin(least, p.share);
        most = fmax(most, p.share);
        alike = alike && p.window_group == middle.window_group;
    }
    alike = alike && most - least <= 0.02 * most;
    if (!alike || (!(most > 0) && !is_covered(scene, place, disc)))
        add_points_of_disc(scene, place, disc, sun, sunlight);
    else if (middle.share > 0)
        orl_sensor_sunlight_add(sunlight, middle.window_group, ORL_SUNLIGHT_DIRECT, sun,
                                middle.share * middle.cosine);
}

static struct orl_rgb cosine_of(const void *ctx, struct orl_vec3 light)
{
    const struct orl_shading_point *place = ctx;
    return orl_gray(fmax(orl_dot(light, place->normal), 0));
}

static struct disc disc_of(const struct orl_year_suns *suns, size_t sun, uint64_t name,
                           const struct orl_sensor_sunlight *sunlight)
{
    return (struct disc){.frame = orl_frame_about(suns->at[sun].towards),
                         .points = sunlight->disc_points,
                         .radius = disc_radius(suns->at[sun].angle_rad),
                         .turn = (double)(orl_mix64(name ^ orl_mix64(sun + 1)) >> 11) * 0x1p-53};
}

/* Context of a sensor's mirrored suns. */
struct mirrored_hours {
    const struct orl_annual_scene *scene;
    const struct orl_year_suns *suns;
    const struct orl_shading_point *place;
    const struct orl_thread_pool *pool;
    uint64_t name;
    uint32_t item; /* the current pane */
    const struct orl_sensor_sunlight *sunlight;
};

static void add_mirrored_hour(void *ctx, uint32_t sun)
{
    const struct mirrored_hours *m = ctx;
    const struct disc disc = disc_of(m->suns, sun, m->name, m->sunlight);
    if (!m->suns->at[sun].wanted || orl_thread_pool_cancelled(m->pool))
        return;
    for (uint32_t n = 0; n < MIRROR_POINTS; n++) {
        double at[2];
        int32_t port = ORL_NO_PORT;
        point_of_disc(FIRST_POINTS + n * (disc.points / MIRROR_POINTS), disc.points, disc.turn, at);
        const double light = orl_luma(orl_mirrors_light_of(
            &m->scene->mirrors, &m->scene->mirrors.everywhere, m->item, m->place,
            on_disc(&disc.frame, disc.radius, at), cosine_of, m->place, &port));
        if (light > 0)
            orl_sensor_sunlight_add(m->sunlight, orl_annual_window_group_of(m->scene, port),
                                    ORL_SUNLIGHT_MIRRORED, sun, light / MIRROR_POINTS);
    }
}

static void find_mirrored(struct mirrored_hours *m)
{
    const struct orl_mirror_set *set = &m->scene->mirrors.everywhere;
    double widest = 0;
    for (size_t c = 0; c < m->suns->count; c++)
        widest = fmax(widest, m->suns->at[c].angle_rad);
    for (m->item = 0; m->item < set->count; m->item++) {
        const struct orl_cone cone =
            orl_cone_widened(orl_mirrors_cone(&m->scene->mirrors, set, m->item, m->place->point),
                             fmin(0.51 * widest, 1));
        orl_direction_tree_find(&m->suns->tree, &cone, add_mirrored_hour, m);
    }
}

void orl_sunlight_find_hours(const struct orl_annual_scene *scene, const struct orl_year_suns *suns,
                             const struct orl_shading_point *place, uint64_t name,
                             const struct orl_thread_pool *pool,
                             const struct orl_sensor_sunlight *sunlight)
{
    for (size_t c = 0; c < suns->count && !orl_thread_pool_cancelled(pool); c++) {
        const struct orl_hour_sun *sun = &suns->at[c];
        const double slack = sin(0.5 * sun->angle_rad) * 1.01;
        if (!sun->wanted || !(orl_dot(sun->towards, place->normal) > -slack) ||
            !may_come_from(scene, place, sun->towards, slack)) /* no point of the disc is visible */
            continue;
        const struct disc disc = disc_of(suns, c, name, sunlight);
        add_disc(scene, place, &disc, c, sunlight);
    }
    if (sunlight->direct_only)
        return;
    struct mirrored_hours m = {.scene = scene,
                               .suns = suns,
                               .place = place,
                               .pool = pool,
                               .name = name,
                               .sunlight = sunlight};
    find_mirrored(&m);
}
