#include "chart/annual_page.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <oriel/version.h>

#include "annual_shades.h"
#include "chart/temporal_map.h"

/* Page units; PNG has twice as many pixels, and PDF is A4. */
static const double width = 960, height = 1358, rim = 40;
static const double png_scale = 2, pdf_scale = 210 / 25.4 * 72 / 960;
static const double title_size = 16, head_size = 10, text_size = 8, line_height = 17;
static const double map_side = 400, year_height = 250, least_map_side = 120;

static const unsigned char ink[3] = {26, 26, 26}, gray[3] = {105, 105, 105},
                           faint[3] = {205, 205, 205};

struct sheet {
    const struct orl_annual_page *page;
    struct orl_canvas *canvas;
};

/* ---- Texts ----------------------------------------------------------------------------------- */

static void put(const struct sheet *s, double x, double y, enum orl_canvas_align align, double size,
                const unsigned char rgb[3], const char *text)
{
    struct orl_canvas_letters letters = {.size = size, .align = align, .bold = size > text_size};
    memcpy(letters.rgb, rgb, 3);
    orl_canvas_text(s->canvas, x, y, &letters, text);
}

/* At most so wide: cut short, with dots. */
static void put_within(const struct sheet *s, double x, double y, double most,
                       const unsigned char rgb[3], const char *text)
{
    char cut[256];
    size_t length = strlen(text);
    if (length >= sizeof cut)
        length = sizeof cut - 1;
    memcpy(cut, text, length);
    cut[length] = '\0';
    while (length > 3 && orl_canvas_text_width(cut, text_size) > most) {
        length--;
        snprintf(cut + length - 2, 3, "..");
    }
    put(s, x, y, ORL_CANVAS_LEFT, text_size, rgb, cut);
}

static void put_number(double value, const char *unit, char *ret_text, size_t size)
{
    const bool percent = unit[0] == '%', counts = unit[0] == 'h';
    snprintf(ret_text, size, percent ? "%.1f" : counts || value >= 100 ? "%.0f" : "%.3g", value);
}

/* "55.1 % (52 to 57)". */
static void put_value(const struct orl_annual_value *value, const char *unit, char *ret_text,
                      size_t size)
{
    char middle[32], low[32], high[32];
    const bool sum = strcmp(unit, "lx h") == 0; /* large: in thousands */
    const double scale = sum ? 1e-3 : 1;
    put_number(scale * value->value, unit, middle, sizeof middle);
    put_number(scale * value->low, unit, low, sizeof low);
    put_number(scale * value->high, unit, high, sizeof high);
    unit = sum ? "klx h" : unit;
    if (isnan(value->low))
        snprintf(ret_text, size, "%s %s", middle, unit);
    else
        snprintf(ret_text, size, "%s %s (%s to %s)", middle, unit, low, high);
}

static double put_heading(const struct sheet *s, double x, double y, double right, const char *text)
{
    put(s, x, y, ORL_CANVAS_LEFT, head_size, ink, text);
    orl_canvas_line(s->canvas, x, y + 6, right, y + 6, 0.8, faint);
    return y + 6 + line_height;
}

/* ---- Figures --------------------------------------------------------------------------------- */

static void name_figure(const struct orl_annual_figure *figure, char *ret_text, size_t size)
{
    const double low = figure->metric.low_lx;
    if (figure->over == ORL_OVER_SHARE && figure->metric.kind == ORL_METRIC_DA)
        snprintf(ret_text, size, "sDA%g/%g: area with %g lx in %g %% of the time", low,
                 figure->least, low, figure->least);
    else if (figure->over == ORL_OVER_SHARE)
        snprintf(ret_text, size, "ASE%g,%g: area with direct sun for %g h", low, figure->least,
                 figure->least);
    else
        orl_annual_metric_title(&figure->metric, ret_text, size);
}

static const char *figure_unit(const struct orl_annual_figure *figure)
{
    return figure->over == ORL_OVER_SHARE ? "%" : orl_annual_unit(figure->metric.kind);
}

/* Returns where it ends. */
static double draw_figures(const struct sheet *s, double x, double y, double right)
{
    const struct orl_annual_report *report = s->page->report;
    const size_t places = report->n_grids + 1;
    y = put_heading(s, x, y, right, "Figures, and averages over the area, with 95 % intervals");
    for (size_t f = 0; f < report->n_figures; f++) {
        char name[96], value[120];
        name_figure(&report->figures[f], name, sizeof name);
        put_value(&report->areas[f * places + s->page->grid].value,
                  figure_unit(&report->figures[f]), value, sizeof value);
        put(s, right, y, ORL_CANVAS_RIGHT, text_size, ink, value);
        put_within(s, x, y, right - x - orl_canvas_text_width(value, text_size) - 8, ink, name);
        y += line_height;
    }
    return y;
}

