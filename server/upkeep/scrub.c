#include "upkeep/scrub.h"

#include <errno.h>
#include <fcntl.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <time.h>
#include <unistd.h>

#include <oriel/open.h>
#include <oriel/run.h>

#include "process/signal_stack.h"
#include "process/times.h"
#include "store/verified.h"

/* ---- One pass ------------------------------------------------------------------------------- */

struct pass {
    struct orl_db *db;
    const struct orl_folders *folders;
    const struct orl_scrubber *scrubber;
    struct orl_scrub_totals *totals;
};

static int check_file(const struct orl_kept_file *file, const char *path, uint64_t *ret_bytes,
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
    const int rc = file->kind == ORL_KEPT_MAP ? orl_map_verify(file->map_kind, path, err)
                                              : orl_verify_file(fd, file->sha, err);
    close(fd);
    return rc;
}

static int check_listed_file(void *ctx, const struct orl_kept_file *file, struct orl_error *err)
{
    const struct pass *pass = ctx;
    struct orl_error why;
    char path[ORL_PATH_MAX];
    uint64_t bytes = 0;
    bool named = true;
    orl_folders_path(pass->folders, path, "%s", file->path);
    if (check_file(file, path, &bytes, &why)) {
        /* The file may have been removed since it was listed. */
        const int rc = orl_kept_is_named(pass->db, file, &named, err);
        if (rc)
            return rc;
        if (named)
            pass->scrubber->found(pass->scrubber->ctx, file, &why);
        pass->totals->damaged += named;
    }
    pass->totals->files++;
    pass->totals->bytes += bytes;
    return pass->scrubber->go_on(pass->scrubber->ctx, bytes) ? 0 : ORL_ERR_CANCELLED;
}

int orl_scrub(struct orl_db *db, const struct orl_folders *folders,
              const struct orl_scrubber *scrubber, struct orl_scrub_totals *totals,
              struct orl_error *err)
{
    struct pass pass = {db, folders, scrubber, totals};
    const int rc = orl_kept_files(db, check_listed_file, &pass, err);
    return rc == ORL_ERR_CANCELLED ? 0 : rc;
}

/* ---- In the daemon -------------------------------------------------------------------------- */

enum { FINDINGS = 64, PASS_S = 86400 };

struct finding {
    struct orl_kept_file file;
    struct orl_error why;
};

