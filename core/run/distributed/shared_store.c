#include <oriel/job/run.h>

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/memory/memory.h"

static int name_file(const struct orl_shared_store *state, const char *kind, const char *key,
                     bool mine, char ret_path[4096], struct orl_error *err)
{
    const int length = snprintf(ret_path, 4096, "%s/%s-%s.opm%s%s", state->folder, kind, key,
                                mine ? "." : "", mine ? state->owner : "");
    if (length < 0 || length >= 4096)
        return orl_error_set(err, ORL_ERR_LIMIT, "the shared folder's path is too long");
    return 0;
}

/* ---- Pending files ------------------------------------------------------------------------------
 */

static int add_pending(struct orl_shared_store *state, const char *kind, const char *key,
                       struct orl_error *err)
{
    struct orl_job_task job_task = {.work = 1};
    snprintf(job_task.kind, sizeof job_task.kind, "%s", kind);
    snprintf(job_task.key, sizeof job_task.key, "%s", key);
    if (!orl_array_reserve(&state->pending, &state->capacity, state->n_pending + 1,
                           sizeof *state->pending))
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
    state->pending[state->n_pending++] = job_task;
    return 0;
}

/* Removes an entry from the list of pending files. Returns true if it was pending. */
static bool remove_pending(struct orl_shared_store *state, const char *kind, const char *key)
{
    for (size_t i = state->n_pending; i-- > 0;)
        if (strcmp(state->pending[i].key, key) == 0 && strcmp(state->pending[i].kind, kind) == 0) {
            state->pending[i] = state->pending[--state->n_pending];
            return true;
        }
    return false;
}

/* ---- The store ------------------------------------------------------------------------------- */

static int shared_acquire(void *ctx, const char *kind, const char *key, atomic_bool *cancel,
                          char ret_path[4096], bool *ret_hit, struct orl_map_info *ret_info,
                          struct orl_error *err)
{
    struct orl_shared_store *state = ctx;
    struct stat st;
    (void)cancel; /* processes that make the same file do not wait for each other */
    int code = name_file(state, kind, key, false, ret_path, err);
    if (code < 0)
        return code;
    *ret_hit = stat(ret_path, &st) == 0;
    if (!*ret_hit) {
        code = name_file(state, kind, key, true, ret_path, err);
        return code < 0 ? code : add_pending(state, kind, key, err);
    }
    memset(ret_info, 0, sizeof *ret_info);
    snprintf(ret_info->kind, sizeof ret_info->kind, "%s", kind);
    snprintf(ret_info->key, sizeof ret_info->key, "%s", key);
    ret_info->bytes = (uint64_t)st.st_size;
    ret_info->cached = true;
    return 0;
}

static int shared_commit(void *ctx, const struct orl_map_info *info, struct orl_error *err)
{
    struct orl_shared_store *state = ctx;
    char from[4096], to[4096];
    int code = name_file(state, info->kind, info->key, true, from, err);
    if (code == 0)
        code = name_file(state, info->kind, info->key, false, to, err);
    if (code == 0 && rename(from, to) != 0)
        code = orl_error_set(err, orl_err_of_errno(errno), "cannot store '%s': %s", to,
                             strerror(errno));
    if (code == 0)
        remove_pending(state, info->kind, info->key);
    return code;
}

/* Deletes a pending file under construction, or else a damaged file that was found. */
static void shared_abandon(void *ctx, const char *kind, const char *key)
{
    struct orl_shared_store *state = ctx;
    char path[4096];
    if (name_file(state, kind, key, remove_pending(state, kind, key), path, NULL) == 0)
        unlink(path);
}

static void shared_release(void *ctx, const char *kind, const char *key)
{
    (void)ctx, (void)kind, (void)key;
}

void orl_shared_store_init(struct orl_shared_store *state, struct orl_map_store *ret_store)
{
    char host[64] = "here";
    gethostname(host, sizeof host - 1);
    snprintf(state->owner, sizeof state->owner, "%s.%ld", host, (long)getpid());
    state->pending = NULL;
    state->n_pending = state->capacity = 0;
    *ret_store = (struct orl_map_store){.ctx = state,
                                        .acquire = shared_acquire,
                                        .commit = shared_commit,
                                        .abandon = shared_abandon,
                                        .release = shared_release};
}

void orl_shared_store_done(struct orl_shared_store *state)
{
    free(state->pending);
    state->pending = NULL;
    state->n_pending = state->capacity = 0;
}
