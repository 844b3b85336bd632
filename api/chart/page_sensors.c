/* Draws a table of a grid's sensors. */
#include "chart/page_text.h"

#include <math.h>
#include <stdio.h>

enum { COLUMNS = 3, MOST_ROWS = 12, COLUMN_WIDTH = 190 };

static const enum orl_metric_kind kinds[COLUMNS] = {ORL_METRIC_DA, ORL_METRIC_DIRECT_HOURS,
                                                    ORL_METRIC_MEAN};

static const struct orl_annual_metric *find_metric(const struct orl_annual_report *report,
                                                   enum orl_metric_kind kind)
{
    for (size_t i = 0; i < report->n_metrics; i++)
        if (report->metrics[i].kind == kind)
            return &report->metrics[i];
    return NULL;
}

static double right_of(int column)
{
    return ORL_PAGE_WIDTH - ORL_PAGE_MARGIN - (COLUMNS - 1 - column) * (double)COLUMN_WIDTH;
}

static double put_titles(const struct orl_page_canvas *s, double y)
{
    orl_page_draw_text(s, ORL_PAGE_MARGIN, y, ORL_CANVAS_LEFT, ORL_PAGE_TEXT, orl_page_gray,
                       "Position and direction");
    for (int c = 0; c < COLUMNS; c++) {
        const struct orl_annual_metric *metric = find_metric(s->page->report, kinds[c]);
        char title[96];
        if (!metric)
            continue;
        orl_annual_metric_title(metric, title, sizeof title);
        orl_page_draw_text(s, right_of(c), y, ORL_CANVAS_RIGHT, ORL_PAGE_TEXT, orl_page_gray,
                           title);
    }
    return y + ORL_PAGE_LINE;
}

static double put_sensor(const struct orl_page_canvas *s, size_t i, double y)
{
    const struct orl_annual_report *report = s->page->report;
    const struct orl_sensor *sensor = &s->page->request->sensors[i];
    const struct orl_vec3 p = sensor->position, d = sensor->direction;
    char text[160];
    snprintf(text, sizeof text, "(%.6g, %.6g, %.6g), (%.3g, %.3g, %.3g)", p.x, p.y, p.z, d.x, d.y,
             d.z);
    orl_page_draw_text_within(s, ORL_PAGE_MARGIN, y,
                              right_of(0) - COLUMN_WIDTH - ORL_PAGE_MARGIN + 40, orl_page_ink,
                              text);
    for (int c = 0; c < COLUMNS; c++) {
        const struct orl_annual_metric *metric = find_metric(report, kinds[c]);
        if (!metric)
            continue;
        const size_t row = (size_t)(metric - report->metrics);
        orl_page_value_text(&report->values[row * report->n_sensors + i],
                            orl_annual_unit(metric->kind), text, sizeof text);
        orl_page_draw_text(s, right_of(c), y, ORL_CANVAS_RIGHT, ORL_PAGE_TEXT, orl_page_ink, text);
    }
    return y + ORL_PAGE_LINE;
}

double orl_page_draw_sensors(const struct orl_page_canvas *s, double y, double bottom)
{
    const struct orl_annual_grid *grid = &s->page->report->grids[s->page->grid];
    size_t n = 0;
    y = orl_page_draw_heading(s, ORL_PAGE_MARGIN, y, ORL_PAGE_WIDTH - ORL_PAGE_MARGIN,
                              "Sensors, with 95 % intervals");
    y = put_titles(s, y);
    while (n < grid->count && n < MOST_ROWS && y + 2 * ORL_PAGE_LINE < bottom)
        y = put_sensor(s, grid->first + n++, y);
    if (n < grid->count) {
        char text[64];
        snprintf(text, sizeof text, "and %zu more, in sensors.csv", grid->count - n);
        orl_page_draw_text(s, ORL_PAGE_MARGIN, y, ORL_CANVAS_LEFT, ORL_PAGE_TEXT, orl_page_gray,
                           text);
        y += ORL_PAGE_LINE;
    }
    return y;
}
