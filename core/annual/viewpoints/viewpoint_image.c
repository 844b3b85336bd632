/* The image of a viewpoint, and the rays of its pixels. */
#include "annual/viewpoints/viewpoints.h"

#include <stdlib.h>

#include "base/memory/memory.h"
#include "light/path.h"
#include "scene/geometry/geometry.h"

/*
 * Rays of a viewpoint's pixels. They add terms for the sky and for diffuse surfaces, reached
 * through panes, mirrors and lobes. They also add spots on visible surfaces where the sun may fall.
 *
 * At a surface a path may continue in three ways: straight through, mirrored, and in one direction
 * sampled from its lobes. It splits into all of them while the ray may have more paths. Afterwards
 * it takes one, sampled in proportion to what each carries. Paths that carry little, and paths of
 * many steps, end by Russian roulette (Arvo and Kirk 1990, "Particle transport and image
 * synthesis"). So a ray has at most ORL_VIEWPOINT_RAY_PATHS paths in any scene, and the estimate is
 * unbiased.
 *
 * Threads: one thread per viewpoint. Random numbers are keyed by viewpoint and pixel.
 */

/* Most paths of a ray: in general, and if the pixel sees lobes and has more rays. */
enum { ORL_VIEWPOINT_RAY_PATHS = 8, ORL_VIEWPOINT_LOBE_PATHS = 4 };

enum { MOST_CONTINUATIONS = 3, MANY_STEPS = 500 };
/* Thresholds of Russian roulette: for paths, as a share of the ray's light; for mirrored rays, as a
 * share of the light that reaches the surface. */
static const double dim_path = 0.002, dim_mirror = 0.02;
static const double survival = 0.999; /* survival probability of each step beyond MANY_STEPS */

struct orl_viewpoint_rays {
    struct orl_viewpoint_image *view; /* receives visible points and spots */
    const struct orl_annual_scene *scene;
    struct orl_random random;
    uint32_t pixel;
    double share;                 /* share of the pixel that a ray represents */
    uint32_t most_paths;          /* most paths of a ray */
    bool spots;                   /* true if the next ray adds spots */
    bool lobes;                   /* true once a ray has hit lobes */
    struct orl_pixel_terms terms; /* terms of the current pixel */
    size_t spots_room;            /* capacity of view->spots */
    uint64_t steps;               /* traced segments */
};

struct branch {
    struct orl_path path;
    uint32_t paths; /* most paths into which it may split, including itself */
    uint32_t steps;
    bool outside, scattered;
};

/* ---- What a path reaches --------------------------------------------------------------------- */

static int add_sky(struct orl_viewpoint_rays *r, const struct branch *b)
{
    const struct orl_vec3 towards = orl_sky_rotation_to_sky(r->scene->north, b->path.direction);
    return orl_pixel_terms_add(&r->terms, orl_bins_find(r->scene->bins, towards),
                               r->share * orl_luma(b->path.weight));
}

/* Adds a spot on the side of the normal. */
static int add_spot(struct orl_viewpoint_rays *r, const struct orl_hit *hit, struct orl_vec3 normal,
                    struct orl_viewpoint_spot spot)
{
    struct orl_viewpoint_image *view = r->view;
    if (!orl_array_reserve(&view->spots, &r->spots_room, view->n_spots, sizeof *view->spots))
        return ORL_ERR_NOMEM;
    spot.place.point = orl_hit_ray_origin(r->scene->lit_scene->geometry, hit, normal);
    spot.place.normal = normal;
    spot.hit = *hit;
    spot.pixel = r->pixel;
    view->spots[view->n_spots++] = spot;
    return 0;
}

static int add_diffuse(struct orl_viewpoint_rays *r, const struct branch *b,
                       const struct orl_hit *hit, struct orl_rgb albedo)
{
    const struct orl_rgb weight = orl_rgb_scale(orl_rgb_mul(b->path.weight, albedo), 1 / ORL_PI);
    const double luma = r->share * orl_luma(weight);
    uint32_t found = 0;
    int code = orl_visible_points_add(&r->view->visible_points, hit,
                                      luma * (double)r->view->field.solid_angle[r->pixel],
                                      &r->random, &found);
    if (code == 0)
        code = orl_pixel_terms_add(&r->terms, ORL_BINS + 2 * found + b->scattered, luma);
    if (code < 0 || !r->spots || b->scattered)
        return code;
    return add_spot(
        r, hit, orl_hit_facing(hit),
        (struct orl_viewpoint_spot){.place = {.outside = b->outside}, .weight = weight});
}

