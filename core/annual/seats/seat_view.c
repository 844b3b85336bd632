#include "annual/seats/seat_view.h"

#include <stdlib.h>

#include "annual/seats/seat_rays.h"
#include "scene/geometry/stand.h"

/* Rays of a pixel along an edge; more if lobes scatter them. */
enum { SIDE = 2, LOBE_SIDE = 6 };

/* ---- Pixels ---------------------------------------------------------------------------------- */

static int trace_pixel(struct orl_seat_rays *rays, uint32_t side)
{
    const struct orl_field *field = &rays->view->field;
    const uint32_t column = rays->pixel % ORL_SEAT_SIDE, row = rays->pixel / ORL_SEAT_SIDE;
    const uint32_t first = (uint32_t)(orl_random_uniform(&rays->random) * side * side);
    int code = 0;
    orl_seat_terms_clear(&rays->terms);
    rays->share = 1.0 / (side * side);
    rays->most_paths = side == SIDE ? ORL_SEAT_RAY_PATHS : ORL_SEAT_LOBE_PATHS;
    for (uint32_t i = 0; i < side * side && code == 0; i++) {
        const double u = orl_random_uniform(&rays->random), v = orl_random_uniform(&rays->random);
        const uint32_t across = i % side, down = i / side;
        const struct orl_vec3 to =
            orl_field_towards(field, column + (across + u) / side, row + (down + v) / side);
        rays->spots = i == first;
        code = orl_seat_rays_follow(rays, orl_to_world(&field->eye, to));
    }
    return code;
}

/* Keeps at most ORL_SEAT_PIXEL_SPOTS of the spots from first on; their weights represent all of
 * them. */
static int thin_spots(struct orl_seat_rays *rays, size_t first)
{
    struct orl_seat_view *view = rays->view;
    const size_t n = view->n_spots - first;
    if (n <= ORL_SEAT_PIXEL_SPOTS)
        return 0;
    double *weights = malloc(2 * n * sizeof *weights);
    if (!weights)
        return ORL_ERR_NOMEM;
    for (size_t i = 0; i < n; i++)
        weights[i] = orl_rgb_max(view->spots[first + i].weight);
    const int code = orl_seat_choose(weights, n, ORL_SEAT_PIXEL_SPOTS, &rays->random, weights + n);
    view->n_spots = code == 0 ? first : view->n_spots;
    for (size_t i = 0; i < n && code == 0; i++) {
        struct orl_seat_spot spot = view->spots[first + i];
        if (!(weights[n + i] > 0))
            continue;
        spot.weight = orl_rgb_scale(spot.weight, weights[n + i]);
        view->spots[view->n_spots++] = spot;
    }
    free(weights);
    return code;
}

