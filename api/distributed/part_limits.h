/*
 * Limits of memory and time for a part under Slurm (runner.h). They are the estimate for its
 * tasks, with a margin because scenes and machines differ by factors. A part that exceeds a
 * limit is tried again with twice as much (task_round.c).
 */
#ifndef ORL_DISTRIBUTED_PART_LIMITS_H
#define ORL_DISTRIBUTED_PART_LIMITS_H

#include <stdint.h>

#include "distributed/runner.h"

/* Estimated needs of a part: time is the sum over its tasks, memory the maximum. */
struct orl_part_needs {
    double core_s;  /* seconds on one core; 0: unknown */
    uint64_t bytes; /* memory in addition to the job's own */
};

/* Facts about the job. */
struct orl_part_limits_input {
    double load_s;         /* seconds that the lead process needed to load; a part takes as long */
    double time_ratio;     /* actual over estimated seconds of ended parts */
    uint32_t threads;      /* threads per part */
    uint64_t memory_bytes; /* memory of the whole job with its tasks; 0: unknown, estimated as this
                              process's memory plus the tasks */
};

enum { ORL_PART_LEAST_MINUTES = 10, ORL_PART_LEAST_MIB = 256 };

struct orl_part_limits orl_part_limits(const struct orl_part_needs *needs,
                                       const struct orl_part_limits_input *input);

/* Returns the limits with the exceeded one doubled. */
struct orl_part_limits orl_part_limits_raised(struct orl_part_limits limits, enum orl_part_end end);

#endif
