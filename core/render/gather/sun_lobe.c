#include "render/gather/direction_sampling.h"

#include <stdlib.h>
#include <string.h>

#include "bsdf/tree/shirley.h"

enum { DRAWS = 1 << 15, DRAWS_A_ROW = DRAWS / ORL_SUN_LOBE_SIDE };
static const double drawn_share =
    0.8; /* share of the table that comes from samples; the rest comes from evaluations */

/* Returns the index of a level's first cell. */
static uint32_t first_cell_of(uint32_t level)
{
    return ((1U << 2 * level) - 1) / 3;
}

/* Returns the Morton index of a cell, so that the four quarters of a cell are neighbours. */
static uint32_t interleave(uint32_t x, uint32_t y)
{
    uint32_t sum = 0;
    for (uint32_t bit = 0; bit < ORL_SUN_LOBE_LEVELS; bit++)
        sum |= ((x >> bit & 1) << 2 * bit) | ((y >> bit & 1) << (2 * bit + 1));
    return sum;
}

static struct orl_vec3 direction_at(double x, double y, uint32_t side)
{
    return orl_square_to_hemisphere((struct orl_square){2 * x / side - 1, 2 * y / side - 1});
}

void orl_sun_lobe_cells_init(struct orl_sun_lobe_cells *cells)
{
    for (uint32_t level = 0; level < ORL_SUN_LOBE_LEVELS; level++) {
        const uint32_t side = 1U << level;
        for (uint32_t y = 0; y < side; y++)
            for (uint32_t x = 0; x < side; x++) {
                const uint32_t cell = first_cell_of(level) + interleave(x, y);
                const struct orl_vec3 middle = direction_at(x + 0.5, y + 0.5, side);
                double reach = 0;
                for (uint32_t corner = 0; corner < 4; corner++) {
                    const struct orl_vec3 at =
                        direction_at(x + (corner & 1), y + (corner >> 1), side);
                    reach = orl_larger(reach, orl_length(orl_sub(at, middle)));
                }
                cells->direction[cell][0] = (float)middle.x;
                cells->direction[cell][1] = (float)middle.y;
                cells->direction[cell][2] = (float)middle.z;
                cells->radius[cell] = (float)reach;
            }
    }
}

/* Returns the finest cell of a direction in the sun lobe's frame, as a Morton index. */
static uint32_t cell_of(struct orl_vec3 d)
{
    const struct orl_square s = orl_disk_to_square(d.x, d.y);
    const double x = 0.5 * (s.x + 1) * ORL_SUN_LOBE_SIDE, y = 0.5 * (s.y + 1) * ORL_SUN_LOBE_SIDE;
    const double most = ORL_SUN_LOBE_SIDE - 1;
    return interleave((uint32_t)orl_smaller(orl_larger(x, 0), most),
                      (uint32_t)orl_smaller(orl_larger(y, 0), most));
}

/* Samples that a table is made from. Threads compute its rows, which are added up in order. */
struct samples {
    const struct orl_sun_lobe *sun_lobe;
    const struct orl_sobol *sobol;
    struct orl_hit hit;
    struct {
        double light;
        uint32_t cell;
    } drawn[DRAWS];
    double value[ORL_SUN_LOBE_SIDE][ORL_SUN_LOBE_SIDE]; /* [y][x] */
};

static void sample_row(void *arg, size_t row, uint32_t member)
{
    struct samples *s = arg;
    const struct orl_sun_lobe *sun_lobe = s->sun_lobe;
    (void)member;
    for (uint32_t i = (uint32_t)row * DRAWS_A_ROW; i < (row + 1) * DRAWS_A_ROW; i++) {
        double u[5];
        orl_sobol_point(s->sobol, i, 1, 5, u);
        /* All of the sun's disc is sampled: parts of it may be in other cells of the data, with
         * other lobes. */
        const struct orl_surface_sample drawn = orl_material_sample_at(
            sun_lobe->material, &s->hit, orl_sun_sample(sun_lobe->sun, u + 3), ORL_TRANSPORT_LIGHT,
            ORL_LOBE_TRANSMITTED, u);
        if (drawn.event != ORL_EVENT_GLOSSY)
            continue;
        s->drawn[i].light = orl_luma(drawn.weight);
        s->drawn[i].cell = cell_of(orl_to_local(&sun_lobe->frame, drawn.direction));
    }
    for (uint32_t x = 0; x < ORL_SUN_LOBE_SIDE; x++) {
        const struct orl_vec3 d = direction_at(x + 0.5, (double)row + 0.5, ORL_SUN_LOBE_SIDE);
        s->value[row][x] =
            orl_luma(orl_material_eval_lobes(sun_lobe->material, &s->hit, sun_lobe->sun->frame.n,
                                             orl_to_world(&sun_lobe->frame, d)));
    }
}

