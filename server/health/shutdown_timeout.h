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
#ifndef ORL_SERVER_HEALTH_SHUTDOWN_TIMEOUT_H
#define ORL_SERVER_HEALTH_SHUTDOWN_TIMEOUT_H

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
