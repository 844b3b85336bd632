/*
 * The threads of libuv's pool, made ready for what strangers send before the first of it comes.
 *
 * Threads: the loop thread only.
 */
#ifndef ORL_SERVER_PROCESS_POOL_H
#define ORL_SERVER_PROCESS_POOL_H

#include <uv.h>

/* The first works of all that are queued: one for each thread, which prepares it
 * (orl_prepare_thread). Without memory for that nothing is done: scenes are built all the same. */
void orl_pool_prepare(uv_loop_t *loop, unsigned n_threads);

#endif
