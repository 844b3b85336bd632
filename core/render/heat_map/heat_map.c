#include "render/heat_map/heat_map.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/statistics/numeric.h"

/* ---- Cells on the page ----------------------------------------------------------------------- */

/* Four corners in order, of either orientation; convex. Page units. */
struct orl_quad {
    double x[4], y[4];
};

/* Returns a rectangle. */
static struct orl_quad orl_quad_of(double x0, double y0, double x1, double y1)
{
    return (struct orl_quad){{x0, x1, x1, x0}, {y0, y0, y1, y1}};
}

/* Returns the distance of a point inside the edge that starts at corner k, times the edge's length;
 * turn: sign of the quad's orientation. */
static double distance_within(const struct orl_quad *q, int k, double turn, double x, double y)
{
    const int n = (k + 1) % 4;
    return turn * ((q->x[n] - q->x[k]) * (y - q->y[k]) - (q->y[n] - q->y[k]) * (x - q->x[k]));
}

static double turn_of(const struct orl_quad *q)
{
    const double cross =
        (q->x[1] - q->x[0]) * (q->y[2] - q->y[0]) - (q->y[1] - q->y[0]) * (q->x[2] - q->x[0]);
    return cross < 0 ? -1 : 1;
}

static void bounds_of(const double v[4], double *ret_low, double *ret_high)
{
    *ret_low = fmin(fmin(v[0], v[1]), fmin(v[2], v[3]));
    *ret_high = fmax(fmax(v[0], v[1]), fmax(v[2], v[3]));
}

/* Clips the line x + y = sum, from (x0, sum - x0) along (1, -1), to the quad. */
static void clip_line(const struct orl_quad *q, double x0, double sum, double *from, double *to)
{
    const double turn = turn_of(q);
    for (int k = 0; k < 4; k++) {
        const double a = distance_within(q, k, turn, x0, sum - x0);
        const double slope = distance_within(q, k, turn, x0 + 1, sum - x0 - 1) - a;
        if (slope > 0)
            *from = fmax(*from, -a / slope);
        else if (slope < 0)
            *to = fmin(*to, -a / slope);
        else if (a < 0)
            *to = -1;
    }
}

/* Hatches a quad with slanting lines; apart: their distance, page units. */
static void orl_quad_hatch(struct orl_canvas *canvas, const struct orl_quad *q, double apart,
                           const unsigned char rgb[3])
{
    double x0, x1, y0, y1;
    bounds_of(q->x, &x0, &x1);
    bounds_of(q->y, &y0, &y1);
    const long last = lrint(floor((x1 + y1) / apart));
    for (long line = lrint(ceil((x0 + y0) / apart)); line <= last; line++) {
        const double sum = apart * (double)line;
        double from = 0, to = x1 - x0;
        clip_line(q, x0, sum, &from, &to);
        if (from < to)
            orl_canvas_line(canvas, x0 + from, sum - x0 - from, x0 + to, sum - x0 - to, 1, rgb);
    }
}

/* Layout of the page, in page units. */
enum { SIDE = 760, MARGIN = 14, HEAD = 46, FOOT = 54, LEAST_WIDTH = 420, LETTERS = 8 };

static const unsigned char ink[3] = {26, 26, 26}, paper[3] = {255, 255, 255};

struct page {
    const struct orl_heat_map *map;
    struct orl_scale scale;
    struct orl_canvas *canvas;
    double low[2], high[2]; /* area shown, u and v */
    double pixels;          /* page units per scene unit */
    double x, y;            /* upper left corner of the map */
    double left, bottom;    /* position of `low` on the page */
    double width, height;
};

static void place_on_page(const struct page *page, const double at[2], double *ret_x, double *ret_y)
{
    *ret_x = page->left + (at[0] - page->low[0]) * page->pixels;
    *ret_y = page->bottom - (at[1] - page->low[1]) * page->pixels;
}

static void write_text(const struct page *page, double x, double y, enum orl_canvas_align align,
                       const unsigned char rgb[3], const char *text)
{
    struct orl_canvas_text_style letters = {.size = LETTERS, .align = align};
    memcpy(letters.rgb, rgb, 3);
    orl_canvas_text(page->canvas, x, y, &letters, text);
}

/* ---- Layout ---------------------------------------------------------------------------------- */

/* Clips a segment to the frame (Liang and Barsky 1984); ret: the part inside. Returns false if
 * there is none. */
