/*
 * Progress on stderr: one line rewritten in place when it is a terminal, else a plain line when the
 * stage changes and every tenth of the way (never more often than that: logs stay short).
 * The caller says how far the job is; time is the caller's steady clock, in seconds.
 */
#ifndef ORL_CLIENT_PROGRESS_H
#define ORL_CLIENT_PROGRESS_H

#include <stdbool.h>
#include <stddef.h>

#include <oriel/eta.h>

struct orl_progress_line {
    bool terminal;
    double drawn_s;
    char stage[32];     /* last one shown */
    int tenth;          /* last one shown, -1 before the first */
    bool line_open;     /* something stands on the terminal's line */
    struct orl_eta eta; /* of a run of this process */
};

double orl_clock_s(void *unused); /* a steady clock */

void orl_progress_start(struct orl_progress_line *progress);

/* fraction of the whole job, 0..1; eta_s: seconds that it has left, NaN: not known. */
void orl_progress_show(struct orl_progress_line *progress, const char *stage, double fraction,
                       double eta_s);

/* The same of a run of this process, which tells what it thinks is left (oriel/run.h). */
void orl_progress_take(struct orl_progress_line *progress, const char *stage, double fraction,
                       double left_s);

/* A line of its own (a map found, a warning), above the bar. */
void orl_progress_note(struct orl_progress_line *progress, const char *format, ...)
    __attribute__((format(printf, 2, 3)));

/* Takes the bar away. */
void orl_progress_end(struct orl_progress_line *progress);

/* "8 s", "2:05", "1:02:05"; "?" when it cannot be said. */
void orl_format_duration(double seconds, char *ret_text, size_t size);
/* "950", "24.7 kB", "1.2 GB", and "2.0 M" for counts when unit is "". */
void orl_format_amount(double amount, const char *unit, char *ret_text, size_t size);

#endif
