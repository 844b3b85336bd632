/*
 * Who is to blame when the daemon ends without a word: a page of the data folder (oriel.running)
 * that outlives the process, since the kernel keeps what has been stored to it.
 *
 * Signals that end a process for a fault of its own (and C++'s terminate, which is where Embree
 * ends up when there is no memory in a place that cannot say so) leave the job there whose thread
 * it was, and two lines in the log: whose, and where in the program. What cannot be caught
 * (SIGKILL, as from a kernel without memory) leaves what was stored last: how much memory was
 * resident, how many checks were under way, and how many processes the kernel had killed for want
 * of memory, so that a restart of the machine, or a kill by somebody else, is no job's fault.
 *
 * Threads: begin and end on any; the rest on the loop's. One daemon a process.
 */
#ifndef ORL_SERVER_HEALTH_BLAME_H
#define ORL_SERVER_HEALTH_BLAME_H

#include <signal.h>
#include <stdbool.h>
#include <stdint.h>

#include "health/machine.h"
#include "health/memory.h"
#include "store/jobs.h"

/* How the daemon before ended. */
struct orl_past {
    int32_t signum;       /* 0: no signal was recorded; ORL_PAST_STOPPED: no job is to blame */
    uint32_t checks;      /* of uploads, under way */
    char job[ORL_JOB_ID]; /* whose thread it was; "": none's */
    uint64_t resident, capacity;
    char boot[ORL_BOOT_ID]; /* machine.h; "": not known */
    uint64_t oom_kills;     /* of the machine, when that was noted last */
    bool rebooted, not_oom; /* since then: another boot; the kernel has killed none for memory */
};

/* The signum of a daemon that was told to stop, and was ended since it did not. */
#define ORL_PAST_STOPPED SIGTERM

/* Says how the last one ended, and begins anew. Without a page nothing is told to the next. */
void orl_blame_open(const char *root, bool log_json, struct orl_past *ret_past);
void orl_blame_close(void);

/* How things stand; to be called when that changes, and every second or so. */
void orl_blame_note(const struct orl_memory *memory, uint32_t checks);

/* What this thread does from now on is the job's; job is borrowed until the end. */
void orl_blame_begin(const char *job);
void orl_blame_end(void);

/* The process ends by order: no job is to blame. */
void orl_blame_excuse(void);

/* Of jobs that ran when the daemon ended: was it this one? alone: no other ran. */
bool orl_blame_is(const struct orl_past *past, bool is_named, bool alone);

/* C++'s std::set_terminate, where the program has it. */
void orl_heed_terminate(void (*handler)(void));

#endif
