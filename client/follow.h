/*
 * Following a job of the daemon's: polls its document, shows progress, says how each photon map
 * was come by, each warning, and how the job ended. `oriel wait` and `oriel submit --wait`.
 */
#ifndef ORL_CLIENT_FOLLOW_H
#define ORL_CLIENT_FOLLOW_H

#include <stdbool.h>

#include <jansson.h>

#include "http.h"

/* Returns an exit code; errors are reported already. */
int orl_follow_job(struct orl_http *http, const char *id);

/* Waits without a word until the job has ended; its last document is the caller's. */
int orl_await_job(struct orl_http *http, const char *id, json_t **ret_job, struct orl_error *err);
bool orl_job_has_ended(const json_t *job);

/* "global map: found in the cache (2.0 M photons), 12.3 s saved", or what building it took. */
void orl_format_map(const json_t *map, char *ret_text, size_t size);

/* "/v1/jobs/ID" and what follows, escaped. */
int orl_job_path(const char *id, const char *rest, char *ret_path, size_t size,
                 struct orl_error *err);

#endif
