#include "render/picture/false_color.h"

#include <stdlib.h>
#include <string.h>

/* ---- Values ---------------------------------------------------------------------------------- */

/* Values as shares of the scale, original and smoothed. */
struct field {
    uint32_t width, height;
    uint32_t reach;        /* radius of the smoothing, pixels */
    float *sharp, *smooth; /* owned */
};

static void field_done(struct field *field)
{
    free(field->sharp);
    free(field->smooth);
}

/* Filters a pixel and its neighbours along one axis by 1 2 1. */
static void blur_along(const float *from, float *to, const struct field *f, bool upright)
{
    const size_t step = upright ? f->width : 1;
    for (uint32_t y = 0; y < f->height; y++)
        for (uint32_t x = 0; x < f->width; x++) {
            const size_t i = (size_t)y * f->width + x;
            const bool first = upright ? y == 0 : x == 0;
            const bool last = upright ? y + 1 == f->height : x + 1 == f->width;
            to[i] = 0.25F * (from[first ? i : i - step] + 2 * from[i] + from[last ? i : i + step]);
        }
}

enum { PIXELS_A_PASS = 150, MOST_PASSES = 40 };

static int field_init(struct field *field, const struct orl_film *film,
                      const struct orl_scale *scale)
{
    const size_t n = (size_t)film->width * film->height;
    const uint32_t side = film->width > film->height ? film->width : film->height;
    const uint32_t passes = 1 + side / PIXELS_A_PASS;
    *field = (struct field){film->width, film->height, passes < MOST_PASSES ? passes : MOST_PASSES,
                            calloc(n, sizeof(float)), calloc(n, sizeof(float))};
    float *scratch = calloc(n, sizeof *scratch);
    const bool whole = field->sharp && field->smooth && scratch;
    for (size_t i = 0; whole && i < n; i++)
        field->sharp[i] = (float)orl_scale_share(scale, orl_scale_value(scale, film->pixels[i]));
    if (whole) {
        memcpy(field->smooth, field->sharp, n * sizeof(float));
        for (uint32_t i = 0; i < field->reach; i++) {
            blur_along(field->smooth, scratch, field, false);
            blur_along(scratch, field->smooth, field, true);
        }
    }
    free(scratch);
    return whole ? 0 : ORL_ERR_NOMEM;
}

/* ---- Lines ----------------------------------------------------------------------------------- */

struct segment {
    double x0, y0, x1, y1;
};

/* Finds the segments, up to two, of a level in the square between pixel (x, y) and the next ones.
 * Returns their number. */
static int cross_square(const struct field *f, uint32_t x, uint32_t y, double level,
                        struct segment ret_segments[2])
{
    const size_t i = (size_t)y * f->width + x;
    const double v[4] = {f->smooth[i], f->smooth[i + 1], f->smooth[i + f->width + 1],
                         f->smooth[i + f->width]};
    static const double px[4] = {0, 1, 1, 0}, py[4] = {0, 0, 1, 1};
    double hx[4], hy[4];
    int n = 0;
    for (int k = 0; k < 4; k++) {
        const int next = (k + 1) % 4;
        if ((v[k] >= level) == (v[next] >= level))
            continue;
        const double t = (level - v[k]) / (v[next] - v[k]);
        hx[n] = x + 0.5 + px[k] + t * (px[next] - px[k]);
        hy[n++] = y + 0.5 + py[k] + t * (py[next] - py[k]);
    }
    for (int k = 0; k + 1 < n; k += 2)
        ret_segments[k / 2] = (struct segment){hx[k], hy[k], hx[k + 1], hy[k + 1]};
    return n / 2;
}

/* Returns true if an object's edge is near a square: a jump by more than one step. */
static bool is_edge(const struct field *f, uint32_t x, uint32_t y, double step)
{
    float least = INFINITY, most = -INFINITY;
    const uint32_t r = f->reach;
    const uint32_t x0 = x > r ? x - r : 0, x1 = x + r + 1 < f->width ? x + r + 1 : f->width - 1;
    const uint32_t y0 = y > r ? y - r : 0, y1 = y + r + 1 < f->height ? y + r + 1 : f->height - 1;
    for (uint32_t v = y0; v <= y1; v++)
        for (uint32_t u = x0; u <= x1; u++) {
            const float value = f->sharp[(size_t)v * f->width + u];
            least = fminf(least, value);
            most = fmaxf(most, value);
        }
    return (double)(most - least) > step;
}