/* ---- Verdicts -------------------------------------------------------------------------------- */

static void draw_mark(const struct sheet *s, double x, double y, enum orl_verdict verdict)
{
    static const unsigned char colors[4][3] = {
        {200, 60, 50}, {225, 160, 30}, {45, 140, 80}, {150, 150, 150}};
    orl_canvas_disc(s->canvas, x, y - text_size / 2, 5, colors[verdict]);
}

/* Lines of a rule hang together: its name stands above them. */
static bool begins_rule(const struct orl_annual_report *report, size_t i, size_t last)
{
    const struct orl_annual_verdict *v = report->verdicts;
    return v[i].rule &&
           (last == SIZE_MAX || v[last].rule != v[i].rule || v[last].grid != v[i].grid);
}

/* Its name, and what all of its targets make together. */
static double draw_rule(const struct sheet *s, size_t i, double x, double y, double right)
{
    const struct orl_annual_report *report = s->page->report;
    const struct orl_annual_verdict *v = report->verdicts;
    enum orl_verdict all = ORL_VERDICT_PASS;
    char text[128];
    for (size_t k = i; k < report->n_verdicts; k++)
        if (v[k].rule == v[i].rule && v[k].grid == v[i].grid)
            all = orl_verdict_both(all, v[k].verdict);
    snprintf(text, sizeof text, "%s: %s", v[i].rule->name, orl_verdict_name(all));
    put_within(s, x, y, right - x, ink, text);
    return y + line_height;
}

static double draw_verdict(const struct sheet *s, const struct orl_annual_verdict *v, double x,
                           double y, double right)
{
    char value[120], text[224];
    const char *where = v->grid == ORL_ALL_GRIDS ? " (all grids)" : "";
    const double indent = v->rule ? 12 : 0;
    put_value(&v->area.value, figure_unit(&v->target.figure), value, sizeof value);
    draw_mark(s, x + 5 + indent, y, v->verdict);
    snprintf(text, sizeof text, "%s%s", v->target.text, where);
    const double from = x + 16 + indent;
    snprintf(text + strlen(text), sizeof text - strlen(text), ": %s", orl_verdict_name(v->verdict));
    put(s, right, y, ORL_CANVAS_RIGHT, text_size, ink, value);
    put_within(s, from, y, right - from - orl_canvas_text_width(value, text_size) - 8, ink, text);
    if (!v->note[0])
        return y + line_height;
    put_within(s, from, y + line_height, right - from, gray, v->note);
    return y + 2 * line_height;
}

/* Where the next one goes, and which was the last that was drawn. */
struct column {
    double x, y, right, bottom;
    size_t last, left_out;
};

/* Those of one grid, or of all together, one behind the other. */
static void draw_verdicts_of(const struct sheet *s, size_t grid, struct column *column)
{
    const struct orl_annual_report *report = s->page->report;
    for (size_t i = 0; i < report->n_verdicts; i++) {
        if (report->verdicts[i].grid != grid)
            continue;
        const int lines = report->verdicts[i].note[0] ? 3 : 2;
        if (column->y + lines * line_height > column->bottom) {
            column->left_out++;
            continue;
        }
        if (begins_rule(report, i, column->last))
            column->y = draw_rule(s, i, column->x, column->y, column->right);
        column->y = draw_verdict(s, &report->verdicts[i], column->x, column->y, column->right);
        column->last = i;
    }
}

static double draw_verdicts(const struct sheet *s, double x, double y, double right, double bottom)
{
    struct column column = {x, put_heading(s, x, y, right, "Targets"), right, bottom, SIZE_MAX, 0};
    if (s->page->report->n_verdicts == 0)
        put(s, x, column.y, ORL_CANVAS_LEFT, text_size, gray, "none were named");
    draw_verdicts_of(s, s->page->grid, &column);
    draw_verdicts_of(s, ORL_ALL_GRIDS, &column);
    if (column.left_out > 0) {
        char text[64];
        snprintf(text, sizeof text, "and %zu more, in result.json", column.left_out);
        put(s, x, column.y, ORL_CANVAS_LEFT, text_size, gray, text);
        column.y += line_height;
    }
    return column.y;
}

/* ---- Maps ------------------------------------------------------------------------------------ */

static size_t find_metric(const struct orl_annual_report *report, enum orl_metric_kind kind)
{
    size_t i = 0;
    while (i < report->n_metrics && report->metrics[i].kind != kind)
        i++;
    return i;
}

