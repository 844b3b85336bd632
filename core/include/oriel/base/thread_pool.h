/*
 * Thread pool: threads lent by the caller that work on one parallel loop at a time.
 *
 * The core starts no threads of its own when it runs inside a daemon. The lead thread calls
 * orl_parallel_for, and any number of worker threads take part. A worker thread may join late or
 * not at all; the lead thread alone can finish every loop. Iterations are claimed one by one, so
 * the result of an iteration must depend on its index alone. This makes results independent of the
 * number of threads.
 *
 * Locks: one mutex inside; callbacks run with it released.
 */
#ifndef ORIEL_BASE_THREAD_POOL_H
#define ORIEL_BASE_THREAD_POOL_H

#include <stdatomic.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct orl_thread_pool;

/* Creates a pool of at most size threads, the lead thread included (size >= 1). NULL when out of
 * memory. */
struct orl_thread_pool *orl_thread_pool_new(uint32_t size);
/* Frees the pool after orl_thread_pool_dismiss, once every worker thread has returned. NULL is
 * allowed. */
void orl_thread_pool_free(struct orl_thread_pool *pool);

uint32_t orl_thread_pool_size(const struct orl_thread_pool *pool); /* NULL pool: 1 */

/* Works on loops until orl_thread_pool_dismiss. `member` is the index of the calling worker thread,
 * 1..size-1. */
void orl_thread_pool_work(struct orl_thread_pool *pool, uint32_t member);
/* Makes the worker threads return; called by the lead thread, once. */
void orl_thread_pool_dismiss(struct orl_thread_pool *pool);

/* Loop body, body(arg, index, member); member is the thread's index, 0..size-1, and selects its
 * scratch. */
typedef void (*orl_loop_body)(void *arg, size_t index, uint32_t member);

/* Runs body for every index in [0, count); returns when all are done. Lead thread only. Without a
 * pool (NULL) the calling thread does all. */
void orl_parallel_for(struct orl_thread_pool *pool, size_t count, orl_loop_body body, void *arg);

/* Returns true if *cancel is set; NULL: false. */
bool orl_is_cancelled(const atomic_bool *cancel);

/* Sets the flag that orl_parallel_try polls. Any thread may set *cancel; NULL: no flag. Lead thread
 * only. */
void orl_thread_pool_set_cancel(struct orl_thread_pool *pool, const atomic_bool *cancel);
bool orl_thread_pool_cancelled(const struct orl_thread_pool *pool);
/*
 * Same as orl_parallel_for, but stops early once the flag of orl_thread_pool_set_cancel is set.
 * Then it skips the remaining iterations and returns ORL_ERR_CANCELLED; else 0. Without a pool
 * (NULL) it polls nothing.
 */
int orl_parallel_try(struct orl_thread_pool *pool, size_t count, orl_loop_body body, void *arg);

/* Starts a pool with size-1 POSIX threads that work in it, for programs without a thread pool. */
struct orl_thread_pool *orl_thread_pool_start(uint32_t size);
/* Dismisses, joins and frees a pool of orl_thread_pool_start. NULL is allowed. */
void orl_thread_pool_stop(struct orl_thread_pool *pool);

#endif
