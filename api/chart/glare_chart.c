#include "chart/charts.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const double page_width = 960, page_height = 520, png_scale = 2;
static const double left = 74, right = 838, top = 66, bottom = 436;
static const double room = 26; /* margin in the frame before the first and after the last hour */
static const unsigned char black[3] = {26, 26, 26}, gray[3] = {115, 115, 115},
                           paper[3] = {255, 255, 255}, faint[3] = {225, 225, 225};

/* DGP's classes in ascending order: lower bound, background and ink. */
static const struct class_band {
    double from;
    unsigned char ground[3], ink[3];
} bands[] = {
    [ORL_GLARE_IMPERCEPTIBLE] = {0, {255, 255, 255}, {0, 114, 178}},
    [ORL_GLARE_PERCEPTIBLE] = {0.35, {255, 249, 219}, {176, 122, 0}},
    [ORL_GLARE_DISTURBING] = {0.40, {255, 236, 214}, {213, 94, 0}},
    [ORL_GLARE_INTOLERABLE] = {0.45, {252, 224, 220}, {166, 28, 40}},
};
enum { BANDS = sizeof bands / sizeof bands[0] };

struct glare_drawing {
    struct orl_canvas *canvas;
    const struct orl_glare_hour *hours;
    size_t count;
    double low, high; /* DGP at the frame's edges */
    bool timed;
};

/* ---- Axes ------------------------------------------------------------------------------------ */

static bool is_shown(const struct orl_glare_hour *h)
{
    return isfinite(h->dgp);
}

static bool has_interval(const struct orl_glare_hour *h)
{
    return isfinite(h->low) && isfinite(h->high);
}

static bool rises(const struct orl_glare_hour *hours, size_t count)
{
    for (size_t i = 0; i < count; i++)
        if (!isfinite(hours[i].hour) || (i > 0 && !(hours[i].hour > hours[i - 1].hour)))
            return false;
    return count > 1;
}

/* Finds the DGP range, in multiples of 0.1; it always includes DGP's class bounds. */
static void find_range(struct glare_drawing *s)
{
    s->low = 0.1;
    s->high = 0.6;
    for (size_t i = 0; i < s->count; i++) {
        const struct orl_glare_hour *h = &s->hours[i];
        if (!is_shown(h))
            continue;
        const double least = has_interval(h) ? h->low : h->dgp;
        const double most = has_interval(h) ? h->high : h->dgp;
        s->low = fmin(s->low, floor(10 * least) / 10);
        s->high = fmax(s->high, ceil(10 * most + 0.2) / 10);
    }
    s->low = fmax(s->low, 0);
    s->high = fmin(s->high, 1);
}

static double x_of(const struct glare_drawing *s, size_t i)
{
    const double wide = right - left - 2 * room;
    if (s->timed) {
        const double first = s->hours[0].hour, last = s->hours[s->count - 1].hour;
        return left + room + wide * (s->hours[i].hour - first) / (last - first);
    }
    return s->count == 1 ? (left + right) / 2
                         : left + room + wide * (double)i / (double)(s->count - 1);
}

static double y_of(const struct glare_drawing *s, double dgp)
{
    return bottom - (bottom - top) * (dgp - s->low) / (s->high - s->low);
}

static void write_text(const struct glare_drawing *s, double x, double y, double size,
                       enum orl_canvas_align align, const unsigned char rgb[3], const char *text)
{
    struct orl_canvas_text_style letters = {.size = size, .align = align};
    memcpy(letters.rgb, rgb, 3);
    orl_canvas_text(s->canvas, x, y, &letters, text);
}

static void draw_band(const struct glare_drawing *s, int i)
{
    const double from = fmax(bands[i].from, s->low);
    const double to = fmin(i + 1 < BANDS ? bands[i + 1].from : 1, s->high);
    if (!(to > from))
        return;
    const double y0 = y_of(s, to), y1 = y_of(s, from);
    const double xs[4] = {left, right, right, left}, ys[4] = {y0, y0, y1, y1};
    orl_canvas_fill(s->canvas, 4, xs, ys, bands[i].ground);
    write_text(s, right + 8, (y0 + y1) / 2 + 4, 8.5, ORL_CANVAS_LEFT, bands[i].ink,
               orl_glare_class_name((enum orl_glare_class)i));
}