/* Adds spots on the visible side of a surface, and if it transmits, on the far side. */
static int add_lobe_spots(struct orl_viewpoint_rays *r, const struct branch *b,
                          const struct orl_hit *hit, const struct orl_material *m)
{
    const struct orl_vec3 seen = orl_hit_facing(hit);
    const int sides = orl_material_transmits_lobes(m) ? 2 : 1;
    int code = 0;
    for (int side = 0; side < sides && code == 0; side++) {
        const struct orl_viewpoint_spot spot = {
            .place = {.outside = orl_lit_scene_outside_after(r->scene->lit_scene, hit, side == 1,
                                                             b->outside)},
            .eye = orl_path_back(&b->path),
            .material = m,
            .weight = b->path.weight};
        code = add_spot(r, hit, side == 0 ? seen : orl_neg(seen), spot);
    }
    return code;
}

/* ---- Continuations --------------------------------------------------------------------------- */

/* Computes the mirrored continuation. If it carries little, Russian roulette applies. */
static bool sample_mirrored(struct orl_viewpoint_rays *r, const struct branch *b,
                            const struct orl_hit *hit, const struct orl_material *m,
                            struct orl_surface_sample *ret_continuation)
{
    struct orl_rgb share = orl_material_mirrored(m, hit, orl_path_back(&b->path));
    const struct orl_vec3 d = b->path.direction, n = orl_hit_facing(hit);
    const double most = orl_rgb_max(share);
    if (!(most > 0))
        return false;
    if (most < dim_mirror) {
        if (!(orl_random_uniform(&r->random) * dim_mirror < most))
            return false;
        share = orl_rgb_scale(share, dim_mirror / most);
    }
    *ret_continuation =
        (struct orl_surface_sample){.event = ORL_EVENT_MIRROR,
                                    .direction = orl_normalize(orl_madd(d, n, -2 * orl_dot(d, n))),
                                    .weight = share};
    return true;
}

/* Lists the continuations at a surface: straight, mirrored, and one sampled from the lobes. */
static uint32_t list_continuations(struct orl_viewpoint_rays *r, const struct branch *b,
                                   const struct orl_hit *hit, const struct orl_material *m,
                                   struct orl_surface_sample ret_continuations[MOST_CONTINUATIONS])
{
    const struct orl_vec3 back = orl_path_back(&b->path);
    const struct orl_rgb straight = orl_material_straight(m, hit, back);
    uint32_t n = 0;
    if (orl_rgb_max(straight) > 0)
        ret_continuations[n++] = (struct orl_surface_sample){.event = ORL_EVENT_STRAIGHT,
                                                             .transmitted = true,
                                                             .direction = b->path.direction,
                                                             .weight = straight};
    n += sample_mirrored(r, b, hit, m, &ret_continuations[n]);
    if (!orl_material_has_lobes(m))
        return n;
    const struct orl_surface_sample drawn = orl_material_sample(
        m, hit, back, ORL_TRANSPORT_EYE,
        (enum orl_lobes)(ORL_LOBE_REFLECTED | ORL_LOBE_TRANSMITTED), &r->random);
    if ((drawn.event == ORL_EVENT_GLOSSY || drawn.event == ORL_EVENT_DIFFUSE) &&
        orl_rgb_max(drawn.weight) > 0)
        ret_continuations[n++] = drawn;
    return n;
}

/* Samples one continuation in proportion to its weight, and rescales it to represent all. */
static struct orl_surface_sample choose_continuation(struct orl_random *random,
                                                     const struct orl_surface_sample *continuations,
                                                     uint32_t n)
{
    double sum = 0;
    for (uint32_t i = 0; i < n; i++)
        sum += orl_rgb_max(continuations[i].weight);
    double threshold = orl_random_uniform(random) * sum;
    uint32_t which = 0;
    while (which + 1 < n && threshold >= orl_rgb_max(continuations[which].weight))
        threshold -= orl_rgb_max(continuations[which++].weight);
    struct orl_surface_sample chosen = continuations[which];
    chosen.weight = orl_rgb_scale(chosen.weight, sum / orl_rgb_max(chosen.weight));
    return chosen;
}