/* ---- Texts ----------------------------------------------------------------------------------- */

enum { MOST_TEXTS = 1024 };

/* Positions of the texts so far. */
struct texts {
    struct {
        double x, y, turn;
        size_t level;
    } at[MOST_TEXTS];
    size_t n;
};

void orl_letters_on_anything(const struct orl_raster *raster, const struct orl_pen *pen, double x,
                             double y, const char *text)
{
    const double half = orl_stroke_text_width(text, pen->size) / 2, drop = pen->size / 2;
    const double c = cos(pen->turn), s = sin(pen->turn);
    const double left = x - half * c + drop * s, base = y + half * s + drop * c;
    const bool dark = 3 * pen->rgb[0] + 6 * pen->rgb[1] + pen->rgb[2] < 1000;
    struct orl_pen rim = *pen;
    memset(rim.rgb, dark ? 255 : 20, 3);
    rim.weight = fmax(pen->size / 8, 1) + fmax(pen->size / 3, 2);
    orl_stroke_text_draw(raster, &rim, left, base, text);
    orl_stroke_text_draw(raster, pen, left, base, text);
}

/* Places a text along a segment, unless one is near: the same number within a third of the picture,
 * or another that it would overlap. */
static void try_text(struct texts *texts, const struct field *f, const struct segment *s,
                     size_t level, double size)
{
    const double x = (s->x0 + s->x1) / 2, y = (s->y0 + s->y1) / 2;
    const double same = 0.33 * fmax(f->width, f->height), other = 3.5 * size, rim = 2.5 * size;
    if (texts->n == MOST_TEXTS || x < rim || y < rim || x > f->width - rim || y > f->height - rim)
        return;
    for (size_t i = 0; i < texts->n; i++) {
        const double off = hypot(x - texts->at[i].x, y - texts->at[i].y);
        if (off < other || (texts->at[i].level == level && off < same))
            return;
    }
    double turn = atan2(s->y0 - s->y1, s->x1 - s->x0);
    turn = turn > ORL_PI / 2 ? turn - ORL_PI : turn <= -ORL_PI / 2 ? turn + ORL_PI : turn;
    texts->at[texts->n].x = x;
    texts->at[texts->n].y = y;
    texts->at[texts->n].turn = turn;
    texts->at[texts->n++].level = level;
}

/* Follows a line from a segment's end over at most `reach` pixels. Returns its length and sets its
 * end. A line that leaves the picture has length `reach`. */
static double follow_line(const struct field *f, const struct segment *s, double level, double step,
                          double reach, double ret_end[2])
{
    const double x0 = s->x0, y0 = s->y0;
    double x = s->x1, y = s->y1, dx = x - x0, dy = y - y0, length = 0;
    struct segment parts[2];
    while (length < reach) {
        const double fx = x + 1e-3 * dx - 0.5, fy = y + 1e-3 * dy - 0.5;
        ret_end[0] = x;
        ret_end[1] = y;
        if (fx < 0 || fy < 0 || fx >= f->width - 1 || fy >= f->height - 1)
            return reach;
        if (is_edge(f, (uint32_t)fx, (uint32_t)fy, step) ||
            cross_square(f, (uint32_t)fx, (uint32_t)fy, level, parts) == 0)
            return length;
        const bool first =
            hypot(parts[0].x0 - x, parts[0].y0 - y) < hypot(parts[0].x1 - x, parts[0].y1 - y);
        dx = (first ? parts[0].x1 : parts[0].x0) - x;
        dy = (first ? parts[0].y1 : parts[0].y0) - y;
        const double gone = hypot(dx, dy);
        if (gone < 1e-9)
            return length;
        length += gone;
        x += dx;
        y += dy;
    }
    return length;
}

