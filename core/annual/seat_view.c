#include "annual/seat_view.h"

#include <stdlib.h>

#include "light/path.h"
#include "scene/geometry/stand.h"

/* Rays of a pixel: two by two, evenly; where lobes scatter them, more. */
enum { SIDE = 2, LOBE_SIDE = 6, MOST_STEPS = 12 };
static const double dimmest = 0.002, dimmest_mirror = 0.02;

/* A pixel's terms while it is looked at. */
struct looking {
    struct orl_seat_view *view;
    const struct orl_annual_scene *scene;
    struct orl_random random;
    uint32_t pixel;
    double share;                  /* of the pixel, a ray's */
    bool first;                    /* of its rays: spots are its */
    bool lobes;                    /* some ray was scattered */
    size_t n_terms;                /* the pixel's, behind the view's others */
    size_t terms_room, spots_room; /* of the view's arrays */
    int code;
};

struct step {
    struct orl_path path;
    bool outside, scattered;
    int depth;
};

/* ---- What a ray finds ------------------------------------------------------------------------ */

static void add_term(struct looking *l, uint32_t which, double weight)
{
    struct orl_seat_view *view = l->view;
    const size_t first = view->first[l->pixel];
    for (size_t i = 0; i < l->n_terms; i++)
        if (view->terms[first + i].which == which) {
            view->terms[first + i].weight += (float)weight;
            return;
        }
    if (first + l->n_terms == l->terms_room) {
        const size_t room = 2 * l->terms_room + ORL_SEAT_PIXELS;
        struct orl_seat_term *grown = realloc(view->terms, room * sizeof *grown);
        if (!grown) {
            l->code = ORL_ERR_NOMEM;
            return;
        }
        view->terms = grown;
        l->terms_room = room;
    }
    view->terms[first + l->n_terms++] = (struct orl_seat_term){which, (float)weight};
}

static void add_sky(struct looking *l, const struct step *s)
{
    const struct orl_vec3 towards = orl_turn_to_sky(l->scene->north, s->path.direction);
    add_term(l, orl_bins_find(l->scene->bins, towards), l->share * orl_luma(s->path.weight));
}

static void add_spot(struct looking *l, const struct orl_seat_spot *spot)
{
    struct orl_seat_view *view = l->view;
    if (view->n_spots == l->spots_room) {
        const size_t room = 2 * l->spots_room + ORL_SEAT_PIXELS;
        struct orl_seat_spot *grown = realloc(view->spots, room * sizeof *grown);
        if (!grown) {
            l->code = ORL_ERR_NOMEM;
            return;
        }
        view->spots = grown;
        l->spots_room = room;
    }
    view->spots[view->n_spots++] = *spot;
}

static void add_diffuse(struct looking *l, const struct step *s, const struct orl_hit *hit,
                        struct orl_rgb albedo)
{
    const struct orl_geometry *geometry = l->scene->world->geometry;
    const struct orl_rgb weight = orl_rgb_scale(orl_rgb_mul(s->path.weight, albedo), 1 / ORL_PI);
    const double luma = l->share * orl_luma(weight);
    const struct orl_vec3 facing = orl_hit_facing(hit);
    uint32_t found = 0;
    if (orl_seat_places_add(&l->view->places, hit,
                            luma * (double)l->view->field.solid_angle[l->pixel], &l->random,
                            &found) < 0) {
        l->code = ORL_ERR_NOMEM;
        return;
    }
    add_term(l, ORL_BINS + 2 * found + s->scattered, luma);
    if (!l->first || s->scattered)
        return;
    const struct orl_seat_spot spot = {.place = {.point = orl_hit_leave(geometry, hit, facing),
                                                 .normal = facing,
                                                 .outside = s->outside},
                                       .hit = *hit,
                                       .weight = weight,
                                       .pixel = l->pixel};
    add_spot(l, &spot);
}

/* Both sides of what transmits. */
static void add_lobe_spots(struct looking *l, const struct step *s, const struct orl_hit *hit,
                           const struct orl_material *m)
{
    const struct orl_world *world = l->scene->world;
    const struct orl_vec3 seen = orl_hit_facing(hit);
    const int sides = orl_material_transmits_lobes(m) ? 2 : 1;
    for (int side = 0; side < sides; side++) {
        const struct orl_vec3 normal = side == 0 ? seen : orl_neg(seen);
        const struct orl_seat_spot spot = {
            .place = {.point = orl_hit_leave(world->geometry, hit, normal),
                      .normal = normal,
                      .outside = orl_world_outside_after(world, hit, side == 1, s->outside)},
            .hit = *hit,
            .eye = orl_path_back(&s->path),
            .material = m,
            .weight = s->path.weight,
            .pixel = l->pixel};
        add_spot(l, &spot);
    }
}

/* ---- Where it goes --------------------------------------------------------------------------- */

static void follow(struct looking *l, const struct step *s);

static void go_on(struct looking *l, const struct step *s, const struct orl_hit *hit,
                  struct orl_scatter scatter)
{
    struct step next = *s;
    next.path.weight = orl_rgb_mul(s->path.weight, scatter.weight);
    if (!(orl_rgb_max(next.path.weight) > dimmest) || s->depth == MOST_STEPS)
        return;
    next.depth++;
    next.outside = orl_world_outside_after(l->scene->world, hit, scatter.transmitted, s->outside);
    next.scattered =
        s->scattered || scatter.event == ORL_EVENT_GLOSSY || scatter.event == ORL_EVENT_DIFFUSE;
    orl_path_leave(&next.path, l->scene->world, hit, &scatter);
    follow(l, &next);
}

