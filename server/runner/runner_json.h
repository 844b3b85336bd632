/* Where a job runs, as clients see it (Runner of api/openapi.yaml). */
#ifndef ORL_SERVER_RUNNER_RUNNER_JSON_H
#define ORL_SERVER_RUNNER_RUNNER_JSON_H

#include <jansson.h>
#include <stdbool.h>

#include "parts/sharing.h"

/* New references; NULL: out of memory. */
json_t *orl_parts_to_json(const struct orl_parts_count *count);
/* count: NULL where there are no parts. */
json_t *orl_runner_to_json(bool in_parts, const char *why, const struct orl_parts_count *count);

#endif
