#include "store/discard.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

struct discard {
    uv_work_t work;
    char path[];
};

/* A file that is removed once its row's deletion is safe. */
struct later {
    struct orl_settling_wait wait; /* first member, whose address is the struct's */
    uv_loop_t *loop;
    const struct orl_folders *folders;
    char path[];
};

static void remove_discarded(uv_work_t *work)
{
    enum { ATTEMPTS = 3 };
    const struct discard *discard = work->data;
    /* Retry, since a lack of memory may pass; otherwise the next start removes it. */
    for (int i = 0; i < ATTEMPTS && orl_remove_tree(discard->path, NULL) != 0; i++)
        nanosleep(&(struct timespec){.tv_nsec = 10000000}, NULL);
}

static void free_discarded(uv_work_t *work, int status)
{
    (void)status;
    free(work->data);
}

void orl_discard(uv_loop_t *loop, const struct orl_folders *folders, const char *path)
{
    char away[ORL_PATH_MAX];
    orl_folders_temporary(folders, away);
    if (rename(path, away) != 0) {
        orl_remove_tree(path, NULL);
        return;
    }
    const size_t size = strlen(away) + 1;
    struct discard *discard = malloc(sizeof *discard + size);
    if (!discard) {
        orl_remove_tree(away, NULL);
        return;
    }
    memcpy(discard->path, away, size);
    discard->work.data = discard;
    uv_queue_work(loop, &discard->work, remove_discarded, free_discarded);
}

static void discard_later(struct orl_settling_wait *wait, int rc, const struct orl_error *err)
{
    struct later *later = (struct later *)wait;
    (void)err;
    if (rc == 0)
        orl_discard(later->loop, later->folders, later->path);
    free(later);
}

void orl_discard_when_safe(struct orl_settling *settling, uv_loop_t *loop,
                           const struct orl_folders *folders, const char *path)
{
    const size_t size = strlen(path) + 1;
    struct later *later = malloc(sizeof *later + size);
    if (!later)
        return;
    *later = (struct later){.wait.settled = discard_later, .loop = loop, .folders = folders};
    memcpy(later->path, path, size);
    orl_settling_ask(settling, &later->wait);
}
