#include <math.h>
#include <stdlib.h>

#include "base/letters.h"
#include "study/plot.h"

struct ink {
    double r, g, b;
};
static const struct ink black = {0.1, 0.1, 0.1}, gray = {0.45, 0.45, 0.45}, faint = {0.9, 0.9, 0.9},
                        gold = {1, 0.86, 0.45}, dark_red = {0.55, 0.1, 0.1};

/* Colours that the colour-blind tell apart (Okabe and Ito 2008), and shapes that nobody mixes up.
 */
static struct ink ink_of(enum orl_technique technique)
{
    static const struct ink inks[ORL_TECHNIQUE_COUNT] = {
        [ORL_TECHNIQUE_BACKWARD] = {0, 0.447, 0.698},
        [ORL_TECHNIQUE_GATHER] = {0.835, 0.369, 0},
        [ORL_TECHNIQUE_DIRECT] = {0, 0.62, 0.451},
        [ORL_TECHNIQUE_PRECOMPUTED] = {0.65, 0.3, 0.55}};
    return inks[technique];
}

static void set_ink(cairo_t *cairo, struct ink ink)
{
    cairo_set_source_rgb(cairo, ink.r, ink.g, ink.b);
}

static void line(cairo_t *cairo, double x0, double y0, double x1, double y1)
{
    cairo_move_to(cairo, x0, y0);
    cairo_line_to(cairo, x1, y1);
    cairo_stroke(cairo);
}

static void marker_path(cairo_t *cairo, enum orl_technique technique, double x, double y,
                        double half)
{
    const double wide = 1.2 * half;
    switch (technique) {
    case ORL_TECHNIQUE_BACKWARD:
        cairo_arc(cairo, x, y, half, 0, 2 * ORL_PI);
        break;
    case ORL_TECHNIQUE_GATHER:
        cairo_rectangle(cairo, x - 0.9 * half, y - 0.9 * half, 1.8 * half, 1.8 * half);
        break;
    case ORL_TECHNIQUE_DIRECT:
        cairo_move_to(cairo, x, y - wide);
        cairo_line_to(cairo, x + wide, y + 0.8 * half);
        cairo_line_to(cairo, x - wide, y + 0.8 * half);
        cairo_close_path(cairo);
        break;
    default:
        cairo_move_to(cairo, x, y - wide);
        cairo_line_to(cairo, x + wide, y);
        cairo_line_to(cairo, x, y + wide);
        cairo_line_to(cairo, x - wide, y);
        cairo_close_path(cairo);
        break;
    }
}

/* Filled for points of the line, hollow for those beaten. */
static void draw_marker(cairo_t *cairo, enum orl_technique technique, double x, double y, bool full)
{
    marker_path(cairo, technique, x, y, full ? 4.5 : 3);
    if (full)
        set_ink(cairo, ink_of(technique));
    else
        cairo_set_source_rgb(cairo, 1, 1, 1);
    cairo_fill_preserve(cairo);
    set_ink(cairo, ink_of(technique));
    cairo_set_line_width(cairo, 1);
    cairo_stroke(cairo);
}

static void draw_cross(cairo_t *cairo, double x, double y)
{
    set_ink(cairo, dark_red);
    cairo_set_line_width(cairo, 2);
    line(cairo, x - 4.5, y - 4.5, x + 4.5, y + 4.5);
    line(cairo, x - 4.5, y + 4.5, x + 4.5, y - 4.5);
}

static void draw_frame(const struct orl_chart *chart, cairo_t *cairo)
{
    const struct orl_chart_box *p = &chart->plot;
    set_ink(cairo, faint);
    cairo_set_line_width(cairo, 1);
    for (size_t i = 0; i < chart->x.n_ticks; i++) {
        const double x = orl_axis_at(&chart->x, chart->x.ticks[i]);
        line(cairo, x, p->y0, x, p->y1);
    }
    for (size_t i = 0; i < chart->y.n_ticks; i++) {
        const double y = orl_axis_at(&chart->y, chart->y.ticks[i]);
        line(cairo, p->x0, y, p->x1, y);
    }
    set_ink(cairo, black);
    for (size_t i = 0; i < chart->x.n_ticks; i++) {
        const double x = orl_axis_at(&chart->x, chart->x.ticks[i]);
        line(cairo, x, p->y1, x, p->y1 + 5);
    }
    for (size_t i = 0; i < chart->y.n_ticks; i++) {
        const double y = orl_axis_at(&chart->y, chart->y.ticks[i]);
        line(cairo, p->x0 - 5, y, p->x0, y);
    }
    cairo_rectangle(cairo, p->x0, p->y0, p->x1 - p->x0, p->y1 - p->y0);
    cairo_stroke(cairo);
}

