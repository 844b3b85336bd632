/* Draws verdicts on targets, in two columns. */
#include "chart/page_text.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum {
    LEAST_LINES = 4,
    PARTS_APART = 10,
    INDENT = 16
}; /* a list with room for fewer lines is not begun */

static const char of_grid[] = "Targets", of_all[] = "Targets, all grids together";

static void draw_mark(const struct orl_page_canvas *s, double x, double y, enum orl_verdict verdict)
{
    static const unsigned char colors[4][3] = {
        {200, 60, 50}, {225, 160, 30}, {45, 140, 80}, {150, 150, 150}};
    orl_canvas_disc(s->canvas, x, y - ORL_PAGE_TEXT / 2.0, 5, colors[verdict]);
}

/* Draws a rule's name and its overall verdict, with that verdict's mark if brief. */
static void draw_rule(const struct orl_page_canvas *s, size_t i, bool brief,
                      const struct orl_page_column *at)
{
    const struct orl_annual_report *report = s->page->report;
    const struct orl_annual_verdict *v = report->verdicts;
    enum orl_verdict all = ORL_VERDICT_PASS;
    const double x = at->x + (brief ? INDENT : 0);
    char text[128];
    for (size_t k = 0; k < report->n_verdicts; k++)
        if (v[k].rule == v[i].rule && v[k].grid == v[i].grid)
            all = orl_verdict_combine(all, v[k].verdict);
    snprintf(text, sizeof text, "%s: %s", v[i].rule->name, orl_verdict_name(all));
    if (brief)
        draw_mark(s, at->x + 5, at->y, all);
    orl_page_draw_text_within(s, x, at->y, at->right - x, orl_page_ink, text);
}

/* name: text before the target. indent: of the mark. */
static void draw_verdict(const struct orl_page_canvas *s, const struct orl_annual_verdict *v,
                         const char *name, double indent, const struct orl_page_column *at)
{
    char value[120], text[320];
    const double from = at->x + INDENT + indent;
    orl_page_value_text(&v->area.value, orl_page_figure_unit(&v->target.figure), value,
                        sizeof value);
    draw_mark(s, at->x + 5 + indent, at->y, v->verdict);
    snprintf(text, sizeof text, "%s%s: %s", name, v->target.text, orl_verdict_name(v->verdict));
    orl_page_draw_text(s, at->right, at->y, ORL_CANVAS_RIGHT, ORL_PAGE_TEXT, orl_page_ink, value);
    orl_page_draw_text_within(s, from, at->y,
                              at->right - from - orl_canvas_text_width(value, ORL_PAGE_TEXT) - 8,
                              orl_page_ink, text);
}

/* Returns true if a rule has one target and both fit into one line. ret_name: the text before
 * the target. */
static bool fits_one_line(const struct orl_annual_report *report, size_t i,
                          const struct orl_page_column *at, char *ret_name, size_t size)
{
    const struct orl_annual_verdict *v = &report->verdicts[i];
    char value[120], text[320];
    size_t n = 0;
    for (size_t k = 0; k < report->n_verdicts; k++)
        n += report->verdicts[k].rule == v->rule && report->verdicts[k].grid == v->grid;
    orl_page_value_text(&v->area.value, orl_page_figure_unit(&v->target.figure), value,
                        sizeof value);
    snprintf(ret_name, size, "%s: ", v->rule->name);
    snprintf(text, sizeof text, "%s%s: %s", ret_name, v->target.text, orl_verdict_name(v->verdict));
    return n == 1 && INDENT + orl_canvas_text_width(text, ORL_PAGE_TEXT) + 8 +
                             orl_canvas_text_width(value, ORL_PAGE_TEXT) <=
                         at->right - at->x;
}

/* ---- One list -------------------------------------------------------------------------------- */

/* Verdicts of one grid, or of all grids together, in the report's order. */
struct verdict_list {
    size_t grid;
    const char *heading;
    bool brief;                         /* true: rules without their targets */
    bool begun;                         /* true if it has a heading */
    size_t next;                        /* index of the next verdict to draw */
    size_t n_left;                      /* number of verdicts not drawn yet */
    const struct orl_annual_rule *rule; /* rule of the last verdict drawn */
    const char *note;
    size_t n_noted; /* verdicts drawn that share note, which is not written yet */
};

static void skip_others(const struct orl_annual_report *report, struct verdict_list *verdict_list)
{
    while (verdict_list->next < report->n_verdicts &&
           report->verdicts[verdict_list->next].grid != verdict_list->grid)
        verdict_list->next++;
}