/* Continues the path from the hit; returns false if it has ended. */
static bool continue_path(struct orl_viewpoint_rays *r, struct branch *b, const struct orl_hit *hit,
                          const struct orl_surface_sample *continuation)
{
    b->path.weight = orl_rgb_mul(b->path.weight, continuation->weight);
    const double most = orl_rgb_max(b->path.weight);
    if (!(most > 0) ||
        (most < dim_path && !orl_path_roulette(&b->path, most / dim_path, &r->random)) ||
        (++b->steps > MANY_STEPS && !orl_path_roulette(&b->path, survival, &r->random)))
        return false;
    b->outside = orl_lit_scene_outside_after(r->scene->lit_scene, hit, continuation->transmitted,
                                             b->outside);
    b->scattered = b->scattered || continuation->event == ORL_EVENT_GLOSSY ||
                   continuation->event == ORL_EVENT_DIFFUSE;
    orl_path_spawn_ray(&b->path, r->scene->lit_scene, hit, continuation);
    return true;
}

/* ---- Splitting ------------------------------------------------------------------------------- */

/* Stack of a ray's branches that are still to be traced. */
struct branches {
    struct branch at[ORL_VIEWPOINT_RAY_PATHS];
    uint32_t count;
};

/* Pushes the continuations of a branch. Its paths are divided in proportion to their weights; each
 * gets at least one. */
static void branch_on(struct orl_viewpoint_rays *r, struct branches *all, const struct branch *from,
                      const struct orl_hit *hit, const struct orl_surface_sample *continuations,
                      uint32_t n)
{
    double sum = 0;
    for (uint32_t i = 0; i < n; i++)
        sum += orl_rgb_max(continuations[i].weight);
    for (uint32_t i = n; i-- > 0;) {
        struct branch b = *from;
        const double share = orl_rgb_max(continuations[i].weight) / sum;
        b.paths = n > 1 ? 1 + (uint32_t)(share * (from->paths - n)) : from->paths;
        if (continue_path(r, &b, hit, &continuations[i]))
            all->at[all->count++] = b;
    }
}

/* Traces a branch to the next surface, or out of the scene. */
static int trace_branch(struct orl_viewpoint_rays *r, struct branches *all)
{
    const struct branch b = all->at[--all->count];
    const struct orl_lit_scene *lit_scene = r->scene->lit_scene;
    struct orl_hit hit;
    int code = 0;
    r->steps++;
    if (!orl_path_intersect(lit_scene, &b.path, &hit))
        return add_sky(r, &b);
    const struct orl_material *m = orl_lit_scene_material(lit_scene, &hit);
    const struct orl_rgb albedo = orl_material_diffuse(m, &hit);
    if (orl_rgb_max(albedo) > 0)
        code = add_diffuse(r, &b, &hit, albedo);
    if (code < 0 || orl_material_is_matt(m))
        return code;
    if (orl_material_has_lobes(m)) {
        r->lobes = true;
        if (r->spots && !b.scattered)
            code = add_lobe_spots(r, &b, &hit, m);
    }
    struct orl_surface_sample continuations[MOST_CONTINUATIONS];
    uint32_t n = list_continuations(r, &b, &hit, m, continuations);
    if (n > 1 && n > b.paths) {
        continuations[0] = choose_continuation(&r->random, continuations, n);
        n = 1;
    }
    branch_on(r, all, &b, &hit, continuations, n);
    return code;
}

/* Traces a ray from the eye. Returns 0 or ORL_ERR_NOMEM. */
static int orl_viewpoint_rays_trace(struct orl_viewpoint_rays *rays, struct orl_vec3 direction)
{
    struct branches all = {.count = 1};
    int code = 0;
    all.at[0] = (struct branch){.path = orl_path_from(rays->view->eye.point, direction),
                                .paths = rays->most_paths,
                                .outside = rays->view->eye.outside};
    while (all.count > 0 && code == 0)
        code = trace_branch(rays, &all);
    return code;
}