/* Fills the finest level: samples resolve narrow lobes, evaluations include directions too dim to
 * be sampled. */
static void fill_finest(const struct samples *s, double *finest)
{
    double drawn = 0, valued = 0;
    for (uint32_t i = 0; i < DRAWS; i++) {
        finest[s->drawn[i].cell] += s->drawn[i].light;
        drawn += s->drawn[i].light;
    }
    for (uint32_t i = 0; i < ORL_SUN_LOBE_SIDE * ORL_SUN_LOBE_SIDE; i++)
        finest[i] *= drawn > 0 ? drawn_share / drawn : 0;
    for (int pass = 0; pass < 2; pass++)
        for (uint32_t y = 0; y < ORL_SUN_LOBE_SIDE; y++)
            for (uint32_t x = 0; x < ORL_SUN_LOBE_SIDE; x++)
                if (pass == 0)
                    valued += s->value[y][x];
                else if (valued > 0)
                    finest[interleave(x, y)] += (1 - drawn_share) * s->value[y][x] / valued;
}

int orl_sun_lobe_init(struct orl_sun_lobe *sun_lobe, const struct orl_sobol *sobol,
                      struct orl_thread_pool *pool)
{
    static const uint32_t last = ORL_SUN_LOBE_LEVELS - 1;
    double finest[ORL_SUN_LOBE_SIDE * ORL_SUN_LOBE_SIDE] = {0};
    const bool from_front = orl_dot(sun_lobe->sun->frame.n, sun_lobe->normal) > 0;
    struct samples *samples = calloc(1, sizeof *samples);
    if (!samples)
        return ORL_ERR_NOMEM;
    sun_lobe->frame = sun_lobe->material->kind == ORL_MATERIAL_BSDF
                          ? orl_bsdf_frame(sun_lobe->material, sun_lobe->normal)
                          : orl_frame_about(sun_lobe->normal);
    if (from_front)
        sun_lobe->frame.n = orl_neg(sun_lobe->frame.n);
    samples->sun_lobe = sun_lobe;
    samples->sobol = sobol;
    samples->hit = orl_hit_surface_mean(sun_lobe->normal, false);
    const int code = orl_parallel_try(pool, ORL_SUN_LOBE_SIDE, sample_row, samples);
    if (code == 0)
        fill_finest(samples, finest);
    free(samples);
    if (code < 0)
        return code;
    memset(sun_lobe->light, 0, sizeof sun_lobe->light);
    for (uint32_t i = 0; i < ORL_SUN_LOBE_SIDE * ORL_SUN_LOBE_SIDE; i++)
        sun_lobe->light[first_cell_of(last) + i] = (float)finest[i];
    for (uint32_t level = last; level-- > 0;)
        for (uint32_t i = 0; i < 1U << 2 * level; i++)
            for (uint32_t k = 0; k < 4; k++)
                sun_lobe->light[first_cell_of(level) + i] +=
                    sun_lobe->light[first_cell_of(level + 1) + 4 * i + k];
    return 0;
}

struct orl_window_lobe orl_window_lobe_make(const struct orl_geometry *geometry,
                                            const struct orl_sun_lobe *sun_lobe, uint32_t index,
                                            uint32_t facet)
{
    struct orl_facet own;
    const struct orl_facet *f = orl_facet_get_own(geometry, facet, &own);
    struct orl_window_lobe window_lobe = {.sun_lobe = index, .facet = facet};
    double low_u = INFINITY, high_u = -INFINITY, low_v = INFINITY, high_v = -INFINITY;
    struct orl_vec3 corner = f->quadric->center[0];
    if (f->n_triangles == 0) { /* a ring */
        low_u = orl_dot(corner, sun_lobe->frame.u) -
                orl_larger(f->quadric->radius[0], f->quadric->radius[1]);
        high_u = low_u + 2 * orl_larger(f->quadric->radius[0], f->quadric->radius[1]);
        low_v = orl_dot(corner, sun_lobe->frame.v) -
                orl_larger(f->quadric->radius[0], f->quadric->radius[1]);
        high_v = low_v + 2 * orl_larger(f->quadric->radius[0], f->quadric->radius[1]);
    }
    for (uint32_t i = 0; i < 3 * f->n_triangles; i++) {
        const struct orl_triangle t = orl_triangle_get(geometry, orl_facet_triangle(f, i / 3));
        corner = i % 3 == 0 ? t.a : i % 3 == 1 ? t.b : t.c;
        low_u = orl_smaller(low_u, orl_dot(corner, sun_lobe->frame.u));
        high_u = orl_larger(high_u, orl_dot(corner, sun_lobe->frame.u));
        low_v = orl_smaller(low_v, orl_dot(corner, sun_lobe->frame.v));
        high_v = orl_larger(high_v, orl_dot(corner, sun_lobe->frame.v));
    }
    window_lobe.half_u = 0.5 * (high_u - low_u);
    window_lobe.half_v = 0.5 * (high_v - low_v);
    window_lobe.center =
        orl_to_world(&sun_lobe->frame, orl_v3(0.5 * (low_u + high_u), 0.5 * (low_v + high_v),
                                              orl_dot(corner, sun_lobe->frame.n)));
    return window_lobe;
}

