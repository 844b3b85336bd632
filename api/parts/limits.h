/*
 * What Slurm is to hold a part to (runner.h): memory and time by what its pieces are thought to
 * take, with a margin for what an estimate does not know: scenes and machines differ by factors. A
 * part that comes up against a limit is tried again with twice as much (wave.c).
 */
#ifndef ORL_PARTS_LIMITS_H
#define ORL_PARTS_LIMITS_H

#include <stdint.h>

#include "parts/runner.h"

/* Of a part: of its pieces the sum, and the most. */
struct orl_part_needs {
    double core_s;  /* of one core; 0: not known */
    uint64_t bytes; /* of memory beside the job itself */
};

/* What its job tells. */
struct orl_limit_basis {
    double load_s;         /* that the lead took until it came to pieces: a part takes as long */
    double pace;           /* seconds of parts that have ended, over what was foreseen of them */
    uint32_t threads;      /* of a part */
    uint64_t memory_bytes; /* of the whole job, pieces included; 0: not known, and taken to be what
                              this process has in memory, and the pieces beside it */
};

enum { ORL_PART_LEAST_MINUTES = 10, ORL_PART_LEAST_MIB = 256 };

struct orl_part_limits orl_part_limits(const struct orl_part_needs *needs,
                                       const struct orl_limit_basis *basis);

/* Twice those that it has come up against. */
struct orl_part_limits orl_part_limits_raised(struct orl_part_limits limits, enum orl_part_end end);

#endif
