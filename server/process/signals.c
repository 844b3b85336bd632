#include "process/signals.h"

#include <pthread.h>
#include <signal.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdlib.h>

#include <oriel/job/run.h>

#include "process/limits.h"

/* ---- The stack for handlers of fatal signals ------------------------------------------------- */

/* Space for a signal frame with all vector registers (up to 11 kB) and for unwinding. */
static _Thread_local _Alignas(16) char stack[32 << 10];
static _Thread_local bool installed;

void orl_signal_stack_install(void)
{
    const stack_t other = {.ss_sp = stack, .ss_size = sizeof stack};
    if (!ORL_SANITIZED && !installed)
        installed = sigaltstack(&other, NULL) == 0;
}

/* ---- The pool's threads ---------------------------------------------------------------------- */

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

enum { SIGNALS = 3 };

/* ---- Signals on the loop --------------------------------------------------------------------- */

/* The handled signals. The table is global since a handler's only argument is the signal number. */
static struct handled {
    atomic_int signum; /* 0: this entry is free. Atomic: any thread may run a handler */
    uv_async_t arrival;
    atomic_uint arrived; /* signals whose callback has not run yet */
    orl_signal_cb on_signal;
    void *ctx;
} table[SIGNALS];

static void record_signal(int signum)
{
    for (int i = 0; i < SIGNALS; i++)
        if (atomic_load(&table[i].signum) == signum) {
            atomic_fetch_add(&table[i].arrived, 1);
            uv_async_send(&table[i].arrival); /* async-signal-safe */
        }
}

static void on_arrival(uv_async_t *arrival)
{
    struct handled *handled = arrival->data;
    for (unsigned n = atomic_exchange(&handled->arrived, 0); n > 0; n--)
        handled->on_signal(atomic_load(&handled->signum), handled->ctx);
}

static void set_handler(int signum, void (*handler)(int signum))
{
    struct sigaction action = {.sa_handler = handler, .sa_flags = SA_RESTART};
    sigemptyset(&action.sa_mask);
    sigaction(signum, &action, NULL);
}

void orl_signal_ignore(int signum)
{
    set_handler(signum, SIG_IGN);
}

int orl_signal_handle(uv_loop_t *loop, int signum, orl_signal_cb on_signal, void *ctx)
{
    int i = 0;
    while (i < SIGNALS && atomic_load(&table[i].signum) != 0)
        i++;
    if (i == SIGNALS)
        return UV_ENOBUFS;
    const int rc = uv_async_init(loop, &table[i].arrival, on_arrival);
    if (rc)
        return rc;
    table[i].on_signal = on_signal;
    table[i].ctx = ctx;
    table[i].arrival.data = &table[i];
    atomic_store(&table[i].signum, signum);
    set_handler(signum, record_signal);
    return 0;
}

void orl_signals_stop(void)
{
    for (int i = 0; i < SIGNALS; i++) {
        const int signum = atomic_exchange(&table[i].signum, 0);
        if (signum == 0)
            continue;
        orl_signal_ignore(signum);
        uv_close((uv_handle_t *)&table[i].arrival, NULL);
    }
}
