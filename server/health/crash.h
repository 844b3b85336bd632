/*
 * How the daemon ends, and what is recorded of it: the log lines of a crash (crash_report.c), the
 * record for the next start (crash_record.c), and the time limit on stopping (shutdown_timeout.c).
 */
#ifndef ORL_SERVER_HEALTH_CRASH_H
#define ORL_SERVER_HEALTH_CRASH_H

#include <signal.h>
#include <stdbool.h>
#include <stdint.h>

#include "health/machine_memory.h"
#include "store/rows/stored_jobs.h"

/*
 * The log lines of a daemon that crashes, written by the handler of a fatal signal:
 *
 *     level=error event=crashed signal=11 job=ID
 *     level=error event=crashed-request id=7 method=GET path=/v1/jobs/ID/result
 *     level=error event=crashed-registers code=1 address=0x0 pc=0x0 sp=0x7f.. caller=orield+0x123
 *     level=error event=crashed-at frames=orield+0x123,libc.so.6+0x456,...
 *
 * or the same as JSON objects. Frames are the calls from the innermost outwards, each as a module
 * and an offset, which addr2line takes. They end at a program counter outside all modules (a call
 * through a null pointer); `caller` then is the return address that the call left, and `pc` says
 * where it went. The stack may be what is broken, so the frames come last.
 *
 * Threads: open before threads start. A request is the calling thread's; the report is written by
 * the thread that the signal came to, and calls only what a signal handler may call.
 */

struct orl_crash {
    int signum;
    const char *job;       /* job of the faulting thread; "": none */
    const siginfo_t *info; /* NULL if the registers are unknown; context is then NULL too */
    const void *context;   /* ucontext_t */
};

void orl_crash_report_open(bool json);
void orl_crash_report_write(const struct orl_crash *crash);

/* Writes the first line alone, for ends that are not caused by a signal. */
void orl_crash_report_line(const char *event, int signum, const char *job);

/* Records the request that this thread serves. Borrows the strings until orl_crash_request_end. */
void orl_crash_request_begin(uint64_t id, const char *method, const char *path);
void orl_crash_request_end(void);

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

enum { ORL_BOOT_ID = 40 };

/* The end of the previous daemon. */
struct orl_previous_exit {
    int32_t signum;       /* 0: no signal was recorded; ORL_EXIT_STOPPED: no job is to blame */
    uint32_t checks;      /* checks of uploads that were running */
    char job[ORL_JOB_ID]; /* job of the faulting thread; "": no job */
    uint64_t resident, capacity;
    char boot[ORL_BOOT_ID]; /* id of the kernel's boot; "": unknown */
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

/*
 * A time limit on stopping: the process ends if it has not stopped ORL_SERVER_STOP_S after the time
 * that jobs have to finish. A thread may be blocked in the kernel (a file server that does not
 * answer), or run without polling for cancellation. Nothing is lost, as with SIGKILL: everything
 * that the daemon has acknowledged is on disk, and the next start queues running jobs again.
 *
 * A separate thread keeps the limit, which begins in the signal handler. So the limit also holds if
 * the event loop is blocked.
 *
 * Threads: open and close on the loop's; begin on any, and in signal handlers. One per process.
 */

/* Starts the thread. If no thread can be created, there is no limit. */
void orl_shutdown_timeout_open(void);
/* Cancels the limit. */
void orl_shutdown_timeout_close(void);

/* Call this for each signal that has a handler already: the first that arrives begins a limit of
 * drain_s + ORL_SERVER_STOP_S, a second one of ORL_SERVER_STOP_S. Later ones do not extend it. */
void orl_shutdown_timeout_watch(int signum, unsigned drain_s);

/* The process ends ORL_SERVER_STOP_S from now, or at the limit that has begun if that is earlier,
 * unless the limit is closed before. */
void orl_shutdown_timeout_start(void);

#endif
