#include "chart/charts.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <oriel/job/picture.h>

enum { LEVELS = 128, MONTHS = 12, HOURS = 24, DECADES = 3 };
static const double page_width = 960, page_height = 360, png_scale = 2;
static const double letters_size = 8, title_size = 10;
static const double head = 34, foot = 30, left_rim = 46, right_rim = 104, bar_width = 14;

static const unsigned char ink[3] = {26, 26, 26}, faint[3] = {150, 150, 150},
                           night[3] = {226, 226, 230}, paper[3] = {255, 255, 255};

struct plot_area {
    const struct orl_temporal_map *map;
    struct orl_canvas *canvas;
    double x0, y0, x1, y1; /* corners of the map */
    double top;
    uint32_t days, per_day;
};

static void write_text(const struct plot_area *s, double x, double y, enum orl_canvas_align align,
                       double size, const char *text)
{
    struct orl_canvas_text_style letters = {
        .size = size, .align = align, .bold = size > letters_size};
    memcpy(letters.rgb, ink, 3);
    orl_canvas_text(s->canvas, x, y, &letters, text);
}

static void fill_box(const struct plot_area *s, double x0, double y0, double x1, double y1,
                     const unsigned char rgb[3])
{
    const double xs[4] = {x0, x1, x1, x0}, ys[4] = {y0, y0, y1, y1};
    orl_canvas_fill(s->canvas, 4, xs, ys, rgb);
}

/* ---- Scale ----------------------------------------------------------------------------------- */

static int by_value(const void *a, const void *b)
{
    const float x = *(const float *)a, y = *(const float *)b;
    return (x > y) - (x < y);
}

/* Rounds up to 1, 1.5, 2, 3, 5 or 7.5 times a power of ten. */
static double round_up(double value)
{
    static const double digits[] = {1, 1.5, 2, 3, 5, 7.5, 10};
    const double power = pow(10, floor(log10(value)));
    int i = 0;
    while (i < 6 && digits[i] * power < value * (1 - 1e-9))
        i++;
    return digits[i] * power;
}

static int find_top(struct plot_area *s)
{
    const uint32_t count = s->map->steps.count;
    float *lit = calloc(count + 1, sizeof *lit);
    size_t n = 0;
    if (!lit)
        return ORL_ERR_NOMEM;
    for (uint32_t i = 0; i < count; i++)
        if (s->map->values[i] >= 0)
            lit[n++] = s->map->values[i];
    qsort(lit, n, sizeof *lit, by_value);
    const double high = n > 0 ? lit[(n - 1) - (n - 1) / 100] : 0;
    free(lit);
    s->top = s->map->top > 0 ? s->map->top : high > 1e-6 ? round_up(high) : 1;
    return 0;
}

/* ---- The map --------------------------------------------------------------------------------- */

enum { LEVEL_NIGHT = -1, LEVEL_NONE = -2 };

static double share_of(const struct plot_area *s, double value)
{
    const double part = fmin(1, value / s->top);
    if (!s->map->logarithmic)
        return part;
    return part > 0 ? fmax(0, 1 + log10(part) / DECADES) : 0;
}

static int level_of(const struct plot_area *s, uint32_t step)
{
    const float value = s->map->values[step];
    if (isnan(value))
        return LEVEL_NONE;
    if (value < 0)
        return LEVEL_NIGHT;
    return (int)lrint(share_of(s, value) * (LEVELS - 1));
}

static double x_of(const struct plot_area *s, double day)
{
    return s->x0 + (s->x1 - s->x0) * day / s->days;
}

static double y_of(const struct plot_area *s, double hour)
{
    return s->y1 - (s->y1 - s->y0) * hour / HOURS;
}

/* Draws a day. Successive steps of one colour are one box, slightly enlarged so that viewers
 * show no gaps between boxes. */
