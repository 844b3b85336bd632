#include "render/mosaic.h"

#include <stdlib.h>

#include "render/pixel.h"

/* Pixels of a tile, and a margin of one about them. */
enum { SIDE = ORL_PAINT_TILE + 2, WIDEST = 8, NAMES = ORL_PIXEL_RAYS + 1 };

/* What is carried over may be off by the first share of a pixel; or by its standard error, but no
 * more than by the second. */
static const double tolerance = 0.02, most_tolerance = 0.06;

/* Neighbours that differ by more than this share see an edge of a shadow; by less than the other
 * they see none, whatever they see. */
static const double sharp_difference = 0.15, no_difference = 0.02;

/* Of a pixel's rays one stands for others that are no further: pixels. */
static const double close_by = 0.3;

/* A pixel by the ray through its middle. */
struct cell {
    bool there;   /* in the picture */
    bool made;    /* what is smooth is known, be it ... */
    bool exact;   /* ... by itself */
    bool refined; /* more rays are to be sent */
    uint64_t way;
    struct orl_rgb rest, direct, lobes;
    double variance; /* of direct and lobes */
    struct orl_smooth smooth;
    struct orl_sight sight;
};

struct mosaic {
    const struct orl_mosaic *m;
    const struct orl_tile *tile;
    struct orl_search *search;
    struct cell (*cells)[SIDE]; /* row by row, from the margin */
    int width, height;          /* of the tile */
};

/* x, y: from the tile's corner; the margin's are -1 and the last. */
static struct cell *cell_at(const struct mosaic *mosaic, int x, int y)
{
    return &mosaic->cells[y + 1][x + 1];
}

static uint64_t pixel_index(const struct mosaic *mosaic, int x, int y)
{
    const uint64_t width = mosaic->m->painting->film->width;
    return (uint64_t)((int64_t)mosaic->tile->y0 + y) * width +
           (uint64_t)((int64_t)mosaic->tile->x0 + x);
}

/* The numbers of a pixel's ray: the one through the middle is the last. */
static struct orl_random numbers_of(const struct mosaic *mosaic, int x, int y, uint32_t ray)
{
    return orl_random_stream(mosaic->m->seed, ORL_PURPOSE_PIXEL,
                             pixel_index(mosaic, x, y) * NAMES + ray);
}

static uint32_t sequence_of(const struct mosaic *mosaic, int x, int y)
{
    return (uint32_t)orl_mix64(mosaic->m->seed * 5 + pixel_index(mosaic, x, y));
}

/* Follows the ray through a place of a pixel, with one in so many of the rays there are for lobes,
 * 0: none; false where the view sees nothing. */
static bool look(const struct mosaic *mosaic, int x, int y, const double place[2],
                 uint32_t lobe_share, struct orl_random *random, struct orl_sight *ret_sight)
{
    const struct orl_mosaic *m = mosaic->m;
    struct orl_onlooker onlooker = m->onlooker;
    struct orl_vec3 origin, direction;
    if (!orl_paint_ray(m->painting, (double)mosaic->tile->x0 + x + place[0],
                       (double)mosaic->tile->y0 + y + place[1], &origin, &direction))
        return false;
    if (lobe_share > 1) {
        onlooker.pane_samples = (onlooker.pane_samples + lobe_share - 1) / lobe_share;
        onlooker.gloss_samples = (onlooker.gloss_samples + lobe_share - 1) / lobe_share;
    }
    orl_shade_look(&onlooker, origin, direction, m->outside, lobe_share > 0, random, mosaic->search,
                   ret_sight);
    ret_sight->rest = orl_health_keep(&mosaic->search->health, ret_sight->rest);
    ret_sight->lobes = orl_health_keep(&mosaic->search->health, ret_sight->lobes);
    return true;
}

/* ---- The rays through the middle ------------------------------------------------------------- */

static bool in_tile(const struct mosaic *mosaic, int x, int y)
{
    return x >= 0 && y >= 0 && x < mosaic->width && y < mosaic->height;
}

