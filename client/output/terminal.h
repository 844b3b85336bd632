/*
 * Text for a terminal: progress, wrapped lines, and plans as tables.
 *
 * Progress goes to stderr. On a terminal one line is rewritten in place: a bar as wide as the
 * window allows, the stage, the percentage, the remaining time and the rate. Otherwise, also on
 * terminals without escape codes (output/style.h), a line is printed when the stage changes and at
 * every tenth, so that logs stay short. The caller gives the job's fraction done. Times are in
 * seconds of a monotonic clock.
 */
#ifndef ORL_CLIENT_OUTPUT_TERMINAL_H
#define ORL_CLIENT_OUTPUT_TERMINAL_H

#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

#include <oriel/base/eta.h>
#include <oriel/job/plan.h>
#include <oriel/job/run.h>

struct orl_progress_line {
    bool terminal; /* true: one line is rewritten */
    double drawn_s;
    char stage[32];                /* last stage shown */
    int tenth;                     /* last tenth shown; -1 before the first */
    bool line_open;                /* true if the terminal's current line has text */
    double rate_from_s, rate_from; /* begin of the rate's interval: time (-1: none), fraction */
    double rate;                   /* percent per second; 0: not known */
    struct orl_eta eta;            /* estimate for a run in this process */
};

double orl_clock_s(void *unused); /* monotonic clock, seconds */

void orl_progress_start(struct orl_progress_line *progress);

/* Shows progress. fraction: of the whole job, 0..1; eta_s: estimated seconds left, NaN if
 * unknown. */
void orl_progress_show(struct orl_progress_line *progress, const char *stage, double fraction,
                       double eta_s);

/* Shows progress of a run in this process. left_s: its own estimate of the seconds left
 * (oriel/job/run.h). */
void orl_progress_show_local(struct orl_progress_line *progress, const char *stage, double fraction,
                             double left_s);

/* Prints a line of its own, such as a warning, above the bar. */
void orl_progress_note(struct orl_progress_line *progress, const char *format, ...)
    __attribute__((format(printf, 2, 3)));

/* Prints a warning likewise. */
void orl_progress_warn(struct orl_progress_line *progress, const char *warning);

/* Removes the bar. */
void orl_progress_end(struct orl_progress_line *progress);

/* Formats "8 s", "2:05" or "1:02:05"; "?" if unknown. */
void orl_format_duration(double seconds, char *ret_text, size_t size);
/* Formats "950", "24.7 kB" or "1.2 GB", and "2.0 M" for counts if unit is "". */
void orl_format_amount(double amount, const char *unit, char *ret_text, size_t size);

/* Widths of wrapped lines: of plans, and of help. */
enum { ORL_WRAP_COLUMNS = 100, ORL_HELP_COLUMNS = 80 };

/*
 * Prints text (UTF-8) and a newline, from the line's column on, in lines of at most `width`
 * columns; further lines are indented. Words longer than a line are cut; control characters, which
 * could move the cursor, become '?'.
 */
void orl_print_wrapped(FILE *to, int width, int column, int indent, const char *text);

/*
 * Prints a plan: as a table for `oriel plan`, or in one line. Lines of the table have at most
 * ORL_WRAP_COLUMNS columns.
 */

/* Prints the technique and its reason, a row per effect, and the total saving by effects left
 * out. */
void orl_plan_print(FILE *to, const struct orl_plan *plan);

/* Prints the estimated time for each accuracy, one per line, or why it is unknown. */
void orl_curve_print(FILE *to, const struct orl_accuracy_curve *curve);

/* Formats a plan in one line: "gather; 7 of 17 effects left out". */
void orl_format_plan(const struct orl_plan *plan, char *ret_text, size_t size);

#endif
