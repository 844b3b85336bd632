/*
 * Progress on stderr. On a terminal one line is rewritten in place. Otherwise a line is printed
 * when the stage changes and at every tenth, so that logs stay short. The caller gives the
 * job's fraction done. Times are in seconds of a monotonic clock.
 */
#ifndef ORL_CLIENT_OUTPUT_PROGRESS_H
#define ORL_CLIENT_OUTPUT_PROGRESS_H

#include <stdbool.h>
#include <stddef.h>

#include <oriel/base/eta.h>

struct orl_progress_line {
    bool terminal;
    double drawn_s;
    char stage[32];     /* last stage shown */
    int tenth;          /* last tenth shown; -1 before the first */
    bool line_open;     /* true if the terminal's current line has text */
    struct orl_eta eta; /* estimate for a run in this process */
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

/* Removes the bar. */
void orl_progress_end(struct orl_progress_line *progress);

/* Formats "8 s", "2:05" or "1:02:05"; "?" if unknown. */
void orl_format_duration(double seconds, char *ret_text, size_t size);
/* Formats "950", "24.7 kB" or "1.2 GB", and "2.0 M" for counts if unit is "". */
void orl_format_amount(double amount, const char *unit, char *ret_text, size_t size);

#endif
