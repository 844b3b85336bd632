#include "chart/charts.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "chart/study_layout.h"

static const double png_scale = 2;
static const unsigned char black[3] = {26, 26, 26}, gray[3] = {115, 115, 115},
                           faint[3] = {230, 230, 230}, gold[3] = {255, 219, 115},
                           dark_red[3] = {140, 26, 26}, paper[3] = {255, 255, 255};

/* State for drawing. */
struct study_drawing {
    const struct orl_chart *chart;
    const struct orl_study *study;
    struct orl_canvas *canvas;
    size_t *index; /* room for all points of the study */
    double *x, *y; /* room for their page coordinates */
};

/* Returns a colour that colour-blind people can distinguish (Okabe and Ito 2008). */
static const unsigned char *ink_of(enum orl_technique technique)
{
    static const unsigned char inks[ORL_TECHNIQUE_COUNT][3] = {
        [ORL_TECHNIQUE_BACKWARD] = {0, 114, 178},
        [ORL_TECHNIQUE_GATHER] = {213, 94, 0},
        [ORL_TECHNIQUE_DIRECT] = {0, 158, 115},
        [ORL_TECHNIQUE_PRECOMPUTED] = {166, 77, 140}};
    return inks[technique];
}

static double x_of(const struct study_drawing *study_drawing, const struct orl_study_point *p)
{
    return orl_axis_at(&study_drawing->chart->x, p->total_s);
}

static double y_of(const struct study_drawing *study_drawing, const struct orl_study_point *p)
{
    return orl_axis_at(&study_drawing->chart->y, 100 * p->rms);
}

/* ---- Points ---------------------------------------------------------------------------------- */

/* Returns the corners of a technique's marker about its middle; none for a disc. The shapes are
 * easy to distinguish. */
static size_t corners_of(enum orl_technique technique, const double (**ret_corners)[2])
{
    static const double square[4][2] = {{-.9, -.9}, {.9, -.9}, {.9, .9}, {-.9, .9}},
                        triangle[3][2] = {{0, -1.2}, {1.2, .8}, {-1.2, .8}},
                        diamond[4][2] = {{0, -1.2}, {1.2, 0}, {0, 1.2}, {-1.2, 0}};
    switch (technique) {
    case ORL_TECHNIQUE_BACKWARD:
        return 0;
    case ORL_TECHNIQUE_GATHER:
        *ret_corners = square;
        return 4;
    case ORL_TECHNIQUE_DIRECT:
        *ret_corners = triangle;
        return 3;
    default:
        *ret_corners = diamond;
        return 4;
    }
}

/* Draws a marker, filled for points of the line, hollow for dominated points. */
static void draw_marker(struct orl_canvas *canvas, enum orl_technique technique, double x, double y,
                        bool full)
{
    const double half = full ? 4.5 : 3;
    const unsigned char *ink = ink_of(technique), *inside = full ? ink : paper;
    const double(*corners)[2] = NULL;
    const size_t n = corners_of(technique, &corners);
    double xs[5], ys[5];
    if (n == 0) {
        orl_canvas_disc(canvas, x, y, half + 0.5, ink);
        orl_canvas_disc(canvas, x, y, half - 0.5, inside);
        return;
    }
    for (size_t i = 0; i <= n; i++) {
        xs[i] = x + half * corners[i % n][0];
        ys[i] = y + half * corners[i % n][1];
    }
    orl_canvas_fill(canvas, n, xs, ys, inside);
    orl_canvas_path(canvas, n + 1, xs, ys, 1, ink);
}

static void draw_cross(struct orl_canvas *canvas, double x, double y)
{
    orl_canvas_line(canvas, x - 4.5, y - 4.5, x + 4.5, y + 4.5, 2, dark_red);
    orl_canvas_line(canvas, x - 4.5, y + 4.5, x + 4.5, y - 4.5, 2, dark_red);
}