/* Daylight autonomy beside hours of direct sun, or what of them there is. */
static int draw_maps(const struct sheet *s, double y, double room)
{
    static const enum orl_metric_kind kinds[2] = {ORL_METRIC_DA, ORL_METRIC_DIRECT_HOURS};
    const struct orl_annual_page *page = s->page;
    double x = rim, side = map_side, wide = 0, high = 0;
    int code = 0;
    if (!orl_annual_plan_size(page->plans, page->grid, side, &wide, &high))
        return 0;
    side = fmin(side, side - (high - room));
    if (side < least_map_side)
        return 0;
    for (int i = 0; i < 2 && code == 0; i++) {
        const size_t metric = find_metric(page->report, kinds[i]);
        if (metric == page->report->n_metrics)
            continue;
        orl_annual_plan_size(page->plans, page->grid, side, &wide, &high);
        code = orl_annual_plan_draw(page->plans, page->report, page->grid, metric, s->canvas,
                                    x - 14, y, side);
        x = width / 2 + 7;
    }
    return code;
}

static int draw_year(const struct sheet *s, double y)
{
    const struct orl_annual_page *page = s->page;
    const struct orl_annual_report *report = page->report;
    float *values = malloc(report->year.steps.count * sizeof *values);
    if (!values)
        return ORL_ERR_NOMEM;
    int code = orl_annual_series_of(report, page->result, page->grid, ORL_SERIES_MEAN, 0,
                                    page->cancel, values);
    const struct orl_temporal_map map = {.title = "Mean illuminance over the year, lx",
                                         .unit = "lx",
                                         .logarithmic = true,
                                         .steps = report->year.steps,
                                         .values = values,
                                         .marks = report->marks};
    if (code == 0)
        code =
            orl_temporal_map_draw(&map, s->canvas, rim - 10, y, width - 2 * rim + 20, year_height);
    free(values);
    return code;
}

/* ---- What was assumed ------------------------------------------------------------------------ */

static double put_line(const struct sheet *s, double y, const char *format, ...)
    __attribute__((format(printf, 3, 4)));
static double put_line(const struct sheet *s, double y, const char *format, ...)
{
    char text[256];
    va_list args;
    va_start(args, format);
    vsnprintf(text, sizeof text, format, args);
    va_end(args);
    put_within(s, rim, y, width - 2 * rim, gray, text);
    return y + 14;
}

enum { GROUPS_SHOWN = 3 };

/* "  south: open 2900 h, closed 750 h". */
static double put_group(const struct sheet *s, double y, const struct orl_window_group *group,
                        const struct orl_state_hours *hours)
{
    char text[200];
    size_t used = (size_t)snprintf(text, sizeof text, "   %.60s:", group->name);
    for (size_t i = 0; i < group->n_states && used < sizeof text; i++)
        used += (size_t)snprintf(text + used, sizeof text - used, "%s %.60s %.0f h",
                                 i > 0 ? "," : "", group->states[i].name, hours[i].occupied);
    return put_line(s, y, "%s", text);
}

/* How many lines they take beyond one. */
static size_t count_groups(const struct orl_annual_page *page)
{
    const size_t n = page->result->states ? page->request->n_groups : 0;
    return n > GROUPS_SHOWN ? GROUPS_SHOWN + 1 : n;
}

/* A line each of the first groups, and how many there are beyond. */
static double put_shades(const struct sheet *s, double y)
{
    const struct orl_annual_page *page = s->page;
    const size_t n = page->request->n_groups;
    if (!page->result->states)
        return put_line(s, y,
                        "No blinds or shades move: all is as in the scene. LM-83 asks for blinds "
                        "that close on more than 2 %% of the points in direct sun.");
    y = put_line(s, y, "Shades, in hours in use with light (ASE is of open ones):");
    for (size_t g = 0; g < n && g < GROUPS_SHOWN; g++) {
        struct orl_state_hours hours[ORL_SHADES_MOST_STATES];
        orl_annual_state_hours(page->result, page->report, g, hours);
        y = put_group(s, y, &page->request->groups[g], hours);
    }
    return n > GROUPS_SHOWN ? put_line(s, y, "   and %zu groups more", n - GROUPS_SHOWN) : y;
}

/* Plans have the model's +Y up. */
static double put_north(const struct sheet *s, double y)
{
    const double north_deg = s->page->request->north_deg;
    if (north_deg == 0)
        return put_line(s, y, "True north is +Y of the model, which is up in plans.");
    return put_line(s, y, "True north is %g degrees %s of +Y of the model, which is up in plans.",
                    fabs(north_deg), north_deg > 0 ? "counter-clockwise" : "clockwise");
}

