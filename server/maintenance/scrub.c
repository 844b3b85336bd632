#include "maintenance/scrub.h"

#include <errno.h>
#include <fcntl.h>
#include <pthread.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include <oriel/base/files.h>
#include <oriel/job/run.h>
#include <sys/resource.h>
#include <sys/syscall.h>

#include "process/signals.h"
#include "process/times.h"
#include "store/files/stored_files.h"

/* ---- Missing files --------------------------------------------------------------------------- */

enum { NAMED = 8 };

void orl_missing_files_log(struct orl_db *db, const struct orl_folders *folders,
                           const struct orl_log *log)
{
    char path[ORL_PATH_MAX];
    int64_t count = 0;
    sqlite3_stmt *stmt = orl_db_prepare(
        db, NULL,
        "SELECT 'blobs/' || substr(sha, 1, 2) || '/' || sha FROM (SELECT blob AS sha FROM "
        "scene_files UNION SELECT id FROM bsdfs UNION SELECT document FROM jobs) "
        "UNION ALL SELECT 'results/' || id FROM jobs WHERE outcome IS NOT NULL AND "
        "evicted_ms IS NULL AND state IN ('succeeded', 'cancelled')",
        "");
    while (stmt && sqlite3_step(stmt) == SQLITE_ROW) {
        orl_folders_path(folders, path, "%s", orl_db_text(stmt, 0));
        if (access(path, F_OK) == 0)
            continue;
        if (count++ < NAMED)
            orl_log_event(log, ORL_LOG_ERROR, "file-missing", "s", "file", orl_db_text(stmt, 0));
    }
    sqlite3_finalize(stmt);
    if (count > 0)
        orl_log_event(log, ORL_LOG_ERROR, "files-missing", "is", "count", count, "hint",
                      "restore them from a backup, or upload their scenes or BSDFs again");
}

/* ---- One pass ------------------------------------------------------------------------------- */

struct pass {
    struct orl_db *db;
    const struct orl_folders *folders;
    const struct orl_scrubber *scrubber;
    struct orl_scrub_totals *totals;
};

static int check_file(const struct orl_stored_file *file, const char *path, uint64_t *ret_bytes,
                      struct orl_error *err)
{
    struct stat st;
    const int fd = orl_open_regular(path, O_RDONLY);
    if (fd < 0 || fstat(fd, &st) != 0) {
        if (fd >= 0)
            close(fd);
        return orl_error_set(err, ORL_ERR_IO, "cannot be read: %s", orl_open_reason(errno));
    }
    *ret_bytes = (uint64_t)st.st_size;
    const int rc = file->kind == ORL_STORED_FILE_MAP ? orl_map_verify(file->map_kind, path, err)
                                                     : orl_verify_file(fd, file->sha, err);
    close(fd);
    return rc;
}

static int check_listed_file(void *ctx, const struct orl_stored_file *file, struct orl_error *err)
{
    const struct pass *pass = ctx;
    struct orl_error why;
    char path[ORL_PATH_MAX];
    uint64_t bytes = 0;
    bool named = true;
    orl_folders_path(pass->folders, path, "%s", file->path);
    if (check_file(file, path, &bytes, &why)) {
        /* The file may have been removed since it was listed. */
        const int rc = orl_stored_file_is_referenced(pass->db, file, &named, err);
        if (rc)
            return rc;
        if (named)
            pass->scrubber->found(pass->scrubber->ctx, file, &why);
        pass->totals->damaged += named;
    }
    pass->totals->files++;
    pass->totals->bytes += bytes;
    return pass->scrubber->should_continue(pass->scrubber->ctx, bytes) ? 0 : ORL_ERR_CANCELLED;
}

int orl_scrub(struct orl_db *db, const struct orl_folders *folders,
              const struct orl_scrubber *scrubber, struct orl_scrub_totals *totals,
              struct orl_error *err)
{
    struct pass pass = {db, folders, scrubber, totals};
    const int rc = orl_stored_files_visit(db, check_listed_file, &pass, err);
    return rc == ORL_ERR_CANCELLED ? 0 : rc;
}

/* ---- In the daemon -------------------------------------------------------------------------- */

