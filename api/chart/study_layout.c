#include "chart/study_layout.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <oriel/base/canvas.h>

static const double left_edge = 86, top_edge = 46, bottom_edge = 58, legend_width = 208,
                    legend_gap = 22, row_height = 21;

static void widen_range(double *low, double *high, double value)
{
    if (isfinite(value) && value > 0) {
        *low = fmin(*low, value);
        *high = fmax(*high, value);
    }
}

static void make_axes(struct orl_chart *chart, const struct orl_study *study)
{
    double x0 = INFINITY, x1 = 0, y0 = INFINITY, y1 = 0;
    for (size_t i = 0; i < study->n_points; i++) {
        const struct orl_study_point *p = &study->points[i];
        if (!orl_chart_shows(p))
            continue;
        widen_range(&x0, &x1, p->total_s);
        widen_range(&y0, &y1, 100 * p->rms);
        widen_range(&y0, &y1, 100 * (p->rms + p->rms_error));
        /* An error bar that reaches zero has no end on a logarithmic axis. */
        widen_range(&y0, &y1, 100 * fmax(p->rms - p->rms_error, p->rms / 2));
    }
    for (size_t i = 0; i < study->n_external; i++) {
        widen_range(&x0, &x1, study->external[i].here_s);
        widen_range(&y0, &y1, 100 * study->external[i].rms);
    }
    if (!(x1 > 0))
        x0 = x1 = 1;
    if (!(y1 > 0))
        y0 = y1 = 1;
    chart->plot = (struct orl_chart_box){
        left_edge, top_edge, chart->width - legend_width - legend_gap, chart->height - bottom_edge};
    orl_axis_init(&chart->x, x0, x1, chart->plot.x0, chart->plot.x1, 46);
    orl_axis_init(&chart->y, y0, y1, chart->plot.y1, chart->plot.y0, 22);
}

static void add_ticks(struct orl_chart *chart)
{
    char text[32];
    for (size_t i = 0; i < chart->x.n_ticks; i++) {
        orl_axis_format(chart->x.ticks[i], text, sizeof text);
        orl_chart_add(chart, ORL_CHART_TICK, text, orl_axis_at(&chart->x, chart->x.ticks[i]),
                      chart->plot.y1 + 15, ORL_CANVAS_MIDDLE);
    }
    for (size_t i = 0; i < chart->y.n_ticks; i++) {
        orl_axis_format(chart->y.ticks[i], text, sizeof text);
        orl_chart_add(chart, ORL_CHART_TICK, text, chart->plot.x0 - 8,
                      orl_axis_at(&chart->y, chart->y.ticks[i]), ORL_CANVAS_RIGHT);
    }
}

/* Cuts whole UTF-8 characters off the last text until its width is at most width. */
static void fit_width(struct orl_chart *chart, double width)
{
    struct orl_chart_text *t = &chart->texts[chart->n_texts - 1];
    size_t length = strlen(t->text);
    while (t->box.x1 - t->box.x0 > width && length > 0) {
        do
            length--;
        while (length > 0 && ((unsigned char)t->text[length] & 0xC0) == 0x80);
        snprintf(t->text + length, sizeof t->text - length, "...");
        t->box.x1 = t->box.x0 + orl_canvas_text_width(t->text, orl_chart_cap_height(t->role));
    }
}

static void add_titles(struct orl_chart *chart, const struct orl_study *study, const char *title)
{
    const struct orl_chart_box *plot = &chart->plot;
    char text[96];
    if (study->threads == 1)
        snprintf(text, sizeof text, "time, seconds (one thread)");
    else
        snprintf(text, sizeof text, "time, seconds (%u threads)", study->threads);
    orl_chart_add(chart, ORL_CHART_AXIS, text, (plot->x0 + plot->x1) / 2, plot->y1 + 40,
                  ORL_CANVAS_MIDDLE);
    struct orl_chart_text *t =
        orl_chart_add(chart, ORL_CHART_AXIS,
                      study->of_views ? "rms error of pixels, %" : "rms error of sensors, %", 0, 0,
                      ORL_CANVAS_MIDDLE);
    /* Rotated counter-clockwise about its middle. */
    const struct orl_chart_box b = t->box;
    const double x = 20, y = (plot->y0 + plot->y1) / 2;
    t->upright = true;
    t->box = (struct orl_chart_box){x + b.y0, y - b.x1, x + b.y1, y - b.x0};
    t->x = x + t->y;
    t->y = y - b.x0;
    if (!title || !title[0])
        return;
    orl_chart_add(chart, ORL_CHART_TITLE, title, plot->x0, 24, ORL_CANVAS_LEFT);
    fit_width(chart, chart->width - plot->x0 - 12);
}

