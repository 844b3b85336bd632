/* JSON for where a job runs (Runner of api/openapi.yaml). */
#ifndef ORL_SERVER_RUNNER_RUNNER_JSON_H
#define ORL_SERVER_RUNNER_RUNNER_JSON_H

#include <jansson.h>
#include <stdbool.h>

#include "distributed/distributed_job.h"

/* Both return new references; NULL: out of memory. */
json_t *orl_parts_to_json(const struct orl_parts_count *count);
/* count: NULL if the job is not split into parts. */
json_t *orl_runner_to_json(bool in_parts, const char *why, const struct orl_parts_count *count);

#endif