static void draw_bounds(const struct glare_drawing *s)
{
    for (int i = 1; i < BANDS; i++) {
        const double y = y_of(s, bands[i].from);
        orl_canvas_line(s->canvas, left, y, right, y, 1, bands[i].ink);
    }
}

static void draw_ticks(const struct glare_drawing *s)
{
    char text[16];
    for (int tenth = (int)lrint(10 * s->low); tenth <= (int)lrint(10 * s->high); tenth++) {
        const double y = y_of(s, tenth / 10.0);
        snprintf(text, sizeof text, "%.1f", tenth / 10.0);
        orl_canvas_line(s->canvas, left, y, right, y, 0.7, faint);
        orl_canvas_line(s->canvas, left - 5, y, left, y, 1, black);
        write_text(s, left - 9, y + 4, 9, ORL_CANVAS_RIGHT, black, text);
    }
}

/* Draws a label only if it does not overlap the one before. */
static void draw_labels(const struct glare_drawing *s)
{
    const double size = 9;
    double free_from = 0;
    for (size_t i = 0; i < s->count; i++) {
        const char *text = s->hours[i].label;
        const double x = x_of(s, i), half = orl_canvas_text_width(text, size) / 2;
        orl_canvas_line(s->canvas, x, bottom, x, bottom + 5, 1, black);
        if (x - half < free_from || x + half > page_width)
            continue;
        write_text(s, x, bottom + 19, size, ORL_CANVAS_MIDDLE, black, text);
        free_from = x + half + 8;
    }
}

static void draw_frame(const struct glare_drawing *s)
{
    const double xs[5] = {left, right, right, left, left}, ys[5] = {top, top, bottom, bottom, top};
    const struct orl_canvas_text_style upright = {
        .size = 9.5, .upright = true, .rgb = {26, 26, 26}};
    static const char what[] = "daylight glare probability";
    const double half = orl_canvas_text_width(what, upright.size) / 2;
    orl_canvas_path(s->canvas, 5, xs, ys, 1, black);
    orl_canvas_text(s->canvas, 28, (top + bottom) / 2 + half, &upright, what);
}

/* ---- Hours ----------------------------------------------------------------------------------- */

/* Returns the ink of the class of the value itself, also if its interval is undecided. */
static const unsigned char *ink_of(const struct orl_glare_hour *h)
{
    int i = BANDS - 1;
    while (i > 0 && h->dgp < bands[i].from)
        i--;
    return bands[i].ink;
}

static void draw_mark(const struct glare_drawing *s, double x, double y, const unsigned char *ink,
                      bool hollow)
{
    orl_canvas_disc(s->canvas, x, y, 5, ink);
    if (hollow)
        orl_canvas_disc(s->canvas, x, y, 3, paper);
}

static void draw_interval(const struct glare_drawing *s, double x, double y0, double y1,
                          const unsigned char *ink)
{
    orl_canvas_line(s->canvas, x, y0, x, y1, 1.6, ink);
    orl_canvas_line(s->canvas, x - 4, y0, x + 4, y0, 1.6, ink);
    orl_canvas_line(s->canvas, x - 4, y1, x + 4, y1, 1.6, ink);
}

static void draw_dark(const struct glare_drawing *s, double x)
{
    const double y = bottom - 9;
    orl_canvas_line(s->canvas, x - 4, y - 4, x + 4, y + 4, 1.4, gray);
    orl_canvas_line(s->canvas, x - 4, y + 4, x + 4, y - 4, 1.4, gray);
}

