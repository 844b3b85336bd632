#include "chart/charts.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <oriel/base/version.h>

#include "annual_job/annual_members_json.h"
#include "chart/page_text.h"

/* All lengths in page units. */
static const double png_scale = 2, pdf_scale = 210 / 25.4 * 72 / ORL_PAGE_WIDTH;
static const double map_side = 400, least_map = 200, year_height = 250, most_year_height = 380;
static const double parts_apart = 18;

/* ---- Figures --------------------------------------------------------------------------------- */

static void name_figure(const struct orl_annual_figure *figure, char *ret_text, size_t size)
{
    const double low = figure->metric.low_lx;
    if (figure->aggregate == ORL_AGGREGATE_SHARE && figure->metric.kind == ORL_METRIC_DA)
        snprintf(ret_text, size, "sDA%g/%g: area with %g lx in %g %% of the time", low,
                 figure->least, low, figure->least);
    else if (figure->aggregate == ORL_AGGREGATE_SHARE)
        snprintf(ret_text, size, "ASE%g,%g: area with direct sun for %g h", low, figure->least,
                 figure->least);
    else
        orl_annual_metric_title(&figure->metric, ret_text, size);
}

/* Draws figures no lower than bottom. Returns the y where they end. */
static double draw_figures(const struct orl_page_canvas *s, double x, double y, double right,
                           double bottom)
{
    const struct orl_annual_report *report = s->page->report;
    const size_t places = report->n_grids + 1;
    y = orl_page_draw_heading(s, x, y, right,
                              "Figures, and averages over the area, with 95 % intervals");
    for (size_t f = 0; f < report->n_figures; f++) {
        char name[96], value[120];
        if (y + ORL_PAGE_LINE > bottom) {
            snprintf(value, sizeof value, "and %zu more, in result.json", report->n_figures - f);
            orl_page_draw_text(s, x, y, ORL_CANVAS_LEFT, ORL_PAGE_TEXT, orl_page_gray, value);
            return y + ORL_PAGE_LINE;
        }
        name_figure(&report->figures[f], name, sizeof name);
        orl_page_value_text(&report->areas[f * places + s->page->grid].value,
                            orl_page_figure_unit(&report->figures[f]), value, sizeof value);
        orl_page_draw_text(s, right, y, ORL_CANVAS_RIGHT, ORL_PAGE_TEXT, orl_page_ink, value);
        orl_page_draw_text_within(s, x, y,
                                  right - x - orl_canvas_text_width(value, ORL_PAGE_TEXT) - 8,
                                  orl_page_ink, name);
        y += ORL_PAGE_LINE;
    }
    return y;
}

/* ---- Maps ------------------------------------------------------------------------------------ */

static size_t find_metric(const struct orl_annual_report *report, enum orl_metric_kind kind)
{
    size_t i = 0;
    while (i < report->n_metrics && report->metrics[i].kind != kind)
        i++;
    return i;
}

/* Returns the largest side that keeps the map's height within room. */
static double fit_map(const struct orl_annual_page *page, double room)
{
    double wide = 0, high = 0, rest = 0;
    orl_annual_plan_size(page->plans, page->grid, 0, &wide, &rest);
    orl_annual_plan_size(page->plans, page->grid, map_side, &wide, &high);
    return fmin(map_side, map_side * (room - rest - 1) / fmax(high - rest, 1));
}

/* Draws daylight autonomy beside hours of direct sun, or the one that exists. Moves y below
 * them. */
static int draw_maps(const struct orl_page_canvas *s, double room, double *y)
{
    static const enum orl_metric_kind kinds[2] = {ORL_METRIC_DA, ORL_METRIC_DIRECT_HOURS};
    const struct orl_annual_page *page = s->page;
    const double side = fit_map(page, room);
    double x = ORL_PAGE_MARGIN, wide = 0, high = 0;
    int code = 0;
    for (int i = 0; i < 2 && code == 0; i++) {
        const size_t metric = find_metric(page->report, kinds[i]);
        if (metric == page->report->n_metrics)
            continue;
        orl_annual_plan_size(page->plans, page->grid, side, &wide, &high);
        code = orl_annual_plan_draw(page->plans, page->report, page->grid, metric, s->canvas,
                                    x - 14, *y, side);
        x = ORL_PAGE_WIDTH / 2.0 + 7;
    }
    *y += high;
    return code;
}

/* ---- The year -------------------------------------------------------------------------------- */