/* Rays of a pixel along an edge; more if lobes scatter them. */
enum { SIDE = 2, LOBE_SIDE = 6 };

/* ---- Pixels ---------------------------------------------------------------------------------- */

static int trace_pixel(struct orl_viewpoint_rays *rays, uint32_t side)
{
    const struct orl_view_field *field = &rays->view->field;
    const uint32_t column = rays->pixel % ORL_VIEWPOINT_SIDE,
                   row = rays->pixel / ORL_VIEWPOINT_SIDE;
    const uint32_t first = (uint32_t)(orl_random_uniform(&rays->random) * side * side);
    int code = 0;
    orl_pixel_terms_clear(&rays->terms);
    rays->share = 1.0 / (side * side);
    rays->most_paths = side == SIDE ? ORL_VIEWPOINT_RAY_PATHS : ORL_VIEWPOINT_LOBE_PATHS;
    for (uint32_t i = 0; i < side * side && code == 0; i++) {
        const double u = orl_random_uniform(&rays->random), v = orl_random_uniform(&rays->random);
        const uint32_t across = i % side, down = i / side;
        const struct orl_vec3 to = orl_view_field_direction_at(field, column + (across + u) / side,
                                                               row + (down + v) / side);
        rays->spots = i == first;
        code = orl_viewpoint_rays_trace(rays, orl_to_world(&field->eye, to));
    }
    return code;
}

/* Keeps at most ORL_VIEWPOINT_PIXEL_SPOTS of the spots from first on; their weights represent all
 * of them. */
static int thin_spots(struct orl_viewpoint_rays *rays, size_t first)
{
    struct orl_viewpoint_image *view = rays->view;
    const size_t n = view->n_spots - first;
    if (n <= ORL_VIEWPOINT_PIXEL_SPOTS)
        return 0;
    double *weights = malloc(2 * n * sizeof *weights);
    if (!weights)
        return ORL_ERR_NOMEM;
    for (size_t i = 0; i < n; i++)
        weights[i] = orl_rgb_max(view->spots[first + i].weight);
    const int code =
        orl_threshold_sample(weights, n, ORL_VIEWPOINT_PIXEL_SPOTS, &rays->random, weights + n);
    view->n_spots = code == 0 ? first : view->n_spots;
    for (size_t i = 0; i < n && code == 0; i++) {
        struct orl_viewpoint_spot spot = view->spots[first + i];
        if (!(weights[n + i] > 0))
            continue;
        spot.weight = orl_rgb_scale(spot.weight, weights[n + i]);
        view->spots[view->n_spots++] = spot;
    }
    free(weights);
    return code;
}

/* Appends the pixel's terms to those of the view. */
static int append_terms(struct orl_viewpoint_rays *rays, size_t *terms_room)
{
    struct orl_viewpoint_image *view = rays->view;
    const size_t first = view->first[rays->pixel];
    int code = orl_pixel_terms_thin(&rays->terms, ORL_VIEWPOINT_PIXEL_TERMS, &rays->random);
    if (code == 0 && !orl_array_reserve_more(&view->terms, terms_room, first, rays->terms.count,
                                             sizeof *view->terms))
        code = ORL_ERR_NOMEM;
    for (size_t i = 0; i < rays->terms.count && code == 0; i++)
        view->terms[first + i] = rays->terms.at[i];
    view->first[rays->pixel + 1] = (uint32_t)(first + rays->terms.count);
    return code;
}

static int fill_pixel(struct orl_viewpoint_rays *rays)
{
    struct orl_viewpoint_image *view = rays->view;
    const size_t spots = view->n_spots;
    rays->lobes = false;
    orl_pixel_terms_clear(&rays->terms);
    if (!(view->field.solid_angle[rays->pixel] > 0))
        return 0;
    int code = trace_pixel(rays, SIDE);
    if (code == 0 && rays->lobes) {
        view->n_spots = spots;
        code = trace_pixel(rays, LOBE_SIDE);
    }
    return code == 0 ? thin_spots(rays, spots) : code;
}

