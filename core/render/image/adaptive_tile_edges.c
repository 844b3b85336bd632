#include "render/image/adaptive_tile.h"

/*
 * Shares of the luma by which neighbours differ: from the first on there is a shadow's edge between
 * them; below the second there is no edge, whatever they see. Above the third the pixel's centre
 * does not give the mean of the caustic part: along its edges.
 */
static const double sharp_difference = 0.15, no_difference = 0.02, steep_difference = 0.2;

/* Distance, in pixels, within which one of a pixel's rays stands for others that see lobes. */
static const double close_by = 0.3;

/* Rays of a pixel for which smooth light is computed wherever it varies, and rays that are shaded.
 * Later ones find how much of the pixel each surface covers, and how much of it is in shadow; all
 * else they take from the nearest earlier ray that sees the same. */
enum { SMOOTH_RAYS = 8, SHADED_RAYS = 12 };

/* Multiples of its reach within which the smooth part is shared: among the rays of a pixel, whose
 * mean counts; and between neighbouring pixels, if the neighbours agree. */
static const double shared_within = 1, shared_about = 4;

static struct orl_ray_radiance shade_of(const struct orl_tile_pixel *tile_pixel)
{
    const struct orl_rgb sharp = orl_rgb_add(tile_pixel->rest, tile_pixel->direct);
    return (struct orl_ray_radiance){
        .radiance = orl_rgb_add(orl_rgb_add(sharp, tile_pixel->lobes), tile_pixel->smooth.radiance),
        .rest_error = tile_pixel->smooth.rest_error,
        .caustic_error = tile_pixel->smooth.caustic_error,
        .ray_error = sqrt(tile_pixel->variance)};
}

/*
 * The reason to refine a pixel, the stronger one last: its neighbours see other surfaces, or a
 * shadow's edge is near. Rays near such an edge agree by chance, on one side of it or the other.
 * Four equal rays are therefore no reason to stop.
 */
enum cause { CAUSE_NONE, CAUSE_THINGS, CAUSE_SHADOW };

/* Returns the reason, if any, why a difference to its neighbour makes a pixel need refinement. */
static enum cause refinement_cause(const struct orl_tile_pixel *tile_pixel,
                                   const struct orl_tile_pixel *other, bool other_made)
{
    const double luma = orl_luma(shade_of(tile_pixel).radiance);
    if (other_made && tile_pixel->path_signature != other->path_signature) {
        const double beside = orl_luma(shade_of(other).radiance);
        return fabs(beside - luma) > no_difference * fmax(luma, beside) ? CAUSE_THINGS : CAUSE_NONE;
    }
    if (tile_pixel->path_signature != other->path_signature)
        return CAUSE_THINGS;
    const double sharp = orl_luma(orl_rgb_add(tile_pixel->rest, tile_pixel->direct));
    const double beside = orl_luma(orl_rgb_add(other->rest, other->direct));
    if (fabs(beside - sharp) > sharp_difference * luma)
        return CAUSE_SHADOW;
    const double step = fabs(other->smooth.caustic - tile_pixel->smooth.caustic);
    return other_made && step > steep_difference * luma ? CAUSE_THINGS : CAUSE_NONE;
}

static enum cause wants_more(const struct orl_adaptive_tile *tile_state, int x, int y)
{
    const struct orl_tile_pixel *tile_pixel = orl_tile_pixel_at(tile_state, x, y);
    enum cause cause = CAUSE_NONE;
    for (int dy = -1; dy <= 1; dy++) {
        for (int dx = -1; dx <= 1; dx++) {
            const struct orl_tile_pixel *other = orl_tile_pixel_at(tile_state, x + dx, y + dy);
            const bool made = orl_tile_contains(tile_state, x + dx, y + dy) && other->made;
            if (other == tile_pixel || !other->there)
                continue;
            const enum cause found = refinement_cause(tile_pixel, other, made);
            cause = found > cause ? found : cause;
        }
    }
    return cause;
}

/* Results of one pixel's rays that the neighbouring pixels do not have. */
struct found {
    uint64_t path_signature;
    double x, y; /* position in the pixel */
    struct orl_vec3 on_surface;
    struct orl_smooth_lighting smooth;
    struct orl_rgb lobes;
    double variance;
};
/* A shaded ray of the pixel. */
struct shaded_sample {
    uint64_t visible_surfaces;
    double x, y; /* position in the pixel */
    struct orl_ray_radiance radiance;
};
struct finds {
    struct found list[ORL_PIXEL_MOST_RAYS];
    uint32_t count;
    struct shaded_sample shaded[ORL_PIXEL_MOST_RAYS];
    uint32_t n_shaded;
    enum cause cause; /* why the pixel is refined */
    bool is_new;      /* true if one of them has a path signature that no pixel about has */
    /* Range of the direct light's luma over rays with the pixel's own signature. */
    double least_direct, most_direct;
};

