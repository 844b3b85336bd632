/*
 * Records why the daemon ended without a message. The record is a page of the data folder
 * (oriel.running). It outlives the process, since the kernel keeps what has been stored to it.
 *
 * Some signals end a process for a fault of its own. C++'s terminate is another such end: Embree
 * calls it when memory runs out where it cannot return an error. Their handlers store the job of
 * the faulting thread, and write two lines to the log: the job, and the place in the program.
 * SIGKILL, as from a kernel without memory, cannot be caught. It leaves the values that were stored
 * last: resident memory, number of running checks, and the kernel's count of processes killed for
 * lack of memory. They show that a restart of the machine, or a kill by another program, is no
 * job's fault.
 *
 * Threads: begin and end on any; the rest on the loop's. One daemon per process.
 */
#ifndef ORL_SERVER_HEALTH_CRASH_RECORD_H
#define ORL_SERVER_HEALTH_CRASH_RECORD_H

#include <signal.h>
#include <stdbool.h>
#include <stdint.h>

#include "health/kernel_facts.h"
#include "health/memory.h"
#include "store/rows/stored_jobs.h"

/* The end of the previous daemon. */
struct orl_previous_exit {
    int32_t signum;       /* 0: no signal was recorded; ORL_EXIT_STOPPED: no job is to blame */
    uint32_t checks;      /* checks of uploads that were running */
    char job[ORL_JOB_ID]; /* job of the faulting thread; "": no job */
    uint64_t resident, capacity;
    char boot[ORL_BOOT_ID]; /* kernel_facts.h; "": unknown */
    uint64_t oom_kills;     /* the machine's count when last recorded */
    bool rebooted, not_oom; /* since then: a reboot; no process killed for memory */
};

/* The signum of a daemon that was ended because it did not stop when asked to. */
#define ORL_EXIT_STOPPED SIGTERM

/* Returns how the previous daemon ended, and starts a new record. If the page cannot be mapped,
 * nothing is recorded for the next daemon. */
void orl_crash_record_open(const char *root, bool log_json, struct orl_previous_exit *ret_exit);
void orl_crash_record_close(void);

/* Records memory and the number of checks. Called when they change, and about every second. */
void orl_crash_record_update(const struct orl_memory *memory, uint32_t checks);

/* Attributes this thread's work to the job from now on. job is borrowed until
 * orl_crash_record_end_job. */
void orl_crash_record_begin_job(const char *job);
void orl_crash_record_end_job(void);

/* Records that the process ends by order, so no job is to blame. */
void orl_crash_record_mark_stopped(void);

/* Returns true if this job, which ran when the daemon ended, is to blame. is_named: the record
 * names it. alone: no other job ran. */
bool orl_previous_exit_caused_by(const struct orl_previous_exit *previous_exit, bool is_named,
                                 bool alone);

/* Calls C++'s std::set_terminate if the program has it. */
void orl_set_terminate_handler(void (*handler)(void));

#endif
