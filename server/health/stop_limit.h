/*
 * The last resort of a stop: the process ends when it has not stopped ORL_SERVER_STOP_S after the
 * time that jobs have to finish. A thread may be blocked in the kernel (a file server that does not
 * answer), or run without polling for cancellation. Nothing is lost: what the daemon has answered
 * for is on the disk, as for SIGKILL, and jobs that ran are queued again by the next start.
 *
 * The limit is kept by a thread of its own, and begins in the handler of the signal, so that it
 * holds for an event loop that is blocked itself.
 *
 * Threads: open and close on the loop's; begin on any, and in signal handlers. One a process.
 */
#ifndef ORL_SERVER_HEALTH_STOP_LIMIT_H
#define ORL_SERVER_HEALTH_STOP_LIMIT_H

/* Without a thread to be had there is no limit. */
void orl_stop_limit_open(void);
/* Cancels the limit. */
void orl_stop_limit_close(void);

/* Call this for each signal that has a handler already: the first that arrives begins a limit of
 * drain_s + ORL_SERVER_STOP_S, a second one of ORL_SERVER_STOP_S. Later ones do not extend it. */
void orl_stop_limit_heed(int signum, unsigned drain_s);

/* The process ends ORL_SERVER_STOP_S from now, or at the limit that has begun if that is earlier,
 * unless the limit is closed before. */
void orl_stop_limit_begin(void);

#endif