/* The neighbouring pixel nearest to a position that sees the same, and the range of luma of all
 * such pixels. */
struct matching_pixels {
    const struct orl_tile_pixel *nearest; /* NULL if there is none */
    double least, most;
};

static struct matching_pixels matching_pixels_of(const struct orl_adaptive_tile *tile_state, int x,
                                                 int y, const double place[2],
                                                 uint64_t path_signature)
{
    struct matching_pixels matching_pixels = {NULL, INFINITY, 0};
    double least = INFINITY;
    for (int dy = -1; dy <= 1; dy++) {
        for (int dx = -1; dx <= 1; dx++) {
            const struct orl_tile_pixel *tile_pixel = orl_tile_pixel_at(tile_state, x + dx, y + dy);
            const double across = dx + 0.5 - place[0], down = dy + 0.5 - place[1];
            const double distance2 = across * across + down * down;
            if (!orl_tile_contains(tile_state, x + dx, y + dy) ||
                tile_pixel->path_signature != path_signature)
                continue;
            const double luma =
                orl_luma(orl_rgb_add(tile_pixel->smooth.radiance, tile_pixel->lobes));
            matching_pixels.least = fmin(matching_pixels.least, luma);
            matching_pixels.most = fmax(matching_pixels.most, luma);
            if (distance2 < least) {
                least = distance2;
                matching_pixels.nearest = tile_pixel;
            }
        }
    }
    return matching_pixels;
}

/* Returns the point of the first surface that a ray saw, or the origin. */
static struct orl_vec3 surface_of(const struct orl_shaded_ray *shaded)
{
    return shaded->n_vertices > 0 ? shaded->vertices[0].on_surface : orl_v3(0, 0, 0);
}

static bool is_within(struct orl_vec3 a, struct orl_vec3 b, double reach)
{
    const struct orl_vec3 way = orl_sub(a, b);
    return orl_dot(way, way) < reach * reach;
}

/* Returns true if the result of one ray can stand for another ray of the pixel. */
static bool can_reuse(const struct found *known, const double place[2],
                      const struct orl_shaded_ray *shaded)
{
    const double across = known->x - place[0], down = known->y - place[1];
    if (known->path_signature != shaded->path_signature)
        return false;
    return shaded->has_lobes ? across * across + down * down < close_by * close_by
                             : is_within(surface_of(shaded), known->on_surface,
                                         shared_within * known->smooth.reach);
}

/* Returns the nearest result in the pixel with the same signature, or NULL. */
static const struct found *nearest_known(const struct finds *finds, const double place[2],
                                         uint64_t path_signature)
{
    const struct found *nearest = NULL;
    double least = INFINITY;
    for (uint32_t i = 0; i < finds->count; i++) {
        const struct found *known = &finds->list[i];
        const double across = known->x - place[0], down = known->y - place[1];
        const double distance2 = across * across + down * down;
        if (known->path_signature == path_signature && distance2 < least) {
            least = distance2;
            nearest = known;
        }
    }
    return nearest;
}

static const struct found *known_for(const struct finds *finds, uint32_t ray, const double place[2],
                                     const struct orl_shaded_ray *shaded)
{
    if (ray >= SMOOTH_RAYS)
        return nearest_known(finds, place, shaded->path_signature);
    for (uint32_t i = 0; i < finds->count; i++)
        if (can_reuse(&finds->list[i], place, shaded))
            return &finds->list[i];
    return NULL;
}

/* Returns the smooth part and the lobes for a ray, computed for it or for a ray close by. */
static const struct found *find_or_compute(const struct orl_adaptive_tile *tile_state, int x, int y,
                                           uint32_t ray, const double place[2],
                                           struct orl_shaded_ray *shaded, struct orl_random *random,
                                           struct finds *finds)
{
    const struct found *known = known_for(finds, ray, place, shaded);
    if (known)
        return known;
    struct found *found = &finds->list[finds->count++];
    if (shaded->has_lobes)
        orl_tile_trace_ray(tile_state, x, y, place,
                           (struct orl_lobe_share){ORL_PIXEL_FIRST_RAYS, finds->count - 1}, random,
                           shaded);
    *found = (struct found){.path_signature = shaded->path_signature,
                            .x = place[0],
                            .y = place[1],
                            .on_surface = surface_of(shaded),
                            .smooth = orl_lighting_smooth(&tile_state->painter->lighting, shaded,
                                                          tile_state->recent_records, random,
                                                          tile_state->search),
                            .lobes = shaded->lobes,
                            .variance = shaded->lobes_variance};
    return found;
}