static struct verdict_list list_of(const struct orl_annual_report *report, size_t grid, bool brief)
{
    struct verdict_list verdict_list = {.grid = grid,
                                        .heading = grid == ORL_ALL_GRIDS ? of_all : of_grid};
    verdict_list.brief = brief;
    verdict_list.note = "";
    for (size_t i = 0; i < report->n_verdicts; i++)
        verdict_list.n_left += report->verdicts[i].grid == grid;
    skip_others(report, &verdict_list);
    return verdict_list;
}

/* Writes the note that the last verdicts share. */
static void put_note(const struct orl_page_canvas *s, struct verdict_list *verdict_list,
                     struct orl_page_column *column)
{
    const double x = column->x + INDENT + (verdict_list->rule ? 12 : 0);
    char text[ORL_VERDICT_NOTE + 32];
    if (verdict_list->n_noted == 0)
        return;
    if (verdict_list->n_noted == 1)
        snprintf(text, sizeof text, "%s", verdict_list->note);
    else
        snprintf(text, sizeof text, "these %zu: %s", verdict_list->n_noted, verdict_list->note);
    if (s->canvas)
        orl_page_draw_text_within(s, x, column->y, column->right - x, orl_page_gray, text);
    column->y += ORL_PAGE_LINE;
    verdict_list->n_noted = 0;
}

/* Draws a verdict with its rule's name before or above it. */
static void draw_one(const struct orl_page_canvas *s, const struct verdict_list *verdict_list,
                     const char *name, bool above, bool alone, struct orl_page_column at)
{
    const struct orl_annual_verdict *v = &s->page->report->verdicts[verdict_list->next];
    if (above)
        draw_rule(s, verdict_list->next, verdict_list->brief, &at);
    if (above)
        at.y += ORL_PAGE_LINE;
    if (!alone)
        draw_verdict(s, v, name, v->rule && !name[0] ? 12 : 0, &at);
}

/* Draws the next verdict. Returns false if there is no room for it and its note. Without
 * a canvas it only measures. */
static bool draw_next(const struct orl_page_canvas *s, struct verdict_list *verdict_list,
                      struct orl_page_column *column, double bottom)
{
    const struct orl_annual_report *report = s->page->report;
    const struct orl_annual_verdict *v = &report->verdicts[verdict_list->next];
    const bool named = v->rule && v->rule != verdict_list->rule,
               alone = verdict_list->brief && v->rule;
    char name[128] = "";
    const bool joined =
        named && !alone && fits_one_line(report, verdict_list->next, column, name, sizeof name);
    const bool above = named && !joined, noted = v->note[0] && !alone;
    if (!noted || strcmp(v->note, verdict_list->note) != 0)
        put_note(s, verdict_list, column);
    const int line = verdict_list->brief ? ORL_PAGE_FINE_LINE : ORL_PAGE_LINE;
    const int high = (above + !alone) * line;
    if (column->y + high - line + noted * ORL_PAGE_LINE > bottom)
        return false;
    if (s->canvas)
        draw_one(s, verdict_list, joined ? name : "", above, alone, *column);
    column->y += high;
    verdict_list->note = v->note;
    verdict_list->n_noted += noted;
    verdict_list->rule = v->rule;
    verdict_list->next++;
    verdict_list->n_left--;
    skip_others(report, verdict_list);
    return true;
}

/* Draws as much of a list as fits into the column, if a heading and LEAST_LINES lines fit. */
static void draw_list(const struct orl_page_canvas *s, struct verdict_list *verdict_list,
                      struct orl_page_column *column, double bottom)
{
    char text[64];
    if (verdict_list->n_left == 0 ||
        column->y + ORL_PAGE_HEADING + LEAST_LINES * ORL_PAGE_LINE > bottom)
        return;
    snprintf(text, sizeof text, "%s%s", verdict_list->heading,
             verdict_list->begun ? ", continued" : "");
    if (s->canvas)
        orl_page_draw_heading(s, column->x, column->y, column->right, text);
    column->y += ORL_PAGE_HEADING;
    verdict_list->begun = true;
    if (!verdict_list->brief)
        verdict_list->rule = NULL; /* repeats its name in this column */
    while (verdict_list->n_left > 0 && draw_next(s, verdict_list, column, bottom))
        ;
    put_note(s, verdict_list, column);
    column->y += PARTS_APART;
}

