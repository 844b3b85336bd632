#include "photon/surface/squares.h"

struct outline {
    struct orl_corner corners[8]; /* a triangle clipped four times */
    uint32_t count;
};

/* Clips the outline to the part where a x + b y <= c (Sutherland and Hodgman 1974). */
static void clip_outline(struct outline *outline, double a, double b, double c)
{
    struct outline kept = {.count = 0};
    for (uint32_t i = 0; i < outline->count; i++) {
        const struct orl_corner p = outline->corners[i];
        const struct orl_corner q = outline->corners[(i + 1) % outline->count];
        const double at_p = a * p.x + b * p.y - c, at_q = a * q.x + b * q.y - c;
        if (at_p <= 0 && kept.count < 8)
            kept.corners[kept.count++] = p;
        if ((at_p < 0) != (at_q < 0) && at_p != at_q && kept.count < 8) {
            const double share = at_p / (at_p - at_q);
            kept.corners[kept.count++] =
                (struct orl_corner){p.x + share * (q.x - p.x), p.y + share * (q.y - p.y)};
        }
    }
    *outline = kept;
}

static double area_of(const struct outline *outline)
{
    double sum = 0;
    for (uint32_t i = 2; i < outline->count; i++)
        sum += orl_corner_turn(outline->corners[0], outline->corners[i - 1], outline->corners[i]);
    return 0.5 * fabs(sum);
}

static uint32_t step_at(double at, double width, uint32_t most)
{
    return (uint32_t)orl_smaller(orl_larger(at / width, 0), most - 1);
}

/* Adds a triangle's area to the squares of one row. */
static void add_row(const struct orl_squares *squares, const struct outline *row, uint32_t y,
                    float *areas)
{
    double low = INFINITY, high = -INFINITY;
    for (uint32_t i = 0; i < row->count; i++) {
        low = orl_smaller(low, row->corners[i].x);
        high = orl_larger(high, row->corners[i].x);
    }
    for (uint32_t x = step_at(low, squares->width, squares->across);
         row->count > 2 && x <= step_at(high, squares->width, squares->across); x++) {
        struct outline square = *row;
        clip_outline(&square, -1, 0, -(x * squares->width));
        clip_outline(&square, 1, 0, (x + 1) * squares->width);
        areas[squares->first + y * squares->across + x] += (float)area_of(&square);
    }
}

void orl_squares_add(const struct orl_squares *squares, const struct orl_flat *flats,
                     uint32_t triangles, float *areas)
{
    for (uint32_t i = 0; i < triangles && squares->across > 0; i++) {
        const struct orl_flat *t = &flats[i];
        const double low =
            orl_smaller(orl_smaller(t->corners[0].y, t->corners[1].y), t->corners[2].y);
        const double high =
            orl_larger(orl_larger(t->corners[0].y, t->corners[1].y), t->corners[2].y);
        for (uint32_t y = step_at(low, squares->height, squares->down);
             y <= step_at(high, squares->height, squares->down); y++) {
            struct outline row = {.count = 3};
            for (int k = 0; k < 3; k++)
                row.corners[k] = t->corners[k];
            clip_outline(&row, 0, -1, -(y * squares->height));
            clip_outline(&row, 0, 1, (y + 1) * squares->height);
            add_row(squares, &row, y, areas);
        }
    }
}

uint32_t orl_squares_fullest(const struct orl_squares *squares, const float *areas, uint32_t x,
                             uint32_t y)
{
    const int dx[4] = {-1, 1, 0, 0}, dy[4] = {0, 0, -1, 1};
    uint32_t best = squares->first + y * squares->across + x;
    for (int i = 0; i < 4; i++) {
        const int64_t to_x = (int64_t)x + dx[i], to_y = (int64_t)y + dy[i];
        if (to_x < 0 || to_y < 0 || to_x >= squares->across || to_y >= squares->down)
            continue;
        const uint32_t other = squares->first + (uint32_t)to_y * squares->across + (uint32_t)to_x;
        if (areas[other] > areas[best])
            best = other;
    }
    return best;
}