static void draw_assumptions(const struct sheet *s, double y)
{
    const struct orl_annual_page *page = s->page;
    const struct orl_occupancy *use = &page->wishes->occupancy;
    const struct orl_annual_report *report = page->report;
    char year[24] = "";
    if (page->request->weather_year > 0)
        snprintf(year, sizeof year, ", rows of %d", page->request->weather_year);
    y = put_heading(s, rim, y, width - rim, "Assumed");
    if (page->wishes->occupancy_file)
        y = put_line(s, y, "Occupied as in %s: %.5g h.", page->wishes->occupancy_file,
                     report->periods[ORL_WHEN_OCCUPIED].hours);
    else
        y = put_line(s, y, "Occupied from %g to %g h, local standard time, %s: %.5g h.",
                     use->from_h, use->to_h,
                     (use->days & 0x7f) == 0x7f ? "every day" : "on some days of the week",
                     report->periods[ORL_WHEN_OCCUPIED].hours);
    y = put_north(s, y);
    y = put_line(
        s, y,
        "Weather: %s%s (%.2f %c, %.2f %c); each hour's sun stands where it is at the middle "
        "of it. Ground outside reflects %g %%.",
        page->request->weather_file, year, fabs(page->result->latitude_deg),
        page->result->latitude_deg < 0 ? 'S' : 'N', fabs(page->result->longitude_deg),
        page->result->longitude_deg < 0 ? 'W' : 'E', 100 * page->request->ground_reflectance);
    if (report->year.n_missing > 0)
        y = put_line(s, y,
                     "%zu hours are not in the file, or were not measured: they count "
                     "nowhere.",
                     report->year.n_missing);
    if (report->year.n_doubtful > 0)
        y = put_line(s, y,
                     "%zu hours have the sun up by 3 degrees or more, and no light in the weather "
                     "file: they count as dark.",
                     report->year.n_doubtful);
    if (report->n_unlit > 0)
        y = put_line(s, y,
                     "No light ever reaches %zu of all sensors: are they inside of something?",
                     report->n_unlit);
    y = put_shades(s, y);
    y = put_line(s, y,
                 "Daylight hours (EN 17037): the half of the year with the most global "
                 "horizontal daylight. Sensors stand for equal areas of a grid.");
    y = put_line(s, y,
                 "Intervals hold what the simulation itself leaves open, not what weather, "
                 "materials or geometry may do otherwise.");
    put_line(s, y, "%u paths a sensor, seed %llu, Oriel %s.", page->result->samples,
             (unsigned long long)page->result->seed, ORL_VERSION);
}

/* ---- The page -------------------------------------------------------------------------------- */

static double draw_head(const struct sheet *s)
{
    const struct orl_annual_page *page = s->page;
    const struct orl_annual_grid *grid = &page->report->grids[page->grid];
    char text[160];
    put(s, rim, rim + title_size, ORL_CANVAS_LEFT, title_size, ink,
        page->title ? page->title : grid->name);
    snprintf(text, sizeof text, "%s%sA year of daylight at %zu sensors",
             page->title ? grid->name : "", page->title ? ": " : "", grid->count);
    put_within(s, rim, rim + title_size + 20, width - 2 * rim, gray, text);
    return rim + title_size + 52;
}

static int draw(const struct sheet *s)
{
    const double assumptions = height - rim - (10 + (double)count_groups(s->page)) * 14 - 24;
    const double top = draw_head(s);
    const double year = assumptions - 24 - year_height, middle = width / 2;
    const double figures = draw_figures(s, rim, top, middle - 20);
    const double verdicts =
        draw_verdicts(s, middle + 10, top, width - rim, year - least_map_side - 140);
    const double maps = fmax(figures, verdicts) + 6;
    int code = draw_maps(s, maps, year - maps - 10);
    if (code == 0)
        code = draw_year(s, year);
    draw_assumptions(s, assumptions);
    return code;
}

int orl_annual_page_write(const struct orl_annual_page *page, enum orl_canvas_kind kind,
                          const char *path, struct orl_error *err)
{
    struct sheet s = {.page = page};
    int code = orl_canvas_open(kind, path, width, height,
                               kind == ORL_CANVAS_PDF ? pdf_scale : png_scale, &s.canvas, err);
    if (code < 0)
        return code;
    code = draw(&s);
    if (code < 0)
        orl_error_set(err, code, "%s drawing a page",
                      code == ORL_ERR_CANCELLED ? "cancelled" : "out of memory");
    return orl_canvas_close(s.canvas, code, err);
}
