/* Where jobs run: the configuration of Slurm, and the JSON that reports where a job runs. */
#ifndef ORL_SERVER_RUNNER_RUNNER_H
#define ORL_SERVER_RUNNER_RUNNER_H

#include <jansson.h>
#include <stdbool.h>

#include "distributed/distributed_job.h"
#include "process/config.h"
#include "store/files/folders.h"

/*
 * The shared folder of jobs in parts (distributed/distributed_job.h), and the command that submits
 * their tasks to Slurm. These are the daemon's options (process/config.h), checked once at its
 * start.
 *
 * A job's folder is below the shared one, by its id. Only the daemon's user has access to the
 * shared folder, since it holds uploads of other users.
 */

enum { ORL_SLURM_ARG_BYTES = 256 };

/* Must not move once it is open: words point into it. */
struct orl_slurm_config {
    char folder[ORL_PATH_MAX], program[ORL_PATH_MAX]; /* program: the path of oriel */
    char named[ORL_RUNNER_NAMED][ORL_SLURM_ARG_BYTES];
    const char *words[ORL_RUNNER_NAMED + ORL_RUNNER_WORDS]; /* some are borrowed from the options */
    size_t n_words;
    uint32_t parts, part_threads, least_s;
};

/* Makes the shared folder if it does not exist. */
int orl_slurm_config_open(const struct orl_runner_options *options,
                          struct orl_slurm_config *ret_slurm, struct orl_error *err);

/* JSON for where a job runs (Runner of api/schema/status.yaml). */

/* Both return new references; NULL: out of memory. */
json_t *orl_parts_to_json(const struct orl_parts_count *count);
/* count: NULL if the job is not split into parts. */
json_t *orl_runner_to_json(bool in_parts, const char *why, const struct orl_parts_count *count);

#endif
