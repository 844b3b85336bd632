#include "annual/sunlight.h"

#include "base/circle.h"
#include "light/direct.h"
#include "light/path.h"

enum { FIRST_POINTS = 7, DISC_POINTS = 128, MIRROR_POINTS = 4, MOST_PANES = 64 };
/* Of the nodes, one in so many is tried at each place: outside, where no wall keeps the sun off, of
 * every other node; and inside. */
enum { STRIDE_OUTSIDE = 6, STRIDE_INSIDE = 2 };

static double disc_radius(double angle_rad)
{
    return tan(0.5 * angle_rad);
}

/* A point of a disc of that radius about a frame's n, not unit; at is in the unit disc. */
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

static struct orl_rgb straight(const struct orl_annual_scene *scene, const struct orl_place *place,
                               struct orl_vec3 towards)
{
    if (!place->outside && !orl_windows_passed(&scene->ports, place->point, towards, 0))
        return orl_gray(0);
    return orl_transmittance(scene->world, place->point, towards, INFINITY, true);
}

/* ---- Nodes ----------------------------------------------------------------------------------- */

/* The cosine, or what lobes send towards the eye. */
static struct orl_rgb response(const void *ctx, struct orl_vec3 light)
{
    const struct orl_sunlit_query *query = ctx;
    const double cosine = orl_dot(light, query->place.normal);
    if (!(cosine > 0))
        return orl_gray(0);
    if (!query->lobes)
        return orl_gray(cosine);
    if (query->lobes->kind == ORL_MATERIAL_BSDF && query->place.outside && !query->all)
        return orl_rgb_scale(
            orl_material_albedo(query->lobes, query->hit, light, ORL_LOBE_REFLECTED),
            cosine / ORL_PI);
    return orl_rgb_scale(orl_scatter_eval_lobes(query->lobes, query->hit, light, query->eye),
                         cosine);
}

/* What comes of a node's sun, at that point of its disc. */
static struct orl_rgb light_of(const struct orl_annual_scene *scene,
                               const struct orl_sunlit_query *query, struct orl_vec3 towards)
{
    const struct orl_rgb seen = response(query, towards);
    struct orl_rgb light = orl_gray(0);
    if (orl_rgb_max(seen) > 0 && !query->mapped)
        light = orl_rgb_mul(seen, straight(scene, &query->place, towards));
    if (scene->mirrors.n_planes > 0)
        light = orl_rgb_add(light, orl_mirrors_light(&scene->mirrors, &query->place, towards,
                                                     query->mapped, response, query));
    return light;
}

/* Of every other node of a circle only, what lies between is their mean. */
static void add_coarsely(const struct orl_annual_scene *scene, size_t node, double light,
                         double *nodes)
{
    const size_t at = node % scene->a_circle;
    nodes[node] += light;
    if (at > 0)
        nodes[node - 1] += 0.5 * light;
    if (at + 1 < scene->a_circle)
        nodes[node + 1] += 0.5 * light;
}

void orl_sunlit_add(const struct orl_annual_scene *scene, const struct orl_sunlit_query *query,
                    struct orl_random *random, double *nodes)
{
    const double radius = disc_radius(ORL_SUN_DIAMETER_DEG * ORL_DEG_TO_RAD);
    const double far = sqrt(orl_random_uniform(random));
    const struct orl_circle circle = orl_circle_turn(orl_random_uniform(random));
    const double at[2] = {far * circle.cosine, far * circle.sine};
    const bool coarse = query->place.outside && !query->all, mirrored = scene->mirrors.n_planes > 0;
    const size_t stride = query->all ? 1 : coarse ? STRIDE_OUTSIDE : STRIDE_INSIDE;
    const size_t first = (size_t)(orl_random_uniform(random) * (double)stride);
    const size_t a_circle = coarse ? (scene->a_circle + 1) / 2 : scene->a_circle;
    const size_t count = scene->a_circle > 0 ? scene->n_nodes / scene->a_circle * a_circle : 0;
    for (size_t i = first; i < count; i += stride) {
        const size_t k = coarse ? i / a_circle * scene->a_circle + i % a_circle * 2 : i;
        const struct orl_vec3 sun = disc_point(&scene->nodes[k], radius, at);
        /* Half of all suns are behind the place: they are passed over before anything is asked. */
        if (!mirrored && !(orl_dot(sun, query->place.normal) > 0))
            continue;
        const struct orl_rgb light = light_of(scene, query, orl_normalize(sun));
        if (!(orl_rgb_max(light) > 0))
            continue;
        const double luma = orl_luma(orl_rgb_mul(query->weight, light)) * (double)stride;
        if (coarse)
            add_coarsely(scene, k, luma, nodes);
        else
            nodes[k] += luma;
    }
}

/* ---- Hours ----------------------------------------------------------------------------------- */

/* Points of the unit disc: the first ones its rim and its middle, the rest evenly over it. */
static void point_of_disc(uint32_t n, double turn, double ret_at[2])
{
    const bool first = n < FIRST_POINTS;
    const double k = first ? n : n - FIRST_POINTS;
    const double far = first ? (n == 0 ? 0 : 0.985) : sqrt((k + 0.5) / DISC_POINTS);
    const double angle = first ? k / (FIRST_POINTS - 1) : k * 0.3819660112501051;
    const double whole = turn + angle;
    const struct orl_circle circle = orl_circle_turn(whole - floor(whole));
    ret_at[0] = far * circle.cosine;
    ret_at[1] = far * circle.sine;
}

