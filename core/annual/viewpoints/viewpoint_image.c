#include "annual/viewpoints/viewpoint_image.h"

#include <stdlib.h>

#include "annual/viewpoints/viewpoint_rays.h"
#include "scene/geometry/surface_offset.h"

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
    if (code == 0 && first + rays->terms.count > *terms_room) {
        const size_t room = *terms_room + *terms_room / 2 + ORL_VIEWPOINT_PIXELS;
        struct orl_pixel_term *grown = realloc(view->terms, room * sizeof *grown);
        if (!grown)
            return ORL_ERR_NOMEM;
        view->terms = grown;
        *terms_room = room;
    }
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
    return code < 0 ? orl_error_set(err, code, "out of memory for what a seat sees") : 0;
}

/* Frees the unused capacity of the arrays. */
static void trim_arrays(struct orl_viewpoint_image *view)
{
    const size_t n_terms = view->first[ORL_VIEWPOINT_PIXELS];
    struct orl_pixel_term *terms = realloc(view->terms, (n_terms + 1) * sizeof *terms);
    struct orl_viewpoint_spot *spots = realloc(view->spots, (view->n_spots + 1) * sizeof *spots);
    view->terms = terms ? terms : view->terms;
    view->spots = spots ? spots : view->spots;
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
        trim_arrays(view);
    }
    return code == ORL_ERR_CANCELLED ? orl_error_set(err, code, "cancelled")
           : code < 0                ? orl_error_set(err, code, "out of memory for a seat's view")
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