/* Returns the lengths of the line on both sides of a segment, and its ends. */
static void follow_both_ways(const struct field *f, const struct segment *s, double level,
                             double step, double reach, double ret_lengths[2],
                             struct segment *ret_whole)
{
    const struct segment back = {s->x1, s->y1, s->x0, s->y0};
    double ends[2][2] = {{s->x0, s->y0}, {s->x1, s->y1}};
    ret_lengths[0] = follow_line(f, &back, level, step, reach, ends[0]);
    ret_lengths[1] = follow_line(f, s, level, step, reach, ends[1]);
    *ret_whole = (struct segment){ends[0][0], ends[0][1], ends[1][0], ends[1][1]};
}

/* Lines shorter than this many units are specks. */
static const double shortest = 16;

/* Draws a level's lines, first as rims and then as lines, and places their texts. */
static void draw_level(const struct orl_raster *raster, const struct field *f,
                       const struct orl_scale *scale, size_t level, const struct orl_pen *pen,
                       double unit, struct texts *texts)
{
    const double share = orl_scale_share(scale, scale->levels[level]);
    const double step =
        level > 0 ? share - orl_scale_share(scale, scale->levels[level - 1]) : share;
    char text[16];
    orl_scale_text(scale->levels[level], text);
    const double room = 0.6 * orl_stroke_text_width(text, pen->size);
    for (uint32_t y = 0; y + 1 < f->height; y++)
        for (uint32_t x = 0; x + 1 < f->width; x++) {
            struct segment parts[2], whole;
            double lengths[2];
            const int n = cross_square(f, x, y, share, parts);
            if (n == 0 || is_edge(f, x, y, step))
                continue;
            follow_both_ways(f, &parts[0], share, step, fmax(room, shortest * unit), lengths,
                             &whole);
            if (lengths[0] + lengths[1] < shortest * unit)
                continue;
            for (int i = 0; i < n; i++)
                orl_raster_line(raster, pen, parts[i].x0, parts[i].y0, parts[i].x1, parts[i].y1);
            if (texts && lengths[0] >= room && lengths[1] >= room)
                try_text(texts, f, &whole, level, pen->size);
        }
}

static struct orl_pen rim_of(const struct orl_pen *pen)
{
    const bool dark = 3 * pen->rgb[0] + 6 * pen->rgb[1] + pen->rgb[2] < 1000;
    struct orl_pen rim = *pen;
    rim.weight *= 2;
    memset(rim.rgb, dark ? 220 : 30, 3);
    return rim;
}

/* Keeps texts off marks and off the labels to their right. */
static void avoid_marks(struct texts *texts, const struct orl_false_color *how, double unit)
{
    for (uint32_t i = 0; i < how->n_points; i++)
        for (int k = 0; k < 3 && texts->n < MOST_TEXTS; k++) {
            texts->at[texts->n].x = how->points[i].x + 28 * k * unit;
            texts->at[texts->n].y = how->points[i].y;
            texts->at[texts->n++].level = SIZE_MAX;
        }
}

int orl_isolines_draw(const struct orl_raster *raster, const struct orl_film *film,
                      const struct orl_scale *scale, const struct orl_false_color *how,
                      orl_isoline_pen pen_of, double unit)
{
    struct field field;
    struct texts *texts = calloc(1, sizeof *texts);
    int code = field_init(&field, film, scale);
    if (!texts)
        code = ORL_ERR_NOMEM;
    if (code == 0)
        avoid_marks(texts, how, unit);
    const size_t first = texts ? texts->n : 0;
    for (size_t level = 0; code == 0 && level < scale->n_levels; level++) {
        const struct orl_pen pen = pen_of(scale, level, unit), rim = rim_of(&pen);
        draw_level(raster, &field, scale, level, &rim, unit, NULL);
        draw_level(raster, &field, scale, level, &pen, unit, texts);
    }
    for (size_t i = first; code == 0 && i < texts->n; i++) {
        struct orl_pen pen = pen_of(scale, texts->at[i].level, unit);
        char text[16];
        pen.weight = 0;
        pen.turn = texts->at[i].turn;
        orl_scale_text(scale->levels[texts->at[i].level], text);
        orl_letters_on_anything(raster, &pen, texts->at[i].x, texts->at[i].y, text);
    }
    field_done(&field);
    free(texts);
    return code;
}
