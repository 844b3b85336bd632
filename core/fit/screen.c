#include "fit/screen.h"

#include <stdlib.h>
#include <string.h>

#include "base/vectors.h"
#include "fit/square.h"

enum { TILE_PLACES = ORL_FIT_TILE_CELLS * ORL_FIT_CELL_POINTS, TILES_GROUPED = 16 };

/* ---- Making it ------------------------------------------------------------------------------- */

static uint32_t even_bits(uint64_t v)
{
    uint32_t bits = 0;
    for (unsigned i = 0; i < 16; i++)
        bits |= (uint32_t)(v >> 2 * i & 1) << i;
    return bits;
}

/* Sets sample points in Morton order on the square of projected solid angles. */
static void set_places(struct orl_fit_screen *s, size_t n)
{
    const double side = UINT32_C(4) << s->levels;
    for (size_t i = 0; i < n; i++) {
        const double u = even_bits(i) + 0.5, v = even_bits(i >> 1) + 0.5;
        const struct orl_vec3 d =
            orl_square_to_hemisphere((struct orl_square){2 * u / side - 1, 2 * v / side - 1});
        s->x[i] = (float)d.x;
        s->y[i] = (float)d.y;
        s->z[i] = (float)d.z;
    }
}

/* Returns a bounding ball of consecutive points. */
static struct orl_fit_ball ball_of(const struct orl_fit_screen *s, size_t first, size_t count)
{
    struct orl_vec3 sum = {0};
    double radius = 0;
    for (size_t i = first; i < first + count; i++)
        sum = orl_add(sum, orl_v3((double)s->x[i], (double)s->y[i], (double)s->z[i]));
    sum = orl_normalize(sum);
    for (size_t i = first; i < first + count; i++)
        radius = fmax(radius, orl_length(orl_sub(
                                  orl_v3((double)s->x[i], (double)s->y[i], (double)s->z[i]), sum)));
    return (struct orl_fit_ball){(float)sum.x, (float)sum.y, (float)sum.z, (float)(radius * 1.001)};
}

static void set_balls(struct orl_fit_screen *s)
{
    for (size_t t = 0; t < s->n_tiles; t++)
        s->tiles[t] = ball_of(s, t * TILE_PLACES, TILE_PLACES);
    for (size_t t = 0; t < s->n_tiles; t += TILES_GROUPED) {
        const size_t tiles = s->n_tiles - t < TILES_GROUPED ? s->n_tiles - t : TILES_GROUPED;
        s->groups[t / TILES_GROUPED] = ball_of(s, t * TILE_PLACES, tiles * TILE_PLACES);
    }
}

int orl_fit_screen_make(unsigned levels, struct orl_fit_screen *ret_screen, struct orl_error *err)
{
    const size_t cells = (size_t)1 << 2 * levels, places = cells * ORL_FIT_CELL_POINTS;
    struct orl_fit_screen s = {
        .levels = levels, .n_cells = cells, .n_tiles = cells / ORL_FIT_TILE_CELLS};
    s.area = ORL_PI / (double)cells;
    s.spacing = sqrt(ORL_PI / (double)places);
    s.x = malloc(3 * places * sizeof *s.x);
    s.tiles = malloc(s.n_tiles * sizeof *s.tiles);
    s.groups = malloc((s.n_tiles / TILES_GROUPED + 1) * sizeof *s.groups);
    if (!s.x || !s.tiles || !s.groups) {
        orl_fit_screen_done(&s);
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory for directions out");
    }
    s.y = s.x + places;
    s.z = s.y + places;
    set_places(&s, places);
    set_balls(&s);
    *ret_screen = s;
    return 0;
}

void orl_fit_screen_done(struct orl_fit_screen *screen)
{
    if (!screen)
        return;
    free(screen->x);
    free(screen->tiles);
    free(screen->groups);
    memset(screen, 0, sizeof *screen);
}

bool orl_fit_brush_make(const struct orl_fit_screen *screen, struct orl_fit_brush *ret_brush)
{
    struct orl_fit_brush brush = {.caught = malloc(screen->n_tiles * sizeof *brush.caught),
                                  .tiles = malloc(screen->n_tiles * sizeof *brush.tiles),
                                  .value = malloc(screen->n_cells * sizeof *brush.value)};
    *ret_brush = brush;
    if (brush.caught && brush.tiles && brush.value)
        return true;
    orl_fit_brush_done(ret_brush);
    return false;
}

void orl_fit_brush_done(struct orl_fit_brush *brush)
{
    if (!brush)
        return;
    free(brush->caught);
    free(brush->tiles);
    free(brush->value);
    memset(brush, 0, sizeof *brush);
}

/* ---- Drawing --------------------------------------------------------------------------------- */

static const double end_of_sigma2 = 12; /* squared radius of the kernel, in squared sigmas */
/* Rays whose kernel radius is below this many point distances use points of their own. */
static const double least_places = 2.5;

/* Sums the kernel of a ray (x, y, z, 1 / squared radius) over the points of a tile's cells. With
 * fold, adds the kernel of its image below the horizon. The sixteen terms of a cell are added in a
 * fixed order. */
