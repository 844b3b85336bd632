/*
 * What a cluster says of itself, for the runner of Slurm: how much of time and memory a part may be
 * given at the most, and what a part that is gone has come up against.
 */
#ifndef ORL_PARTS_SLURM_FACTS_H
#define ORL_PARTS_SLURM_FACTS_H

#include <stdbool.h>

#include "parts/runner.h"

struct orl_slurm_bounds {
    bool known;
    struct orl_part_limits most; /* 0: parts are given no such limit */
};

/*
 * By sinfo: of the partition that the options name, or of the usual one. What the options set
 * themselves, and memory that the cluster does not tell of, parts are given no limit of. Where
 * Slurm does not answer nothing is known yet.
 */
void orl_slurm_bounds_ask(const struct orl_runner_spec *spec, struct orl_slurm_bounds *bounds);

/* No more than that. */
struct orl_part_limits orl_slurm_bounded(const struct orl_slurm_bounds *bounds,
                                         struct orl_part_limits limits);

/* Whether another try may go better than the sbatch that said that. */
bool orl_slurm_is_passing(const char *output);

/* Of a task of that name that is gone: by what Slurm has written into its log, and by squeue, as
 * long as that tells of it. */
enum orl_part_end orl_slurm_end(const struct orl_runner_spec *spec, const char *tasks,
                                uint32_t task, uint32_t number);

#endif
