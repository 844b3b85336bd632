/*
 * Facts about a cluster for the Slurm runner: the largest time and memory for a part, and the
 * limit that an ended part exceeded.
 */
#ifndef ORL_DISTRIBUTED_SLURM_LIMITS_H
#define ORL_DISTRIBUTED_SLURM_LIMITS_H

#include <stdbool.h>

#include "distributed/runner.h"

struct orl_slurm_bounds {
    bool known;
    struct orl_part_limits most; /* 0: no limit is requested */
};

/*
 * Gets the bounds from sinfo, for the partition in the options or else the default one. A bound
 * is 0 if the options set that limit or the cluster does not report its memory. If Slurm does
 * not answer, bounds stay unknown.
 */
void orl_slurm_bounds_query(const struct orl_runner_spec *spec, struct orl_slurm_bounds *bounds);

/* Returns limits reduced to the bounds. */
struct orl_part_limits orl_slurm_bounded(const struct orl_slurm_bounds *bounds,
                                         struct orl_part_limits limits);

/* Returns true if sbatch's output means a temporary failure, so that a retry may succeed. */
bool orl_slurm_is_temporary_failure(const char *output);

/* Returns why a task of that name ended: from its log, and from squeue while that still lists
 * it. */
enum orl_part_end orl_slurm_end_reason(const struct orl_runner_spec *spec, const char *tasks,
                                       uint32_t task, uint32_t number);

#endif
