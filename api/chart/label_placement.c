/*
 * Places labels of points. Each label tries places around its point, from near to far, and
 * takes the cheapest. Overlap with other texts is forbidden; overlap with markers, curves and
 * bars has a cost.
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "chart/study_layout.h"

static const double marker_half = 6;  /* half the side of a marker's box */
static const double text_gap = 2;     /* least gap between texts */
static const double leader_from = 12; /* labels at least this far away get a leader line */
static const double impossible = 1e9;
enum { DIRECTIONS = 16, RINGS = 9, GRID = 48 };

struct segment {
    double x0, y0, x1, y1, cost;
};

struct label_search {
    struct orl_chart *chart;
    struct orl_chart_box *markers; /* owned */
    size_t n_markers;
    struct segment *segments; /* owned */
    size_t n_segments;
};

struct label_box {
    struct orl_chart_box box;
    double cost;
    bool has_leader;
};

/* Returns true if the segment passes through the box (Liang and Barsky 1984). */
static bool crosses_box(const struct segment *s, const struct orl_chart_box *box)
{
    const double dx = s->x1 - s->x0, dy = s->y1 - s->y0;
    const double p[4] = {-dx, dx, -dy, dy};
    const double q[4] = {s->x0 - box->x0, box->x1 - s->x0, s->y0 - box->y0, box->y1 - s->y0};
    double enter = 0, leave = 1;
    for (int i = 0; i < 4; i++) {
        if (p[i] == 0 && q[i] < 0)
            return false;
        if (p[i] < 0)
            enter = fmax(enter, q[i] / p[i]);
        else if (p[i] > 0)
            leave = fmin(leave, q[i] / p[i]);
    }
    return enter < leave;
}

static struct orl_chart_box expand_box(struct orl_chart_box box, double by)
{
    return (struct orl_chart_box){box.x0 - by, box.y0 - by, box.x1 + by, box.y1 + by};
}

/* Returns the leader line from the point to the nearest point of the box. */
static struct segment leader_to(const struct orl_chart_box *box, double x, double y)
{
    return (struct segment){x, y, fmin(fmax(x, box->x0), box->x1), fmin(fmax(y, box->y0), box->y1),
                            0};
}

static double length_of(const struct segment *s)
{
    return hypot(s->x1 - s->x0, s->y1 - s->y0);
}

/* Returns the cost of the box for a label of the point (x, y); impossible if it overlaps a text. */
static double cost_of(const struct label_search *label_search, const struct orl_chart_box *box,
                      double x, double y, bool has_leader)
{
    const struct orl_chart_box wide = expand_box(*box, text_gap),
                               plot = expand_box(label_search->chart->plot, -text_gap);
    const struct segment leader = leader_to(box, x, y);
    double cost = 0;
    if (box->x0 < plot.x0 || box->x1 > plot.x1 || box->y0 < plot.y0 || box->y1 > plot.y1)
        return impossible;
    for (size_t i = 0; i < label_search->chart->n_texts; i++) {
        const struct orl_chart_text *t = &label_search->chart->texts[i];
        const struct segment other = leader_to(&t->box, t->from_x, t->from_y);
        if (orl_box_overlaps(&wide, &t->box))
            return impossible;
        cost += has_leader && crosses_box(&leader, &t->box) ? 60 : 0;
        cost += t->has_leader && crosses_box(&other, &wide) ? 60 : 0;
    }
    for (size_t i = 0; i < label_search->n_markers; i++) {
        const struct orl_chart_box *m = &label_search->markers[i];
        const bool own = x > m->x0 && x < m->x1 && y > m->y0 && y < m->y1;
        cost += orl_box_overlaps(&wide, m) ? 40 : 0;
        cost += has_leader && !own && crosses_box(&leader, m) ? 12 : 0;
        /* The label would seem to belong to the other point. */
        const struct segment rival = leader_to(box, 0.5 * (m->x0 + m->x1), 0.5 * (m->y0 + m->y1));
        cost += !own && length_of(&rival) < length_of(&leader) + 4 ? 18 : 0;
    }
    for (size_t i = 0; i < label_search->n_segments; i++)
        cost += crosses_box(&label_search->segments[i], &wide) ? label_search->segments[i].cost : 0;
    return cost + 0.4 * length_of(&leader);
}