enum { FINDINGS = 64, PASS_S = 86400 };

struct finding {
    struct orl_stored_file file;
    struct orl_error why;
};

struct orl_scrub_thread {
    const struct orl_log *log;
    struct orl_map_cache *maps;
    struct orl_folders folders; /* copy for the thread */
    uint64_t bytes_per_s;
    pthread_t thread;
    pthread_mutex_t mutex;  /* protects the members below */
    pthread_cond_t changed; /* stop or ended has changed */
    bool stop, ended;
    struct orl_scrub_totals totals;
    struct finding findings[FINDINGS]; /* not logged yet; when full, the next pass reports more */
    size_t count;
};

static void record_finding(void *ctx, const struct orl_stored_file *file,
                           const struct orl_error *why)
{
    struct orl_scrub_thread *scrub_thread = ctx;
    pthread_mutex_lock(&scrub_thread->mutex);
    if (scrub_thread->count < FINDINGS)
        scrub_thread->findings[scrub_thread->count++] = (struct finding){*file, *why};
    scrub_thread->totals.damaged++;
    pthread_mutex_unlock(&scrub_thread->mutex);
}

static struct timespec to_timespec(double steady_s)
{
    const time_t whole_s = (time_t)steady_s;
    return (struct timespec){whole_s, (long)(1e9 * (steady_s - (double)whole_s))};
}

/* Waits. Returns false at once if the thread must stop. */
static bool wait_seconds(struct orl_scrub_thread *scrub_thread, double seconds)
{
    const struct timespec until = to_timespec(orl_time_steady_s() + seconds);
    int rc = 0;
    pthread_mutex_lock(&scrub_thread->mutex);
    while (!scrub_thread->stop && rc == 0)
        rc = pthread_cond_timedwait(&scrub_thread->changed, &scrub_thread->mutex, &until);
    const bool should_continue = !scrub_thread->stop;
    pthread_mutex_unlock(&scrub_thread->mutex);
    return should_continue;
}

static bool limit_rate(void *ctx, uint64_t bytes)
{
    struct orl_scrub_thread *scrub_thread = ctx;
    pthread_mutex_lock(&scrub_thread->mutex);
    scrub_thread->totals.files++;
    scrub_thread->totals.bytes += bytes;
    pthread_mutex_unlock(&scrub_thread->mutex);
    return wait_seconds(scrub_thread, (double)bytes / (double)scrub_thread->bytes_per_s);
}

static void lower_priority(void)
{
    enum { WHO_PROCESS = 1, CLASS_IDLE = 3, CLASS_SHIFT = 13, NICEST = 19 };
    setpriority(PRIO_PROCESS, (id_t)gettid(), NICEST);
    syscall(SYS_ioprio_set, WHO_PROCESS, 0, CLASS_IDLE << CLASS_SHIFT);
}

/* Scrubs once a day until the thread must stop. */
static void scrub_daily(struct orl_scrub_thread *scrub_thread)
{
    const struct orl_folders *folders = &scrub_thread->folders;
    const struct orl_scrubber scrubber = {record_finding, limit_rate, scrub_thread};
    char path[ORL_PATH_MAX];
    orl_folders_path(folders, path, "oriel.db");
    while (wait_seconds(scrub_thread, 1)) {
        const double until_s = orl_time_steady_s() + PASS_S;
        struct orl_scrub_totals totals = {0};
        struct orl_db db = {NULL};
        if (orl_db_open_existing(&db, path, NULL) == 0)
            orl_scrub(&db, folders, &scrubber, &totals, NULL);
        orl_db_close(&db);
        if (!wait_seconds(scrub_thread, until_s - orl_time_steady_s()))
            break;
    }
}

static void *thread_main(void *arg)
{
    struct orl_scrub_thread *scrub_thread = arg;
    orl_signal_stack_install();
    lower_priority();
    scrub_daily(scrub_thread);
    pthread_mutex_lock(&scrub_thread->mutex);
    scrub_thread->ended = true;
    pthread_cond_signal(&scrub_thread->changed);
    pthread_mutex_unlock(&scrub_thread->mutex);
    return NULL;
}