/* Returns the part of a cell's light that may reach a place, given relative to the pane's
 * centre. */
static double light_of(const struct orl_window_lobe *window_lobe,
                       const struct orl_sun_lobe *sun_lobe, const struct orl_sun_lobe_cells *cells,
                       uint32_t cell, struct orl_vec3 place)
{
    const float *d = cells->direction[cell];
    const double radius = cells->radius[cell], cosine = d[2];
    if (!(sun_lobe->light[cell] > 0))
        return 0;
    if (cosine <= 1.5 * radius) /* the cell may come from any direction */
        return sun_lobe->light[cell];
    const double way = place.z / cosine, wide = 1.2 * way * radius / cosine;
    return fabs(place.x - way * d[0]) <= window_lobe->half_u + wide &&
                   fabs(place.y - way * d[1]) <= window_lobe->half_v + wide
               ? sun_lobe->light[cell]
               : 0;
}

/* Computes the light of the four quarters that begin at cell `first`; returns their sum. */
static double light_of_quarters(const struct orl_window_lobe *window_lobe,
                                const struct orl_sun_lobe *sun_lobe,
                                const struct orl_sun_lobe_cells *cells, uint32_t first,
                                struct orl_vec3 place, double ret_light[4])
{
    double sum = 0;
    for (uint32_t k = 0; k < 4; k++) {
        ret_light[k] = light_of(window_lobe, sun_lobe, cells, first + k, place);
        sum += ret_light[k];
    }
    return sum;
}

bool orl_window_lobe_sample(const struct orl_window_lobe *window_lobe,
                            const struct orl_sun_lobe *sun_lobe,
                            const struct orl_sun_lobe_cells *cells, struct orl_vec3 point,
                            const double u[2], struct orl_vec3 *ret_direction)
{
    const struct orl_vec3 place =
        orl_to_local(&sun_lobe->frame, orl_sub(point, window_lobe->center));
    double across = u[0], along = u[1];
    uint32_t index = 0, x = 0, y = 0;
    if (!(place.z > 0))
        return false;
    for (uint32_t level = 1; level < ORL_SUN_LOBE_LEVELS; level++) {
        double light[4];
        const double sum = light_of_quarters(window_lobe, sun_lobe, cells,
                                             first_cell_of(level) + 4 * index, place, light);
        if (!(sum > 0))
            return false;
        /* Choose the column first, then the row in it. */
        const double left = (light[0] + light[2]) / sum;
        const uint32_t column = across >= left;
        across = column ? (across - left) / (1 - left) : across / left;
        const double low = light[column] / (light[column] + light[column + 2]);
        const uint32_t row = along >= low;
        along = row ? (along - low) / (1 - low) : along / low;
        index = 4 * index + column + 2 * row;
        x = 2 * x + column;
        y = 2 * y + row;
    }
    *ret_direction = orl_neg(
        orl_to_world(&sun_lobe->frame, direction_at(x + across, y + along, ORL_SUN_LOBE_SIDE)));
    return true;
}

double orl_window_lobe_pdf(const struct orl_window_lobe *window_lobe,
                           const struct orl_sun_lobe *sun_lobe,
                           const struct orl_sun_lobe_cells *cells, struct orl_vec3 point,
                           struct orl_vec3 direction)
{
    const struct orl_vec3 place =
        orl_to_local(&sun_lobe->frame, orl_sub(point, window_lobe->center));
    const struct orl_vec3 d = orl_to_local(&sun_lobe->frame, orl_neg(direction));
    const uint32_t finest = cell_of(d);
    double density = ORL_SUN_LOBE_SIDE * ORL_SUN_LOBE_SIDE * d.z / ORL_PI;
    if (!(place.z > 0) || !(d.z > 0))
        return 0;
    for (uint32_t level = 1; level < ORL_SUN_LOBE_LEVELS; level++) {
        const uint32_t cell = finest >> 2 * (ORL_SUN_LOBE_LEVELS - 1 - level);
        double light[4];
        const double sum = light_of_quarters(window_lobe, sun_lobe, cells,
                                             first_cell_of(level) + (cell & ~3U), place, light);
        if (!(light[cell & 3] > 0))
            return 0;
        density *= light[cell & 3] / sum;
    }
    return density;
}