static void try_label_box(const struct label_search *label_search, struct orl_chart_box box,
                          double x, double y, bool has_leader, struct label_box *best)
{
    const double cost = cost_of(label_search, &box, x, y, has_leader);
    if (cost < best->cost)
        *best = (struct label_box){box, cost, has_leader};
}

/* Returns a box of the given size beside the point, with its edge at the distance and direction. */
static struct orl_chart_box box_beside_point(double x, double y, double width, double height,
                                             double distance, int direction)
{
    const double angle = 2 * ORL_PI * direction / DIRECTIONS;
    const double cx = x + cos(angle) * (width / 2 + distance);
    const double cy = y + sin(angle) * (height / 2 + distance);
    return (struct orl_chart_box){cx - width / 2, cy - height / 2, cx + width / 2, cy + height / 2};
}

static struct label_box find_label_box(const struct label_search *label_search,
                                       const struct orl_chart_text *text, double x, double y)
{
    static const double rings[RINGS] = {7, 10, 16, 24, 36, 52, 72, 100, 140};
    const struct orl_chart_box *plot = &label_search->chart->plot;
    const double width = text->box.x1 - text->box.x0, height = text->box.y1 - text->box.y0;
    const bool external = text->role == ORL_CHART_GIVEN;
    struct label_box best = {.cost = external ? impossible : 16};
    for (int ring = 0; ring < (external ? RINGS : 3); ring++)
        for (int i = 0; i < DIRECTIONS; i++)
            try_label_box(label_search, box_beside_point(x, y, width, height, rings[ring], i), x, y,
                          rings[ring] > leader_from, &best);
    /* No place around the point is free: try the whole plot. */
    for (int i = 0; external && best.cost >= impossible && i < GRID * GRID; i++) {
        const double left = plot->x0 + (plot->x1 - plot->x0) * (i % GRID) / GRID;
        const double top = plot->y0 + (plot->y1 - plot->y0) * (int)(i / GRID) / GRID;
        try_label_box(label_search, (struct orl_chart_box){left, top, left + width, top + height},
                      x, y, true, &best);
    }
    return best;
}

/* Adds a label if there is room for it. */
static void add_label(struct label_search *label_search, enum orl_chart_role role, const char *text,
                      double x, double y)
{
    struct orl_chart *chart = label_search->chart;
    struct orl_chart_text *t = orl_chart_add(chart, role, text, 0, 0, ORL_CANVAS_LEFT);
    const struct orl_chart_text made = *t;
    chart->n_texts--; /* removed, or the label would block itself */
    const struct label_box label_box = find_label_box(label_search, &made, x, y);
    if (label_box.box.x1 <= label_box.box.x0) {
        chart->n_unlabelled += role == ORL_CHART_GIVEN;
        return;
    }
    *t = made;
    t->x += label_box.box.x0 - made.box.x0;
    t->y += label_box.box.y0 - made.box.y0;
    t->box = label_box.box;
    t->has_leader = label_box.has_leader;
    t->from_x = x;
    t->from_y = y;
    chart->n_texts++;
}

static void add_marker(struct label_search *label_search, double x, double y, double half)
{
    label_search->markers[label_search->n_markers++] =
        (struct orl_chart_box){x - half, y - half, x + half, y + half};
}

/* Adds the segments of a curve through the points. */
static void add_curve(struct label_search *label_search, const struct orl_study *study,
                      const size_t *index, size_t n)
{
    const struct orl_chart *chart = label_search->chart;
    for (size_t i = 1; i < n; i++) {
        const struct orl_study_point *a = &study->points[index[i - 1]];
        const struct orl_study_point *b = &study->points[index[i]];
        label_search->segments[label_search->n_segments++] = (struct segment){
            orl_axis_at(&chart->x, a->total_s), orl_axis_at(&chart->y, 100 * a->rms),
            orl_axis_at(&chart->x, b->total_s), orl_axis_at(&chart->y, 100 * b->rms), 12};
    }
}

static void add_curves(struct label_search *label_search, const struct orl_study *study,
                       size_t *index)
{
    for (int technique = 0; technique < ORL_TECHNIQUE_COUNT; technique++)
        add_curve(label_search, study, index,
                  orl_chart_technique_front(study, (enum orl_technique)technique, index));
    add_curve(label_search, study, index, orl_chart_front(study, index));
}