static void trace(const struct orl_chart *chart, const struct orl_study *study, cairo_t *cairo,
                  const size_t *index, size_t n)
{
    cairo_new_path(cairo);
    for (size_t i = 0; i < n; i++) {
        const struct orl_study_point *p = &study->points[index[i]];
        cairo_line_to(cairo, orl_axis_at(&chart->x, p->total_s),
                      orl_axis_at(&chart->y, 100 * p->rms));
    }
    cairo_stroke(cairo);
}

static void set_front_pen(cairo_t *cairo)
{
    set_ink(cairo, gold);
    cairo_set_line_width(cairo, 11);
    cairo_set_line_cap(cairo, CAIRO_LINE_CAP_ROUND);
    cairo_set_line_join(cairo, CAIRO_LINE_JOIN_ROUND);
}

static void set_reference_pen(cairo_t *cairo)
{
    static const double dashes[] = {6, 4};
    set_ink(cairo, gray);
    cairo_set_line_width(cairo, 1);
    cairo_set_dash(cairo, dashes, 2, 0);
}

/* What lies under the points: the front as a broad band, the reference's noise. */
static void draw_ground(const struct orl_chart *chart, const struct orl_study *study,
                        cairo_t *cairo, size_t *index)
{
    const double noise = 100 * study->reference.standard_error;
    const size_t n = orl_chart_front(study, index);
    cairo_save(cairo);
    set_front_pen(cairo);
    trace(chart, study, cairo, index, n);
    cairo_restore(cairo);
    if (!(noise > chart->y.low && noise < chart->y.high))
        return;
    cairo_save(cairo);
    set_reference_pen(cairo);
    line(cairo, chart->plot.x0, orl_axis_at(&chart->y, noise), chart->plot.x1,
         orl_axis_at(&chart->y, noise));
    cairo_restore(cairo);
}

/* Standard errors of error and time; what would reach to zero ends at the plot's edge. */
static void draw_bars(const struct orl_chart *chart, const struct orl_study_point *p,
                      cairo_t *cairo)
{
    const double x = orl_axis_at(&chart->x, p->total_s), y = orl_axis_at(&chart->y, 100 * p->rms);
    const double up = p->rms_error, right = p->total_error_s, tiny = 1e-3;
    set_ink(cairo, ink_of(p->setting.technique));
    cairo_set_line_width(cairo, 1);
    if (up > 0)
        line(cairo, x, orl_axis_at(&chart->y, 100 * (p->rms + up)), x,
             orl_axis_at(&chart->y, 100 * fmax(p->rms - up, tiny * p->rms)));
    if (right > 0)
        line(cairo, orl_axis_at(&chart->x, p->total_s + right), y,
             orl_axis_at(&chart->x, fmax(p->total_s - right, tiny * p->total_s)), y);
}

static void draw_technique(const struct orl_chart *chart, const struct orl_study *study,
                           enum orl_technique technique, cairo_t *cairo, size_t *index)
{
    const size_t n = orl_chart_line(study, technique, index);
    for (size_t i = 0; i < study->n_points; i++) {
        const struct orl_study_point *p = &study->points[i];
        if (p->setting.technique == technique && orl_chart_shows(p))
            draw_bars(chart, p, cairo);
    }
    set_ink(cairo, ink_of(technique));
    cairo_set_line_width(cairo, 1.8);
    trace(chart, study, cairo, index, n);
    for (size_t i = 0; i < study->n_points; i++) {
        const struct orl_study_point *p = &study->points[i];
        bool on_line = false;
        for (size_t k = 0; k < n; k++)
            on_line = on_line || index[k] == i;
        if (p->setting.technique == technique && orl_chart_shows(p))
            draw_marker(cairo, technique, orl_axis_at(&chart->x, p->total_s),
                        orl_axis_at(&chart->y, 100 * p->rms), on_line);
    }
}

