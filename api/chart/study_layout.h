/*
 * The layout of a study's chart: the place of each item on the page. study_chart.c draws it.
 *
 * Page units are 1/72 inch in SVG and two pixels in PNG, y downwards. Every text has a box; no two
 * boxes overlap, and none extends beyond the page. The legend has a column of its own, right of
 * the curves. A point's label is placed at a free place nearby, or farther off with a leader line.
 * If there is none, labels of the study's own points are dropped. Labels of given points may then
 * be anywhere in the plot, or are counted in n_unlabelled.
 */
#ifndef ORL_API_CHART_STUDY_LAYOUT_H
#define ORL_API_CHART_STUDY_LAYOUT_H

#include <stddef.h>

#include <oriel/base/canvas.h>
#include <oriel/job/study.h>

/*
 * A logarithmic axis: maps values above zero to a range on the page. Ticks are at 1, 2 and 5
 * times powers of ten, or only at powers of ten if those are too dense.
 */

enum { ORL_AXIS_TICKS = 64 };

struct orl_axis {
    double low, high; /* values at the ends */
    double from, to;  /* page coordinates of the ends; may run either way */
    double ticks[ORL_AXIS_TICKS];
    size_t n_ticks; /* at least 2 */
};

/*
 * Makes an axis that shows values from low to high, both > 0, with a margin, over at least a
 * factor of 8. spacing: least distance between ticks, in page units.
 */
void orl_axis_init(struct orl_axis *axis, double low, double high, double from, double to,
                   double spacing);

/* Returns the page coordinate of a value; it may lie beyond the ends. */
double orl_axis_at(const struct orl_axis *axis, double value);

/* Writes a tick's label, such as "0.05", "20", "10000" or "1e+05". */
void orl_axis_format(double tick, char *ret_text, size_t size);

struct orl_chart_box {
    double x0, y0, x1, y1;
};

enum orl_chart_role {
    ORL_CHART_TITLE,
    ORL_CHART_AXIS,
    ORL_CHART_TICK,
    ORL_CHART_LEGEND,
    ORL_CHART_GIVEN, /* name of a given point */
    ORL_CHART_POINT, /* setting of a point on the front */
    ORL_CHART_ROLES
};

struct orl_chart_text {
    enum orl_chart_role role;
    char text[96];
    double x, y;  /* start of the baseline */
    bool upright; /* rotated, reads upwards */
    struct orl_chart_box box;
    bool has_leader; /* true if a leader line goes from (from_x, from_y) to the box */
    double from_x, from_y;
};

/* Symbol of a legend row. */
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
    double x, y; /* left end and middle of the symbol */
};

#define ORL_CHART_ROWS (ORL_TECHNIQUE_COUNT + 8)

struct orl_chart {
    double width, height;
    struct orl_chart_box plot;
    struct orl_axis x, y;         /* seconds, and percent */
    struct orl_chart_text *texts; /* owned; sized for the largest number of texts */
    size_t n_texts;
    struct orl_chart_row rows[ORL_CHART_ROWS];
    size_t n_rows;
    size_t n_unlabelled;
};

#define ORL_CHART_WIDTH 960.0
#define ORL_CHART_HEIGHT 600.0
#define ORL_CHART_KEY_WIDTH 30.0

/* Lays out the chart. title: NULL for none; cut short if it does not fit. Returns 0 or
 * ORL_ERR_NOMEM. */
int orl_chart_make(const struct orl_study *study, const char *title, struct orl_chart *ret_chart,
                   struct orl_error *err);
void orl_chart_done(struct orl_chart *chart);

/* Returns the height of capitals for a role, in page units. */
double orl_chart_cap_height(enum orl_chart_role role);

/* Returns true if a point can be drawn: its values are known, positive and plausible. */
bool orl_chart_shows(const struct orl_study_point *point);

/* Finds the curve of a technique: its points whose error is less than that of all faster ones,
 * by time. Returns their number. */
size_t orl_chart_technique_front(const struct orl_study *study, enum orl_technique technique,
                                 size_t *ret_index);
/* Finds the front over all techniques, by time. Returns the number of points. */
size_t orl_chart_front(const struct orl_study *study, size_t *ret_index);

/* Places the labels of points after axes, legend and title (label_placement.c). */
int orl_chart_place_labels(struct orl_chart *chart, const struct orl_study *study,
                           struct orl_error *err);

/* Adds a text. x: left, middle or right of its box, as align says. y: middle of its capitals. */
struct orl_chart_text *orl_chart_add(struct orl_chart *chart, enum orl_chart_role role,
                                     const char *text, double x, double y,
                                     enum orl_canvas_align align);

bool orl_box_overlaps(const struct orl_chart_box *a, const struct orl_chart_box *b);

#endif