static void look_through(const struct mosaic *mosaic, int x, int y)
{
    static const double middle[2] = {0.5, 0.5};
    const struct orl_film *film = mosaic->m->painting->film;
    const int64_t column = (int64_t)mosaic->tile->x0 + x, row = (int64_t)mosaic->tile->y0 + y;
    struct cell *cell = cell_at(mosaic, x, y);
    struct orl_random random = numbers_of(mosaic, x, y, ORL_PIXEL_RAYS);
    cell->there = column >= 0 && row >= 0 && column < film->width && row < film->height;
    cell->made = cell->exact = cell->refined = false;
    if (!cell->there)
        return;
    cell->way = 0;
    cell->variance = 0;
    cell->rest = cell->direct = cell->lobes = orl_gray(0);
    cell->sight.n_vertices = 0;
    if (!look(mosaic, x, y, middle, (uint32_t)in_tile(mosaic, x, y), &random, &cell->sight))
        return;
    const struct orl_shadowed direct = orl_lighting_direct(
        &mosaic->m->lighting, &cell->sight, sequence_of(mosaic, x, y),
        ORL_PIXEL_RAYS * mosaic->m->lighting.shadow_rays, &mosaic->search->health);
    cell->way = cell->sight.way;
    cell->rest = cell->sight.rest;
    cell->lobes = cell->sight.lobes;
    cell->direct = direct.radiance;
    cell->variance = direct.variance + cell->sight.lobes_variance;
}

/* ---- What is smooth -------------------------------------------------------------------------- */

static void make_exact(const struct mosaic *mosaic, int x, int y)
{
    struct cell *cell = cell_at(mosaic, x, y);
    struct orl_random random = numbers_of(mosaic, x, y, ORL_PIXEL_RAYS);
    if (cell->exact || !cell->there)
        return;
    cell->smooth = orl_lighting_smooth(&mosaic->m->lighting, &cell->sight, &random, mosaic->search);
    cell->made = cell->exact = true;
}

/* Corners of a square of pixels, all of them in it. */
struct square {
    int x0, y0, x1, y1;
};

/* Adds a share of one to another. */
static void add_smooth(struct orl_smooth *sum, const struct orl_smooth *more, double share)
{
    sum->radiance = orl_rgb_add(sum->radiance, orl_rgb_scale(more->radiance, share));
    sum->rest_error += share * more->rest_error;
    sum->caustic_error += share * more->caustic_error;
    sum->reach = fmin(sum->reach, more->reach);
}

/* Between the corners, by shares of the way across and down. */
static struct orl_smooth between(const struct mosaic *mosaic, const struct square *s, double across,
                                 double down)
{
    struct orl_smooth sum = {.reach = INFINITY};
    add_smooth(&sum, &cell_at(mosaic, s->x0, s->y0)->smooth, (1 - across) * (1 - down));
    add_smooth(&sum, &cell_at(mosaic, s->x1, s->y0)->smooth, across * (1 - down));
    add_smooth(&sum, &cell_at(mosaic, s->x0, s->y1)->smooth, (1 - across) * down);
    add_smooth(&sum, &cell_at(mosaic, s->x1, s->y1)->smooth, across * down);
    return sum;
}

static double share_of(int at, int from, int to)
{
    return to > from ? (double)(at - from) / (to - from) : 0;
}

/* Whether corners and middle see alike, and the corners say what the middle is. */
static bool is_smooth(const struct mosaic *mosaic, const struct square *s)
{
    const int x = (s->x0 + s->x1) / 2, y = (s->y0 + s->y1) / 2;
    const int xs[4] = {s->x0, s->x1, s->x0, s->x1}, ys[4] = {s->y0, s->y0, s->y1, s->y1};
    const struct cell *middle = cell_at(mosaic, x, y);
    for (int i = 0; i < 4; i++)
        if (!cell_at(mosaic, xs[i], ys[i])->there ||
            cell_at(mosaic, xs[i], ys[i])->way != middle->way)
            return false;
    for (int i = 0; i < 4; i++)
        make_exact(mosaic, xs[i], ys[i]);
    make_exact(mosaic, x, y);
    const struct orl_smooth guess =
        between(mosaic, s, share_of(x, s->x0, s->x1), share_of(y, s->y0, s->y1));
    const double luma = orl_luma(middle->smooth.radiance);
    const double all = luma + orl_luma(middle->rest) + orl_luma(middle->direct);
    const double error = hypot(middle->smooth.rest_error, middle->smooth.caustic_error);
    return fabs(orl_luma(guess.radiance) - luma) <=
           fmax(tolerance * all, fmin(error, most_tolerance * all));
}