/* Draws standard errors of error and time, clipped at the plot's edge. */
static void draw_bars(const struct study_drawing *study_drawing, const struct orl_study_point *p)
{
    const struct orl_chart_box *plot = &study_drawing->chart->plot;
    const double x = x_of(study_drawing, p), y = y_of(study_drawing, p), tiny = 1e-3;
    const double up = p->rms_error, right = p->total_error_s;
    const unsigned char *ink = ink_of(p->setting.technique);
    if (up > 0) {
        const double low =
            orl_axis_at(&study_drawing->chart->y, 100 * fmax(p->rms - up, tiny * p->rms));
        const double high = orl_axis_at(&study_drawing->chart->y, 100 * (p->rms + up));
        orl_canvas_line(study_drawing->canvas, x, fmax(high, plot->y0), x, fmin(low, plot->y1), 1,
                        ink);
    }
    if (right > 0) {
        const double low =
            orl_axis_at(&study_drawing->chart->x, fmax(p->total_s - right, tiny * p->total_s));
        const double high = orl_axis_at(&study_drawing->chart->x, p->total_s + right);
        orl_canvas_line(study_drawing->canvas, fmax(low, plot->x0), y, fmin(high, plot->x1), y, 1,
                        ink);
    }
}

/* ---- Curves ---------------------------------------------------------------------------------- */

static void draw_curve(const struct study_drawing *study_drawing, size_t n, double weight,
                       const unsigned char rgb[3])
{
    for (size_t i = 0; i < n; i++) {
        const struct orl_study_point *p = &study_drawing->study->points[study_drawing->index[i]];
        study_drawing->x[i] = x_of(study_drawing, p);
        study_drawing->y[i] = y_of(study_drawing, p);
    }
    if (n > 1)
        orl_canvas_path(study_drawing->canvas, n, study_drawing->x, study_drawing->y, weight, rgb);
}

static void draw_technique(const struct study_drawing *study_drawing, enum orl_technique technique)
{
    const struct orl_study *study = study_drawing->study;
    const size_t n = orl_chart_technique_front(study, technique, study_drawing->index);
    for (size_t i = 0; i < study->n_points; i++) {
        const struct orl_study_point *p = &study->points[i];
        if (p->setting.technique == technique && orl_chart_shows(p))
            draw_bars(study_drawing, p);
    }
    draw_curve(study_drawing, n, 1.8, ink_of(technique));
    for (size_t i = 0; i < study->n_points; i++) {
        const struct orl_study_point *p = &study->points[i];
        bool on_line = false;
        for (size_t k = 0; k < n; k++)
            on_line = on_line || study_drawing->index[k] == i;
        if (p->setting.technique == technique && orl_chart_shows(p))
            draw_marker(study_drawing->canvas, technique, x_of(study_drawing, p),
                        y_of(study_drawing, p), on_line);
    }
}

static void draw_reference(struct orl_canvas *canvas, double x0, double x1, double y)
{
    static const double dash = 6, gap = 4;
    const int n = (int)ceil((x1 - x0) / (dash + gap));
    for (int i = 0; i < n; i++) {
        const double x = x0 + i * (dash + gap);
        orl_canvas_line(canvas, x, y, fmin(x + dash, x1), y, 1, gray);
    }
}

static void draw_curves(const struct study_drawing *study_drawing)
{
    const struct orl_chart *chart = study_drawing->chart;
    const double noise = 100 * study_drawing->study->reference.standard_error;
    draw_curve(study_drawing, orl_chart_front(study_drawing->study, study_drawing->index), 11,
               gold);
    if (noise > chart->y.low && noise < chart->y.high)
        draw_reference(study_drawing->canvas, chart->plot.x0, chart->plot.x1,
                       orl_axis_at(&chart->y, noise));
    for (int technique = 0; technique < ORL_TECHNIQUE_COUNT; technique++)
        draw_technique(study_drawing, (enum orl_technique)technique);
    for (size_t i = 0; i < study_drawing->study->n_external; i++)
        draw_cross(study_drawing->canvas,
                   orl_axis_at(&chart->x, study_drawing->study->external[i].here_s),
                   orl_axis_at(&chart->y, 100 * study_drawing->study->external[i].rms));
}

/* ---- Frame, legend, texts -------------------------------------------------------------------- */