static void scrub_thread_free(struct orl_scrub_thread *scrub_thread)
{
    pthread_cond_destroy(&scrub_thread->changed);
    pthread_mutex_destroy(&scrub_thread->mutex);
    free(scrub_thread);
}

struct orl_scrub_thread *orl_scrub_thread_start(const struct orl_folders *folders,
                                                const struct orl_log *log,
                                                struct orl_map_cache *maps, uint64_t bytes_per_s)
{
    struct orl_scrub_thread *scrub_thread =
        bytes_per_s > 0 ? calloc(1, sizeof *scrub_thread) : NULL;
    pthread_condattr_t steady;
    if (!scrub_thread)
        return NULL;
    scrub_thread->log = log;
    scrub_thread->maps = maps;
    scrub_thread->folders = *folders;
    scrub_thread->bytes_per_s = bytes_per_s;
    pthread_mutex_init(&scrub_thread->mutex, NULL);
    pthread_condattr_init(&steady);
    pthread_condattr_setclock(&steady, CLOCK_MONOTONIC);
    pthread_cond_init(&scrub_thread->changed, &steady);
    pthread_condattr_destroy(&steady);
    if (pthread_create(&scrub_thread->thread, NULL, thread_main, scrub_thread) != 0) {
        scrub_thread_free(scrub_thread);
        return NULL;
    }
    return scrub_thread;
}

/* State of a thread that still runs when the process ends. */
static struct orl_scrub_thread *left_behind;

void orl_scrub_thread_stop(struct orl_scrub_thread *scrub_thread)
{
    if (!scrub_thread)
        return;
    const struct timespec until = to_timespec(orl_time_steady_s() + 1);
    int rc = 0;
    pthread_mutex_lock(&scrub_thread->mutex);
    scrub_thread->stop = true;
    pthread_cond_signal(&scrub_thread->changed);
    while (!scrub_thread->ended && rc == 0)
        rc = pthread_cond_timedwait(&scrub_thread->changed, &scrub_thread->mutex, &until);
    const bool ended = scrub_thread->ended;
    pthread_mutex_unlock(&scrub_thread->mutex);
    /* The thread may be reading a large file on a slow disk, so the process ends without it. */
    if (!ended) {
        pthread_detach(scrub_thread->thread);
        left_behind = scrub_thread;
        return;
    }
    pthread_join(scrub_thread->thread, NULL);
    scrub_thread_free(scrub_thread);
}

static void log_finding(const struct orl_scrub_thread *scrub_thread, const struct finding *finding)
{
    const struct orl_stored_file *file = &finding->file;
    enum orl_map_removal removal;
    orl_log_event(scrub_thread->log, ORL_LOG_ERROR, "damaged", "sss", "path", file->path, "job",
                  file->job[0] ? file->job : "-", "why", finding->why.message);
    if (file->kind == ORL_STORED_FILE_MAP)
        orl_map_cache_remove(scrub_thread->maps, file->map_kind, file->map_key, &removal, NULL);
}

void orl_scrub_thread_poll(struct orl_scrub_thread *scrub_thread)
{
    struct finding *findings = NULL;
    size_t count = 0;
    if (!scrub_thread)
        return;
    pthread_mutex_lock(&scrub_thread->mutex);
    if (scrub_thread->count > 0)
        findings = malloc(scrub_thread->count * sizeof *findings);
    if (findings) {
        count = scrub_thread->count;
        memcpy(findings, scrub_thread->findings, count * sizeof *findings);
        scrub_thread->count = 0;
    }
    pthread_mutex_unlock(&scrub_thread->mutex);
    for (size_t i = 0; i < count; i++)
        log_finding(scrub_thread, &findings[i]);
    free(findings);
}

struct orl_scrub_totals orl_scrub_thread_totals(struct orl_scrub_thread *scrub_thread)
{
    struct orl_scrub_totals totals = {0};
    if (!scrub_thread)
        return totals;
    pthread_mutex_lock(&scrub_thread->mutex);
    totals = scrub_thread->totals;
    pthread_mutex_unlock(&scrub_thread->mutex);
    return totals;
}
