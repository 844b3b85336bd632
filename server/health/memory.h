/*
 * Memory: what there is for the daemon and its children, what is promised of it, and to whom.
 *
 * What there is: --memory; else nine tenths of what the control group allows (version 2 and 1, the
 * groups above among them), or what the machine had available at the start, whichever is less. What
 * is held: the daemon's own resident memory, or what jobs that run are estimated to take
 * (job_memory.h) beside what was resident when none ran, whichever is more; and what checks have
 * been granted. What does not fit now waits; what never can is refused.
 *
 * Estimates of jobs are no bounds: nothing ends a job that takes more. Grants of checks are.
 * Threads: the loop thread only.
 */
#ifndef ORL_SERVER_HEALTH_MEMORY_H
#define ORL_SERVER_HEALTH_MEMORY_H

#include <stdbool.h>
#include <stdint.h>

struct orl_memory {
    uint64_t capacity;
    uint64_t idle;   /* resident when no job ran */
    uint64_t jobs;   /* promised to those that run */
    uint64_t checks; /* granted */
    uint64_t wanted; /* by the job that is next and waits for it */
};

/* bytes: as configured; 0: what the system says. */
void orl_memory_open(struct orl_memory *memory, uint64_t bytes);

/* Of the process itself: what nobody else has a copy of, neither files nor the kernel. */
uint64_t orl_memory_resident(void);

/* Not held now. */
uint64_t orl_memory_free(const struct orl_memory *memory);
/* What a job may be estimated at, at most, and a check granted. */
uint64_t orl_memory_most(const struct orl_memory *memory);

void orl_memory_promise(struct orl_memory *memory, uint64_t bytes);
void orl_memory_take_back(struct orl_memory *memory, uint64_t bytes);

/*
 * What the control groups of a process allow, by the text of its /proc/PID/cgroup and where they
 * are mounted ("/sys/fs/cgroup"); UINT64_MAX: all there is.
 */
uint64_t orl_memory_of_groups(const char *groups, const char *mount);

#endif