static void carry_over(const struct mosaic *mosaic, const struct square *s)
{
    const uint64_t way = cell_at(mosaic, s->x0, s->y0)->way;
    for (int y = s->y0; y <= s->y1; y++) {
        for (int x = s->x0; x <= s->x1; x++) {
            struct cell *cell = cell_at(mosaic, x, y);
            if (cell->made)
                continue;
            if (cell->way != way) {
                make_exact(mosaic, x, y);
                continue;
            }
            cell->smooth = between(mosaic, s, share_of(x, s->x0, s->x1), share_of(y, s->y0, s->y1));
            cell->made = true;
        }
    }
}

static void fill_square(const struct mosaic *mosaic, const struct square *s)
{
    const int x = (s->x0 + s->x1) / 2, y = (s->y0 + s->y1) / 2;
    const bool wide = s->x1 - s->x0 > 1, high = s->y1 - s->y0 > 1;
    if (!wide && !high) {
        make_exact(mosaic, s->x0, s->y0);
        make_exact(mosaic, s->x1, s->y0);
        make_exact(mosaic, s->x0, s->y1);
        make_exact(mosaic, s->x1, s->y1);
        return;
    }
    if (is_smooth(mosaic, s)) {
        carry_over(mosaic, s);
        return;
    }
    fill_square(mosaic, &(struct square){s->x0, s->y0, wide ? x : s->x1, high ? y : s->y1});
    if (wide)
        fill_square(mosaic, &(struct square){x, s->y0, s->x1, high ? y : s->y1});
    if (high)
        fill_square(mosaic, &(struct square){s->x0, y, wide ? x : s->x1, s->y1});
    if (wide && high)
        fill_square(mosaic, &(struct square){x, y, s->x1, s->y1});
}

static int lesser(int a, int b)
{
    return a < b ? a : b;
}

/* Squares share their corners, also with those of the tiles beside: hence the margin. */
static void fill_all(const struct mosaic *mosaic)
{
    const int last_x = cell_at(mosaic, mosaic->width, 0)->there ? mosaic->width : mosaic->width - 1;
    const int last_y =
        cell_at(mosaic, 0, mosaic->height)->there ? mosaic->height : mosaic->height - 1;
    for (int y = 0; y < mosaic->height; y += WIDEST)
        for (int x = 0; x < mosaic->width; x += WIDEST)
            fill_square(mosaic, &(struct square){x, y, lesser(x + WIDEST, last_x),
                                                 lesser(y + WIDEST, last_y)});
}

/* ---- More rays ------------------------------------------------------------------------------- */

static struct orl_shade shade_of(const struct cell *cell)
{
    const struct orl_rgb sharp = orl_rgb_add(cell->rest, cell->direct);
    return (struct orl_shade){
        .radiance = orl_rgb_add(orl_rgb_add(sharp, cell->lobes), cell->smooth.radiance),
        .rest_error = cell->smooth.rest_error,
        .caustic_error = cell->smooth.caustic_error,
        .ray_error = sqrt(cell->variance)};
}

/* Whether two neighbours make one look closer at the first. */
static bool differ(const struct cell *cell, const struct cell *other, bool other_made)
{
    const double luma = orl_luma(shade_of(cell).radiance);
    if (other_made && cell->way != other->way) {
        const double beside = orl_luma(shade_of(other).radiance);
        return fabs(beside - luma) > no_difference * fmax(luma, beside);
    }
    if (cell->way != other->way)
        return true;
    const double sharp = orl_luma(orl_rgb_add(cell->rest, cell->direct));
    const double beside = orl_luma(orl_rgb_add(other->rest, other->direct));
    return fabs(beside - sharp) > sharp_difference * luma;
}

static bool wants_more(const struct mosaic *mosaic, int x, int y)
{
    const struct cell *cell = cell_at(mosaic, x, y);
    for (int dy = -1; dy <= 1; dy++) {
        for (int dx = -1; dx <= 1; dx++) {
            const struct cell *other = cell_at(mosaic, x + dx, y + dy);
            const bool made = in_tile(mosaic, x + dx, y + dy) && other->made;
            if (other != cell && other->there && differ(cell, other, made))
                return true;
        }
    }
    return false;
}