static int fill_pixels(struct orl_viewpoint_rays *rays, uint64_t seed,
                       const struct orl_thread_pool *pool)
{
    size_t terms_room = 0;
    int code = 0;
    for (uint32_t i = 0; i < ORL_VIEWPOINT_PIXELS && code == 0; i++) {
        if (orl_thread_pool_cancelled(pool))
            return ORL_ERR_CANCELLED;
        rays->pixel = i;
        rays->random = orl_random_stream(seed, ORL_PURPOSE_ANNUAL, ~(uint64_t)i);
        code = fill_pixel(rays);
        if (code == 0)
            code = append_terms(rays, &terms_room);
    }
    return code;
}

/* Replaces indices of found visible points by indices of kept visible points. */
static void renumber_terms(struct orl_viewpoint_image *view)
{
    for (size_t i = 0; i < view->first[ORL_VIEWPOINT_PIXELS]; i++) {
        struct orl_pixel_term *term = &view->terms[i];
        if (term->which < ORL_BINS)
            continue;
        const uint32_t found = (term->which - ORL_BINS) / 2, all = (term->which - ORL_BINS) % 2;
        term->which = ORL_BINS + 2 * view->visible_points.found[found].selected + all;
    }
}

/* ---- All of it ------------------------------------------------------------------------------- */

static int init_view(struct orl_viewpoint_image *view, const struct orl_lit_scene *lit_scene,
                     const struct orl_viewpoint *viewpoint, struct orl_error *err)
{
    const struct orl_vec3 towards = orl_normalize(viewpoint->towards);
    const struct orl_vec3 at = orl_sub(viewpoint->at, lit_scene->geometry->center);
    const struct orl_view fisheye = {.type = 'a',
                                     .point = at,
                                     .direction = towards,
                                     .up = orl_v3(0, 0, 1),
                                     .horizontal = 180,
                                     .vertical = 180};
    char text[512];
    struct orl_view whole;
    orl_view_format(&fisheye, text, sizeof text);
    int code = orl_view_parse(text, &whole, err);
    if (code == 0)
        code = orl_view_field_init(&view->field, &whole, ORL_VIEWPOINT_SIDE, ORL_VIEWPOINT_SIDE, 0,
                                   err);
    if (code < 0)
        return code;
    view->eye = (struct orl_shading_point){
        .point = orl_offset_from_surface(lit_scene->geometry, at, towards), .normal = towards};
    view->eye.outside = orl_lit_scene_is_outside(lit_scene, view->eye.point);
    view->first = calloc(ORL_VIEWPOINT_PIXELS + 1, sizeof *view->first);
    code = view->first ? orl_visible_points_init(&view->visible_points, view->eye.point)
                       : ORL_ERR_NOMEM;
    return code < 0 ? orl_error_set(err, code, "out of memory for the image of a seat") : 0;
}

int orl_viewpoint_image_init(struct orl_viewpoint_image *view, const struct orl_annual_scene *scene,
                             const struct orl_viewpoint *viewpoint, uint64_t name,
                             const struct orl_thread_pool *pool, struct orl_error *err)
{
    *view = (struct orl_viewpoint_image){.n_spots = 0};
    struct orl_viewpoint_rays rays = {.view = view, .scene = scene};
    int code = init_view(view, scene->lit_scene, viewpoint, err);
    if (code < 0)
        return code;
    code = fill_pixels(&rays, name, pool);
    view->n_steps = rays.steps;
    orl_pixel_terms_done(&rays.terms);
    if (code == 0)
        code = orl_visible_points_choose(&view->visible_points, pool);
    if (code == 0) {
        renumber_terms(view);
        orl_visible_points_trim(&view->visible_points);
    }
    return code == ORL_ERR_CANCELLED ? orl_error_set(err, code, "cancelled")
           : code < 0 ? orl_error_set(err, code, "out of memory for the view of a seat")
                      : 0;
}

void orl_viewpoint_image_done(struct orl_viewpoint_image *view)
{
    orl_view_field_done(&view->field);
    orl_visible_points_done(&view->visible_points);
    free(view->first);
    free(view->terms);
    free(view->spots);
}
