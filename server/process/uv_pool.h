/*
 * Prepares the threads of libuv's pool before they read the first untrusted data.
 *
 * Threads: the loop thread only.
 */
#ifndef ORL_SERVER_PROCESS_UV_POOL_H
#define ORL_SERVER_PROCESS_UV_POOL_H

#include <uv.h>

/* Queues one work for each thread, which prepares it (orl_prepare_thread). Call it before any other
 * work is queued. Without memory it does nothing; scenes can be built all the same. */
void orl_uv_pool_prepare(uv_loop_t *loop, unsigned n_threads);

#endif
