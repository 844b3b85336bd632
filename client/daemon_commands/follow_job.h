/*
 * Follows a job on the daemon: polls its document and shows progress, the origin of each photon
 * map, each warning, and the outcome. Used by `oriel wait` and `oriel submit --wait`.
 */
#ifndef ORL_CLIENT_DAEMON_COMMANDS_FOLLOW_JOB_H
#define ORL_CLIENT_DAEMON_COMMANDS_FOLLOW_JOB_H

#include <stdbool.h>

#include <jansson.h>

#include "http/http_client.h"
#include "options/command.h"

/* A command that uses a daemon. All zero at first. */
struct orl_daemon_command {
    const char *server; /* value of --server; NULL: absent */
    struct orl_operands operands;
    struct orl_http http;
    struct orl_error err;
};
/* Opens the connection. */
int orl_daemon_open(struct orl_daemon_command *command);
/* Closes it, and reports the error if rc is not 0. Returns an exit code. */
int orl_daemon_end(struct orl_daemon_command *command, int rc);

/* Follows the job until it ends. Returns an exit code; errors are already reported. */
int orl_follow_job(struct orl_http *http, const char *id);

/* Waits silently until the job has ended. *ret_job: its last document, owned by the caller. */
int orl_await_job(struct orl_http *http, const char *id, json_t **ret_job, struct orl_error *err);
bool orl_job_has_ended(const json_t *job);

/* Formats a map: "global map: found in the cache (2.0 M photons), 12.3 s saved", or the cost of
 * building it. */
void orl_format_map(const json_t *map, char *ret_text, size_t size);

/* Makes the path "/v1/jobs/ID" followed by rest; the id is escaped. */
int orl_job_path(const char *id, const char *rest, char *ret_path, size_t size,
                 struct orl_error *err);

#endif