static bool clip_segment(const struct page *page, const double from[2], const double to[2],
                         double ret[2])
{
    ret[0] = 0;
    ret[1] = 1;
    for (int axis = 0; axis < 2; axis++) {
        const double d = to[axis] - from[axis];
        const double a = (page->low[axis] - from[axis]) / d;
        const double b = (page->high[axis] - from[axis]) / d;
        if (d == 0 && (from[axis] < page->low[axis] || from[axis] > page->high[axis]))
            return false;
        if (d != 0) {
            ret[0] = fmax(ret[0], fmin(a, b));
            ret[1] = fmin(ret[1], fmax(a, b));
        }
    }
    return ret[0] < ret[1];
}

/* The extent of the plan within the frame. */
struct extent {
    const struct page *frame;
    double low[2], high[2];
};

static void extend_extent(void *ctx, const double from[2], const double to[2])
{
    struct extent *extent = ctx;
    double part[2];
    if (!clip_segment(extent->frame, from, to, part))
        return;
    for (int i = 0; i < 2; i++)
        for (int axis = 0; axis < 2; axis++) {
            const double at = from[axis] + part[i] * (to[axis] - from[axis]);
            extent->low[axis] = fmin(extent->low[axis], at);
            extent->high[axis] = fmax(extent->high[axis], at);
        }
}

/* Sets the area shown: the cells, plus the parts with walls up to an eighth more on every side,
 * plus a margin. */
static void lay_out(struct page *page, double side)
{
    const struct orl_sensor_plane *plane = page->map->plane;
    const double most = fmax(plane->high[0] - plane->low[0], plane->high[1] - plane->low[1]);
    struct extent extent = {.frame = page};
    for (int axis = 0; axis < 2; axis++) {
        extent.low[axis] = plane->low[axis];
        extent.high[axis] = plane->high[axis];
        page->low[axis] = plane->low[axis] - most / 8;
        page->high[axis] = plane->high[axis] + most / 8;
    }
    orl_section_cut(page->map->geometry, plane, extend_extent, &extent);
    for (int axis = 0; axis < 2; axis++) {
        page->low[axis] = fmax(page->low[axis], extent.low[axis] - most / 40);
        page->high[axis] = fmin(page->high[axis], extent.high[axis] + most / 40);
    }
    const double wide = page->high[0] - page->low[0], high = page->high[1] - page->low[1];
    page->pixels = side / fmax(wide, high);
    const double across = ceil(wide * page->pixels), down = ceil(high * page->pixels);
    page->width = fmax(across, LEAST_WIDTH) + 2 * MARGIN;
    page->height = down + HEAD + FOOT;
    page->left = page->x + (page->width - across) / 2;
    page->bottom = page->y + HEAD + down;
}

enum { DECADES_BY_VALUES = -1 };
const struct orl_heat_map_request orl_default_heat_map = {.asked = true,
                                                          .colors = {.decades = DECADES_BY_VALUES},
                                                          .thresholds_lx = {300},
                                                          .n_thresholds = 1};

/* Returns the decades of a scale: as requested, or enough for nine tenths of the values. n of these
 * are in values, which are reordered. */
static double decades_of(const struct orl_false_color *how, double *values, size_t n, double high)
{
    static const double narrow = 10; /* ratio up to which a linear scale shows all values */
    if (how->decades != DECADES_BY_VALUES)
        return how->decades;
    const double low = n > 0 ? orl_nth_element(values, n, n / 10) : 0;
    return low > 0 && high > narrow * low ? fmin(ceil(log10(high / low) + 0.5), 4) : 0;
}

/* Makes the scale. Its top covers 99 of 100 sensors of the plane. */
static int make_scale(struct page *page)
{
    const struct orl_sensor_plane *plane = page->map->plane;
    double *values = calloc(plane->count + 1, sizeof *values);
    size_t n = 0;
    if (!values)
        return ORL_ERR_NOMEM;
    for (size_t i = 0; i < plane->count; i++)
        if (isfinite(page->map->values[plane->sensors[i]]))
            values[n++] = page->map->values[plane->sensors[i]];
    const double high = n > 0 ? orl_nth_element(values, n, (n - 1) - (n - 1) / 100) : 0;
    struct orl_false_color colors = page->map->how->colors;
    colors.decades = decades_of(&colors, values, n, high);
    free(values);
    orl_scale_set(&page->scale, &colors, page->map->unit, high);
    return 0;
}

/* ---- Cells ----------------------------------------------------------------------------------- */

