#include "health/crash.h"

#include <errno.h>
#include <pthread.h>
#include <semaphore.h>
#include <signal.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <time.h>
#include <unistd.h>

#include "process/limits.h"

enum { SIGNALS = 65 };

static struct {
    sem_t changed; /* sem_post may be called in a signal handler; conditions may not */
    pthread_t thread;
    bool started;
    atomic_llong deadline_s; /* by CLOCK_MONOTONIC; 0: none */
    atomic_bool closed;
    atomic_uint arrived; /* number of signals */
    /* Atomic: a handler may run on any thread while the main thread sets the next signal. */
    atomic_uint drain_s;
    void (*_Atomic handlers[SIGNALS])(int);
} limit;

static struct timespec now(void)
{
    struct timespec time;
    clock_gettime(CLOCK_MONOTONIC, &time);
    return time;
}

/* Sets the deadline, or moves it nearer. A deadline is never put off, or repeated signals could
 * keep the process alive. */
static void set_deadline(unsigned seconds)
{
    const long long rounded_up = (long long)now().tv_sec + 1 + (long long)seconds;
    long long before = atomic_load(&limit.deadline_s);
    while ((before == 0 || rounded_up < before) &&
           !atomic_compare_exchange_weak(&limit.deadline_s, &before, rounded_up))
        continue;
    sem_post(&limit.changed);
}

static void end_process(void)
{
    orl_crash_record_mark_stopped();
    orl_crash_report_line("stop-forced", SIGTERM, "");
    _exit(1);
}

static void *run_timeout(void *unused)
{
    (void)unused;
    while (!atomic_load(&limit.closed)) {
        const struct timespec deadline = {.tv_sec = (time_t)atomic_load(&limit.deadline_s)};
        if (deadline.tv_sec == 0)
            sem_wait(&limit.changed);
        else if (sem_clockwait(&limit.changed, CLOCK_MONOTONIC, &deadline) != 0 &&
                 errno == ETIMEDOUT)
            end_process();
    }
    return NULL;
}

void orl_shutdown_timeout_open(void)
{
    sigset_t all, before;
    sem_init(&limit.changed, 0, 0);
    atomic_store(&limit.closed, false);
    atomic_store(&limit.deadline_s, 0);
    sigfillset(&all);
    pthread_sigmask(SIG_SETMASK, &all, &before);
    limit.started = pthread_create(&limit.thread, NULL, run_timeout, NULL) == 0;
    pthread_sigmask(SIG_SETMASK, &before, NULL);
}

void orl_shutdown_timeout_close(void)
{
    atomic_store(&limit.closed, true);
    sem_post(&limit.changed);
    if (limit.started)
        pthread_join(limit.thread, NULL);
    limit.started = false;
}

void orl_shutdown_timeout_start(void)
{
    set_deadline(ORL_SERVER_STOP_S);
}

static void on_signal(int signum)
{
    const int why = errno;
    const bool first = atomic_fetch_add(&limit.arrived, 1) == 0;
    set_deadline(ORL_SERVER_STOP_S + (first ? atomic_load(&limit.drain_s) : 0));
    void (*const handler)(int) = atomic_load(&limit.handlers[signum]);
    handler(signum);
    errno = why;
}

void orl_shutdown_timeout_watch(int signum, unsigned drain_s)
{
    struct sigaction action;
    atomic_store(&limit.drain_s, drain_s);
    if (sigaction(signum, NULL, &action) != 0 || (action.sa_flags & SA_SIGINFO) ||
        action.sa_handler == SIG_DFL || action.sa_handler == SIG_IGN)
        return;
    atomic_store(&limit.handlers[signum], action.sa_handler);
    action.sa_handler = on_signal;
    sigaction(signum, &action, NULL);
}
