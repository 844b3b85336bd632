#include "photon/surface/facet_grid.h"

struct outline {
    struct orl_plane_point corners[8]; /* a triangle clipped four times */
    uint32_t count;
};

/* Clips the outline to the part where a x + b y <= c (Sutherland and Hodgman 1974). */
static void clip_outline(struct outline *outline, double a, double b, double c)
{
    struct outline kept = {.count = 0};
    for (uint32_t i = 0; i < outline->count; i++) {
        const struct orl_plane_point p = outline->corners[i];
        const struct orl_plane_point q = outline->corners[(i + 1) % outline->count];
        const double at_p = a * p.x + b * p.y - c, at_q = a * q.x + b * q.y - c;
        if (at_p <= 0 && kept.count < 8)
            kept.corners[kept.count++] = p;
        if ((at_p < 0) != (at_q < 0) && at_p != at_q && kept.count < 8) {
            const double share = at_p / (at_p - at_q);
            kept.corners[kept.count++] =
                (struct orl_plane_point){p.x + share * (q.x - p.x), p.y + share * (q.y - p.y)};
        }
    }
    *outline = kept;
}

static double area_of(const struct outline *outline)
{
    double sum = 0;
    for (uint32_t i = 2; i < outline->count; i++)
        sum += orl_plane_cross(outline->corners[0], outline->corners[i - 1], outline->corners[i]);
    return 0.5 * fabs(sum);
}

static uint32_t step_at(double at, double width, uint32_t most)
{
    return (uint32_t)orl_smaller(orl_larger(at / width, 0), most - 1);
}

/* Adds a triangle's area to the cells of one row. */
static void add_row(const struct orl_facet_grid *grid, const struct outline *row, uint32_t y,
                    float *areas)
{
    double low = INFINITY, high = -INFINITY;
    for (uint32_t i = 0; i < row->count; i++) {
        low = orl_smaller(low, row->corners[i].x);
        high = orl_larger(high, row->corners[i].x);
    }
    for (uint32_t x = step_at(low, grid->width, grid->columns);
         row->count > 2 && x <= step_at(high, grid->width, grid->columns); x++) {
        struct outline square = *row;
        clip_outline(&square, -1, 0, -(x * grid->width));
        clip_outline(&square, 1, 0, (x + 1) * grid->width);
        areas[grid->first + y * grid->columns + x] += (float)area_of(&square);
    }
}

void orl_facet_grid_add_areas(const struct orl_facet_grid *grid,
                              const struct orl_plane_triangle *plane_triangles, uint32_t triangles,
                              float *areas)
{
    for (uint32_t i = 0; i < triangles && grid->columns > 0; i++) {
        const struct orl_plane_triangle *t = &plane_triangles[i];
        const double low =
            orl_smaller(orl_smaller(t->corners[0].y, t->corners[1].y), t->corners[2].y);
        const double high =
            orl_larger(orl_larger(t->corners[0].y, t->corners[1].y), t->corners[2].y);
        for (uint32_t y = step_at(low, grid->height, grid->rows);
             y <= step_at(high, grid->height, grid->rows); y++) {
            struct outline row = {.count = 3};
            for (int k = 0; k < 3; k++)
                row.corners[k] = t->corners[k];
            clip_outline(&row, 0, -1, -(y * grid->height));
            clip_outline(&row, 0, 1, (y + 1) * grid->height);
            add_row(grid, &row, y, areas);
        }
    }
}

uint32_t orl_facet_grid_fullest(const struct orl_facet_grid *grid, const float *areas, uint32_t x,
                                uint32_t y)
{
    const int dx[4] = {-1, 1, 0, 0}, dy[4] = {0, 0, -1, 1};
    uint32_t best = grid->first + y * grid->columns + x;
    for (int i = 0; i < 4; i++) {
        const int64_t to_x = (int64_t)x + dx[i], to_y = (int64_t)y + dy[i];
        if (to_x < 0 || to_y < 0 || to_x >= grid->columns || to_y >= grid->rows)
            continue;
        const uint32_t other = grid->first + (uint32_t)to_y * grid->columns + (uint32_t)to_x;
        if (areas[other] > areas[best])
            best = other;
    }
    return best;
}
