#include "annual/year/annual_cache.h"

#include <sodium.h>
#include <stdlib.h>
#include <string.h>

#include <oriel/base/sha256.h>

#include "annual/year/annual_year.h"
#include "run/cache/word_file.h"

/* Version of the computation and of the array layout; raise it when either changes. */
static const char recipe[] = "oriel annual 11";
static const char kind[] = "annual";

/* ---- Keys ------------------------------------------------------------------------------------ */

static void finish_key(struct orl_sha256 *hash, char ret_hex[ORL_DIGEST_HEX + 1])
{
    unsigned char digest[ORL_SHA256_BYTES];
    orl_sha256_finish(hash, digest);
    sodium_bin2hex(ret_hex, ORL_DIGEST_HEX + 1, digest, sizeof digest);
}

static void add_vector(struct orl_sha256 *hash, struct orl_vec3 v)
{
    const double numbers[] = {v.x, v.y, v.z};
    orl_sha256_add(hash, numbers, sizeof numbers);
}

static bool may_store(const struct orl_year *year)
{
    const size_t most = year->env->reuse_most;
    if (year->env->run->tasks && year->env->run->store)
        return true;
    return year->env->reuse && (most == 0 || year->request->n_sensors <= most);
}

void orl_annual_cache_init(struct orl_annual_cache *cache, struct orl_year *year)
{
    const struct orl_year_suns *suns = &year->hours.suns;
    const double numbers[] = {year->request->north_deg,
                              year->result->site.latitude_deg,
                              (double)suns->count,
                              (double)year->nodes.count,
                              (double)year->request->technique,
                              (double)year->request->photons};
    struct orl_sha256 hash;
    *cache = (struct orl_annual_cache){.year = year,
                                       .store = may_store(year) ? year->env->run->store : NULL};
    cache->disabled = cache->store == NULL;
    orl_sha256_init(&hash);
    orl_sha256_add(&hash, recipe, sizeof recipe);
    orl_sha256_add(&hash, year->digest, ORL_SHA256_BYTES);
    orl_sha256_add(&hash, &year->request->seed, sizeof year->request->seed);
    orl_sha256_add(&hash, numbers, sizeof numbers);
    for (size_t i = 0; i < suns->count; i++) {
        add_vector(&hash, suns->at[i].towards);
        orl_sha256_add(&hash, &suns->at[i].angle_rad, sizeof suns->at[i].angle_rad);
    }
    finish_key(&hash, cache->site);
    year->result->reuse.asked = cache->store != NULL;
}

static void name_entry(const struct orl_annual_cache *cache, struct orl_annual_cache_entry *entry)
{
    const uint32_t samples = cache->year->request->samples;
    const uint64_t numbers[] = {
        (uint64_t)entry->data_kind, entry->first, entry->count,
        entry->data_kind == ORL_ANNUAL_CACHE_SUNLIGHT ? orl_disc_points(samples) : 0};
    const struct orl_job_tasks *const shared = cache->year->env->run->tasks;
    const char *const job = shared && shared->job ? shared->job : "";
    struct orl_sha256 hash;
    orl_sha256_init(&hash);
    orl_sha256_add(&hash, cache->site, ORL_DIGEST_HEX);
    orl_sha256_add(&hash, numbers, sizeof numbers);
    for (size_t i = entry->first; i < entry->first + entry->count; i++) {
        add_vector(&hash, cache->year->request->sensors[i].position);
        add_vector(&hash, cache->year->request->sensors[i].direction);
    }
    finish_key(&hash, entry->key);
    if (entry->data_kind != ORL_ANNUAL_CACHE_PATHS && entry->data_kind != ORL_ANNUAL_CACHE_ROWS)
        return;
    memcpy(entry->family, entry->key, sizeof entry->family);
    orl_sha256_init(&hash);
    orl_sha256_add(&hash, entry->family, ORL_DIGEST_HEX);
    orl_sha256_add(&hash, &entry->samples, sizeof entry->samples);
    if (entry->data_kind == ORL_ANNUAL_CACHE_ROWS) {
        orl_sha256_add(&hash, job, strlen(job));
        const unsigned char *wanted = orl_year_wanted(cache->year, 0); /* of all window groups */
        if (wanted)
            orl_sha256_add(&hash, wanted,
                           cache->year->n_window_groups * cache->year->hours.n_columns);
    }
    finish_key(&hash, entry->key);
}

/* ---- Look-up --------------------------------------------------------------------------------- */

static void disable_store(struct orl_annual_cache *cache, const struct orl_error *why)
{
    cache->disabled = true;
    cache->why = *why;
}

static struct orl_annual_cache_stats *counters_of(struct orl_annual_cache *cache,
                                                  const struct orl_annual_cache_entry *entry)
{
    return entry->data_kind < ORL_ANNUAL_CACHE_KINDS
               ? &cache->year->result->reuse.of[entry->data_kind]
               : &cache->rows_stats;
}

/* Reads an entry that the store has; abandons it if it is damaged. */
static void read_entry(struct orl_annual_cache *cache, struct orl_annual_cache_entry *entry)
{
    struct orl_word_file_info file_info;
    if (orl_word_file_read(entry->path, entry->key, &file_info, &entry->data, &entry->size, NULL) ==
        0) {
        entry->stored_samples = entry->samples;
        entry->rays = file_info.rays;
        counters_of(cache, entry)->found++;
        counters_of(cache, entry)->rays_saved += file_info.rays;
        cache->store->release(cache->store->ctx, kind, entry->key);
        return;
    }
    cache->damaged = true;
    cache->store->abandon(cache->store->ctx, kind, entry->key);
}

/* Looks for paths with fewer samples. A damaged entry is left for a run that requests exactly that
 * entry. */
