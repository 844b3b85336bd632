#include "annual/year/annual_cache.h"

#include <sodium.h>
#include <stdlib.h>
#include <string.h>

#include <oriel/sha256.h>

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

static bool may_keep(const struct orl_year *year)
{
    const size_t most = year->env->reuse_most;
    if (year->env->run->pieces && year->env->run->store)
        return true;
    return year->env->reuse && (most == 0 || year->request->n_sensors <= most);
}

void orl_keep_begin(struct orl_keep *keep, struct orl_year *year, const unsigned char *scene)
{
    const struct orl_year_suns *suns = &year->hours.suns;
    const double numbers[] = {year->request->north_deg,
                              year->result->latitude_deg,
                              (double)suns->count,
                              (double)year->nodes.count,
                              (double)year->request->technique,
                              (double)year->request->photons};
    struct orl_sha256 hash;
    *keep = (struct orl_keep){.year = year, .store = may_keep(year) ? year->env->run->store : NULL};
    keep->off = keep->store == NULL;
    orl_sha256_init(&hash);
    orl_sha256_add(&hash, recipe, sizeof recipe);
    orl_sha256_add(&hash, scene, ORL_SHA256_BYTES);
    orl_sha256_add(&hash, &year->request->seed, sizeof year->request->seed);
    orl_sha256_add(&hash, numbers, sizeof numbers);
    for (size_t i = 0; i < suns->count; i++) {
        add_vector(&hash, suns->at[i].towards);
        orl_sha256_add(&hash, &suns->at[i].angle_rad, sizeof suns->at[i].angle_rad);
    }
    finish_key(&hash, keep->site);
    year->result->reuse.asked = keep->store != NULL;
}

/* Adds the columns that want light, by part, to the digest. */
static void add_wanted(struct orl_sha256 *hash, const struct orl_year *year)
{
    const struct orl_year_parts *parts = year->variant ? year->variant->parts : NULL;
    if (parts && parts->wanted)
        orl_sha256_add(hash, parts->wanted, year->n_parts * year->hours.n_columns);
}

static void name_entry(const struct orl_keep *keep, struct orl_keeping *it)
{
    const uint32_t samples = keep->year->request->samples;
    const uint64_t numbers[] = {(uint64_t)it->what, it->first, it->count,
                                it->what == ORL_YEARS_SUN ? orl_disc_points(samples) : 0};
    const struct orl_pieces *const shared = keep->year->env->run->pieces;
    const char *const job = shared && shared->job ? shared->job : "";
    struct orl_sha256 hash;
    orl_sha256_init(&hash);
    orl_sha256_add(&hash, keep->site, ORL_DIGEST_HEX);
    orl_sha256_add(&hash, numbers, sizeof numbers);
    for (size_t i = it->first; i < it->first + it->count; i++) {
        add_vector(&hash, keep->year->request->sensors[i].position);
        add_vector(&hash, keep->year->request->sensors[i].direction);
    }
    finish_key(&hash, it->key);
    if (it->what != ORL_YEARS_PATHS && it->what != ORL_YEARS_ROWS)
        return;
    memcpy(it->family, it->key, sizeof it->family);
    orl_sha256_init(&hash);
    orl_sha256_add(&hash, it->family, ORL_DIGEST_HEX);
    orl_sha256_add(&hash, &it->samples, sizeof it->samples);
    if (it->what == ORL_YEARS_ROWS) {
        orl_sha256_add(&hash, job, strlen(job));
        add_wanted(&hash, keep->year);
    }
    finish_key(&hash, it->key);
}

/* ---- Look-up --------------------------------------------------------------------------------- */

static void disable_store(struct orl_keep *keep, const struct orl_error *why)
{
    keep->off = true;
    keep->why = *why;
}

static struct orl_annual_reused *counters_of(struct orl_keep *keep, const struct orl_keeping *it)
{
    return it->what < ORL_YEARS_KINDS ? &keep->year->result->reuse.of[it->what] : &keep->rows;
}

/* Reads an entry that the store has; abandons it if it is damaged. */
static void read_entry(struct orl_keep *keep, struct orl_keeping *it)
{
    struct orl_kept_about about;
    if (orl_kept_read(it->path, it->key, &about, &it->data, &it->size, NULL) == 0) {
        it->had = it->samples;
        it->rays = about.rays;
        counters_of(keep, it)->found++;
        counters_of(keep, it)->rays_saved += about.rays;
        keep->store->release(keep->store->ctx, kind, it->key);
        return;
    }
    keep->damaged = true;
    keep->store->abandon(keep->store->ctx, kind, it->key);
}

/* Looks for paths with fewer samples. A damaged entry is left for a run that requests exactly that
 * entry. */
