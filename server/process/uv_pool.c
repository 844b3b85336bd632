#include "process/uv_pool.h"

#include <pthread.h>
#include <stdlib.h>

#include <oriel/job/run.h>

#include "process/signal_stack.h"

struct preparing {
    pthread_barrier_t all; /* keeps a thread from taking two of the works */
    unsigned n_left;
    uv_work_t works[];
};

static void prepare_thread(uv_work_t *work)
{
    struct preparing *preparing = work->data;
    orl_signal_stack_install();
    orl_prepare_thread(NULL);
    pthread_barrier_wait(&preparing->all);
}

static void end_preparing(uv_work_t *work, int status)
{
    struct preparing *preparing = work->data;
    (void)status;
    if (--preparing->n_left > 0)
        return;
    pthread_barrier_destroy(&preparing->all);
    free(preparing);
}

void orl_uv_pool_prepare(uv_loop_t *loop, unsigned n_threads)
{
    struct preparing *preparing =
        calloc(1, sizeof *preparing + n_threads * sizeof *preparing->works);
    if (!preparing)
        return;
    pthread_barrier_init(&preparing->all, NULL, n_threads);
    preparing->n_left = n_threads;
    for (unsigned i = 0; i < n_threads; i++) {
        preparing->works[i].data = preparing;
        uv_queue_work(loop, &preparing->works[i], prepare_thread, end_preparing);
    }
}