struct disc {
    struct orl_frame frame;
    double radius, turn;
};

/* Share of a point's light that gets through, and its cosine. */
struct point {
    double share, cosine;
};

static struct point look_at_point(const struct orl_annual_scene *scene,
                                  const struct orl_place *place, const struct disc *disc,
                                  uint32_t n)
{
    double at[2];
    point_of_disc(n, disc->turn, at);
    const struct orl_vec3 towards = on_disc(&disc->frame, disc->radius, at);
    const double cosine = orl_dot(towards, place->normal);
    if (!(cosine > 0))
        return (struct point){0, 0};
    return (struct point){orl_luma(straight(scene, place, towards)), cosine};
}

/* The facet that keeps a ray from the sun; UINT32_MAX: none does. */
static uint32_t blocker_of(const struct orl_annual_scene *scene, const struct orl_place *place,
                           struct orl_vec3 towards)
{
    const struct orl_world *world = scene->world;
    struct orl_path path = orl_path_from(place->point, towards);
    for (int pane = 0; pane < MOST_PANES; pane++) {
        struct orl_hit hit;
        if (!orl_path_meet(world, &path, &hit))
            return UINT32_MAX;
        if (!orl_path_look_through(&path, orl_world_material(world, &hit), &hit))
            return hit.facet;
        orl_path_pass(&path, world, &hit);
    }
    return UINT32_MAX;
}

/* Whether one surface covers the whole disc: between several there may be a slit. */
static bool is_covered(const struct orl_annual_scene *scene, const struct orl_place *place,
                       const struct disc *disc)
{
    uint32_t by = UINT32_MAX;
    for (uint32_t n = 0; n < FIRST_POINTS; n++) {
        double at[2];
        point_of_disc(n, disc->turn, at);
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

/* Rim and middle see the same: that is all; an edge crosses the disc, or a slit may: its points
 * tell. */
static double disc_light(const struct orl_annual_scene *scene, const struct orl_place *place,
                         const struct disc *disc, double *ret_unsure)
{
    double middle = 0, sum = 0, squares = 0, least = INFINITY, most = 0;
    *ret_unsure = 0;
    for (uint32_t n = 0; n < FIRST_POINTS; n++) {
        const struct point p = look_at_point(scene, place, disc, n);
        least = fmin(least, p.share);
        most = fmax(most, p.share);
        if (n == 0)
            middle = p.share * p.cosine;
    }
    if (most - least <= 0.02 * most && (most > 0 || is_covered(scene, place, disc)))
        return middle;
    for (uint32_t n = 0; n < DISC_POINTS; n++) {
        const struct point p = look_at_point(scene, place, disc, FIRST_POINTS + n);
        sum += p.share * p.cosine / DISC_POINTS;
        squares += p.share * p.cosine * p.share * p.cosine / DISC_POINTS;
    }
    /* Points in a plane so even err as their number to the power of -3/4, where edges are straight
     * (Beck and Chen 1987, irregularities of distribution). */
    *ret_unsure = sqrt(fmax(squares - sum * sum, 0)) * pow(DISC_POINTS, -0.75);
    return sum;
}

static struct orl_rgb cosine_of(const void *ctx, struct orl_vec3 light)
{
    const struct orl_place *place = ctx;
    return orl_gray(fmax(orl_dot(light, place->normal), 0));
}

static double mirrored_light(const struct orl_annual_scene *scene, const struct orl_place *place,
                             const struct disc *disc)
{
    double sum = 0;
    for (uint32_t n = 0; n < MIRROR_POINTS; n++) {
        double at[2];
        point_of_disc(FIRST_POINTS + n * (DISC_POINTS / MIRROR_POINTS), disc->turn, at);
        sum += orl_luma(orl_mirrors_light(&scene->mirrors, place,
                                          on_disc(&disc->frame, disc->radius, at), false, cosine_of,
                                          place));
    }
    return sum / MIRROR_POINTS;
}

/* Whether any point of the disc may be seen. */
static bool may_see(const struct orl_annual_scene *scene, const struct orl_place *place,
                    const struct orl_hour_sun *sun)
{
    const double slack = sin(0.5 * sun->angle_rad) * 1.01;
    return orl_dot(sun->towards, place->normal) > -slack &&
           (place->outside || orl_windows_passed(&scene->ports, place->point, sun->towards, slack));
}

void orl_sunlit_hours_find(const struct orl_annual_scene *scene, const struct orl_year_suns *suns,
                           const struct orl_place *place, uint64_t name,
                           const struct orl_sunlit_hours *ret)
{
    for (size_t c = 0; c < suns->count; c++) {
        const struct orl_hour_sun *sun = &suns->at[c];
        double seen = 0, mirrored = 0, unsure = 0;
        if (sun->wanted) {
            const struct disc disc = {.frame = orl_frame_about(sun->towards),
                                      .radius = disc_radius(sun->angle_rad),
                                      .turn = (double)(orl_mix64(name ^ orl_mix64(c + 1)) >> 11) *
                                              0x1p-53};
            if (may_see(scene, place, sun))
                seen = disc_light(scene, place, &disc, &unsure);
            if (scene->mirrors.n_planes > 0)
                mirrored = mirrored_light(scene, place, &disc);
        }
        ret->straight[c] = (float)seen;
        ret->mirrored[c] = (float)mirrored;
        ret->squares[c] = (float)(unsure * unsure);
    }
}