/* Adds the dashed line of the reference's own error. */
static void add_reference(struct label_search *label_search, const struct orl_study *study)
{
    const struct orl_chart_box *plot = &label_search->chart->plot;
    const double noise = 100 * study->reference.standard_error;
    if (!(noise > label_search->chart->y.low && noise < label_search->chart->y.high))
        return;
    const double y = orl_axis_at(&label_search->chart->y, noise);
    label_search->segments[label_search->n_segments++] =
        (struct segment){plot->x0, y, plot->x1, y, 8};
}

static void add_points(struct label_search *label_search, const struct orl_study *study)
{
    const struct orl_chart *chart = label_search->chart;
    for (size_t i = 0; i < study->n_points; i++) {
        const struct orl_study_point *p = &study->points[i];
        if (!orl_chart_shows(p))
            continue;
        const double x = orl_axis_at(&chart->x, p->total_s);
        const double up = isnan(p->rms_error) ? 0 : p->rms_error;
        add_marker(label_search, x, orl_axis_at(&chart->y, 100 * p->rms),
                   p->on_front ? marker_half : 0.7 * marker_half);
        label_search->segments[label_search->n_segments++] =
            (struct segment){x, orl_axis_at(&chart->y, 100 * (p->rms + up)), x,
                             orl_axis_at(&chart->y, 100 * fmax(p->rms - up, p->rms / 2)), 4};
    }
    for (size_t i = 0; i < study->n_external; i++)
        add_marker(label_search, orl_axis_at(&chart->x, study->external[i].here_s),
                   orl_axis_at(&chart->y, 100 * study->external[i].rms), marker_half);
}

/* Formats a count: "2 M", "250 k", "4096". */
static void format_count(double count, char *ret_text, size_t size)
{
    const double unit = count >= 1e6 ? 1e6 : count >= 1e4 ? 1e3 : 1;
    snprintf(ret_text, size, "%.4g%s", count / unit, unit > 1e3 ? " M" : unit > 1 ? " k" : "");
}

static void format_setting(const struct orl_study_setting *s, char *ret_text, size_t size)
{
    char photons[32];
    format_count((double)s->photons, photons, sizeof photons);
    if (s->photons > 0 && s->samples > 0)
        snprintf(ret_text, size, "%s, %u", photons, s->samples);
    else if (s->photons > 0)
        snprintf(ret_text, size, "%s", photons);
    else
        snprintf(ret_text, size, "%u", s->samples);
}

static void add_labels(struct label_search *label_search, const struct orl_study *study,
                       const size_t *front, size_t n_front)
{
    const struct orl_chart *chart = label_search->chart;
    char text[64];
    for (size_t i = 0; i < study->n_external; i++)
        add_label(label_search, ORL_CHART_GIVEN, study->external[i].name,
                  orl_axis_at(&chart->x, study->external[i].here_s),
                  orl_axis_at(&chart->y, 100 * study->external[i].rms));
    for (size_t i = 0; i < n_front; i++) {
        const struct orl_study_point *p = &study->points[front[i]];
        format_setting(&p->setting, text, sizeof text);
        add_label(label_search, ORL_CHART_POINT, text, orl_axis_at(&chart->x, p->total_s),
                  orl_axis_at(&chart->y, 100 * p->rms));
    }
}

int orl_chart_place_labels(struct orl_chart *chart, const struct orl_study *study,
                           struct orl_error *err)
{
    const size_t n = study->n_points;
    struct label_search label_search = {
        .chart = chart,
        .markers = calloc(n + study->n_external + 1, sizeof *label_search.markers),
        .segments = calloc(3 * n + 2, sizeof *label_search.segments)};
    size_t *index = calloc(n + 1, sizeof *index);
    int code = 0;
    if (!label_search.markers || !label_search.segments || !index) {
        code = orl_error_set(err, ORL_ERR_NOMEM, "out of memory for labels");
    } else {
        add_points(&label_search, study);
        add_curves(&label_search, study, index);
        add_reference(&label_search, study);
        const size_t n_front = orl_chart_front(study, index);
        add_labels(&label_search, study, index, n_front);
    }
    free(label_search.markers);
    free(label_search.segments);
    free(index);
    return code;
}
