#include "maintenance/storage.h"

#include <stdlib.h>
#include <string.h>
#include <sys/statvfs.h>

#include "jobs/job_results.h"
#include "process/limits.h"
#include "process/times.h"

const char *const orl_stored_names[ORL_STORED_COUNT] = {"maps", "bsdfs", "results", "uploads"};

uint64_t orl_storage_default(const char *folder, uint64_t used)
{
    struct statvfs disk;
    uint64_t free_bytes = 0;
    if (statvfs(folder, &disk) == 0)
        free_bytes = (uint64_t)disk.f_bavail * disk.f_frsize;
    return free_bytes / 2 + used / 2;
}

void orl_storage_usage(const struct orl_storage *storage, uint64_t ret_bytes[ORL_STORED_COUNT])
{
    struct orl_map_cache_totals totals;
    orl_map_cache_totals(storage->maps, &totals);
    ret_bytes[ORL_STORED_MAPS] = totals.bytes - totals.bsdf_bytes;
    ret_bytes[ORL_STORED_BSDFS] = totals.bsdf_bytes;
    ret_bytes[ORL_STORED_RESULTS] = orl_job_results_bytes(storage->jobs);
    ret_bytes[ORL_STORED_UPLOADS] = orl_blobs_bytes(storage->blobs);
}

uint64_t orl_storage_total(const struct orl_storage *storage)
{
    uint64_t bytes[ORL_STORED_COUNT], total = 0;
    orl_storage_usage(storage, bytes);
    for (int i = 0; i < ORL_STORED_COUNT; i++)
        total += bytes[i];
    return total;
}

/* ---- Eviction ------------------------------------------------------------------------------- */

/* Something that may be evicted. */
struct candidate {
    int64_t used_ms;
    uint64_t bytes;
    const struct orl_map_info *map; /* NULL: a job's results */
    const char *job;
};

static int compare_use(const void *a, const void *b)
{
    const struct candidate *x = a, *y = b;
    return (x->used_ms > y->used_ms) - (x->used_ms < y->used_ms);
}

static bool is_evictable(const struct orl_jobs_job *job, int64_t now_ms)
{
    const int64_t spared_ms = 1000 * (int64_t)ORL_SERVER_UNFETCHED_S;
    return orl_job_results_exist(job) &&
           (job->row.fetched_ms > 0 || now_ms - job->row.retained_ms >= spared_ms);
}

/* Returns everything that may be evicted, least recently used first; owned. NULL: out of memory. */
static struct candidate *list_candidates(const struct orl_storage *storage,
                                         const struct orl_stored_map *maps, size_t n_maps,
                                         size_t *ret_count)
{
    const struct orl_jobs *jobs = storage->jobs;
    const size_t n_jobs =
        orl_jobs_count(jobs, ORL_JOB_SUCCEEDED) + orl_jobs_count(jobs, ORL_JOB_CANCELLED);
    struct candidate *list = calloc(n_maps + n_jobs + 1, sizeof *list);
    const int64_t now_ms = orl_retention_clock_ms(storage->clock);
    size_t count = 0;
    if (!list)
        return NULL;
    for (size_t i = 0; i < n_maps; i++)
        if (!maps[i].in_use)
            list[count++] = (struct candidate){
                .used_ms = maps[i].last_used_ms, .bytes = maps[i].info.bytes, .map = &maps[i].info};
    for (const struct orl_jobs_job *job = orl_jobs_newest(jobs); job; job = job->older)
        if (is_evictable(job, now_ms))
            list[count++] = (struct candidate){.used_ms = orl_job_results_used_ms(job),
                                               .bytes = job->row.result_bytes,
                                               .job = job->row.id};
    qsort(list, count, sizeof *list, compare_use);
    *ret_count = count;
    return list;
}

/* Deletes a candidate's row. *ret_leaves is false for a map that has come into use, which stays. */
static int delete_row(struct orl_storage *storage, const struct candidate *candidate,
                      bool *ret_leaves, struct orl_error *err)
{
    enum orl_map_removal removal = ORL_MAP_REMOVED;
    const struct orl_map_info *map = candidate->map;
    const int rc =
        map ? orl_map_cache_begin_removal(storage->maps, map->kind, map->key, &removal, err)
            : orl_job_results_mark_evicted(storage->jobs, candidate->job, err);
    *ret_leaves = removal == ORL_MAP_REMOVED;
    return rc;
}

/* Deletes a candidate's file if its row is safely gone; otherwise the candidate stays. */
static void end_eviction(struct orl_storage *storage, const struct candidate *candidate, bool gone)
{
    const struct orl_map_info *map = candidate->map;
    enum orl_stored kind = ORL_STORED_RESULTS;
    if (map) {
        kind = strcmp(map->kind, "bsdf") == 0 ? ORL_STORED_BSDFS : ORL_STORED_MAPS;
        orl_map_cache_end_removal(storage->maps, map->kind, map->key, gone);
    } else if (gone) {
        orl_job_results_delete_files(storage->jobs, candidate->job);
    }
    if (!gone)
        return;
    storage->evicted[kind]++;
    orl_log_event(storage->log, ORL_LOG_INFO, "evicted", "ssi", "what", orl_stored_names[kind],
                  "name", map ? map->key : candidate->job, "bytes", (int64_t)candidate->bytes);
}

/*
 * Evicts the first of the list until so many bytes are freed. Their rows go in one transaction;
 * then their files. If the database refuses, all of them stay, and more recently used ones are not
 * evicted in their place.
 */
