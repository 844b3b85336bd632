/* Prints jobs as a table, one per line, for `oriel status` without an id and `oriel watch`. */
#ifndef ORL_CLIENT_OUTPUT_JOB_TABLE_H
#define ORL_CLIENT_OUTPUT_JOB_TABLE_H

#include <jansson.h>

/* jobs: JobSummary of api/openapi.yaml, or whole documents, which have the same members. Ids
 * are cut to their first eight digits, which all commands accept. */
void orl_print_jobs(const json_t *jobs);

/* Prints the table's heading, or one line. */
void orl_print_job_heading(void);
void orl_print_job(const json_t *job);

#endif