static int draw_year(const struct orl_page_canvas *s, double y, double high)
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
        code = orl_temporal_map_draw(&map, s->canvas, ORL_PAGE_MARGIN - 10, y,
                                     ORL_PAGE_WIDTH - 2 * ORL_PAGE_MARGIN + 20, high);
    free(values);
    return code;
}

/* ---- Assumptions ----------------------------------------------------------------------------- */

static double put_line(const struct orl_page_canvas *s, double y, const char *format, ...)
    __attribute__((format(printf, 3, 4)));
static double put_line(const struct orl_page_canvas *s, double y, const char *format, ...)
{
    char text[256];
    va_list args;
    va_start(args, format);
    vsnprintf(text, sizeof text, format, args);
    va_end(args);
    orl_page_draw_text_within(s, ORL_PAGE_MARGIN, y, ORL_PAGE_WIDTH - 2 * ORL_PAGE_MARGIN,
                              orl_page_gray, text);
    return y + ORL_PAGE_FINE_LINE;
}

enum { GROUPS_SHOWN = 3 };

/* Writes a group's hours per state: "   south: open 2900 h, closed 750 h". */
static double put_group(const struct orl_page_canvas *s, double y,
                        const struct orl_window_group *group, const struct orl_state_hours *hours)
{
    char text[200];
    size_t used = (size_t)snprintf(text, sizeof text, "   %.60s:", group->name);
    for (size_t i = 0; i < group->n_states && used < sizeof text; i++)
        used += (size_t)snprintf(text + used, sizeof text - used, "%s %.60s %.0f h",
                                 i > 0 ? "," : "", group->states[i].name, hours[i].occupied);
    return put_line(s, y, "%s", text);
}

/* Returns the height of the list of assumptions. */
static double measure_assumptions(const struct orl_annual_page *page)
{
    enum { LINES = 7 }; /* lines that every job has */
    const size_t n = page->result->states ? page->request->n_groups : 0;
    const size_t groups = n > GROUPS_SHOWN ? GROUPS_SHOWN + 1 : n;
    const size_t lines = LINES + groups + (page->report->year.n_missing > 0 ? 1 : 0);
    return ORL_PAGE_HEADING + (double)lines * ORL_PAGE_FINE_LINE;
}

/* Writes a line for each of the first GROUPS_SHOWN groups, and the number of the others. */
static double put_shades(const struct orl_page_canvas *s, double y)
{
    const struct orl_annual_page *page = s->page;
    const size_t n = page->request->n_groups;
    if (!page->result->states)
        return put_line(s, y,
                        "No movable blinds or shades. LM-83 asks for blinds that close when more "
                        "than 2 %% of the points are in direct sun.");
    y = put_line(s, y, "Shades, in occupied hours with light (ASE is for open shades):");
    for (size_t g = 0; g < n && g < GROUPS_SHOWN; g++) {
        struct orl_state_hours hours[ORL_SHADES_MOST_STATES];
        orl_annual_state_hours(page->result, page->report, g, hours);
        y = put_group(s, y, &page->request->groups[g], hours);
    }
    return n > GROUPS_SHOWN ? put_line(s, y, "   and %zu more groups", n - GROUPS_SHOWN) : y;
}

/* Writes the direction of north in plans, which have the model's +Y up. */
static double put_north(const struct orl_page_canvas *s, double y)
{
    const double north_deg = s->page->request->north_deg;
    if (north_deg == 0)
        return put_line(s, y, "True north is +Y of the model, which is up in plans.");
    return put_line(s, y, "True north is %g degrees %s of +Y of the model, which is up in plans.",
                    fabs(north_deg), north_deg > 0 ? "counter-clockwise" : "clockwise");
}