static void read_fewer_samples(struct orl_annual_cache *cache, struct orl_annual_cache_entry *entry)
{
    const struct orl_map_store *store = cache->store;
    struct orl_map_info info;
    struct orl_word_file_info file_info;
    char path[4096];
    bool found = false;
    if (entry->data_kind != ORL_ANNUAL_CACHE_PATHS || !store->find_smaller ||
        store->find_smaller(store->ctx, kind, entry->family, entry->samples, path, &found, &info,
                            NULL) < 0 ||
        !found)
        return;
    if (orl_word_file_read(path, info.key, &file_info, &entry->data, &entry->size, NULL) == 0) {
        entry->stored_samples = (uint32_t)file_info.target;
        entry->rays = file_info.rays;
        entry->stored_s = info.seconds;
        counters_of(cache, entry)->topped_up++;
        counters_of(cache, entry)->rays_saved += file_info.rays;
    }
    store->release(store->ctx, kind, info.key);
}

bool orl_annual_cache_has(struct orl_annual_cache *cache, struct orl_annual_cache_entry *entry)
{
    struct orl_map_info info;
    bool hit = false;
    if (cache->disabled)
        return false;
    name_entry(cache, entry);
    if (cache->store->acquire(cache->store->ctx, kind, entry->key, cache->year->env->run->cancel,
                              entry->path, &hit, &info, NULL) < 0)
        return false;
    if (hit)
        cache->store->release(cache->store->ctx, kind, entry->key);
    else
        cache->store->abandon(cache->store->ctx, kind, entry->key);
    return hit;
}

/* Distributed runs: asks other processes to compute what all chunks need. */
static int distribute_entry(struct orl_annual_cache *cache, struct orl_annual_cache_entry *entry,
                            struct orl_error *err)
{
    const struct orl_job_tasks *tasks = cache->year->env->run->tasks;
    struct orl_job_task job_task = {.work = 1, .core_s = entry->core_s};
    bool here = false;
    if (!tasks || cache->disabled ||
        (entry->data_kind != ORL_ANNUAL_CACHE_SUN_WEIGHTS &&
         entry->data_kind != ORL_ANNUAL_CACHE_SUN_MAP) ||
        orl_annual_cache_has(cache, entry))
        return 0;
    memcpy(job_task.kind, kind, sizeof kind);
    memcpy(job_task.key, entry->key, sizeof job_task.key);
    return orl_job_tasks_claim(tasks, &job_task, 1, &here, NULL, err);
}

int orl_annual_cache_get(struct orl_annual_cache *cache, struct orl_annual_cache_entry *entry,
                         struct orl_error *err)
{
    const struct orl_run_env *run = cache->year->env->run;
    struct orl_map_info info;
    struct orl_error why = {0};
    bool hit = true;
    const int shared = distribute_entry(cache, entry, err);
    entry->start_s = orl_year_now(cache->year);
    if (shared < 0)
        return shared;
    if (!cache->disabled)
        name_entry(cache, entry);
    for (int attempt = 0; attempt < 2 && !cache->disabled && hit && !entry->data; attempt++) {
        const int code = cache->store->acquire(cache->store->ctx, kind, entry->key, run->cancel,
                                               entry->path, &hit, &info, &why);
        if (code == ORL_ERR_CANCELLED)
            return orl_error_set(err, code, "cancelled");
        if (code < 0)
            disable_store(cache, &why);
        else if (hit)
            read_entry(cache, entry);
        else
            entry->must_commit = true;
    }
    if (entry->must_commit)
        read_fewer_samples(cache, entry);
    if (cache->store && !entry->data)
        counters_of(cache, entry)->made++;
    return 0;
}

/* ---- Storing --------------------------------------------------------------------------------- */

void orl_annual_cache_put(struct orl_annual_cache *cache, struct orl_annual_cache_entry *entry,
                          void *data, size_t size)
{
    struct orl_word_file_info file_info = {.target = entry->samples, .rays = entry->rays};
    struct orl_error why = {0};
    if (!entry->must_commit || !data) {
        free(data);
        return;
    }
    memcpy(file_info.key, entry->key, sizeof file_info.key);
    memcpy(file_info.family, entry->family, sizeof file_info.family);
    int code = orl_word_file_write(entry->path, &file_info, data, size, &why);
    free(data);
    if (code == 0) {
        struct orl_map_info info = {.target = entry->samples,
                                    .emitted = entry->rays,
                                    .stored = size / sizeof(float),
                                    .bytes = file_info.bytes,
                                    .seconds = entry->stored_s + orl_year_now(cache->year) -
                                               entry->start_s};
        memcpy(info.kind, kind, sizeof kind);
        memcpy(info.key, entry->key, sizeof info.key);
        memcpy(info.family, entry->family, sizeof info.family);
        code = cache->store->commit(cache->store->ctx, &info, &why);
    }
    if (code < 0) {
        orl_annual_cache_release(cache, entry);
        disable_store(cache, &why);
        return;
    }
    cache->store->release(cache->store->ctx, kind, entry->key);
    entry->must_commit = false;
}

void orl_annual_cache_release(struct orl_annual_cache *cache, struct orl_annual_cache_entry *entry)
{
    if (entry->must_commit)
        cache->store->abandon(cache->store->ctx, kind, entry->key);
    entry->must_commit = false;
    free(entry->data);
    entry->data = NULL;
}

void orl_annual_cache_report(struct orl_annual_cache *cache)
{
    cache->year->warnings_emitted = false;
    if (cache->damaged)
        orl_year_warn(
            cache->year,
            "cached light of this year was damaged or out of date: it was computed again");
    if (cache->why.code < 0)
        orl_year_warn(cache->year, "light of this year could not be cached for later jobs: %s",
                      cache->why.message);
}
