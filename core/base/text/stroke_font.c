#include "base/text/stroke_font.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { MOST_LINES = 512, BENDS = 6 };

/* ---- Strokes --------------------------------------------------------------------------------- */

struct point {
    double x, y;
};

/* Stroke in progress, in the glyph's units. */
struct stroke {
    void (*to)(void *ctx, bool begins, struct point p);
    void *ctx;
    struct point first, at, bend; /* bend: middle point of the next parabola */
    bool has_first, has_bend, is_closed;
};

static struct point between(struct point a, struct point b, double share)
{
    return (struct point){a.x + share * (b.x - a.x), a.y + share * (b.y - a.y)};
}

static void extend_stroke(struct stroke *s, struct point p)
{
    for (int i = 1; s->has_bend && i < BENDS; i++) {
        const double t = (double)i / BENDS;
        s->to(s->ctx, false, between(between(s->at, s->bend, t), between(s->bend, p, t), t));
    }
    s->to(s->ctx, false, p);
    s->at = p;
    s->has_bend = false;
}

static void begin_stroke(struct stroke *s, struct point p)
{
    s->first = s->at = p;
    s->has_first = true;
    s->to(s->ctx, true, p);
}

/* Adds a point to the stroke. A closed stroke may begin with bend points; it then begins half way
 * between the first two. */
static void take_point(struct stroke *s, struct point p, bool is_bend)
{
    if (!s->has_first && !is_bend) {
        begin_stroke(s, p);
    } else if (!is_bend) {
        extend_stroke(s, p);
    } else {
        if (s->has_bend && !s->has_first)
            begin_stroke(s, between(s->bend, p, 0.5));
        else if (s->has_bend)
            extend_stroke(s, between(s->bend, p, 0.5));
        s->bend = p;
        s->has_bend = true;
    }
}

static void walk_stroke(const char **text, struct stroke *s)
{
    struct point skipped = {0, 0};
    bool has_skipped = false;
    s->has_first = s->has_bend = s->is_closed = false;
    while (**text && **text != ';') {
        if (**text == ' ' || **text == '@') {
            s->is_closed = s->is_closed || **text == '@';
            (*text)++;
            continue;
        }
        const bool is_bend = **text == '~';
        char *end;
        const long x = strtol(*text + is_bend, &end, 10);
        const long y = strtol(end + 1, &end, 10);
        const struct point p = {(double)x, (double)y};
        *text = end;
        if (is_bend && !s->has_first && !s->has_bend) {
            skipped = p;
            has_skipped = true;
        }
        take_point(s, p, is_bend);
    }
    if (s->is_closed && has_skipped)
        take_point(s, skipped, true);
    if (s->is_closed && s->has_first)
        extend_stroke(s, s->first);
}

static void walk_glyph(const struct orl_stroke_glyph *glyph, struct stroke *s)
{
    if (glyph->base)
        walk_glyph(orl_stroke_glyph_find(glyph->base), s);
    for (const char *text = glyph->shape; *text; text += *text == ';')
        walk_stroke(&text, s);
}

/* ---- Texts ----------------------------------------------------------------------------------- */

/* Returns the next character of UTF-8. Each invalid byte counts as U+FFFD. */
static uint32_t next_code(const char **text)
{
    const unsigned char *at = (const unsigned char *)*text;
    const int more = at[0] < 0x80 ? 0 : at[0] < 0xc0 ? -1 : at[0] < 0xe0 ? 1 : at[0] < 0xf0 ? 2 : 3;
    uint32_t code = more <= 0 ? at[0] : at[0] & (0x3fU >> more);
    for (int i = 1; i <= more; i++) {
        if ((at[i] & 0xc0) != 0x80) {
            *text += 1;
            return 0xfffd;
        }
        code = code << 6 | (at[i] & 0x3fU);
    }
    *text += more > 0 ? more + 1 : 1;
    return more < 0 ? 0xfffd : code;
}

double orl_stroke_text_width(const char *text, double size)
{
    double units = 0;
    while (*text)
        units += orl_stroke_glyph_find(next_code(&text))->width + ORL_STROKE_GLYPH_GAP;
    return units * size / ORL_STROKE_GLYPH_HEIGHT;
}

/* Transform from the glyph's units to pixels. */
struct frame {
    double x, y;        /* position of the glyph's origin */
    double along, down; /* unit step to the right, along x and y */
};

static struct point to_pixels(const struct frame *f, struct point p)
{
    return (struct point){f->x + f->along * p.x + f->down * p.y,
                          f->y + f->down * p.x - f->along * p.y};
}

static struct frame frame_of(const struct orl_pen *pen, double x, double y)
{
    const double unit = pen->size / ORL_STROKE_GLYPH_HEIGHT;
    struct frame f = {x, y, unit, 0};
    if (pen->turn != 0) {
        f.along = unit * cos(pen->turn);
        f.down = -unit * sin(pen->turn);
    }
    const struct point start = to_pixels(&f, (struct point){ORL_STROKE_GLYPH_GAP / 2.0, 0});
    f.x = start.x;
    f.y = start.y;
    return f;
}