static void draw_assumptions(const struct orl_page_canvas *s, double y)
{
    const struct orl_annual_page *page = s->page;
    const struct orl_occupancy *use = &page->report_request->occupancy;
    const struct orl_annual_report *report = page->report;
    char year[24] = "";
    if (page->request->weather_year > 0)
        snprintf(year, sizeof year, ", rows of %d", page->request->weather_year);
    y = orl_page_draw_heading(s, ORL_PAGE_MARGIN, y, ORL_PAGE_WIDTH - ORL_PAGE_MARGIN, "Assumed");
    if (page->report_request->occupancy_file)
        y = put_line(s, y, "Occupied as in %s: %.5g h.", page->report_request->occupancy_file,
                     report->periods[ORL_WHEN_OCCUPIED].hours);
    else
        y = put_line(s, y, "Occupied from %g to %g h, local standard time, %s: %.5g h.",
                     use->from_h, use->to_h,
                     (use->days & 0x7f) == 0x7f ? "every day" : "on some days of the week",
                     report->periods[ORL_WHEN_OCCUPIED].hours);
    y = put_north(s, y);
    y = put_line(
        s, y,
        "Weather: %s%s (%.2f %c, %.2f %c); each hour has the sun of its middle. The "
        "ground outside reflects %g %%.",
        page->request->weather_file, year, fabs(page->result->site.latitude_deg),
        page->result->site.latitude_deg < 0 ? 'S' : 'N', fabs(page->result->site.longitude_deg),
        page->result->site.longitude_deg < 0 ? 'W' : 'E', 100 * page->request->ground_reflectance);
    if (report->year.n_missing > 0)
        y = put_line(s, y,
                     "%zu hours are not in the file, or were not measured: they are not counted.",
                     report->year.n_missing);
    y = put_shades(s, y);
    y = put_line(s, y,
                 "Daylight hours (EN 17037): the half of the year with the most global horizontal "
                 "daylight. All sensors of a grid have equal areas.");
    y = put_line(
        s, y,
        "Intervals cover the error of the simulation, not that of weather, materials or geometry.");
    put_line(s, y, "%u paths per sensor, seed %llu, Oriel %s.", page->result->samples,
             (unsigned long long)page->result->seed, ORL_VERSION);
}

/* ---- The page -------------------------------------------------------------------------------- */

static double draw_head(const struct orl_page_canvas *s)
{
    const struct orl_annual_page *page = s->page;
    const struct orl_annual_grid *grid = &page->report->grids[page->grid];
    char text[160];
    orl_page_draw_title(s, ORL_PAGE_MARGIN + ORL_PAGE_TITLE,
                        page->title ? page->title : grid->name);
    snprintf(text, sizeof text, "%s%sA year of daylight at %zu sensors",
             page->title ? grid->name : "", page->title ? ": " : "", grid->count);
    orl_page_draw_text_within(s, ORL_PAGE_MARGIN, ORL_PAGE_MARGIN + ORL_PAGE_TITLE + 20,
                              ORL_PAGE_WIDTH - 2 * ORL_PAGE_MARGIN, orl_page_gray, text);
    return ORL_PAGE_MARGIN + ORL_PAGE_TITLE + 52;
}

/* Draws figures and targets side by side, no lower than bottom. */
static double draw_columns(const struct orl_page_canvas *s, double y, double bottom)
{
    const double middle = ORL_PAGE_WIDTH / 2.0;
    struct orl_page_column left = {ORL_PAGE_MARGIN, y, middle - 10};
    struct orl_page_column right = {middle + 10, y, ORL_PAGE_WIDTH - ORL_PAGE_MARGIN};
    left.y = draw_figures(s, left.x, left.y, left.right, bottom);
    orl_page_draw_verdicts(s, &left, &right, bottom);
    return fmax(left.y, right.y);
}

/* Draws all parts from top to bottom. Each leaves the parts below it the least height they need. */
static int draw_page(const struct orl_page_canvas *s)
{
    const double assumptions = ORL_PAGE_HEIGHT - ORL_PAGE_MARGIN - measure_assumptions(s->page);
    const double year =
        assumptions - parts_apart - year_height; /* latest start of the year's temporal map */
    double y = draw_head(s), wide, high;
    int code = 0;
    y = orl_page_draw_warnings(s, y);
    y = draw_columns(s, y, year - parts_apart - least_map) + parts_apart;
    if (orl_annual_plan_size(s->page->plans, s->page->grid, map_side, &wide, &high))
        code = draw_maps(s, year - y, &y);
    else
        y = orl_page_draw_sensors(s, y, year);
    high = fmin(assumptions - parts_apart - y, most_year_height);
    if (code == 0)
        code = draw_year(s, y, high);
    draw_assumptions(s, y + high + parts_apart);
    return code;
}

int orl_annual_page_write(const struct orl_annual_page *page, enum orl_canvas_kind kind,
                          const char *path, struct orl_error *err)
{
    struct orl_page_canvas s = {.page = page};
    int code = orl_canvas_open(kind, path, ORL_PAGE_WIDTH, ORL_PAGE_HEIGHT,
                               kind == ORL_CANVAS_PDF ? pdf_scale : png_scale, &s.canvas, err);
    if (code < 0)
        return code;
    code = draw_page(&s);
    if (code < 0)
        orl_error_set(err, code, "%s drawing a page",
                      code == ORL_ERR_CANCELLED ? "cancelled" : "out of memory");
    return orl_canvas_close(s.canvas, code, err);
}
