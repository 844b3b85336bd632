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
#ifndef ORL_SERVER_HEALTH_CRASH_REPORT_H
#define ORL_SERVER_HEALTH_CRASH_REPORT_H

#include <signal.h>
#include <stdbool.h>
#include <stdint.h>

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

#endif