/* What the rays of one pixel have found that the pixels about cannot tell. */
struct found {
    uint64_t way;
    double x, y; /* in the pixel */
    struct orl_smooth smooth;
    struct orl_rgb lobes;
    double variance;
};
struct finds {
    struct found list[ORL_PIXEL_RAYS];
    uint32_t count;
    bool is_new; /* one of them nobody about has seen */
};

/* The nearest of the pixels about a place of one that see the same, and how far their lumas reach.
 */
struct kin {
    const struct cell *nearest; /* NULL: there is none */
    double least, most;
};

static struct kin kin_of(const struct mosaic *mosaic, int x, int y, const double place[2],
                         uint64_t way)
{
    struct kin kin = {NULL, INFINITY, 0};
    double least = INFINITY;
    for (int dy = -1; dy <= 1; dy++) {
        for (int dx = -1; dx <= 1; dx++) {
            const struct cell *cell = cell_at(mosaic, x + dx, y + dy);
            const double across = dx + 0.5 - place[0], down = dy + 0.5 - place[1];
            const double distance2 = across * across + down * down;
            if (!in_tile(mosaic, x + dx, y + dy) || cell->way != way)
                continue;
            const double luma = orl_luma(orl_rgb_add(cell->smooth.radiance, cell->lobes));
            kin.least = fmin(kin.least, luma);
            kin.most = fmax(kin.most, luma);
            if (distance2 < least) {
                least = distance2;
                kin.nearest = cell;
            }
        }
    }
    return kin;
}

/* What is smooth and what lobes show, worked out for a ray, or for one close by. */
static const struct found *find(const struct mosaic *mosaic, int x, int y, const double place[2],
                                struct orl_sight *sight, struct orl_random *random,
                                struct finds *finds)
{
    const uint64_t way = sight->way;
    for (uint32_t i = 0; i < finds->count; i++) {
        const struct found *known = &finds->list[i];
        const double across = known->x - place[0], down = known->y - place[1];
        if (known->way == way && across * across + down * down < close_by * close_by)
            return known;
    }
    struct found *found = &finds->list[finds->count++];
    if (sight->has_lobes)
        look(mosaic, x, y, place, ORL_PIXEL_FIRST_RAYS, random, sight);
    *found = (struct found){
        .way = way,
        .x = place[0],
        .y = place[1],
        .smooth = orl_lighting_smooth(&mosaic->m->lighting, sight, random, mosaic->search),
        .lobes = sight->lobes,
        .variance = sight->lobes_variance};
    return found;
}

/* Whether the nearest may speak for a ray that sees the same. */
static bool is_close(const struct kin *kin, const struct orl_sight *sight)
{
    /* Lobes change within a pixel of what frames them. */
    if (!kin->nearest || sight->has_lobes || kin->most - kin->least > sharp_difference * kin->most)
        return false;
    if (sight->n_vertices == 0)
        return true;
    const struct orl_vec3 way =
        orl_sub(sight->vertices[0].on_surface, kin->nearest->sight.vertices[0].on_surface);
    return orl_dot(way, way) < kin->nearest->smooth.reach * kin->nearest->smooth.reach;
}

/* What one more ray sees. */
static struct orl_shade shade_ray(const struct mosaic *mosaic, int x, int y, uint32_t ray,
                                  struct finds *finds)
{
    struct orl_random random = numbers_of(mosaic, x, y, ray);
    struct orl_sight sight;
    struct cell seen;
    double place[2];
    orl_pixel_place(ray, &place[0], &place[1]);
    if (!look(mosaic, x, y, place, 0, &random, &sight))
        return (struct orl_shade){.rest_error = 0};
    const struct orl_shadowed direct =
        orl_lighting_direct(&mosaic->m->lighting, &sight, sequence_of(mosaic, x, y),
                            ray * mosaic->m->lighting.shadow_rays, &mosaic->search->health);
    const struct kin kin = kin_of(mosaic, x, y, place, sight.way);
    seen.rest = sight.rest;
    seen.direct = direct.radiance;
    if (is_close(&kin, &sight)) {
        seen.smooth = kin.nearest->smooth;
        seen.lobes = kin.nearest->lobes;
        seen.variance = kin.nearest->sight.lobes_variance + direct.variance;
    } else {
        const struct found *found = find(mosaic, x, y, place, &sight, &random, finds);
        finds->is_new = finds->is_new || !kin.nearest;
        seen.smooth = found->smooth;
        seen.lobes = found->lobes;
        seen.variance = found->variance + direct.variance;
    }
    return shade_of(&seen);
}

