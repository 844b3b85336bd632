#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "chart/study_layout.h"

bool orl_box_overlaps(const struct orl_chart_box *a, const struct orl_chart_box *b)
{
    return a->x0 < b->x1 && b->x0 < a->x1 && a->y0 < b->y1 && b->y0 < a->y1;
}

bool orl_chart_shows(const struct orl_study_point *point)
{
    return orl_study_can_show(point->rms) && orl_study_can_show(point->total_s);
}

double orl_chart_cap_height(enum orl_chart_role role)
{
    static const double sizes[ORL_CHART_ROLES] = {12, 9.5, 9, 9, 8, 7.5};
    return sizes[role];
}

struct orl_chart_text *orl_chart_add(struct orl_chart *chart, enum orl_chart_role role,
                                     const char *text, double x, double y,
                                     enum orl_canvas_align align)
{
    const double size = orl_chart_cap_height(role);
    struct orl_chart_text *t = &chart->texts[chart->n_texts++];
    *t = (struct orl_chart_text){.role = role};
    snprintf(t->text, sizeof t->text, "%s", text);
    const double width = orl_canvas_text_width(t->text, size);
    t->x = x - (align == ORL_CANVAS_MIDDLE ? width / 2 : align == ORL_CANVAS_RIGHT ? width : 0);
    /* y is the middle of capitals; accents extend above them and descenders below. */
    t->y = y + size / 2;
    t->box = (struct orl_chart_box){t->x, t->y - 1.2 * size, t->x + width, t->y + 0.35 * size};
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

size_t orl_chart_technique_front(const struct orl_study *study, enum orl_technique technique,
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

static const double least_ratio = 8;

/* Sets ticks at `per` values of every step-th decade. Returns false if they are too close. */
static int place_ticks(struct orl_axis *axis, int per, int step, double spacing)
{
    static const double digits[] = {1, 2, 5};
    const int first = (int)floor(log10(axis->low)), last = (int)ceil(log10(axis->high));
    axis->n_ticks = 0;
    for (int decade = first; decade <= last; decade++) {
        for (int i = 0; i < per; i++) {
            /* Dividing gives the double nearest to 1/10; pow(10, -1) need not. */
            const double power = pow(10, abs(decade));
            const double value = decade < 0 ? digits[i] / power : digits[i] * power;
            if (decade % step != 0 || value < axis->low || value > axis->high)
                continue;
            if (axis->n_ticks == ORL_AXIS_TICKS)
                return 0;
            axis->ticks[axis->n_ticks++] = value;
        }
    }
    for (size_t i = 1; i < axis->n_ticks; i++)
        if (fabs(orl_axis_at(axis, axis->ticks[i]) - orl_axis_at(axis, axis->ticks[i - 1])) <
            spacing)
            return 0;
    return 1;
}

void orl_axis_init(struct orl_axis *axis, double low, double high, double from, double to,
                   double spacing)
{
    const double margin = fmax(pow(high / low, 0.06), sqrt(fmax(1, least_ratio * low / high)));
    *axis = (struct orl_axis){.low = low / margin, .high = high * margin, .from = from, .to = to};
    if (place_ticks(axis, 3, 1, spacing))
        return;
    for (int step = 1; step < ORL_AXIS_TICKS && !place_ticks(axis, 1, step, spacing); step++)
        continue;
}

double orl_axis_at(const struct orl_axis *axis, double value)
{
    const double t = log(value / axis->low) / log(axis->high / axis->low);
    return axis->from + t * (axis->to - axis->from);
}

void orl_axis_format(double tick, char *ret_text, size_t size)
{
    snprintf(ret_text, size, tick >= 1e5 || tick < 1e-4 ? "%.0e" : "%.10g", tick);
}