static void draw_day(const struct plot_area *s, uint32_t day)
{
    const uint32_t first = day * s->per_day;
    const double hair = 0.25, right = fmin(s->x1, x_of(s, day + 1) + hair);
    for (uint32_t from = 0; from < s->per_day;) {
        const int level = level_of(s, first + from);
        unsigned char rgb[3];
        uint32_t to = from + 1;
        while (to < s->per_day && level_of(s, first + to) == level)
            to++;
        if (level >= 0) {
            orl_palette_color(ORL_PALETTE_EVEN, (double)level / (LEVELS - 1), rgb);
            fill_box(s, x_of(s, day),
                     y_of(s, (double)to / s->map->steps.per_hour) - (to < s->per_day ? hair : 0),
                     right, y_of(s, (double)from / s->map->steps.per_hour), rgb);
        } else if (level == LEVEL_NONE) {
            fill_box(s, x_of(s, day),
                     y_of(s, (double)to / s->map->steps.per_hour) - (to < s->per_day ? hair : 0),
                     right, y_of(s, (double)from / s->map->steps.per_hour), paper);
        }
        from = to;
    }
}

/* ---- Axes and legend ------------------------------------------------------------------------- */

static void draw_months(const struct plot_area *s)
{
    static const char *const names[MONTHS] = {"Jan", "Feb", "Mar", "Apr", "May", "Jun",
                                              "Jul", "Aug", "Sep", "Oct", "Nov", "Dec"};
    static const int lengths[MONTHS] = {31, 28, 31, 30, 31, 30, 31, 31, 30, 31, 30, 31};
    double day = 0;
    for (int month = 0; month < MONTHS; month++) {
        const double length = lengths[month] + (month == 1 && s->days == 366);
        write_text(s, x_of(s, day + length / 2), s->y1 + 6 + letters_size + 4, ORL_CANVAS_MIDDLE,
                   letters_size, names[month]);
        day += length;
        orl_canvas_line(s->canvas, x_of(s, day), s->y1, x_of(s, day), s->y1 + 5, 1, ink);
    }
    orl_canvas_line(s->canvas, s->x0, s->y1, s->x0, s->y1 + 5, 1, ink);
}

static void draw_hours(const struct plot_area *s)
{
    for (int hour = 0; hour <= HOURS; hour += 6) {
        char text[16];
        snprintf(text, sizeof text, "%d:00", hour);
        orl_canvas_line(s->canvas, s->x0 - 5, y_of(s, hour), s->x0, y_of(s, hour), 1, ink);
        write_text(s, s->x0 - 8, y_of(s, hour) + letters_size / 2, ORL_CANVAS_RIGHT, letters_size,
                   text);
    }
}

/* Draws lines at the hours where marks begin or end on more than half of the days with marks. */
static void draw_use(const struct plot_area *s)
{
    uint32_t used_days = 0;
    for (uint32_t day = 0; s->map->marks && day < s->days; day++)
        used_days += memchr(s->map->marks + (size_t)day * s->per_day, 1, s->per_day) != NULL;
    for (uint32_t k = 0; s->map->marks && k < s->per_day; k++) {
        uint32_t changes = 0;
        for (uint32_t day = 0; day < s->days; day++) {
            const unsigned char *marks = s->map->marks + (size_t)day * s->per_day;
            changes += marks[k] != (k > 0 ? marks[k - 1] : 0);
        }
        const double y = y_of(s, (double)k / s->map->steps.per_hour);
        const int dashes = 2 * changes > used_days ? (int)ceil((s->x1 - s->x0) / 12) : 0;
        for (int i = 0; i < dashes; i++)
            orl_canvas_line(s->canvas, s->x0 + 12 * i, y, fmin(s->x0 + 12 * i + 6, s->x1), y, 0.9,
                            paper);
    }
}

