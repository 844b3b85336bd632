/*
 * Reports to the user: errors on stderr, and jobs, studies and verdicts as tables and lines.
 *
 * Errors are reported as "file:line: primitive: message (hint)", so that editors can jump
 * to the line. A daemon's problem document (RFC 9457) is reported in the same form.
 */
#ifndef ORL_CLIENT_OUTPUT_REPORTS_H
#define ORL_CLIENT_OUTPUT_REPORTS_H

#include <jansson.h>
#include <stddef.h>
#include <stdio.h>

#include <oriel/base/error.h>
#include <oriel/job/study.h>

/* Fills err from a reply that is not 2xx, also if its body is not a problem document. Returns
 * the code. */
int orl_report_reply_to_error(const char *body, size_t size, long status, struct orl_error *err);

/* Prints err to stderr. Returns ORL_EXIT_FAILED for convenience. */
int orl_report_error(const struct orl_error *err);

/* Prints a document on standard output, indented, with so many significant digits (0: all). Takes
 * ownership of it; NULL: ORL_ERR_NOMEM. */
int orl_print_json(json_t *json, size_t digits, struct orl_error *err);

/* Prints each text of the array to stderr as a warning. Takes ownership of it. */
void orl_print_warnings(json_t *warnings);

/* Prints "failed" with the reason from the job document's "error", if there is one. */
void orl_report_job_error(const json_t *job);

/* Prints jobs as a table, one per line, for `oriel status` without an id and `oriel watch`. jobs:
 * JobSummary of api/schema/status.yaml, or whole documents, which have the same members. Ids are
 * cut to their first eight digits, which all commands accept. */
void orl_print_jobs(const json_t *jobs);

/* Prints the table's heading, or one line. */
void orl_print_job_heading(void);
void orl_print_job(const json_t *job);

/* Prints a study as tables: its points, the fits, and notes on the reference. */
void orl_study_print(FILE *to, const struct orl_study *study);

/* Formats a point in short (study_json.h): "gather, 1.0 M photons, 256 samples: 1.2 s, rms 2.31
 * %". */
void orl_format_study_point(const json_t *point, char *ret_text, size_t size);

/*
 * Prints verdicts of a year, for `oriel annual`, `oriel status` and the end of `oriel wait`. A line
 * per verdict: "pass       LEED: sDA300/50 >= 55 % (desks): 61 [60, 62.5]: NOTE".
 * verdicts: "verdicts" of a year's result or of its job's document; NULL: none. In the latter,
 * the first are those of whole rules, without a value.
 */
void orl_print_verdicts(FILE *to, const json_t *verdicts);

#endif
