/* Draws parts of an annual page: warnings, and a table of sensors where there is no map. Warnings
 * are above the figures, because they may invalidate figures. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "chart/page_text.h"

enum { LINES_OF_ONE = 2, LINES_OF_ALL = 8, INDENT = 16 };

static const unsigned char amber[3] = {225, 160, 30};

/* Returns true if the warning is about this grid: it begins with "grid 'NAME': ". */
static bool is_of(const char *warning, const char *grid)
{
    char begins[ORL_TARGET_GRID + 16];
    snprintf(begins, sizeof begins, "grid '%s': ", grid);
    return strncmp(warning, begins, strlen(begins)) == 0;
}

static bool is_of_another_grid(const struct orl_annual_page *page, const char *warning)
{
    for (size_t g = 0; g < page->report->n_grids; g++)
        if (g != page->grid && is_of(warning, page->report->grids[g].name))
            return true;
    return false;
}

struct warning_list {
    double y;
    size_t lines, left_out;
    bool cut; /* true if a warning was cut short */
};

static void put_warning(const struct orl_page_canvas *s, const char *text,
                        struct warning_list *warning_list)
{
    const double x = ORL_PAGE_MARGIN + INDENT, width = ORL_PAGE_WIDTH - ORL_PAGE_MARGIN - x;
    const size_t n_all = orl_page_draw_wrapped(NULL, x, warning_list->y, width, LINES_OF_ONE + 1,
                                               orl_page_ink, text);
    const size_t n = n_all > LINES_OF_ONE ? LINES_OF_ONE : n_all;
    if (warning_list->left_out > 0 || warning_list->lines + n > LINES_OF_ALL) {
        warning_list->left_out++;
        return;
    }
    warning_list->cut = warning_list->cut || n_all > n;
    orl_canvas_disc(s->canvas, ORL_PAGE_MARGIN + 5, warning_list->y - ORL_PAGE_TEXT / 2.0, 5,
                    amber);
    orl_page_draw_wrapped(s, x, warning_list->y, width, LINES_OF_ONE, orl_page_ink, text);
    warning_list->y += (double)n * ORL_PAGE_FINE_LINE + 3;
    warning_list->lines += n;
}

static void put_rest(const struct orl_page_canvas *s, struct warning_list *warning_list)
{
    char text[64] = "result.json has the full warnings";
    if (warning_list->left_out > 0)
        snprintf(text, sizeof text, "and %zu more warning%s, in result.json",
                 warning_list->left_out, warning_list->left_out > 1 ? "s" : "");
    else if (!warning_list->cut)
        return;
    orl_page_draw_text(s, ORL_PAGE_MARGIN + INDENT, warning_list->y, ORL_CANVAS_LEFT, ORL_PAGE_TEXT,
                       orl_page_gray, text);
    warning_list->y += ORL_PAGE_LINE;
}

double orl_page_draw_warnings(const struct orl_page_canvas *s, double y)
{
    const struct orl_annual_page *page = s->page;
    const struct orl_annual_result *result = page->result;
    const char *grid = page->report->grids[page->grid].name;
    struct warning_list warning_list = {.y = y + ORL_PAGE_HEADING};
    for (int own = 1; own >= 0; own--)
        for (size_t i = 0; i < result->n_warnings; i++)
            if (is_of(result->warnings[i], grid) == own &&
                (own || !is_of_another_grid(page, result->warnings[i])))
                put_warning(s, result->warnings[i], &warning_list);
    if (warning_list.lines == 0)
        return y;
    orl_page_draw_heading(s, ORL_PAGE_MARGIN, y, ORL_PAGE_WIDTH - ORL_PAGE_MARGIN, "Warnings");
    put_rest(s, &warning_list);
    return warning_list.y + 10;
}

/* ---- Sensors --------------------------------------------------------------------------------- */

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