static void add_row(struct orl_chart *chart, enum orl_chart_key key, enum orl_technique technique,
                    const char *text)
{
    const double x = chart->plot.x1 + legend_gap;
    const double y = chart->plot.y0 + 10 + row_height * (double)chart->n_rows;
    const double indent = key == ORL_CHART_KEY_NOTE ? 0 : ORL_CHART_KEY_WIDTH + 8;
    chart->rows[chart->n_rows++] = (struct orl_chart_row){key, technique, x, y};
    orl_chart_add(chart, ORL_CHART_LEGEND, text, x + indent, y, ORL_CANVAS_LEFT);
    fit_width(chart, chart->width - x - indent - 6);
}

/* Returns true if a given point's time was measured on another machine. */
static bool any_scaled(const struct orl_study *study)
{
    bool any = false;
    for (size_t i = 0; i < study->n_external; i++)
        any = any || study->external[i].rays_per_s > 0;
    return any;
}

static void add_techniques(struct orl_chart *chart, const struct orl_study *study)
{
    bool seen[ORL_TECHNIQUE_COUNT] = {false};
    for (size_t i = 0; i < study->n_points; i++) {
        const enum orl_technique technique = study->points[i].setting.technique;
        if (!seen[technique] && orl_chart_shows(&study->points[i])) {
            add_row(chart, ORL_CHART_KEY_TECHNIQUE, technique, orl_technique_name(technique));
            seen[technique] = true;
        }
    }
}

static void add_legend(struct orl_chart *chart, const struct orl_study *study)
{
    const enum orl_technique none = ORL_TECHNIQUE_AUTO;
    const double noise = 100 * study->reference.standard_error;
    const uint32_t seeds = study->n_points > 0 ? study->points[0].seeds : 0;
    char text[96];
    add_techniques(chart, study);
    add_row(chart, ORL_CHART_KEY_FRONT, none, "best at its time");
    if (noise > chart->y.low && noise < chart->y.high)
        add_row(chart, ORL_CHART_KEY_REFERENCE, none, "reference's own error");
    if (study->n_external > 0)
        add_row(chart, ORL_CHART_KEY_GIVEN, none,
                any_scaled(study) ? "other programs, scaled times" : "other programs");
    chart->rows[chart->n_rows++].key = ORL_CHART_KEY_NOTE; /* an empty row */
    add_row(chart, ORL_CHART_KEY_NOTE, none, "hollow: same technique does better");
    snprintf(text, sizeof text, "bars: standard error, %u seed%s", seeds, seeds == 1 ? "" : "s");
    add_row(chart, ORL_CHART_KEY_NOTE, none, text);
    add_row(chart, ORL_CHART_KEY_NOTE, none, "numbers: photons, samples");
}

/* Returns the largest number of texts: ticks, titles, legend rows, and a label for every point. */
static size_t most_texts(const struct orl_study *study)
{
    return 2 * (size_t)ORL_AXIS_TICKS + 3 + ORL_CHART_ROWS + study->n_points + study->n_external;
}

int orl_chart_make(const struct orl_study *study, const char *title, struct orl_chart *ret_chart,
                   struct orl_error *err)
{
    struct orl_chart chart = {.width = ORL_CHART_WIDTH, .height = ORL_CHART_HEIGHT};
    chart.texts = calloc(most_texts(study), sizeof *chart.texts);
    if (!chart.texts)
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory for a chart");
    make_axes(&chart, study);
    add_ticks(&chart);
    add_titles(&chart, study, title);
    add_legend(&chart, study);
    const int code = orl_chart_place_labels(&chart, study, err);
    if (code < 0)
        orl_chart_done(&chart);
    else
        *ret_chart = chart;
    return code;
}

void orl_chart_done(struct orl_chart *chart)
{
    free(chart->texts);
    chart->texts = NULL;
    chart->n_texts = 0;
}
