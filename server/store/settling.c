#include "store/settling.h"

#include <errno.h>
#include <fcntl.h>
#include <pthread.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include <oriel/open.h>

#include "process/signal_stack.h"
#include "store/folders.h"

enum { FOLD_TRIES = 100, FOLD_TRIES_EVERY_NS = 20000000 };

/* The result for all requests up to a ticket. */
struct verdict {
    uint64_t ticket;
    int rc;
    struct orl_error err;
};

struct orl_settling {
    struct orl_db *db; /* the connection that commits */
    uv_async_t woken;
    void (*quiet)(void *ctx);
    void *ctx;
    uint64_t last, safe; /* numbers of commits; used by the loop */
    struct orl_settling_wait *first, **end;

    pthread_t thread;
    pthread_mutex_t mutex;
    pthread_cond_t called;
    uint64_t asked; /* the last ticket; protected by the mutex from here on */
    struct verdict verdict;
    bool ending;

    struct orl_db own; /* used by the thread from here on */
    int log_fd;
    bool doubted; /* a sync of the log has failed, and SQLite has not restarted the log since */
    int doubted_frames;
};

/* ---- On the thread -------------------------------------------------------------------------- */

/* Runs a checkpoint. Retries while another connection runs one. */
static int checkpoint_with_retries(struct orl_settling *settling, int *ret_in_log, int *ret_folded)
{
    int code = SQLITE_BUSY;
    for (int i = 0; i < FOLD_TRIES && code == SQLITE_BUSY; i++) {
        if (i > 0)
            nanosleep(&(struct timespec){.tv_nsec = FOLD_TRIES_EVERY_NS}, NULL);
        code = sqlite3_wal_checkpoint_v2(settling->own.handle, NULL, SQLITE_CHECKPOINT_PASSIVE,
                                         ret_in_log, ret_folded);
    }
    return code;
}

/* Copies the whole log into the database, which SQLite syncs. */
static int checkpoint_all(struct orl_settling *settling, struct orl_error *err)
{
    int in_log = 0, folded = 0;
    if (checkpoint_with_retries(settling, &in_log, &folded) != SQLITE_OK)
        return orl_db_error(&settling->own, "its log cannot be synced", err);
    if (folded < in_log)
        return orl_error_set(err, ORL_ERR_IO,
                             "database: a sync of its log has failed, and a "
                             "reader kept it from being folded in");
    if (in_log < settling->doubted_frames)
        settling->doubted = false; /* the log was restarted: all of it was written since */
    settling->doubted_frames = in_log;
    return 0;
}

static int sync_log(struct orl_settling *settling, struct orl_error *err)
{
    if (!settling->doubted && fdatasync(settling->log_fd) != 0) {
        settling->doubted = true;
        settling->doubted_frames = 0;
    }
    return settling->doubted ? checkpoint_all(settling, err) : 0;
}

static void *sync_when_asked(void *ctx)
{
    struct orl_settling *settling = ctx;
    orl_signal_stack_install();
    pthread_mutex_lock(&settling->mutex);
    while (!settling->ending) {
        struct verdict verdict = {.ticket = settling->asked};
        if (verdict.ticket == settling->verdict.ticket) {
            pthread_cond_wait(&settling->called, &settling->mutex);
            continue;
        }
        pthread_mutex_unlock(&settling->mutex);
        verdict.rc = sync_log(settling, &verdict.err);
        pthread_mutex_lock(&settling->mutex);
        settling->verdict = verdict;
        uv_async_send(&settling->woken);
    }
    pthread_mutex_unlock(&settling->mutex);
    return NULL;
}

/* ---- On the loop ---------------------------------------------------------------------------- */

/* Counts every transaction just before it is committed. */
static int on_commit(void *ctx)
{
    struct orl_settling *settling = ctx;
    settling->last++;
    return 0;
}

static void report_verdict(struct orl_settling *settling, const struct verdict *verdict)
{
    while (settling->first && settling->first->ticket <= verdict->ticket) {
        struct orl_settling_wait *wait = settling->first;
        settling->first = wait->next;
        if (!settling->first)
            settling->end = &settling->first;
        if (verdict->rc == 0)
            settling->safe = wait->commit;
        wait->settled(wait, verdict->rc, &verdict->err);
    }
}