static void evict_first(struct orl_storage *storage, struct candidate *list, size_t count,
                        uint64_t bytes)
{
    struct orl_error err = {0};
    size_t n_leaving = 0;
    uint64_t leaving = 0;
    int rc = orl_db_begin(storage->db, &err);
    const bool begun = rc == 0;
    for (size_t i = 0; i < count && leaving < bytes && rc == 0; i++) {
        bool leaves = false;
        rc = delete_row(storage, &list[i], &leaves, &err);
        if (!leaves)
            continue;
        leaving += list[i].bytes;
        list[n_leaving++] = list[i];
    }
    if (begun)
        rc = orl_db_end(storage->db, rc, &err);
    if (rc)
        orl_log_event(storage->log, ORL_LOG_ERROR, "eviction-failed", "s", "why", err.message);
    for (size_t i = 0; i < n_leaving; i++)
        end_eviction(storage, &list[i], rc == 0);
}

enum shrink_how { SHRINK_AS_FAR_AS_IT_GOES, SHRINK_OR_LEAVE };

/*
 * Shrinks the data to at most that many bytes; returns the bytes left. SHRINK_OR_LEAVE evicts
 * nothing if evicting everything would not be enough.
 */
static uint64_t shrink_to(struct orl_storage *storage, uint64_t most, enum shrink_how how)
{
    uint64_t used = orl_storage_total(storage), stays = used;
    struct orl_stored_map *maps = NULL;
    struct candidate *list = NULL;
    size_t n_maps = 0, count = 0;
    if (used <= most || orl_map_cache_list(storage->maps, &maps, &n_maps, NULL))
        return used;
    list = list_candidates(storage, maps, n_maps, &count);
    for (size_t i = 0; list && i < count; i++)
        stays -= list[i].bytes;
    if (list && count > 0 && (how == SHRINK_AS_FAR_AS_IT_GOES || stays <= most))
        evict_first(storage, list, count, used - most);
    free(list);
    free(maps);
    return orl_storage_total(storage);
}

/* Returns the stored bytes that must stay. */
static uint64_t count_staying(struct orl_storage *storage)
{
    uint64_t bytes = orl_storage_total(storage);
    struct orl_stored_map *maps = NULL;
    size_t n_maps = 0, count = 0;
    if (orl_map_cache_list(storage->maps, &maps, &n_maps, NULL))
        return bytes;
    struct candidate *list = list_candidates(storage, maps, n_maps, &count);
    for (size_t i = 0; list && i < count; i++)
        bytes -= list[i].bytes;
    free(list);
    free(maps);
    return bytes;
}

/* Sets the quota of data in flight. Candidates for eviction are listed only if more than half of
 * the budget is taken, since otherwise the result does not matter. */
static void set_upload_quota(struct orl_storage *storage)
{
    const uint64_t promised = orl_job_results_expected(storage->jobs);
    uint64_t taken = orl_storage_total(storage) + promised;
    if (taken > storage->budget / 2)
        taken = count_staying(storage) + promised;
    atomic_store(&storage->upload_quota.most,
                 taken < storage->budget ? storage->budget - taken : 0);
}

void orl_storage_evict(struct orl_storage *storage)
{
    const uint64_t reserved = atomic_load(&storage->upload_quota.reserved);
    shrink_to(storage, storage->budget > reserved ? storage->budget - reserved : 0,
              SHRINK_AS_FAR_AS_IT_GOES);
    set_upload_quota(storage);
}

void orl_storage_check(struct orl_storage *storage)
{
    if (atomic_load(&storage->upload_quota.reserved) > 0)
        orl_storage_evict(storage);
}

bool orl_storage_reserve_body(struct orl_storage *storage, struct orl_reservation *reservation,
                              uint64_t bytes)
{
    set_upload_quota(storage);
    return orl_reservation_grow(reservation, bytes, NULL) == 0;
}

bool orl_storage_admit(struct orl_storage *storage, const struct orl_reservation *reservation,
                       uint64_t bytes)
{
    const uint64_t budget = storage->budget, own = reservation->bytes;
    const uint64_t promised = (bytes > own ? bytes - own : 0) +
                              atomic_load(&storage->upload_quota.reserved) +
                              orl_job_results_expected(storage->jobs);
    if (promised <= budget &&
        shrink_to(storage, budget - promised, SHRINK_OR_LEAVE) <= budget - promised) {
        set_upload_quota(storage);
        return true;
    }
    return false;
}

/* ---- Times of fetches ----------------------------------------------------------------------- */

static void save_fetch_times(uv_timer_t *timer)
{
    const struct orl_storage *storage = timer->data;
    orl_job_results_flush(storage->jobs);
}

void orl_storage_fetched(struct orl_storage *storage, const char *job_id)
{
    enum { DELAY_MS = 2000 };
    orl_job_results_fetched(storage->jobs, job_id);
    if (!uv_is_active((const uv_handle_t *)&storage->fetch_timer) &&
        !uv_is_closing((const uv_handle_t *)&storage->fetch_timer))
        uv_timer_start(&storage->fetch_timer, save_fetch_times, DELAY_MS, 0);
}

void orl_storage_stop(struct orl_storage *storage)
{
    if (storage->jobs)
        orl_job_results_flush(storage->jobs);
    if (!uv_is_closing((const uv_handle_t *)&storage->fetch_timer))
        uv_close((uv_handle_t *)&storage->fetch_timer, NULL);
}
