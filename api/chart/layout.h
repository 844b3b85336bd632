/*
 * A study's chart before it is drawn: where everything stands on the page. study_chart.c draws what
 * is decided here.
 *
 * Page units are 1/72 inch in SVG and two pixels in PNG, y downwards. Every text has a box; no two
 * boxes meet, and none lies beyond the page. The legend has a column of its own, right of the
 * curves. Labels of points look for a free place nearby, or farther off with a leader line; those
 * of the study's own points are dropped where there is none, those of given points find one
 * anywhere in the plot or are counted in n_unlabelled.
 */
#ifndef ORL_CHART_LAYOUT_H
#define ORL_CHART_LAYOUT_H

#include <oriel/canvas.h>
#include <oriel/study.h>

#include "chart/axis.h"

struct orl_chart_box {
    double x0, y0, x1, y1;
};

enum orl_chart_role {
    ORL_CHART_TITLE,
    ORL_CHART_AXIS,
    ORL_CHART_TICK,
    ORL_CHART_LEGEND,
    ORL_CHART_GIVEN, /* a given point's name */
    ORL_CHART_POINT, /* the setting of a point on the front */
    ORL_CHART_ROLES
};

struct orl_chart_text {
    enum orl_chart_role role;
    char text[96];
    double x, y;  /* where its baseline starts */
    bool upright; /* turned to read from below */
    struct orl_chart_box box;
    bool leads; /* a line goes from (from_x, from_y) to the box */
    double from_x, from_y;
};

/* What a row of the legend shows beside its text. */
enum orl_chart_key {
    ORL_CHART_KEY_TECHNIQUE,
    ORL_CHART_KEY_FRONT,
    ORL_CHART_KEY_GIVEN,
    ORL_CHART_KEY_REFERENCE,
    ORL_CHART_KEY_NOTE
};
struct orl_chart_row {
    enum orl_chart_key key;
    enum orl_technique technique;
    double x, y; /* left end and middle of the place for the key */
};

#define ORL_CHART_ROWS (ORL_TECHNIQUE_COUNT + 8)

struct orl_chart {
    double width, height;
    struct orl_chart_box plot;
    struct orl_axis x, y;         /* seconds; percent */
    struct orl_chart_text *texts; /* owned; room for all there can be */
    size_t n_texts;
    struct orl_chart_row rows[ORL_CHART_ROWS];
    size_t n_rows;
    size_t n_unlabelled;
};

#define ORL_CHART_WIDTH 960.0
#define ORL_CHART_HEIGHT 600.0
#define ORL_CHART_KEY_WIDTH 30.0

/* Returns 0 or ORL_ERR_NOMEM. title: NULL for none; cut short when it does not fit. */
int orl_chart_make(const struct orl_study *study, const char *title, struct orl_chart *ret_chart,
                   struct orl_error *err);
void orl_chart_done(struct orl_chart *chart);

/* How high capitals of a role are, page units. */
double orl_chart_letters(enum orl_chart_role role);

/* Whether a point can be drawn: known, above zero, nothing absurd. */
bool orl_chart_shows(const struct orl_study_point *point);

/* The points of a technique that none other of it beats, by time: its line. Returns how many. */
size_t orl_chart_line(const struct orl_study *study, enum orl_technique technique,
                      size_t *ret_index);
/* The same of all techniques. */
size_t orl_chart_front(const struct orl_study *study, size_t *ret_index);

/* The room labels find, once axes, legend and title stand (labels.c). */
int orl_chart_place_labels(struct orl_chart *chart, const struct orl_study *study,
                           struct orl_error *err);

/* Adds a text. x, y: of the box's left, middle or right, as align says; and of its letters' middle.
 */
struct orl_chart_text *orl_chart_add(struct orl_chart *chart, enum orl_chart_role role,
                                     const char *text, double x, double y,
                                     enum orl_canvas_align align);

bool orl_box_meets(const struct orl_chart_box *a, const struct orl_chart_box *b);

#endif