static void on_woken(uv_async_t *woken)
{
    struct orl_settling *settling = woken->data;
    pthread_mutex_lock(&settling->mutex);
    const struct verdict verdict = settling->verdict;
    pthread_mutex_unlock(&settling->mutex);
    report_verdict(settling, &verdict);
    if (!settling->first)
        settling->quiet(settling->ctx);
}

void orl_settling_ask(struct orl_settling *settling, struct orl_settling_wait *wait)
{
    wait->next = NULL;
    wait->commit = settling->last;
    *settling->end = wait;
    settling->end = &wait->next;
    pthread_mutex_lock(&settling->mutex);
    wait->ticket = ++settling->asked;
    pthread_cond_signal(&settling->called);
    pthread_mutex_unlock(&settling->mutex);
}

uint64_t orl_settling_last(const struct orl_settling *settling)
{
    return settling->last;
}

bool orl_settling_is_safe(const struct orl_settling *settling, uint64_t commit)
{
    return commit <= settling->safe;
}

bool orl_settling_is_quiet(const struct orl_settling *settling)
{
    return !settling || !settling->first;
}

/* ---- Start and end -------------------------------------------------------------------------- */

static int open_log(struct orl_settling *settling, const char *path, struct orl_error *err)
{
    char log[ORL_PATH_MAX];
    snprintf(log, sizeof log, "%s-wal", path);
    settling->log_fd = orl_open_regular(log, O_RDWR);
    if (settling->log_fd >= 0)
        return 0;
    return orl_error_set(err, ORL_ERR_IO, "cannot open %s: %s", log, orl_open_reason(errno));
}

/* Starts the thread with all signals blocked, since the loop handles them. */
static int start_thread(struct orl_settling *settling, struct orl_error *err)
{
    sigset_t all, before;
    sigfillset(&all);
    pthread_sigmask(SIG_SETMASK, &all, &before);
    const int failed = pthread_create(&settling->thread, NULL, sync_when_asked, settling);
    pthread_sigmask(SIG_SETMASK, &before, NULL);
    return failed ? orl_error_set(err, ORL_ERR_NOMEM, "cannot start a thread") : 0;
}

static void free_settling(struct orl_settling *settling)
{
    if (settling->log_fd >= 0)
        close(settling->log_fd);
    orl_db_close(&settling->own);
    pthread_cond_destroy(&settling->called);
    pthread_mutex_destroy(&settling->mutex);
    free(settling);
}

int orl_settling_open(uv_loop_t *loop, struct orl_db *db, const char *path,
                      void (*quiet)(void *ctx), void *ctx, struct orl_settling **ret_settling,
                      struct orl_error *err)
{
    struct orl_settling *settling = calloc(1, sizeof *settling);
    if (!settling)
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
    *settling = (struct orl_settling){.db = db, .quiet = quiet, .ctx = ctx, .log_fd = -1};
    settling->end = &settling->first;
    pthread_mutex_init(&settling->mutex, NULL);
    pthread_cond_init(&settling->called, NULL);
    int rc = orl_db_open_existing(&settling->own, path, err);
    if (rc == 0)
        rc = open_log(settling, path, err);
    if (rc == 0)
        rc = start_thread(settling, err);
    if (rc) {
        free_settling(settling);
        return rc;
    }
    uv_async_init(loop, &settling->woken, on_woken);
    settling->woken.data = settling;
    sqlite3_commit_hook(db->handle, on_commit, settling);
    *ret_settling = settling;
    return 0;
}

void orl_settling_stop(struct orl_settling *settling)
{
    if (!settling)
        return;
    pthread_mutex_lock(&settling->mutex);
    settling->ending = true;
    pthread_cond_signal(&settling->called);
    pthread_mutex_unlock(&settling->mutex);
    pthread_join(settling->thread, NULL);
    uv_close((uv_handle_t *)&settling->woken, NULL);
}

void orl_settling_free(struct orl_settling *settling)
{
    if (!settling)
        return;
    sqlite3_commit_hook(settling->db->handle, NULL, NULL);
    free_settling(settling);
}
