#include "store/files/async_remove.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

struct removal {
    uv_work_t work;
    char path[];
};

/* A file that is removed once its row's deletion is safe. */
struct deferred_removal {
    struct orl_wal_sync_wait wait; /* first member, whose address is the struct's */
    uv_loop_t *loop;
    const struct orl_folders *folders;
    char path[];
};

static void run_removal(uv_work_t *work)
{
    enum { ATTEMPTS = 3 };
    const struct removal *removal = work->data;
    /* Retry, since a lack of memory may pass; otherwise the next start removes it. */
    for (int i = 0; i < ATTEMPTS && orl_remove_tree(removal->path, NULL) != 0; i++)
        nanosleep(&(struct timespec){.tv_nsec = 10000000}, NULL);
}

static void end_removal(uv_work_t *work, int status)
{
    (void)status;
    free(work->data);
}

void orl_remove_async(uv_loop_t *loop, const struct orl_folders *folders, const char *path)
{
    char away[ORL_PATH_MAX];
    orl_folders_temporary(folders, away);
    if (rename(path, away) != 0) {
        orl_remove_tree(path, NULL);
        return;
    }
    const size_t size = strlen(away) + 1;
    struct removal *removal = malloc(sizeof *removal + size);
    if (!removal) {
        orl_remove_tree(away, NULL);
        return;
    }
    memcpy(removal->path, away, size);
    removal->work.data = removal;
    uv_queue_work(loop, &removal->work, run_removal, end_removal);
}

static void remove_deferred(struct orl_wal_sync_wait *wait, int rc, const struct orl_error *err)
{
    struct deferred_removal *deferred_removal = (struct deferred_removal *)wait;
    (void)err;
    if (rc == 0)
        orl_remove_async(deferred_removal->loop, deferred_removal->folders, deferred_removal->path);
    free(deferred_removal);
}

void orl_remove_when_durable(struct orl_wal_sync *wal_sync, uv_loop_t *loop,
                             const struct orl_folders *folders, const char *path)
{
    const size_t size = strlen(path) + 1;
    struct deferred_removal *deferred_removal = malloc(sizeof *deferred_removal + size);
    if (!deferred_removal)
        return;
    *deferred_removal =
        (struct deferred_removal){.wait.synced = remove_deferred, .loop = loop, .folders = folders};
    memcpy(deferred_removal->path, path, size);
    orl_wal_sync_request(wal_sync, &deferred_removal->wait);
}