/* Returns true if the nearest pixel's values hold for a ray that sees the same. */
static bool is_close(const struct matching_pixels *matching_pixels,
                     const struct orl_shaded_ray *shaded)
{
    /* Lobes vary within a pixel with the geometry that frames them. */
    if (!matching_pixels->nearest || shaded->has_lobes ||
        matching_pixels->most - matching_pixels->least > sharp_difference * matching_pixels->most)
        return false;
    if (shaded->n_vertices == 0)
        return true;
    return is_within(surface_of(shaded), surface_of(&matching_pixels->nearest->shaded),
                     shared_about * matching_pixels->nearest->smooth.reach);
}

/*
 * Returns the shaded ray of the pixel nearest to a position that sees the same surfaces, or NULL.
 * There is none either if such rays differ, as along the edge of a shadow, of a pattern, or of what
 * a mirror shows: coverage by the surfaces seen does not then give the pixel.
 */
static const struct shaded_sample *nearest_shaded(const struct finds *finds, const double place[2],
                                                  uint64_t visible_surfaces)
{
    const struct shaded_sample *nearest = NULL;
    double least = INFINITY, darkest = INFINITY, brightest = 0;
    for (uint32_t i = 0; i < finds->n_shaded; i++) {
        const struct shaded_sample *sample = &finds->shaded[i];
        const double across = sample->x - place[0], down = sample->y - place[1];
        const double distance2 = across * across + down * down;
        if (sample->visible_surfaces != visible_surfaces)
            continue;
        const double luma = orl_luma(sample->radiance.radiance);
        darkest = fmin(darkest, luma);
        brightest = fmax(brightest, luma);
        if (distance2 < least) {
            least = distance2;
            nearest = sample;
        }
    }
    return brightest - darkest <= sharp_difference * brightest ? nearest : NULL;
}

/* Returns a shaded ray that stands for one through this position, or NULL. */
static const struct shaded_sample *find_shaded(const struct orl_adaptive_tile *tile_state, int x,
                                               int y, uint32_t ray, const struct finds *finds)
{
    const struct orl_tile_painter *painter = tile_state->painter;
    struct orl_vec3 origin, direction;
    double place[2];
    orl_pixel_ray_position(ray, &place[0], &place[1]);
    if (ray < SHADED_RAYS || finds->cause == CAUSE_SHADOW ||
        painter->shader.lit_scene->scene->mist ||
        !orl_paint_ray(painter->painting, (double)tile_state->tile->x0 + x + place[0],
                       (double)tile_state->tile->y0 + y + place[1], &origin, &direction))
        return NULL;
    return nearest_shaded(finds, place,
                          orl_shade_visible_surfaces(&painter->shader, origin, direction,
                                                     &tile_state->search->health));
}

/* Returns the radiance of one more ray. */
static struct orl_ray_radiance shade_ray(const struct orl_adaptive_tile *tile_state, int x, int y,
                                         uint32_t ray, struct finds *finds)
{
    struct orl_random random =
        orl_tile_pixel_random(tile_state, x, y, ray < ORL_PIXEL_RAYS ? ray : ray + 1);
    struct orl_shaded_ray shaded;
    struct orl_tile_pixel seen;
    double place[2];
    orl_pixel_ray_position(ray, &place[0], &place[1]);
    if (!orl_tile_trace_ray(tile_state, x, y, place, (struct orl_lobe_share){0, 0}, &random,
                            &shaded))
        return (struct orl_ray_radiance){.rest_error = 0};
    const struct orl_direct_lighting direct = orl_lighting_direct(
        &tile_state->painter->lighting, &shaded, orl_tile_pixel_sequence(tile_state, x, y),
        ray * tile_state->painter->lighting.shadow_rays, &tile_state->search->health);
    const struct matching_pixels matching_pixels =
        matching_pixels_of(tile_state, x, y, place, shaded.path_signature);
    if (shaded.path_signature == orl_tile_pixel_at(tile_state, x, y)->path_signature) {
        finds->least_direct = fmin(finds->least_direct, orl_luma(direct.radiance));
        finds->most_direct = fmax(finds->most_direct, orl_luma(direct.radiance));
    }
    seen.rest = shaded.rest;
    seen.direct = direct.radiance;
    if (is_close(&matching_pixels, &shaded)) {
        seen.smooth = matching_pixels.nearest->smooth;
        seen.lobes = matching_pixels.nearest->lobes;
        seen.variance = matching_pixels.nearest->shaded.lobes_variance + direct.variance;
    } else {
        const struct found *found =
            find_or_compute(tile_state, x, y, ray, place, &shaded, &random, finds);
        finds->is_new = finds->is_new || !matching_pixels.nearest;
        seen.smooth = found->smooth;
        seen.lobes = found->lobes;
        seen.variance = found->variance + direct.variance;
    }
    const struct orl_ray_radiance radiance = shade_of(&seen);
    finds->shaded[finds->n_shaded++] =
        (struct shaded_sample){shaded.visible_surfaces, place[0], place[1], radiance};
    return radiance;
}