/* Draws a number of the legend at its place. The last one has the unit. */
static void draw_tick(const struct plot_area *s, double x, double value, bool last)
{
    char text[48];
    const double y = s->y1 - (s->y1 - s->y0) * share_of(s, value);
    snprintf(text, sizeof text, value >= 1000 ? "%.0f%s%s%s" : "%.3g%s%s%s", value, last ? " " : "",
             last ? s->map->unit : "", last && !(s->map->top > 0) ? " +" : "");
    orl_canvas_line(s->canvas, x, y, x + 4, y, 1, ink);
    write_text(s, x + 7, y + letters_size / 2, ORL_CANVAS_LEFT, letters_size, text);
}

/* Draws ticks at fifths of the scale. A logarithmic scale has them at its top and at 1 and 3 of
 * every decade that are far enough from the top. */
static void draw_ticks(const struct plot_area *s, double x)
{
    enum { TICKS = 5 };
    for (int i = 0; i <= TICKS && !s->map->logarithmic; i++)
        draw_tick(s, x, s->top * i / TICKS, i == TICKS);
    if (!s->map->logarithmic)
        return;
    const double low = s->top * pow(10, -DECADES), hair = 1e-9;
    const double clear = 1 - 2 * letters_size / (s->y1 - s->y0);
    for (int decade = 0; decade <= DECADES; decade++) {
        const double power = pow(10, floor(log10(low) + hair) + decade);
        const double values[2] = {power, 3 * power};
        for (int i = 0; i < 2; i++)
            if (values[i] >= low * (1 - hair) && share_of(s, values[i]) < clear)
                draw_tick(s, x, values[i], false);
    }
    draw_tick(s, x, s->top, true);
}

static void draw_legend(const struct plot_area *s)
{
    enum { STEPS = 96 };
    const double x0 = s->x1 + 16, x1 = x0 + bar_width;
    for (int i = 0; i < STEPS; i++) {
        unsigned char rgb[3];
        const double y0 = s->y1 - (s->y1 - s->y0) * (i + 1) / STEPS;
        orl_palette_color(ORL_PALETTE_EVEN, (i + 0.5) / STEPS, rgb);
        fill_box(s, x0, y0, x1, s->y1 - (s->y1 - s->y0) * i / STEPS + (i ? 0.3 : 0), rgb);
    }
    draw_ticks(s, x1);
}

static void draw_frame(const struct plot_area *s)
{
    const double xs[5] = {s->x0, s->x1, s->x1, s->x0, s->x0};
    const double ys[5] = {s->y0, s->y0, s->y1, s->y1, s->y0};
    orl_canvas_path(s->canvas, 5, xs, ys, 1, faint);
    draw_months(s);
    draw_hours(s);
    draw_legend(s);
}

/* ---- Pages ----------------------------------------------------------------------------------- */

int orl_temporal_map_draw(const struct orl_temporal_map *map, struct orl_canvas *canvas, double x,
                          double y, double width, double height)
{
    struct plot_area s = {.map = map,
                          .canvas = canvas,
                          .x0 = x + left_rim,
                          .y0 = y + head,
                          .x1 = x + width - right_rim,
                          .y1 = y + height - foot,
                          .per_day = HOURS * map->steps.per_hour};
    s.days = map->steps.count / s.per_day;
    const int code = find_top(&s);
    if (code < 0)
        return code;
    write_text(&s, s.x0, y + 18, ORL_CANVAS_LEFT, title_size, map->title);
    fill_box(&s, s.x0, s.y0, s.x1, s.y1, night);
    for (uint32_t day = 0; day < s.days; day++)
        draw_day(&s, day);
    draw_use(&s);
    draw_frame(&s);
    return 0;
}

int orl_temporal_map_write(const struct orl_temporal_map *map, enum orl_canvas_kind kind,
                           const char *path, struct orl_error *err)
{
    struct orl_canvas *canvas;
    int code = orl_canvas_open(kind, path, page_width, page_height, png_scale, &canvas, err);
    if (code < 0)
        return code;
    code = orl_temporal_map_draw(map, canvas, 0, 0, page_width, page_height);
    if (code < 0)
        orl_error_set(err, code, "out of memory drawing a year");
    return orl_canvas_close(canvas, code, err);
}