static void read_smaller(struct orl_keep *keep, struct orl_keeping *it)
{
    const struct orl_map_store *store = keep->store;
    struct orl_map_info info;
    struct orl_kept_about about;
    char path[4096];
    bool found = false;
    if (it->what != ORL_YEARS_PATHS || !store->find_smaller ||
        store->find_smaller(store->ctx, kind, it->family, it->samples, path, &found, &info, NULL) <
            0 ||
        !found)
        return;
    if (orl_kept_read(path, info.key, &about, &it->data, &it->size, NULL) == 0) {
        it->had = (uint32_t)about.target;
        it->rays = about.rays;
        it->earlier_s = info.seconds;
        counters_of(keep, it)->topped_up++;
        counters_of(keep, it)->rays_saved += about.rays;
    }
    store->release(store->ctx, kind, info.key);
}

bool orl_keep_has(struct orl_keep *keep, struct orl_keeping *it)
{
    struct orl_map_info info;
    bool hit = false;
    if (keep->off)
        return false;
    name_entry(keep, it);
    if (keep->store->acquire(keep->store->ctx, kind, it->key, keep->year->env->run->cancel,
                             it->path, &hit, &info, NULL) < 0)
        return false;
    if (hit)
        keep->store->release(keep->store->ctx, kind, it->key);
    else
        keep->store->abandon(keep->store->ctx, kind, it->key);
    return hit;
}

/* Distributed runs: asks other processes to compute what all blocks need. */
static int share_entry(struct orl_keep *keep, struct orl_keeping *it, struct orl_error *err)
{
    const struct orl_pieces *pieces = keep->year->env->run->pieces;
    struct orl_piece piece = {.work = 1, .core_s = it->core_s};
    bool here = false;
    if (!pieces || keep->off || (it->what != ORL_YEARS_SUNS && it->what != ORL_YEARS_MAP) ||
        orl_keep_has(keep, it))
        return 0;
    memcpy(piece.kind, kind, sizeof kind);
    memcpy(piece.key, it->key, sizeof piece.key);
    return pieces->divide(pieces->ctx, &piece, 1, &here, NULL, err);
}

int orl_keep_ask(struct orl_keep *keep, struct orl_keeping *it, struct orl_error *err)
{
    const struct orl_run_env *run = keep->year->env->run;
    struct orl_map_info info;
    struct orl_error why = {0};
    bool hit = true;
    const int shared = share_entry(keep, it, err);
    it->began_s = orl_year_now(keep->year);
    if (shared < 0)
        return shared;
    if (!keep->off)
        name_entry(keep, it);
    for (int attempt = 0; attempt < 2 && !keep->off && hit && !it->data; attempt++) {
        const int code = keep->store->acquire(keep->store->ctx, kind, it->key, run->cancel,
                                              it->path, &hit, &info, &why);
        if (code == ORL_ERR_CANCELLED)
            return orl_error_set(err, code, "cancelled");
        if (code < 0)
            disable_store(keep, &why);
        else if (hit)
            read_entry(keep, it);
        else
            it->owed = true;
    }
    if (it->owed)
        read_smaller(keep, it);
    if (keep->store && !it->data)
        counters_of(keep, it)->made++;
    return 0;
}

/* ---- Storing --------------------------------------------------------------------------------- */

void orl_keep_put(struct orl_keep *keep, struct orl_keeping *it, const void *data, size_t size)
{
    struct orl_kept_about about = {.target = it->samples, .rays = it->rays};
    struct orl_error why = {0};
    if (!it->owed)
        return;
    memcpy(about.key, it->key, sizeof about.key);
    memcpy(about.family, it->family, sizeof about.family);
    int code = orl_kept_write(it->path, &about, data, size, &why);
    if (code == 0) {
        struct orl_map_info info = {.target = it->samples,
                                    .emitted = it->rays,
                                    .stored = size / sizeof(float),
                                    .bytes = about.bytes,
                                    .seconds =
                                        it->earlier_s + orl_year_now(keep->year) - it->began_s};
        memcpy(info.kind, kind, sizeof kind);
        memcpy(info.key, it->key, sizeof info.key);
        memcpy(info.family, it->family, sizeof info.family);
        code = keep->store->commit(keep->store->ctx, &info, &why);
    }
    if (code < 0) {
        orl_keep_done(keep, it);
        disable_store(keep, &why);
        return;
    }
    keep->store->release(keep->store->ctx, kind, it->key);
    it->owed = false;
}

void orl_keep_done(struct orl_keep *keep, struct orl_keeping *it)
{
    if (it->owed)
        keep->store->abandon(keep->store->ctx, kind, it->key);
    it->owed = false;
    free(it->data);
    it->data = NULL;
}

void orl_keep_end(struct orl_keep *keep)
{
    keep->year->hushed = false;
    if (keep->damaged)
        orl_year_warn(keep->year, "parts of this year's light were kept, but damaged or out of "
                                  "date: they were made again");
    if (keep->why.code < 0)
        orl_year_warn(keep->year,
                      "what this year's light is made of is not kept for later jobs: %s",
                      keep->why.message);
}
