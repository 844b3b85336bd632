#include "store/durability/wal.h"

#include <pthread.h>
#include <signal.h>
#include <stdbool.h>
#include <stdlib.h>

#include "process/signals.h"

struct orl_wal_checkpointer {
    struct orl_db *db; /* the connection that commits */
    struct orl_db own; /* the thread's connection */
    pthread_t thread;
    pthread_mutex_t mutex;
    pthread_cond_t called;
    bool due, ending;
};

static void run_checkpoint(struct orl_db *db)
{
    sqlite3_wal_checkpoint_v2(db->handle, NULL, SQLITE_CHECKPOINT_PASSIVE, NULL, NULL);
}

static void *run_checkpoints(void *ctx)
{
    struct orl_wal_checkpointer *checkpointer = ctx;
    orl_signal_stack_install();
    pthread_mutex_lock(&checkpointer->mutex);
    while (!checkpointer->ending) {
        if (!checkpointer->due) {
            pthread_cond_wait(&checkpointer->called, &checkpointer->mutex);
            continue;
        }
        checkpointer->due = false;
        pthread_mutex_unlock(&checkpointer->mutex);
        run_checkpoint(&checkpointer->own);
        pthread_mutex_lock(&checkpointer->mutex);
    }
    pthread_mutex_unlock(&checkpointer->mutex);
    return NULL;
}

/* Called after a commit; pages: the number of pages in the log. */
static int on_commit(void *ctx, sqlite3 *handle, const char *name, int pages)
{
    struct orl_wal_checkpointer *checkpointer = ctx;
    (void)handle, (void)name;
    if (pages >= ORL_WAL_MAX_PAGES)
        run_checkpoint(checkpointer->db);
    if (pages < ORL_WAL_CHECKPOINT_PAGES)
        return SQLITE_OK;
    pthread_mutex_lock(&checkpointer->mutex);
    checkpointer->due = true;
    pthread_cond_signal(&checkpointer->called);
    pthread_mutex_unlock(&checkpointer->mutex);
    return SQLITE_OK;
}

/* Starts the thread with all signals blocked, since the loop handles them. */
static int start_thread(struct orl_wal_checkpointer *checkpointer, struct orl_error *err)
{
    sigset_t all, before;
    sigfillset(&all);
    pthread_sigmask(SIG_SETMASK, &all, &before);
    const int failed = pthread_create(&checkpointer->thread, NULL, run_checkpoints, checkpointer);
    pthread_sigmask(SIG_SETMASK, &before, NULL);
    return failed ? orl_error_set(err, ORL_ERR_NOMEM, "cannot start a thread") : 0;
}

int orl_wal_checkpointer_open(struct orl_db *db, const char *path,
                              struct orl_wal_checkpointer **ret_checkpointer, struct orl_error *err)
{
    struct orl_wal_checkpointer *checkpointer = calloc(1, sizeof *checkpointer);
    if (!checkpointer)
        return orl_error_no_memory(err);
    checkpointer->db = db;
    pthread_mutex_init(&checkpointer->mutex, NULL);
    pthread_cond_init(&checkpointer->called, NULL);
    int rc = orl_db_open_existing(&checkpointer->own, path, err);
    if (rc == 0)
        rc = start_thread(checkpointer, err);
    if (rc) {
        orl_db_close(&checkpointer->own);
        pthread_cond_destroy(&checkpointer->called);
        pthread_mutex_destroy(&checkpointer->mutex);
        free(checkpointer);
        return rc;
    }
    sqlite3_wal_hook(db->handle, on_commit, checkpointer);
    *ret_checkpointer = checkpointer;
    return 0;
}

void orl_wal_checkpointer_close(struct orl_wal_checkpointer *checkpointer)
{
    if (!checkpointer)
        return;
    sqlite3_wal_hook(checkpointer->db->handle, NULL, NULL);
    pthread_mutex_lock(&checkpointer->mutex);
    checkpointer->ending = true;
    pthread_cond_signal(&checkpointer->called);
    pthread_mutex_unlock(&checkpointer->mutex);
    pthread_join(checkpointer->thread, NULL);
    orl_db_close(&checkpointer->own);
    pthread_cond_destroy(&checkpointer->called);
    pthread_mutex_destroy(&checkpointer->mutex);
    free(checkpointer);
}