/* Appends the pixel's terms to those of the view. */
static int append_terms(struct orl_seat_rays *rays, size_t *terms_room)
{
    struct orl_seat_view *view = rays->view;
    const size_t first = view->first[rays->pixel];
    int code = orl_seat_terms_thin(&rays->terms, ORL_SEAT_PIXEL_TERMS, &rays->random);
    if (code == 0 && first + rays->terms.count > *terms_room) {
        const size_t room = *terms_room + *terms_room / 2 + ORL_SEAT_PIXELS;
        struct orl_seat_term *grown = realloc(view->terms, room * sizeof *grown);
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

static int fill_pixel(struct orl_seat_rays *rays)
{
    struct orl_seat_view *view = rays->view;
    const size_t spots = view->n_spots;
    rays->lobes = false;
    orl_seat_terms_clear(&rays->terms);
    if (!(view->field.solid_angle[rays->pixel] > 0))
        return 0;
    int code = trace_pixel(rays, SIDE);
    if (code == 0 && rays->lobes) {
        view->n_spots = spots;
        code = trace_pixel(rays, LOBE_SIDE);
    }
    return code == 0 ? thin_spots(rays, spots) : code;
}

static int fill_pixels(struct orl_seat_rays *rays, uint64_t seed, const struct orl_crew *crew)
{
    size_t terms_room = 0;
    int code = 0;
    for (uint32_t i = 0; i < ORL_SEAT_PIXELS && code == 0; i++) {
        if (orl_crew_cancelled(crew))
            return ORL_ERR_CANCELLED;
        rays->pixel = i;
        rays->random = orl_random_stream(seed, ORL_PURPOSE_ANNUAL, ~(uint64_t)i);
        code = fill_pixel(rays);
        if (code == 0)
            code = append_terms(rays, &terms_room);
    }
    return code;
}

/* Replaces indices of found places by indices of kept places. */
static void rename_terms(struct orl_seat_view *view)
{
    for (size_t i = 0; i < view->first[ORL_SEAT_PIXELS]; i++) {
        struct orl_seat_term *term = &view->terms[i];
        if (term->which < ORL_BINS)
            continue;
        const uint32_t found = (term->which - ORL_BINS) / 2, all = (term->which - ORL_BINS) % 2;
        term->which = ORL_BINS + 2 * view->places.found[found].kept + all;
    }
}

/* ---- All of it ------------------------------------------------------------------------------- */

static int init_view(struct orl_seat_view *view, const struct orl_world *world,
                     const struct orl_seat *seat, struct orl_error *err)
{
    const struct orl_vec3 towards = orl_normalize(seat->towards);
    const struct orl_vec3 at = orl_sub(seat->at, world->geometry->center);
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
        code = orl_field_init(&view->field, &whole, ORL_SEAT_SIDE, ORL_SEAT_SIDE, 0, err);
    if (code < 0)
        return code;
    view->eye =
        (struct orl_place){.point = orl_stand(world->geometry, at, towards), .normal = towards};
    view->eye.outside = orl_world_is_outside(world, view->eye.point);
    view->first = calloc(ORL_SEAT_PIXELS + 1, sizeof *view->first);
    code = view->first ? orl_seat_places_init(&view->places, view->eye.point) : ORL_ERR_NOMEM;
    return code < 0 ? orl_error_set(err, code, "out of memory for what a seat sees") : 0;
}

/* Frees the unused capacity of the arrays. */
static void trim_arrays(struct orl_seat_view *view)
{
    const size_t n_terms = view->first[ORL_SEAT_PIXELS];
    struct orl_seat_term *terms = realloc(view->terms, (n_terms + 1) * sizeof *terms);
    struct orl_seat_spot *spots = realloc(view->spots, (view->n_spots + 1) * sizeof *spots);
    view->terms = terms ? terms : view->terms;
    view->spots = spots ? spots : view->spots;
}

int orl_seat_view_init(struct orl_seat_view *view, const struct orl_annual_scene *scene,
                       const struct orl_seat *seat, uint64_t name, const struct orl_crew *crew,
                       struct orl_error *err)
{
    *view = (struct orl_seat_view){.n_spots = 0};
    struct orl_seat_rays rays = {.view = view, .scene = scene};
    int code = init_view(view, scene->world, seat, err);
    if (code < 0)
        return code;
    code = fill_pixels(&rays, name, crew);
    view->n_steps = rays.steps;
    orl_seat_terms_done(&rays.terms);
    if (code == 0)
        code = orl_seat_places_choose(&view->places, crew);
    if (code == 0) {
        rename_terms(view);
        orl_seat_places_trim(&view->places);
        trim_arrays(view);
    }
    return code == ORL_ERR_CANCELLED ? orl_error_set(err, code, "cancelled")
           : code < 0                ? orl_error_set(err, code, "out of memory for a seat's view")
                                     : 0;
}

void orl_seat_view_done(struct orl_seat_view *view)
{
    orl_field_done(&view->field);
    orl_seat_places_done(&view->places);
    free(view->first);
    free(view->terms);
    free(view->spots);
}