static void mirror(struct looking *l, const struct step *s, const struct orl_hit *hit,
                   const struct orl_material *m)
{
    const struct orl_rgb share = orl_material_mirrored(m, hit, orl_path_back(&s->path));
    const struct orl_vec3 d = s->path.direction, n = orl_hit_facing(hit);
    if (!(orl_rgb_max(share) > dimmest_mirror))
        return;
    go_on(l, s, hit,
          (struct orl_scatter){.event = ORL_EVENT_MIRROR,
                               .direction = orl_normalize(orl_madd(d, n, -2 * orl_dot(d, n))),
                               .weight = share});
}

/* What is specular goes its way whole; of lobes one direction is drawn. */
static void follow(struct looking *l, const struct step *s)
{
    const struct orl_world *world = l->scene->world;
    struct orl_hit hit;
    if (!orl_path_meet(world, &s->path, &hit)) {
        add_sky(l, s);
        return;
    }
    const struct orl_material *m = orl_world_material(world, &hit);
    const struct orl_rgb albedo = orl_material_diffuse(m, &hit);
    if (orl_rgb_max(albedo) > 0)
        add_diffuse(l, s, &hit, albedo);
    if (orl_material_is_matt(m))
        return;
    const struct orl_rgb straight = orl_material_straight(m, &hit, orl_path_back(&s->path));
    if (orl_rgb_max(straight) > 0)
        go_on(l, s, &hit,
              (struct orl_scatter){.event = ORL_EVENT_STRAIGHT,
                                   .transmitted = true,
                                   .direction = s->path.direction,
                                   .weight = straight});
    mirror(l, s, &hit, m);
    if (!orl_material_has_lobes(m))
        return;
    l->lobes = true;
    if (l->first && !s->scattered)
        add_lobe_spots(l, s, &hit, m);
    const struct orl_scatter drawn =
        orl_scatter_sample(m, &hit, orl_path_back(&s->path), ORL_TRANSPORT_EYE,
                           (enum orl_lobes)(ORL_LOBE_REFLECTED | ORL_LOBE_TRANSMITTED), &l->random);
    if (drawn.event == ORL_EVENT_GLOSSY || drawn.event == ORL_EVENT_DIFFUSE)
        go_on(l, s, &hit, drawn);
}

/* ---- Pixels ---------------------------------------------------------------------------------- */

static void look_at(struct looking *l, uint32_t side)
{
    const struct orl_field *field = &l->view->field;
    const uint32_t column = l->pixel % ORL_SEAT_SIDE, row = l->pixel / ORL_SEAT_SIDE;
    const uint32_t first = (uint32_t)(orl_random_uniform(&l->random) * side * side);
    l->n_terms = 0;
    l->share = 1.0 / (side * side);
    for (uint32_t i = 0; i < side * side; i++) {
        const double u = orl_random_uniform(&l->random), v = orl_random_uniform(&l->random);
        const uint32_t across = i % side, down = i / side;
        const struct orl_vec3 to =
            orl_field_towards(field, column + (across + u) / side, row + (down + v) / side);
        const struct step s = {.path =
                                   orl_path_from(l->view->eye.point, orl_to_world(&field->eye, to)),
                               .outside = l->view->eye.outside};
        l->first = i == first;
        follow(l, &s);
    }
}

static int look_all(struct looking *l, uint64_t seed)
{
    struct orl_seat_view *view = l->view;
    int code = 0;
    for (uint32_t i = 0; i < ORL_SEAT_PIXELS && code == 0; i++) {
        const size_t spots = view->n_spots;
        l->pixel = i;
        l->n_terms = 0;
        l->lobes = false;
        l->random = orl_random_stream(seed, ORL_PURPOSE_ANNUAL, ~(uint64_t)i);
        if (view->field.solid_angle[i] > 0) {
            look_at(l, SIDE);
            if (l->lobes) {
                view->n_spots = spots;
                look_at(l, LOBE_SIDE);
            }
        }
        view->first[i + 1] = view->first[i] + (uint32_t)l->n_terms;
        code = l->code;
    }
    return code;
}

/* Terms of places are of those that are kept. */
static void settle_terms(struct orl_seat_view *view)
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

static int start(struct orl_seat_view *view, const struct orl_world *world,
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

int orl_seat_view_init(struct orl_seat_view *view, const struct orl_annual_scene *scene,
                       const struct orl_seat *seat, uint64_t name, struct orl_error *err)
{
    *view = (struct orl_seat_view){.n_spots = 0};
    int code = start(view, scene->world, seat, err);
    struct looking *l = calloc(1, sizeof *l);
    if (code == 0 && l) {
        *l = (struct looking){.view = view, .scene = scene};
        code = look_all(l, name);
        if (code == 0)
            code = orl_seat_places_settle(&view->places);
    }
    if (code == 0 && l)
        settle_terms(view);
    else if (err->code == 0)
        code = orl_error_set(err, ORL_ERR_NOMEM, "out of memory for what a seat sees");
    free(l);
    return code;
}

void orl_seat_view_done(struct orl_seat_view *view)
{
    orl_field_done(&view->field);
    orl_seat_places_done(&view->places);
    free(view->first);
    free(view->terms);
    free(view->spots);
}
