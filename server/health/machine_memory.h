/*
 * The memory account of the daemon and its children: capacity, and the amounts promised to jobs and
 * checks.
 *
 * The capacity is --memory. The default is the smaller of two amounts: nine tenths of the control
 * group's limit (version 2 and 1, including the groups above), and the memory available at the
 * start. Memory in use is the grants of checks plus the larger of two amounts. One is the daemon's
 * own resident memory. The other is the estimates of running jobs (job_estimate.h) plus what was
 * resident when none ran. Work that does not fit now waits; work that can never fit is refused.
 *
 * Estimates of jobs are no bounds: a job that takes more is not ended. Grants of checks are bounds.
 * Threads: the loop thread only.
 */
#ifndef ORL_SERVER_HEALTH_MACHINE_MEMORY_H
#define ORL_SERVER_HEALTH_MACHINE_MEMORY_H

#include <stdbool.h>
#include <stdint.h>

struct orl_memory {
    uint64_t capacity;
    uint64_t idle;   /* resident when no job ran, bytes */
    uint64_t jobs;   /* promised to running jobs */
    uint64_t checks; /* granted to running checks */
    uint64_t wanted; /* needed by the next job, which waits for it */
};

/* bytes: the configured capacity; 0: ask the system. */
void orl_memory_open(struct orl_memory *memory, uint64_t bytes);

/* Returns the resident bytes of the process that are its own: pages of files and the kernel do not
 * count. */
uint64_t orl_memory_resident(void);

/* Returns the capacity not in use now, bytes. */
uint64_t orl_memory_available(const struct orl_memory *memory);
/* Returns the largest allowed estimate of a job, and grant of a check, in bytes. */
uint64_t orl_memory_limit(const struct orl_memory *memory);

void orl_memory_reserve(struct orl_memory *memory, uint64_t bytes);
void orl_memory_release(struct orl_memory *memory, uint64_t bytes);

/*
 * Returns the memory limit of a process's control groups, in bytes. groups: text of its
 * /proc/PID/cgroup. mount: where they are mounted ("/sys/fs/cgroup"). UINT64_MAX: no limit.
 */
uint64_t orl_memory_cgroup_limit(const char *groups, const char *mount);

#endif
