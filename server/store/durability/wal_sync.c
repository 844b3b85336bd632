#include "store/durability/wal.h"

#include <errno.h>
#include <fcntl.h>
#include <pthread.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include <oriel/base/files.h>

#include "process/signals.h"
#include "store/files/folders.h"

enum { CHECKPOINT_TRIES = 100, CHECKPOINT_RETRY_NS = 20000000 };

/* The result for all requests up to a ticket. */
struct sync_result {
    uint64_t ticket;
    int rc;
    struct orl_error err;
};

struct orl_wal_sync {
    struct orl_db *db; /* the connection that commits */
    uv_async_t woken;
    void (*on_idle)(void *ctx);
    void *ctx;
    uint64_t last, durable; /* numbers of commits; used by the loop */
    struct orl_wal_sync_wait *first, **end;

    pthread_t thread;
    pthread_mutex_t mutex;
    pthread_cond_t called;
    uint64_t requested; /* the last ticket; protected by the mutex from here on */
    struct sync_result sync_result;
    bool ending;

    struct orl_db own; /* used by the thread from here on */
    int log_fd;
    bool sync_failed; /* a sync of the log has failed, and SQLite has not restarted the log since */
    int failed_frames;
};

/* ---- On the thread -------------------------------------------------------------------------- */

/* Runs a checkpoint. Retries while another connection runs one. */
static int checkpoint_with_retries(struct orl_wal_sync *wal_sync, int *ret_in_log, int *ret_copied)
{
    int code = SQLITE_BUSY;
    for (int i = 0; i < CHECKPOINT_TRIES && code == SQLITE_BUSY; i++) {
        if (i > 0)
            nanosleep(&(struct timespec){.tv_nsec = CHECKPOINT_RETRY_NS}, NULL);
        code = sqlite3_wal_checkpoint_v2(wal_sync->own.handle, NULL, SQLITE_CHECKPOINT_PASSIVE,
                                         ret_in_log, ret_copied);
    }
    return code;
}

/* Copies the whole log into the database, which SQLite syncs. */
static int checkpoint_all(struct orl_wal_sync *wal_sync, struct orl_error *err)
{
    int in_log = 0, copied = 0;
    if (checkpoint_with_retries(wal_sync, &in_log, &copied) != SQLITE_OK)
        return orl_db_error(&wal_sync->own, "its log cannot be synced", err);
    if (copied < in_log)
        return orl_error_set(
            err, ORL_ERR_IO,
            "database: a sync of its log has failed, and a reader prevented the checkpoint");
    if (in_log < wal_sync->failed_frames)
        wal_sync->sync_failed = false; /* the log was restarted: all of it was written since */
    wal_sync->failed_frames = in_log;
    return 0;
}

static int sync_log(struct orl_wal_sync *wal_sync, struct orl_error *err)
{
    if (!wal_sync->sync_failed && fdatasync(wal_sync->log_fd) != 0) {
        wal_sync->sync_failed = true;
        wal_sync->failed_frames = 0;
    }
    return wal_sync->sync_failed ? checkpoint_all(wal_sync, err) : 0;
}

static void *sync_on_request(void *ctx)
{
    struct orl_wal_sync *wal_sync = ctx;
    orl_signal_stack_install();
    pthread_mutex_lock(&wal_sync->mutex);
    while (!wal_sync->ending) {
        struct sync_result sync_result = {.ticket = wal_sync->requested};
        if (sync_result.ticket == wal_sync->sync_result.ticket) {
            pthread_cond_wait(&wal_sync->called, &wal_sync->mutex);
            continue;
        }
        pthread_mutex_unlock(&wal_sync->mutex);
        sync_result.rc = sync_log(wal_sync, &sync_result.err);
        pthread_mutex_lock(&wal_sync->mutex);
        wal_sync->sync_result = sync_result;
        uv_async_send(&wal_sync->woken);
    }
    pthread_mutex_unlock(&wal_sync->mutex);
    return NULL;
}

/* ---- On the loop ---------------------------------------------------------------------------- */

/* Counts every transaction just before it is committed. */
static int on_commit(void *ctx)
{
    struct orl_wal_sync *wal_sync = ctx;
    wal_sync->last++;
    return 0;
}

static void report_sync_result(struct orl_wal_sync *wal_sync, const struct sync_result *sync_result)
{
    while (wal_sync->first && wal_sync->first->ticket <= sync_result->ticket) {
        struct orl_wal_sync_wait *wait = wal_sync->first;
        wal_sync->first = wait->next;
        if (!wal_sync->first)
            wal_sync->end = &wal_sync->first;
        if (sync_result->rc == 0)
            wal_sync->durable = wait->commit;
        wait->synced(wait, sync_result->rc, &sync_result->err);
    }
}