ORL_FOR_WIDE_VECTORS
static double catch_tile(const struct orl_fit_screen *s, size_t tile, const float ray[4], bool fold,
                         float caught[ORL_FIT_TILE_CELLS])
{
    double all = 0;
    for (size_t cell = 0; cell < ORL_FIT_TILE_CELLS; cell++) {
        const size_t first = tile * TILE_PLACES + cell * ORL_FIT_CELL_POINTS;
        const float *x = s->x + first, *y = s->y + first, *z = s->z + first;
        float sums[ORL_FIT_CELL_POINTS];
        for (int i = 0; i < ORL_FIT_CELL_POINTS; i++) {
            const float dx = x[i] - ray[0], dy = y[i] - ray[1], dz = z[i] - ray[2];
            const float q = 1 - (dx * dx + dy * dy + dz * dz) * ray[3], p = q > 0 ? q : 0;
            sums[i] = (p * p) * (p * p);
        }
        for (int i = 0; i < ORL_FIT_CELL_POINTS && fold; i++) {
            const float dx = x[i] - ray[0], dy = y[i] - ray[1], up = z[i] + ray[2];
            const float q = 1 - (dx * dx + dy * dy + up * up) * ray[3], p = q > 0 ? q : 0;
            sums[i] += (p * p) * (p * p);
        }
        for (int half = ORL_FIT_CELL_POINTS / 2; half > 0; half /= 2)
            for (int i = 0; i < half; i++)
                sums[i] += sums[i + half];
        caught[cell] = sums[0];
        all += (double)sums[0];
    }
    return all;
}

static bool reaches(const struct orl_fit_ball *ball, const float ray[4], float end)
{
    const float dx = ball->x - ray[0], dy = ball->y - ray[1], dz = ball->z - ray[2];
    const float up = ball->z + ray[2], flat = dx * dx + dy * dy, most = end + ball->radius;
    return flat + dz * dz < most * most || flat + up * up < most * most;
}

static size_t cell_of(const struct orl_fit_screen *s, struct orl_vec3 d)
{
    const struct orl_square q = orl_disk_to_square(d.x, d.y);
    const unsigned coarser = ORL_FIT_SQUARE_LEVELS - s->levels;
    return (size_t)(orl_fit_spread_bits(orl_fit_square_index(q.x) >> coarser) |
                    orl_fit_spread_bits(orl_fit_square_index(q.y) >> coarser) << 1);
}

/* Adds a ray that is too narrow for the sample points, by points of its own that are closer
 * together. */
static void draw_points(const struct orl_fit_screen *s, const struct orl_fit_ray *ray, double sigma,
                        struct orl_fit_brush *brush)
{
    enum { MOST = 6, POINTS = (2 * MOST + 1) * (2 * MOST + 1) };
    const double wanted = ceil(3 * sigma / (0.8 * s->spacing));
    const int reach = wanted < MOST ? (int)wanted : MOST, side = 2 * reach + 1;
    const double step = reach > 0 ? 3 * sigma / reach : 0;
    const struct orl_frame frame =
        orl_frame_about(orl_v3((double)ray->x, (double)ray->y, (double)ray->z));
    size_t cells[POINTS];
    double weights[POINTS], sum = 0;
    for (int i = 0; i < side * side; i++) {
        const int row = i / side;
        const double u = step * (i % side - reach), v = step * (row - reach);
        const double q = 1 - (u * u + v * v) / (end_of_sigma2 * sigma * sigma), p = q > 0 ? q : 0;
        struct orl_vec3 at = orl_normalize(orl_to_world(&frame, orl_v3(u, v, 1)));
        at.z = fabs(at.z);
        cells[i] = cell_of(s, at);
        weights[i] = (p * p) * (p * p) * (at.z + 1e-6);
        sum += weights[i];
    }
    for (int i = 0; i < side * side; i++)
        brush->value[cells[i]] += weights[i] / sum * (double)ray->mass / s->area;
}

static void draw_ray(const struct orl_fit_screen *s, const struct orl_fit_ray *ray, double sigma,
                     struct orl_fit_brush *brush)
{
    const double end = sqrt(end_of_sigma2) * sigma;
    const float near[4] = {ray->x, ray->y, ray->z, (float)(1 / (end * end))};
    const bool fold = (double)ray->z < end;
    size_t reached = 0;
    double sum = 0;
    for (size_t t = 0; t < s->n_tiles; t++) {
        if (t % TILES_GROUPED == 0 && !reaches(&s->groups[t / TILES_GROUPED], near, (float)end)) {
            t += TILES_GROUPED - 1;
            continue;
        }
        if (!reaches(&s->tiles[t], near, (float)end))
            continue;
        sum += catch_tile(s, t, near, fold, brush->caught[reached]);
        brush->tiles[reached++] = (uint32_t)t;
    }
    if (!(sum > 0)) {
        draw_points(s, ray, sigma, brush);
        return;
    }
    const double scale = (double)ray->mass / (sum * s->area);
    for (size_t k = 0; k < reached; k++)
        for (size_t c = 0; c < ORL_FIT_TILE_CELLS; c++)
            brush->value[(size_t)brush->tiles[k] * ORL_FIT_TILE_CELLS + c] +=
                scale * (double)brush->caught[k][c];
}

void orl_fit_draw(const struct orl_fit_screen *screen, const struct orl_fit_light *light,
                  double blur_rad, struct orl_fit_brush *brush)
{
    for (size_t i = 0; i < screen->n_cells; i++)
        brush->value[i] = light->floor;
    for (size_t i = 0; i < light->n; i++) {
        const struct orl_fit_ray *ray = &light->rays[i];
        const double sigma = hypot((double)ray->sigma_rad, blur_rad);
        /* Towards the horizon, points are farther apart as seen from the surface. */
        if (sigma * sqrt(end_of_sigma2) * orl_larger(0.1, (double)ray->z) <
            least_places * screen->spacing)
            draw_points(screen, ray, sigma, brush);
        else
            draw_ray(screen, ray, sigma, brush);
    }
}