static struct orl_quad cell_of(const struct page *page, size_t index)
{
    static const double corners[4][2] = {{-0.5, -0.5}, {0.5, -0.5}, {0.5, 0.5}, {-0.5, 0.5}};
    const struct orl_sensor_plane *plane = page->map->plane;
    const double c = cos(plane->angle), s = sin(plane->angle);
    struct orl_quad quad;
    for (int k = 0; k < 4; k++) {
        const double a = corners[k][0] * plane->cell[0], b = corners[k][1] * plane->cell[1];
        const double at[2] = {plane->at[index][0] + a * c - b * s,
                              plane->at[index][1] + a * s + b * c};
        place_on_page(page, at, &quad.x[k], &quad.y[k]);
    }
    return quad;
}

static bool is_open(const struct page *page, size_t sensor)
{
    const struct orl_heat_map_request *how = page->map->how;
    const double *interval = page->map->intervals[sensor];
    for (uint32_t i = 0; i < how->n_thresholds; i++)
        if (interval[0] < how->thresholds_lx[i] && interval[1] > how->thresholds_lx[i])
            return true;
    return false;
}

static bool is_dark(const unsigned char rgb[3])
{
    return 3 * rgb[0] + 6 * rgb[1] + rgb[2] < 1200;
}

/* Returns true if the numbers of all cells fit into them. */
static bool has_room(const struct page *page)
{
    const struct orl_sensor_plane *plane = page->map->plane;
    double widest = 0;
    for (size_t i = 0; i < plane->count; i++) {
        char text[16];
        orl_scale_text(page->map->values[plane->sensors[i]], text);
        widest = fmax(widest, orl_canvas_text_width(text, LETTERS));
    }
    return plane->cell[0] * page->pixels > widest + 6 &&
           plane->cell[1] * page->pixels > 2 * LETTERS;
}

static void draw_number(struct page *page, size_t index, const unsigned char under[3],
                        const unsigned char over[3])
{
    const struct orl_sensor_plane *plane = page->map->plane;
    char text[16];
    double x, y;
    orl_scale_text(page->map->values[plane->sensors[index]], text);
    place_on_page(page, plane->at[index], &x, &y);
    const double half = orl_canvas_text_width(text, LETTERS) / 2 + 2, up = LETTERS / 2.0 + 3;
    const struct orl_quad ground = orl_quad_of(x - half, y - up, x + half, y + up);
    orl_canvas_fill(page->canvas, 4, ground.x, ground.y, under);
    write_text(page, x, y + LETTERS / 2.0, ORL_CANVAS_MIDDLE, over, text);
}

static void draw_cells(struct page *page)
{
    const struct orl_sensor_plane *plane = page->map->plane;
    const bool numbers = has_room(page);
    for (size_t i = 0; i < plane->count; i++) {
        const double value = page->map->values[plane->sensors[i]];
        const struct orl_quad quad = cell_of(page, i);
        unsigned char rgb[3];
        if (!isfinite(value))
            continue;
        orl_palette_color(page->scale.palette, orl_scale_share(&page->scale, value), rgb);
        orl_canvas_fill(page->canvas, 4, quad.x, quad.y, rgb);
        const unsigned char *over = is_dark(rgb) ? paper : ink;
        if (is_open(page, plane->sensors[i]))
            orl_quad_hatch(page->canvas, &quad, 7, over);
        if (numbers)
            draw_number(page, i, rgb, over);
    }
}

/* ---- The plan -------------------------------------------------------------------------------- */

static void draw_piece(void *ctx, const double from[2], const double to[2])
{
    const struct page *page = ctx;
    double part[2], x[2], y[2];
    if (!clip_segment(page, from, to, part))
        return;
    for (int i = 0; i < 2; i++) {
        const double at[2] = {from[0] + part[i] * (to[0] - from[0]),
                              from[1] + part[i] * (to[1] - from[1])};
        place_on_page(page, at, &x[i], &y[i]);
    }
    orl_canvas_line(page->canvas, x[0], y[0], x[1], y[1], 1.6, ink);
}

/* ---- Texts and legend ------------------------------------------------------------------------ */