static void draw_row(const struct orl_chart_row *row, cairo_t *cairo)
{
    const double x = row->x, y = row->y, middle = x + ORL_CHART_KEY_WIDTH / 2;
    cairo_save(cairo);
    switch (row->key) {
    case ORL_CHART_KEY_TECHNIQUE:
        set_ink(cairo, ink_of(row->technique));
        cairo_set_line_width(cairo, 1.8);
        line(cairo, x, y, x + ORL_CHART_KEY_WIDTH, y);
        draw_marker(cairo, row->technique, middle, y, true);
        break;
    case ORL_CHART_KEY_FRONT:
        set_front_pen(cairo);
        line(cairo, x + 5, y, x + ORL_CHART_KEY_WIDTH - 5, y);
        break;
    case ORL_CHART_KEY_REFERENCE:
        set_reference_pen(cairo);
        line(cairo, x, y, x + ORL_CHART_KEY_WIDTH, y);
        break;
    case ORL_CHART_KEY_GIVEN:
        draw_cross(cairo, middle, y);
        break;
    case ORL_CHART_KEY_NOTE:
        break;
    }
    cairo_restore(cairo);
}

static void take_stroke(void *cairo, bool begins, double x, double y)
{
    if (begins)
        cairo_move_to(cairo, x, y);
    else
        cairo_line_to(cairo, x, y);
}

static void draw_text(const struct orl_chart_text *t, cairo_t *cairo)
{
    cairo_save(cairo);
    if (t->leads) {
        set_ink(cairo, gray);
        cairo_set_line_width(cairo, 0.7);
        line(cairo, t->from_x, t->from_y, fmin(fmax(t->from_x, t->box.x0), t->box.x1),
             fmin(fmax(t->from_y, t->box.y0), t->box.y1));
    }
    const double size = orl_chart_letters(t->role),
                 weight = t->role == ORL_CHART_TITLE ? 0.17 : 0.13;
    const struct orl_pen pen = {.size = size, .turn = t->upright ? ORL_PI / 2 : 0};
    cairo_new_path(cairo);
    orl_letters_strokes(&pen, t->x, t->y, t->text, take_stroke, cairo);
    cairo_set_line_join(cairo, CAIRO_LINE_JOIN_ROUND);
    cairo_set_line_cap(cairo, CAIRO_LINE_CAP_ROUND);
    if (t->role == ORL_CHART_GIVEN || t->role == ORL_CHART_POINT) {
        /* A rim of white keeps letters legible on what they had to cross. */
        cairo_set_source_rgb(cairo, 1, 1, 1);
        cairo_set_line_width(cairo, weight * size + 3);
        cairo_stroke_preserve(cairo);
    }
    set_ink(cairo, t->role == ORL_CHART_GIVEN   ? dark_red
                   : t->role == ORL_CHART_POINT ? gray
                                                : black);
    cairo_set_line_width(cairo, weight * size);
    cairo_stroke(cairo);
    cairo_restore(cairo);
}

int orl_chart_draw(const struct orl_chart *chart, const struct orl_study *study, cairo_t *cairo,
                   struct orl_error *err)
{
    const struct orl_chart_box *p = &chart->plot;
    size_t *index = calloc(study->n_points + 1, sizeof *index);
    if (!index)
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory drawing a chart");
    cairo_set_source_rgb(cairo, 1, 1, 1);
    cairo_paint(cairo);
    draw_frame(chart, cairo);
    cairo_save(cairo);
    cairo_rectangle(cairo, p->x0, p->y0, p->x1 - p->x0, p->y1 - p->y0);
    cairo_clip(cairo);
    draw_ground(chart, study, cairo, index);
    for (int technique = 0; technique < ORL_TECHNIQUE_COUNT; technique++)
        draw_technique(chart, study, (enum orl_technique)technique, cairo, index);
    for (size_t i = 0; i < study->n_given; i++)
        draw_cross(cairo, orl_axis_at(&chart->x, study->given[i].here_s),
                   orl_axis_at(&chart->y, 100 * study->given[i].rms));
    cairo_restore(cairo);
    for (size_t i = 0; i < chart->n_rows; i++)
        draw_row(&chart->rows[i], cairo);
    for (size_t i = 0; i < chart->n_texts; i++)
        draw_text(&chart->texts[i], cairo);
    free(index);
    return 0;
}