/* Returns a pixel from several rays, all of the usual ones along the edge of a shadow. *ret_cause:
 * why its neighbours need refinement as well: a ray has a new path signature, or crosses a shadow's
 * edge. */
static struct orl_pixel refine_pixel(const struct orl_adaptive_tile *tile_state, int x, int y,
                                     enum cause cause, enum cause *ret_cause)
{
    const uint32_t rays = cause == CAUSE_SHADOW ? ORL_PIXEL_RAYS : ORL_PIXEL_FIRST_RAYS;
    const double own = orl_luma(orl_tile_pixel_at(tile_state, x, y)->direct);
    struct orl_pixel_rays tally = {.rays = 0};
    struct finds finds;
    finds.count = finds.n_shaded = 0;
    finds.cause = cause;
    finds.is_new = false;
    finds.least_direct = finds.most_direct = own;
    for (uint32_t i = 0; i < rays || i < orl_pixel_rays_needed(&tally); i++) {
        const struct shaded_sample *same = find_shaded(tile_state, x, y, i, &finds);
        const struct orl_ray_radiance ray_radiance =
            same ? same->radiance : shade_ray(tile_state, x, y, i, &finds);
        orl_pixel_add(&tally, &ray_radiance);
    }
    *ret_cause = finds.is_new ? CAUSE_THINGS : CAUSE_NONE;
    if (finds.most_direct - finds.least_direct >
        sharp_difference * orl_luma(tally.sum) / tally.rays)
        *ret_cause = CAUSE_SHADOW;
    return orl_pixel_resolve(&tally);
}

static struct orl_pixel resolve_pixel(const struct orl_tile_pixel *tile_pixel)
{
    struct orl_pixel_rays tally = {.rays = 0};
    const struct orl_ray_radiance ray_radiance = shade_of(tile_pixel);
    orl_pixel_add(&tally, &ray_radiance);
    return orl_pixel_resolve(&tally);
}

static void set_pixel(const struct orl_adaptive_tile *tile_state, int x, int y,
                      const struct orl_pixel *pixel)
{
    orl_film_set(tile_state->painter->painting->film, tile_state->tile->x0 + (uint32_t)x,
                 tile_state->tile->y0 + (uint32_t)y, pixel, &tile_state->search->health);
}

/* Stack of pixels to be refined. */
struct refining {
    struct {
        int x, y;
        enum cause cause;
    } stack[ORL_PAINT_TILE * ORL_PAINT_TILE];
    int depth;
};

static void push_pixel(const struct orl_adaptive_tile *tile_state, int x, int y, enum cause cause,
                       struct refining *refining)
{
    if (!orl_tile_contains(tile_state, x, y) || orl_tile_pixel_at(tile_state, x, y)->refined)
        return;
    orl_tile_pixel_at(tile_state, x, y)->refined = true;
    refining->stack[refining->depth].x = x;
    refining->stack[refining->depth].y = y;
    refining->stack[refining->depth++].cause = cause;
}

/* Refines a pixel, and its neighbours while new surfaces or shadow edges are found. */
static void refine_about(const struct orl_adaptive_tile *tile_state, int x, int y, enum cause cause)
{
    struct refining refining; /* its stack stays uninitialised, because it is large */
    refining.depth = 0;
    push_pixel(tile_state, x, y, cause, &refining);
    while (refining.depth > 0) {
        refining.depth--;
        const int at_x = refining.stack[refining.depth].x, at_y = refining.stack[refining.depth].y;
        enum cause found;
        const struct orl_pixel pixel =
            refine_pixel(tile_state, at_x, at_y, refining.stack[refining.depth].cause, &found);
        set_pixel(tile_state, at_x, at_y, &pixel);
        for (int i = 0; i < 9 && found != CAUSE_NONE; i++)
            push_pixel(tile_state, at_x + i % 3 - 1, at_y + i / 3 - 1, found, &refining);
    }
}

void orl_tile_write_pixels(const struct orl_adaptive_tile *tile_state)
{
    for (int y = 0; y < tile_state->height; y++) {
        for (int x = 0; x < tile_state->width; x++) {
            const struct orl_pixel pixel = resolve_pixel(orl_tile_pixel_at(tile_state, x, y));
            set_pixel(tile_state, x, y, &pixel);
        }
    }
    for (int y = 0; y < tile_state->height; y++)
        for (int x = 0;
             x < tile_state->width && !orl_paint_cancelled(tile_state->painter->painting->env); x++)
            if (!orl_tile_pixel_at(tile_state, x, y)->refined) {
                const enum cause cause = wants_more(tile_state, x, y);
                if (cause != CAUSE_NONE)
                    refine_about(tile_state, x, y, cause);
            }
}