/* A pixel by more rays; ret_new: these have seen something that no ray about has. */
static struct orl_pixel refine(const struct mosaic *mosaic, int x, int y, bool *ret_new)
{
    struct orl_pixel_rays tally = {.rays = 0};
    struct finds finds;
    finds.count = 0;
    finds.is_new = false;
    for (uint32_t i = 0;
         i < ORL_PIXEL_FIRST_RAYS || (i < ORL_PIXEL_RAYS && orl_pixel_is_uneven(&tally)); i++) {
        const struct orl_shade shade = shade_ray(mosaic, x, y, i, &finds);
        orl_pixel_add(&tally, &shade);
    }
    *ret_new = finds.is_new;
    return orl_pixel_settle(&tally);
}

static struct orl_pixel settle_cell(const struct cell *cell)
{
    struct orl_pixel_rays tally = {.rays = 0};
    const struct orl_shade shade = shade_of(cell);
    orl_pixel_add(&tally, &shade);
    return orl_pixel_settle(&tally);
}

static void set(const struct mosaic *mosaic, int x, int y, const struct orl_pixel *pixel)
{
    orl_film_set(mosaic->m->painting->film, mosaic->tile->x0 + (uint32_t)x,
                 mosaic->tile->y0 + (uint32_t)y, pixel, &mosaic->search->health);
}

/* Refines a pixel, and those about it for as long as something new comes up. */
static void refine_about(const struct mosaic *mosaic, int x, int y)
{
    int stack[ORL_PAINT_TILE * ORL_PAINT_TILE][2];
    int depth = 0;
    stack[depth][0] = x;
    stack[depth++][1] = y;
    cell_at(mosaic, x, y)->refined = true;
    while (depth > 0) {
        const int at_x = stack[--depth][0], at_y = stack[depth][1];
        bool is_new;
        const struct orl_pixel pixel = refine(mosaic, at_x, at_y, &is_new);
        set(mosaic, at_x, at_y, &pixel);
        for (int i = 0; i < 9 && is_new; i++) {
            const int to_x = at_x + i % 3 - 1, to_y = at_y + i / 3 - 1;
            if (!in_tile(mosaic, to_x, to_y) || cell_at(mosaic, to_x, to_y)->refined)
                continue;
            cell_at(mosaic, to_x, to_y)->refined = true;
            stack[depth][0] = to_x;
            stack[depth++][1] = to_y;
        }
    }
}

static void settle_all(const struct mosaic *mosaic)
{
    for (int y = 0; y < mosaic->height; y++) {
        for (int x = 0; x < mosaic->width; x++) {
            const struct orl_pixel pixel = settle_cell(cell_at(mosaic, x, y));
            set(mosaic, x, y, &pixel);
        }
    }
    for (int y = 0; y < mosaic->height; y++)
        for (int x = 0; x < mosaic->width && !orl_paint_cancelled(mosaic->m->painting->env); x++)
            if (!cell_at(mosaic, x, y)->refined && wants_more(mosaic, x, y))
                refine_about(mosaic, x, y);
}

void orl_mosaic_paint(void *ctx, const struct orl_tile *tile, struct orl_search *search)
{
    const struct orl_mosaic *m = ctx;
    struct mosaic mosaic = {.m = m,
                            .tile = tile,
                            .search = search,
                            .cells = malloc(SIDE * sizeof *mosaic.cells),
                            .width = (int)(tile->x1 - tile->x0),
                            .height = (int)(tile->y1 - tile->y0)};
    if (!mosaic.cells) {
        atomic_store(m->failed, true);
        return;
    }
    for (int y = -1; y <= mosaic.height && !orl_paint_cancelled(m->painting->env); y++)
        for (int x = -1; x <= mosaic.width; x++)
            look_through(&mosaic, x, y);
    if (!orl_paint_cancelled(m->painting->env)) {
        fill_all(&mosaic);
        settle_all(&mosaic);
    }
    free(mosaic.cells);
}