static void draw_hours(const struct glare_drawing *s)
{
    for (size_t i = 1; i < s->count; i++) {
        const struct orl_glare_hour *a = &s->hours[i - 1], *b = &s->hours[i];
        if (is_shown(a) && is_shown(b) && !a->dark && !b->dark)
            orl_canvas_line(s->canvas, x_of(s, i - 1), y_of(s, a->dgp), x_of(s, i), y_of(s, b->dgp),
                            1.2, gray);
    }
    for (size_t i = 0; i < s->count; i++) {
        const struct orl_glare_hour *h = &s->hours[i];
        const double x = x_of(s, i);
        if (h->dark)
            draw_dark(s, x);
        if (!is_shown(h) || h->dark)
            continue;
        if (has_interval(h))
            draw_interval(s, x, y_of(s, fmin(fmax(h->low, s->low), s->high)),
                          y_of(s, fmin(fmax(h->high, s->low), s->high)), ink_of(h));
        draw_mark(s, x, y_of(s, h->dgp), ink_of(h), h->class_of == ORL_GLARE_UNDECIDED);
    }
}

/* ---- Texts ----------------------------------------------------------------------------------- */

static void draw_title(const struct glare_drawing *s, const char *title)
{
    struct orl_canvas_text_style letters = {.size = 12, .bold = true, .rgb = {26, 26, 26}};
    const double width = orl_canvas_text_width(title, letters.size), most = page_width - left - 16;
    if (width > most)
        letters.size *= most / width;
    orl_canvas_text(s->canvas, left, 30, &letters, title);
}

/* Writes the worst DGP as text. */
static void draw_worst(const struct glare_drawing *s)
{
    const struct orl_glare_hour *worst = NULL;
    char text[128], margin[32] = "";
    for (size_t i = 0; i < s->count; i++)
        if (is_shown(&s->hours[i]) && !s->hours[i].dark && (!worst || s->hours[i].dgp > worst->dgp))
            worst = &s->hours[i];
    if (!worst)
        return;
    if (has_interval(worst))
        snprintf(margin, sizeof margin, " (%.3f to %.3f)", worst->low, worst->high);
    snprintf(text, sizeof text, "worst: %.3f%s at %s, %s", worst->dgp, margin, worst->label,
             orl_glare_class_name(worst->class_of));
    write_text(s, left, 52, 9.5, ORL_CANVAS_LEFT, black, text);
}

static void draw_legend(const struct glare_drawing *s)
{
    const double y = page_height - 24;
    bool undecided = false, dark = false;
    double x = left;
    for (size_t i = 0; i < s->count; i++) {
        dark = dark || s->hours[i].dark;
        undecided = undecided || (is_shown(&s->hours[i]) && !s->hours[i].dark &&
                                  s->hours[i].class_of == ORL_GLARE_UNDECIDED);
    }
    const struct {
        const char *text;
        bool there, hollow, cross;
    } rows[] = {{"value and its 95 % interval", true, false, false},
                {"undecided: the interval includes a bound", undecided, true, false},
                {"no light from the sky", dark, false, true}};
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        if (!rows[i].there)
            continue;
        if (rows[i].cross) {
            orl_canvas_line(s->canvas, x, y - 8, x + 8, y, 1.4, gray);
            orl_canvas_line(s->canvas, x, y, x + 8, y - 8, 1.4, gray);
        } else {
            draw_interval(s, x + 4, y - 13, y + 5, gray);
            draw_mark(s, x + 4, y - 4, gray, rows[i].hollow);
        }
        write_text(s, x + 18, y, 9, ORL_CANVAS_LEFT, black, rows[i].text);
        x += 18 + orl_canvas_text_width(rows[i].text, 9) + 34;
    }
}

int orl_glare_chart_write(const struct orl_glare_hour *hours, size_t count, const char *title,
                          enum orl_canvas_kind kind, const char *path, struct orl_error *err)
{
    struct glare_drawing s = {.hours = hours, .count = count, .timed = rises(hours, count)};
    const int code =
        orl_canvas_open(kind, path, page_width, page_height, png_scale, &s.canvas, err);
    if (code < 0)
        return code;
    find_range(&s);
    for (int i = 0; i < BANDS; i++)
        draw_band(&s, i);
    draw_ticks(&s);
    draw_bounds(&s);
    draw_labels(&s);
    draw_hours(&s);
    draw_frame(&s);
    draw_title(&s, title);
    draw_worst(&s);
    draw_legend(&s);
    return orl_canvas_close(s.canvas, 0, err);
}
