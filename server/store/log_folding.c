#include "store/log_folding.h"

#include <pthread.h>
#include <signal.h>
#include <stdbool.h>
#include <stdlib.h>

#include "process/signal_stack.h"

struct orl_folding {
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
    struct orl_folding *folding = ctx;
    orl_signal_stack_install();
    pthread_mutex_lock(&folding->mutex);
    while (!folding->ending) {
        if (!folding->due) {
            pthread_cond_wait(&folding->called, &folding->mutex);
            continue;
        }
        folding->due = false;
        pthread_mutex_unlock(&folding->mutex);
        run_checkpoint(&folding->own);
        pthread_mutex_lock(&folding->mutex);
    }
    pthread_mutex_unlock(&folding->mutex);
    return NULL;
}

/* Called after a commit; pages: the number of pages in the log. */
static int on_commit(void *ctx, sqlite3 *handle, const char *name, int pages)
{
    struct orl_folding *folding = ctx;
    (void)handle, (void)name;
    if (pages >= ORL_FOLD_AT_MOST)
        run_checkpoint(folding->db);
    if (pages < ORL_FOLD_PAGES)
        return SQLITE_OK;
    pthread_mutex_lock(&folding->mutex);
    folding->due = true;
    pthread_cond_signal(&folding->called);
    pthread_mutex_unlock(&folding->mutex);
    return SQLITE_OK;
}

/* Starts the thread with all signals blocked, since the loop handles them. */
static int start_thread(struct orl_folding *folding, struct orl_error *err)
{
    sigset_t all, before;
    sigfillset(&all);
    pthread_sigmask(SIG_SETMASK, &all, &before);
    const int failed = pthread_create(&folding->thread, NULL, run_checkpoints, folding);
    pthread_sigmask(SIG_SETMASK, &before, NULL);
    return failed ? orl_error_set(err, ORL_ERR_NOMEM, "cannot start a thread") : 0;
}

int orl_folding_open(struct orl_db *db, const char *path, struct orl_folding **ret_folding,
                     struct orl_error *err)
{
    struct orl_folding *folding = calloc(1, sizeof *folding);
    if (!folding)
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
    folding->db = db;
    pthread_mutex_init(&folding->mutex, NULL);
    pthread_cond_init(&folding->called, NULL);
    int rc = orl_db_open_existing(&folding->own, path, err);
    if (rc == 0)
        rc = start_thread(folding, err);
    if (rc) {
        orl_db_close(&folding->own);
        pthread_cond_destroy(&folding->called);
        pthread_mutex_destroy(&folding->mutex);
        free(folding);
        return rc;
    }
    sqlite3_wal_hook(db->handle, on_commit, folding);
    *ret_folding = folding;
    return 0;
}

void orl_folding_close(struct orl_folding *folding)
{
    if (!folding)
        return;
    sqlite3_wal_hook(folding->db->handle, NULL, NULL);
    pthread_mutex_lock(&folding->mutex);
    folding->ending = true;
    pthread_cond_signal(&folding->called);
    pthread_mutex_unlock(&folding->mutex);
    pthread_join(folding->thread, NULL);
    orl_db_close(&folding->own);
    pthread_cond_destroy(&folding->called);
    pthread_mutex_destroy(&folding->mutex);
    free(folding);
}
