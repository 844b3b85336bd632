/*
 * Signals: callbacks on the event loop, a stack for the handlers of fatal signals, and the
 * preparation of the pool's threads.
 */
#ifndef ORL_SERVER_PROCESS_SIGNALS_H
#define ORL_SERVER_PROCESS_SIGNALS_H

#include <uv.h>

/*
 * Signals as callbacks on the event loop: SIGTERM, SIGINT, SIGHUP. Unlike libuv's signal handles,
 * these never restore a signal's default effect: once a signal has been handled, it is ignored
 * until the process exits. Otherwise a signal during the cleanup would end the process before the
 * database is closed.
 *
 * Threads: the loop's. One loop per process.
 */

typedef void (*orl_signal_cb)(int signum, void *ctx);

void orl_signal_ignore(int signum);

/* Calls on_signal on the loop, once for each signal that arrived. Returns 0 or libuv's error. */
int orl_signal_handle(uv_loop_t *loop, int signum, orl_signal_cb on_signal, void *ctx);

/* From now on ignores all handled signals, and closes their handles. */
void orl_signals_stop(void);

/*
 * A separate stack for the handler of fatal signals, so that a stack overflow can be reported.
 *
 * Threads: each thread that the daemon starts, or runs work on, calls this once for itself; further
 * calls do nothing. Sanitized builds keep the sanitizer's own stack.
 */

void orl_signal_stack_install(void);

/*
 * Prepares the threads of libuv's pool before they read the first untrusted data.
 *
 * Threads: the loop thread only.
 */

/* Queues one work for each thread, which prepares it (orl_prepare_thread). Call it before any other
 * work is queued. Without memory it does nothing; scenes can be built all the same. */
void orl_uv_pool_prepare(uv_loop_t *loop, unsigned n_threads);

#endif
