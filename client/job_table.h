/* Jobs as a table, a line each, as schedulers list them: `oriel status` without an id, `oriel
 * watch`.
 */
#ifndef ORL_CLIENT_JOB_TABLE_H
#define ORL_CLIENT_JOB_TABLE_H

#include <jansson.h>

/* jobs: JobSummary of api/openapi.yaml, or whole documents, which have the same members. Ids are
 * cut to their first eight digits, which all commands take. */
void orl_print_jobs(const json_t *jobs);

/* Its heading, and a line. */
void orl_print_job_heading(void);
void orl_print_job(const json_t *job);

#endif