static void draw_head(struct page *page)
{
    const struct orl_heat_map_request *how = page->map->how;
    const struct orl_sensor_plane *plane = page->map->plane;
    const char *unit = how->length_unit[0] ? how->length_unit : "m";
    char text[160], thresholds[96] = "";
    size_t open = 0;
    for (size_t i = 0; i < plane->count; i++)
        open += is_open(page, plane->sensors[i]);
    if (fabs(plane->normal.z) > 0.9999)
        snprintf(text, sizeof text, "%s, %s: %zu sensors at z = %.4g %s, facing %s",
                 page->map->quantity, page->scale.unit, plane->count,
                 plane->offset * plane->normal.z, unit, plane->normal.z > 0 ? "up" : "down");
    else
        snprintf(text, sizeof text, "%s, %s: %zu sensors facing (%.3g, %.3g, %.3g)",
                 page->map->quantity, page->scale.unit, plane->count, plane->normal.x,
                 plane->normal.y, plane->normal.z);
    write_text(page, page->x + MARGIN, page->y + 18, ORL_CANVAS_LEFT, ink, text);
    for (uint32_t i = 0; i < how->n_thresholds; i++) {
        const size_t length = strlen(thresholds);
        snprintf(thresholds + length, sizeof thresholds - length, "%s%g", i ? " or " : "",
                 how->thresholds_lx[i]);
    }
    if (open == 0)
        return;
    snprintf(text, sizeof text, "%zu hatched: %s %s lies within the 95 %% interval", open,
             thresholds, page->map->unit);
    write_text(page, page->x + MARGIN, page->y + 34, ORL_CANVAS_LEFT, ink, text);
}

/* Draws a scale bar of 1, 2 or 5 times a power of ten, some hundred page units long. */
static void draw_length(struct page *page, double right, double y)
{
    const char *unit = page->map->how->length_unit[0] ? page->map->how->length_unit : "m";
    const double about = 110 / page->pixels, power = pow(10, floor(log10(about)));
    const double length = power * (about / power >= 5 ? 5 : about / power >= 2 ? 2 : 1);
    const double left = right - length * page->pixels;
    char text[32];
    snprintf(text, sizeof text, "%g %.12s", length, unit);
    orl_canvas_line(page->canvas, left, y, right, y, 1.6, ink);
    orl_canvas_line(page->canvas, left, y - 4, left, y + 4, 1.6, ink);
    orl_canvas_line(page->canvas, right, y - 4, right, y + 4, 1.6, ink);
    write_text(page, (left + right) / 2, y + 16, ORL_CANVAS_MIDDLE, ink, text);
}

static void draw_legend(struct page *page)
{
    enum { STEPS = 100 };
    const double top = page->bottom + 12, left = page->x + MARGIN + 4;
    const double width = fmin(page->width - 2.0 * MARGIN - 150, 400);
    struct orl_legend legend = {.n_ticks = 0};
    double free_from = 0;
    for (int i = 0; i < STEPS; i++) {
        const struct orl_quad part = orl_quad_of(left + width * i / STEPS, top,
                                                 left + width * (i + 1) / STEPS + 0.3, top + 12);
        unsigned char rgb[3];
        orl_palette_color(page->scale.palette, (i + 0.5) / STEPS, rgb);
        orl_canvas_fill(page->canvas, 4, part.x, part.y, rgb);
    }
    orl_scale_legend(&page->scale, &legend);
    for (size_t i = 0; i < legend.n_ticks; i++) {
        const double x = left + width * legend.ticks[i].at;
        const double half = orl_canvas_text_width(legend.ticks[i].text, LETTERS) / 2;
        orl_canvas_line(page->canvas, x, top + 12, x, top + 15, 1, ink);
        if (x - half < free_from)
            continue;
        write_text(page, x, top + 27, ORL_CANVAS_MIDDLE, ink, legend.ticks[i].text);
        free_from = x + half + 5;
    }
    draw_length(page, page->x + page->width - MARGIN - 12.0, top + 6);
}

static void draw_map(struct page *page)
{
    draw_cells(page);
    orl_section_cut(page->map->geometry, page->map->plane, draw_piece, page);
    draw_head(page);
    draw_legend(page);
}

void orl_heat_map_size(const struct orl_heat_map *map, double side, double *ret_width,
                       double *ret_height)
{
    struct page page = {.map = map};
    lay_out(&page, side);
    *ret_width = page.width;
    *ret_height = page.height;
}

int orl_heat_map_draw(const struct orl_heat_map *map, struct orl_canvas *canvas, double x, double y,
                      double side)
{
    struct page page = {.map = map, .canvas = canvas, .x = x, .y = y};
    lay_out(&page, side);
    const int code = make_scale(&page);
    if (code == 0)
        draw_map(&page);
    return code;
}

int orl_heat_map_write(const struct orl_heat_map *map, enum orl_canvas_kind kind, const char *path,
                       struct orl_error *err)
{
    struct orl_canvas *canvas;
    double width, height;
    orl_heat_map_size(map, SIDE, &width, &height);
    int code = orl_canvas_open(kind, path, width, height, 1, &canvas, err);
    if (code < 0)
        return code;
    code = orl_heat_map_draw(map, canvas, 0, 0, SIDE);
    if (code < 0)
        orl_error_set(err, code, "out of memory drawing a heat map");
    return orl_canvas_close(canvas, code, err);
}