/* Returns the height in a column of a list's remaining verdicts, with their heading. */
static double measure_list(const struct orl_page_canvas *s, struct verdict_list verdict_list,
                           struct orl_page_column column)
{
    const struct orl_page_canvas measuring = {.page = s->page};
    column.y = 0;
    draw_list(&measuring, &verdict_list, &column, INFINITY);
    return column.y > 0 ? fmax(column.y, ORL_PAGE_HEADING + LEAST_LINES * ORL_PAGE_LINE) : 0;
}

/* ---- Both lists ------------------------------------------------------------------------------ */

struct verdict_lists {
    struct verdict_list own, all;
};

/* Draws both lists. Returns the number of verdicts without room. */
static size_t draw_lists(const struct orl_page_canvas *s, struct verdict_lists verdict_lists,
                         struct orl_page_column *left, struct orl_page_column *right, double bottom)
{
    left->y += PARTS_APART;
    draw_list(s, &verdict_lists.all, left, bottom);
    draw_list(s, &verdict_lists.own, right, bottom - measure_list(s, verdict_lists.all, *right));
    draw_list(s, &verdict_lists.all, right, bottom);
    draw_list(s, &verdict_lists.own, left, bottom);
    return verdict_lists.own.n_left + verdict_lists.all.n_left;
}

/* Chooses how rules are listed. If there is no room for all targets, the grid's rules are
 * listed without their targets. If that does not suffice, so are those of all grids. */
static struct verdict_lists choose_lists(const struct orl_page_canvas *s,
                                         const struct orl_page_column *left,
                                         const struct orl_page_column *right, double bottom)
{
    const struct orl_page_canvas measuring = {.page = s->page};
    struct verdict_lists verdict_lists = {.own.n_left = 0};
    for (int brief = 0; brief < 3; brief++) {
        struct orl_page_column columns[2] = {*left, *right};
        verdict_lists.own = list_of(s->page->report, s->page->grid, brief > 0);
        verdict_lists.all = list_of(s->page->report, ORL_ALL_GRIDS, brief > 1);
        if (draw_lists(&measuring, verdict_lists, &columns[0], &columns[1], bottom) == 0)
            break;
    }
    return verdict_lists;
}

/* Returns the least bottom that still has room for as many verdicts, to leave the rest to the
 * maps. */
static double level_columns(const struct orl_page_canvas *s, struct verdict_lists verdict_lists,
                            const struct orl_page_column *left, const struct orl_page_column *right,
                            double bottom)
{
    const struct orl_page_canvas measuring = {.page = s->page};
    struct orl_page_column columns[2];
    do {
        columns[0] = *left;
        columns[1] = *right;
        bottom -= ORL_PAGE_LINE;
    } while (bottom > left->y &&
             draw_lists(&measuring, verdict_lists, &columns[0], &columns[1], bottom) == 0);
    return bottom + ORL_PAGE_LINE;
}

static void put_rest(const struct orl_page_canvas *s, size_t n_left, bool brief,
                     struct orl_page_column *column)
{
    char text[64] = "values of the targets are in result.json";
    if (n_left > 0)
        snprintf(text, sizeof text, "and %zu more, in result.json", n_left);
    else if (!brief)
        return;
    orl_page_draw_text(s, column->x, column->y, ORL_CANVAS_LEFT, ORL_PAGE_TEXT, orl_page_gray,
                       text);
    column->y += ORL_PAGE_LINE;
}

static void put_none(const struct orl_page_canvas *s, struct orl_page_column *column)
{
    column->y = orl_page_draw_heading(s, column->x, column->y, column->right, of_grid);
    orl_page_draw_text(s, column->x, column->y, ORL_CANVAS_LEFT, ORL_PAGE_TEXT, orl_page_gray,
                       "no targets were given");
    column->y += ORL_PAGE_LINE;
}

void orl_page_draw_verdicts(const struct orl_page_canvas *s, struct orl_page_column *left,
                            struct orl_page_column *right, double bottom)
{
    bottom -= ORL_PAGE_LINE; /* room for the line about omitted verdicts */
    if (s->page->report->n_verdicts == 0)
        put_none(s, right);
    const struct verdict_lists verdict_lists = choose_lists(s, left, right, bottom);
    bottom = level_columns(s, verdict_lists, left, right, bottom);
    const size_t n_left = draw_lists(s, verdict_lists, left, right, bottom);
    put_rest(s, n_left, verdict_lists.own.brief, right);
}