static void advance_frame(struct frame *f, const struct orl_stroke_glyph *glyph)
{
    const struct point next = to_pixels(f, (struct point){glyph->width + ORL_STROKE_GLYPH_GAP, 0});
    f->x = next.x;
    f->y = next.y;
}

/* ---- Pixels ---------------------------------------------------------------------------------- */

struct line {
    struct point a, b;
};

/* Strokes of one glyph that are drawn together, so that they are not darker where they meet. */
struct stroke_painter {
    const struct orl_raster *raster;
    const unsigned char *rgb;
    const struct frame *frame;
    double half; /* half of a stroke's width */
    struct point last;
    size_t count;
    struct line lines[MOST_LINES];
};

static double square_to(const struct line *l, double x, double y)
{
    const double dx = l->b.x - l->a.x, dy = l->b.y - l->a.y, px = x - l->a.x, py = y - l->a.y;
    const double length2 = dx * dx + dy * dy;
    const double along = length2 > 0 ? (px * dx + py * dy) / length2 : 0;
    const double share = !(along > 0) ? 0 : along < 1 ? along : 1;
    const double ox = px - share * dx, oy = py - share * dy;
    return ox * ox + oy * oy;
}

static void blend_pixel(unsigned char *pixel, const unsigned char rgb[3], double share)
{
    for (int c = 0; c < 3; c++)
        pixel[c] = (unsigned char)lrint(pixel[c] + share * (rgb[c] - pixel[c]));
}

/* Return the range of pixels, first and end, that an interval covers along an axis. */
static uint32_t first_pixel(double low, uint32_t size)
{
    return !(low > 0) ? 0 : low >= size ? size : (uint32_t)low;
}

static uint32_t end_pixel(double high, uint32_t size)
{
    return !(high > 0) ? 0 : high >= size ? size : (uint32_t)ceil(high);
}

static double least_square(const struct stroke_painter *k, double x, double y)
{
    double least = INFINITY;
    for (size_t i = 0; i < k->count; i++)
        least = fmin(least, square_to(&k->lines[i], x, y));
    return least;
}

static void draw_lines(const struct stroke_painter *k)
{
    const struct orl_raster *raster = k->raster;
    const double reach = k->half + 0.5;
    struct point low = {INFINITY, INFINITY}, high = {-INFINITY, -INFINITY};
    for (size_t i = 0; i < k->count; i++) {
        const struct point a = k->lines[i].a, b = k->lines[i].b;
        low = (struct point){fmin(low.x, fmin(a.x, b.x)), fmin(low.y, fmin(a.y, b.y))};
        high = (struct point){fmax(high.x, fmax(a.x, b.x)), fmax(high.y, fmax(a.y, b.y))};
    }
    const uint32_t x0 = first_pixel(low.x - reach, raster->width);
    const uint32_t x1 = end_pixel(high.x + reach, raster->width);
    const uint32_t y1 = end_pixel(high.y + reach, raster->height);
    for (uint32_t y = first_pixel(low.y - reach, raster->height); y < y1; y++)
        for (uint32_t x = x0; x < x1; x++) {
            const double share = reach - sqrt(least_square(k, x + 0.5, y + 0.5));
            if (share > 0)
                blend_pixel(raster->rgb + 3 * ((size_t)y * raster->width + x), k->rgb,
                            share < 1 ? share : 1);
        }
}

static void add_line(void *ctx, bool begins, struct point p)
{
    struct stroke_painter *k = ctx;
    const struct point at = to_pixels(k->frame, p);
    if (!begins && k->count < MOST_LINES)
        k->lines[k->count++] = (struct line){k->last, at};
    k->last = at;
}

static double half_weight(const struct orl_pen *pen)
{
    const double weight = pen->weight > 0 ? pen->weight : 0.13 * pen->size;
    return fmax(weight, 1) / 2;
}

void orl_stroke_text_draw(const struct orl_raster *raster, const struct orl_pen *pen, double x,
                          double y, const char *text)
{
    struct frame frame = frame_of(pen, x, y);
    struct stroke_painter stroke_painter = {
        .raster = raster, .rgb = pen->rgb, .frame = &frame, .half = half_weight(pen)};
    struct stroke stroke = {.to = add_line, .ctx = &stroke_painter};
    while (*text) {
        const struct orl_stroke_glyph *glyph = orl_stroke_glyph_find(next_code(&text));
        stroke_painter.count = 0;
        walk_glyph(glyph, &stroke);
        draw_lines(&stroke_painter);
        advance_frame(&frame, glyph);
    }
}

void orl_raster_line(const struct orl_raster *raster, const struct orl_pen *pen, double x0,
                     double y0, double x1, double y1)
{
    struct stroke_painter stroke_painter = {.raster = raster,
                                            .rgb = pen->rgb,
                                            .half = fmax(pen->weight, 1) / 2,
                                            .count = 1,
                                            .lines = {{{x0, y0}, {x1, y1}}}};
    draw_lines(&stroke_painter);
}