static void on_woken(uv_async_t *woken)
{
    struct orl_wal_sync *wal_sync = woken->data;
    pthread_mutex_lock(&wal_sync->mutex);
    const struct sync_result sync_result = wal_sync->sync_result;
    pthread_mutex_unlock(&wal_sync->mutex);
    report_sync_result(wal_sync, &sync_result);
    if (!wal_sync->first)
        wal_sync->on_idle(wal_sync->ctx);
}

void orl_wal_sync_request(struct orl_wal_sync *wal_sync, struct orl_wal_sync_wait *wait)
{
    wait->next = NULL;
    wait->commit = wal_sync->last;
    *wal_sync->end = wait;
    wal_sync->end = &wait->next;
    pthread_mutex_lock(&wal_sync->mutex);
    wait->ticket = ++wal_sync->requested;
    pthread_cond_signal(&wal_sync->called);
    pthread_mutex_unlock(&wal_sync->mutex);
}

uint64_t orl_wal_sync_last_commit(const struct orl_wal_sync *wal_sync)
{
    return wal_sync->last;
}

bool orl_wal_sync_is_durable(const struct orl_wal_sync *wal_sync, uint64_t commit)
{
    return commit <= wal_sync->durable;
}

bool orl_wal_sync_is_idle(const struct orl_wal_sync *wal_sync)
{
    return !wal_sync || !wal_sync->first;
}

/* ---- Start and end -------------------------------------------------------------------------- */

static int open_log(struct orl_wal_sync *wal_sync, const char *path, struct orl_error *err)
{
    char log[ORL_PATH_MAX];
    snprintf(log, sizeof log, "%s-wal", path);
    wal_sync->log_fd = orl_open_regular(log, O_RDWR);
    if (wal_sync->log_fd >= 0)
        return 0;
    return orl_error_set(err, ORL_ERR_IO, "cannot open %s: %s", log, orl_open_reason(errno));
}

/* Starts the thread with all signals blocked, since the loop handles them. */
static int start_thread(struct orl_wal_sync *wal_sync, struct orl_error *err)
{
    sigset_t all, before;
    sigfillset(&all);
    pthread_sigmask(SIG_SETMASK, &all, &before);
    const int failed = pthread_create(&wal_sync->thread, NULL, sync_on_request, wal_sync);
    pthread_sigmask(SIG_SETMASK, &before, NULL);
    return failed ? orl_error_set(err, ORL_ERR_NOMEM, "cannot start a thread") : 0;
}

static void free_wal_sync(struct orl_wal_sync *wal_sync)
{
    if (wal_sync->log_fd >= 0)
        close(wal_sync->log_fd);
    orl_db_close(&wal_sync->own);
    pthread_cond_destroy(&wal_sync->called);
    pthread_mutex_destroy(&wal_sync->mutex);
    free(wal_sync);
}

int orl_wal_sync_open(uv_loop_t *loop, struct orl_db *db, const char *path,
                      void (*on_idle)(void *ctx), void *ctx, struct orl_wal_sync **ret_wal_sync,
                      struct orl_error *err)
{
    struct orl_wal_sync *wal_sync = calloc(1, sizeof *wal_sync);
    if (!wal_sync)
        return orl_error_no_memory(err);
    *wal_sync = (struct orl_wal_sync){.db = db, .on_idle = on_idle, .ctx = ctx, .log_fd = -1};
    wal_sync->end = &wal_sync->first;
    pthread_mutex_init(&wal_sync->mutex, NULL);
    pthread_cond_init(&wal_sync->called, NULL);
    int rc = orl_db_open_existing(&wal_sync->own, path, err);
    if (rc == 0)
        rc = open_log(wal_sync, path, err);
    if (rc == 0)
        rc = start_thread(wal_sync, err);
    if (rc) {
        free_wal_sync(wal_sync);
        return rc;
    }
    uv_async_init(loop, &wal_sync->woken, on_woken);
    wal_sync->woken.data = wal_sync;
    sqlite3_commit_hook(db->handle, on_commit, wal_sync);
    *ret_wal_sync = wal_sync;
    return 0;
}

void orl_wal_sync_stop(struct orl_wal_sync *wal_sync)
{
    if (!wal_sync)
        return;
    pthread_mutex_lock(&wal_sync->mutex);
    wal_sync->ending = true;
    pthread_cond_signal(&wal_sync->called);
    pthread_mutex_unlock(&wal_sync->mutex);
    pthread_join(wal_sync->thread, NULL);
    uv_close((uv_handle_t *)&wal_sync->woken, NULL);
}

void orl_wal_sync_free(struct orl_wal_sync *wal_sync)
{
    if (!wal_sync)
        return;
    sqlite3_commit_hook(wal_sync->db->handle, NULL, NULL);
    free_wal_sync(wal_sync);
}