static void draw_frame(const struct orl_chart *chart, struct orl_canvas *canvas)
{
    const struct orl_chart_box *p = &chart->plot;
    const double xs[5] = {p->x0, p->x1, p->x1, p->x0, p->x0};
    const double ys[5] = {p->y0, p->y0, p->y1, p->y1, p->y0};
    for (size_t i = 0; i < chart->x.n_ticks; i++) {
        const double x = orl_axis_at(&chart->x, chart->x.ticks[i]);
        orl_canvas_line(canvas, x, p->y0, x, p->y1, 1, faint);
        orl_canvas_line(canvas, x, p->y1, x, p->y1 + 5, 1, black);
    }
    for (size_t i = 0; i < chart->y.n_ticks; i++) {
        const double y = orl_axis_at(&chart->y, chart->y.ticks[i]);
        orl_canvas_line(canvas, p->x0, y, p->x1, y, 1, faint);
        orl_canvas_line(canvas, p->x0 - 5, y, p->x0, y, 1, black);
    }
    orl_canvas_path(canvas, 5, xs, ys, 1, black);
}

static void draw_row(const struct orl_chart_row *row, struct orl_canvas *canvas)
{
    const double x = row->x, y = row->y, end = x + ORL_CHART_KEY_WIDTH;
    switch (row->key) {
    case ORL_CHART_KEY_TECHNIQUE:
        orl_canvas_line(canvas, x, y, end, y, 1.8, ink_of(row->technique));
        draw_marker(canvas, row->technique, (x + end) / 2, y, true);
        break;
    case ORL_CHART_KEY_FRONT:
        orl_canvas_line(canvas, x + 5, y, end - 5, y, 11, gold);
        break;
    case ORL_CHART_KEY_REFERENCE:
        draw_reference(canvas, x, end, y);
        break;
    case ORL_CHART_KEY_GIVEN:
        draw_cross(canvas, (x + end) / 2, y);
        break;
    case ORL_CHART_KEY_NOTE:
        break;
    }
}

static void draw_text(const struct orl_chart_text *t, struct orl_canvas *canvas)
{
    const bool external = t->role == ORL_CHART_GIVEN, point = t->role == ORL_CHART_POINT;
    struct orl_canvas_text_style letters = {.size = orl_chart_cap_height(t->role),
                                            .upright = t->upright,
                                            .bold = t->role == ORL_CHART_TITLE,
                                            .rimmed = external || point};
    memcpy(letters.rgb, external ? dark_red : point ? gray : black, 3);
    if (t->has_leader)
        orl_canvas_line(canvas, t->from_x, t->from_y, fmin(fmax(t->from_x, t->box.x0), t->box.x1),
                        fmin(fmax(t->from_y, t->box.y0), t->box.y1), 0.7, gray);
    orl_canvas_text(canvas, t->x, t->y, &letters, t->text);
}

static void draw_chart(const struct study_drawing *study_drawing)
{
    draw_frame(study_drawing->chart, study_drawing->canvas);
    draw_curves(study_drawing);
    for (size_t i = 0; i < study_drawing->chart->n_rows; i++)
        draw_row(&study_drawing->chart->rows[i], study_drawing->canvas);
    for (size_t i = 0; i < study_drawing->chart->n_texts; i++)
        draw_text(&study_drawing->chart->texts[i], study_drawing->canvas);
}

int orl_study_chart_write(const struct orl_study *study, const char *title,
                          enum orl_canvas_kind kind, const char *path, struct orl_error *err)
{
    const size_t room = study->n_points + 1;
    struct orl_chart chart;
    int code = orl_chart_make(study, title, &chart, err);
    if (code < 0)
        return code;
    struct study_drawing study_drawing = {.chart = &chart,
                                          .study = study,
                                          .index = calloc(room, sizeof *study_drawing.index),
                                          .x = calloc(room, sizeof *study_drawing.x),
                                          .y = calloc(room, sizeof *study_drawing.y)};
    if (!study_drawing.index || !study_drawing.x || !study_drawing.y)
        code = orl_error_set(err, ORL_ERR_NOMEM, "out of memory drawing a chart");
    if (code == 0)
        code = orl_canvas_open(kind, path, chart.width, chart.height, png_scale,
                               &study_drawing.canvas, err);
    if (code == 0) {
        draw_chart(&study_drawing);
        code = orl_canvas_close(study_drawing.canvas, 0, err);
    }
    free(study_drawing.index);
    free(study_drawing.x);
    free(study_drawing.y);
    orl_chart_done(&chart);
    return code;
}
