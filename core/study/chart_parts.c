#include "study/chart.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/grow.h"
#include "study/series.h"

bool orl_box_meets(const struct orl_chart_box *a, const struct orl_chart_box *b)
{
    return a->x0 < b->x1 && b->x0 < a->x1 && a->y0 < b->y1 && b->y0 < a->y1;
}

bool orl_chart_shows(const struct orl_study_point *point)
{
    return orl_study_can_show(point->rms) && orl_study_can_show(point->total_s);
}

void orl_chart_set_font(cairo_t *cairo, enum orl_chart_role role)
{
    static const double sizes[ORL_CHART_ROLES] = {16, 13, 12, 12, 11, 10};
    cairo_font_options_t *options = cairo_font_options_create();
    /* The same widths whatever the scale, so that what was laid out is what is drawn. */
    cairo_font_options_set_hint_metrics(options, CAIRO_HINT_METRICS_OFF);
    cairo_font_options_set_hint_style(options, CAIRO_HINT_STYLE_NONE);
    cairo_set_font_options(cairo, options);
    cairo_font_options_destroy(options);
    cairo_select_font_face(cairo, "DejaVu Sans", CAIRO_FONT_SLANT_NORMAL,
                           role == ORL_CHART_TITLE ? CAIRO_FONT_WEIGHT_BOLD
                                                   : CAIRO_FONT_WEIGHT_NORMAL);
    cairo_set_font_size(cairo, sizes[role]);
}

struct orl_chart_text *orl_chart_add(struct orl_chart *chart, cairo_t *cairo,
                                     enum orl_chart_role role, const char *text, double x, double y,
                                     enum orl_chart_align align)
{
    cairo_text_extents_t extents;
    cairo_font_extents_t font;
    if (!orl_grow(&chart->texts, &chart->capacity, chart->n_texts, sizeof *chart->texts))
        return NULL;
    struct orl_chart_text *t = &chart->texts[chart->n_texts++];
    *t = (struct orl_chart_text){.role = role};
    snprintf(t->text, sizeof t->text, "%s", text);
    orl_chart_set_font(cairo, role);
    cairo_text_extents(cairo, t->text, &extents);
    cairo_font_extents(cairo, &font);
    const double width = extents.x_advance;
    t->x = x - (align == ORL_CHART_MIDDLE ? width / 2 : align == ORL_CHART_RIGHT ? width : 0);
    /* y is of the middle of the letters. */
    t->y = y + (font.ascent - font.descent) / 2;
    t->box = (struct orl_chart_box){t->x, t->y - font.ascent, t->x + width, t->y + font.descent};
    return t;
}

static size_t sort_by_time(const struct orl_study *study, size_t *index, size_t n)
{
    for (size_t i = 1; i < n; i++)
        for (size_t k = i;
             k > 0 && study->points[index[k]].total_s < study->points[index[k - 1]].total_s; k--) {
            const size_t kept = index[k];
            index[k] = index[k - 1];
            index[k - 1] = kept;
        }
    return n;
}

size_t orl_chart_line(const struct orl_study *study, enum orl_technique technique,
                      size_t *ret_index)
{
    size_t n = 0, kept = 0;
    for (size_t i = 0; i < study->n_points; i++)
        if (study->points[i].setting.technique == technique && orl_chart_shows(&study->points[i]))
            ret_index[n++] = i;
    sort_by_time(study, ret_index, n);
    for (size_t i = 0; i < n; i++)
        if (kept == 0 || study->points[ret_index[i]].rms < study->points[ret_index[kept - 1]].rms)
            ret_index[kept++] = ret_index[i];
    return kept;
}

size_t orl_chart_front(const struct orl_study *study, size_t *ret_index)
{
    size_t n = 0;
    for (size_t i = 0; i < study->n_points; i++)
        if (study->points[i].on_front && orl_chart_shows(&study->points[i]))
            ret_index[n++] = i;
    return sort_by_time(study, ret_index, n);
}