struct orl_scrubbing {
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

static void record_finding(void *ctx, const struct orl_kept_file *file, const struct orl_error *why)
{
    struct orl_scrubbing *scrubbing = ctx;
    pthread_mutex_lock(&scrubbing->mutex);
    if (scrubbing->count < FINDINGS)
        scrubbing->findings[scrubbing->count++] = (struct finding){*file, *why};
    scrubbing->totals.damaged++;
    pthread_mutex_unlock(&scrubbing->mutex);
}

static struct timespec to_timespec(double steady_s)
{
    const time_t whole_s = (time_t)steady_s;
    return (struct timespec){whole_s, (long)(1e9 * (steady_s - (double)whole_s))};
}

/* Waits. Returns false at once if the thread must stop. */
static bool wait_seconds(struct orl_scrubbing *scrubbing, double seconds)
{
    const struct timespec until = to_timespec(orl_time_steady_s() + seconds);
    int rc = 0;
    pthread_mutex_lock(&scrubbing->mutex);
    while (!scrubbing->stop && rc == 0)
        rc = pthread_cond_timedwait(&scrubbing->changed, &scrubbing->mutex, &until);
    const bool go_on = !scrubbing->stop;
    pthread_mutex_unlock(&scrubbing->mutex);
    return go_on;
}

static bool limit_rate(void *ctx, uint64_t bytes)
{
    struct orl_scrubbing *scrubbing = ctx;
    pthread_mutex_lock(&scrubbing->mutex);
    scrubbing->totals.files++;
    scrubbing->totals.bytes += bytes;
    pthread_mutex_unlock(&scrubbing->mutex);
    return wait_seconds(scrubbing, (double)bytes / (double)scrubbing->bytes_per_s);
}

static void lower_priority(void)
{
    enum { WHO_PROCESS = 1, CLASS_IDLE = 3, CLASS_SHIFT = 13, NICEST = 19 };
    setpriority(PRIO_PROCESS, (id_t)gettid(), NICEST);
    syscall(SYS_ioprio_set, WHO_PROCESS, 0, CLASS_IDLE << CLASS_SHIFT);
}

/* Scrubs once a day until the thread must stop. */
static void scrub_daily(struct orl_scrubbing *scrubbing)
{
    const struct orl_folders *folders = &scrubbing->folders;
    const struct orl_scrubber scrubber = {record_finding, limit_rate, scrubbing};
    char path[ORL_PATH_MAX];
    orl_folders_path(folders, path, "oriel.db");
    while (wait_seconds(scrubbing, 1)) {
        const double until_s = orl_time_steady_s() + PASS_S;
        struct orl_scrub_totals totals = {0};
        struct orl_db db = {NULL};
        if (orl_db_open_existing(&db, path, NULL) == 0)
            orl_scrub(&db, folders, &scrubber, &totals, NULL);
        orl_db_close(&db);
        if (!wait_seconds(scrubbing, until_s - orl_time_steady_s()))
            break;
    }
}

static void *thread_main(void *arg)
{
    struct orl_scrubbing *scrubbing = arg;
    orl_signal_stack_install();
    lower_priority();
    scrub_daily(scrubbing);
    pthread_mutex_lock(&scrubbing->mutex);
    scrubbing->ended = true;
    pthread_cond_signal(&scrubbing->changed);
    pthread_mutex_unlock(&scrubbing->mutex);
    return NULL;
}

static void scrubbing_free(struct orl_scrubbing *scrubbing)
{
    pthread_cond_destroy(&scrubbing->changed);
    pthread_mutex_destroy(&scrubbing->mutex);
    free(scrubbing);
}

struct orl_scrubbing *orl_scrubbing_start(const struct orl_folders *folders,
                                          const struct orl_log *log, struct orl_map_cache *maps,
                                          uint64_t bytes_per_s)
{
    struct orl_scrubbing *scrubbing = bytes_per_s > 0 ? calloc(1, sizeof *scrubbing) : NULL;
    pthread_condattr_t steady;
    if (!scrubbing)
        return NULL;
    scrubbing->log = log;
    scrubbing->maps = maps;
    scrubbing->folders = *folders;
    scrubbing->bytes_per_s = bytes_per_s;
    pthread_mutex_init(&scrubbing->mutex, NULL);
    pthread_condattr_init(&steady);
    pthread_condattr_setclock(&steady, CLOCK_MONOTONIC);
    pthread_cond_init(&scrubbing->changed, &steady);
    pthread_condattr_destroy(&steady);
    if (pthread_create(&scrubbing->thread, NULL, thread_main, scrubbing) != 0) {
        scrubbing_free(scrubbing);
        return NULL;
    }
    return scrubbing;
}

/* State of a thread that still runs when the process ends. */
static struct orl_scrubbing *left_behind;

void orl_scrubbing_stop(struct orl_scrubbing *scrubbing)
{
    if (!scrubbing)
        return;
    const struct timespec until = to_timespec(orl_time_steady_s() + 1);
    int rc = 0;
    pthread_mutex_lock(&scrubbing->mutex);
    scrubbing->stop = true;
    pthread_cond_signal(&scrubbing->changed);
    while (!scrubbing->ended && rc == 0)
        rc = pthread_cond_timedwait(&scrubbing->changed, &scrubbing->mutex, &until);
    const bool ended = scrubbing->ended;
    pthread_mutex_unlock(&scrubbing->mutex);
    /* The thread may be reading a large file on a slow disk, so the process ends without it. */
    if (!ended) {
        pthread_detach(scrubbing->thread);
        left_behind = scrubbing;
        return;
    }
    pthread_join(scrubbing->thread, NULL);
    scrubbing_free(scrubbing);
}

static void log_finding(const struct orl_scrubbing *scrubbing, const struct finding *finding)
{
    const struct orl_kept_file *file = &finding->file;
    enum orl_map_removal removal;
    orl_log_event(scrubbing->log, ORL_LOG_ERROR, "damaged", "sss", "path", file->path, "job",
                  file->job[0] ? file->job : "-", "why", finding->why.message);
    if (file->kind == ORL_KEPT_MAP)
        orl_map_cache_remove(scrubbing->maps, file->map_kind, file->map_key, &removal, NULL);
}

void orl_scrubbing_look(struct orl_scrubbing *scrubbing)
{
    struct finding *findings = NULL;
    size_t count = 0;
    if (!scrubbing)
        return;
    pthread_mutex_lock(&scrubbing->mutex);
    if (scrubbing->count > 0)
        findings = malloc(scrubbing->count * sizeof *findings);
    if (findings) {
        count = scrubbing->count;
        memcpy(findings, scrubbing->findings, count * sizeof *findings);
        scrubbing->count = 0;
    }
    pthread_mutex_unlock(&scrubbing->mutex);
    for (size_t i = 0; i < count; i++)
        log_finding(scrubbing, &findings[i]);
    free(findings);
}

struct orl_scrub_totals orl_scrubbing_totals(struct orl_scrubbing *scrubbing)
{
    struct orl_scrub_totals totals = {0};
    if (!scrubbing)
        return totals;
    pthread_mutex_lock(&scrubbing->mutex);
    totals = scrubbing->totals;
    pthread_mutex_unlock(&scrubbing->mutex);
    return totals;
}
