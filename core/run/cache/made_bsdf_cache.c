/*
 * Caches computed BSDFs in a store (oriel/bsdf/bsdf_store.h): those made of a panel, and those
 * fitted to measurements.
 */
#include <stdlib.h>
#include <string.h>

#include <oriel/bsdf/bsdf_store.h>

#include "run/cache/word_file.h"

/* Operations for one kind of BSDF; ctx receives the result. */
struct orl_made_bsdf_calls {
    void *ctx;
    int (*make)(void *ctx, struct orl_error *err);
    /* Serialises to whole words, owned by the caller; NULL: out of memory. */
    char *(*pack)(const void *ctx, size_t *ret_size, uint64_t *ret_effort);
    /* Returns false if the data are malformed or memory is exhausted. */
    bool (*unpack)(void *ctx, const char *data, size_t size);
};

static bool read_cached(const struct orl_made_bsdf_calls *bsdf_calls, const char *path,
                        const char *key)
{
    struct orl_word_file_info file_info;
    void *data = NULL;
    size_t size = 0;
    if (orl_word_file_read(path, key, &file_info, &data, &size, NULL) < 0)
        return false;
    const bool found = bsdf_calls->unpack(bsdf_calls->ctx, data, size);
    free(data);
    return found;
}

/* Stores the BSDF. Returns false on failure; the next job then makes it again. */
static bool store_bsdf(const struct orl_made_bsdf_calls *bsdf_calls,
                       const struct orl_map_store *store, const char *path,
                       struct orl_map_info *info)
{
    struct orl_word_file_info file_info = {.rays = 0};
    size_t size = 0;
    char *data = bsdf_calls->pack(bsdf_calls->ctx, &size, &file_info.rays);
    memcpy(file_info.key, info->key, sizeof file_info.key);
    const bool written = data && orl_word_file_write(path, &file_info, data, size, NULL) == 0;
    free(data);
    info->emitted = file_info.rays;
    info->stored = size / sizeof(float);
    info->bytes = file_info.bytes;
    return written && store->commit(store->ctx, info, NULL) == 0;
}

static int make_and_store(const struct orl_made_bsdf_calls *bsdf_calls,
                          const struct orl_bsdf_make_env *env,
                          const struct orl_bsdf_cache_key *cache_key, const char *path,
                          struct orl_map_info *info, struct orl_error *err)
{
    const struct orl_map_store *store = cache_key->store;
    const double began_s = cache_key->now_s(env->ctx);
    const int code = bsdf_calls->make(bsdf_calls->ctx, err);
    info->seconds = cache_key->now_s(env->ctx) - began_s;
    if (code == 0 && path[0] && store_bsdf(bsdf_calls, store, path, info))
        store->release(store->ctx, ORL_BSDF_CACHE_KIND, info->key);
    else if (path[0])
        store->abandon(store->ctx, ORL_BSDF_CACHE_KIND, info->key);
    return code;
}

/* Finds the BSDF, or makes and stores it. */
static int orl_made_bsdf_get(const struct orl_made_bsdf_calls *bsdf_calls,
                             const struct orl_bsdf_make_env *env,
                             const struct orl_bsdf_cache_key *cache_key,
                             struct orl_map_info *ret_info, struct orl_error *err)
{
    const struct orl_map_store *store = cache_key->store;
    struct orl_map_info info = {.kind = ORL_BSDF_CACHE_KIND};
    char path[4096] = "";
    bool hit = true;
    memcpy(info.key, cache_key->key, ORL_DIGEST_HEX);
    for (int attempt = 0; attempt < 2 && hit; attempt++) {
        struct orl_map_info found = info;
        const int code =
            store->acquire(store->ctx, ORL_BSDF_CACHE_KIND, cache_key->key,
                           (atomic_bool *)(uintptr_t)env->cancel, path, &hit, &found, NULL);
        if (code == ORL_ERR_CANCELLED)
            return orl_error_set(err, code, "cancelled");
        if (code < 0) { /* it is made for this job only */
            path[0] = '\0';
            break;
        }
        if (hit && read_cached(bsdf_calls, path, cache_key->key)) {
            store->release(store->ctx, ORL_BSDF_CACHE_KIND, cache_key->key);
            *ret_info = found;
            ret_info->cached = true;
            return 0;
        }
        if (hit) {
            store->abandon(store->ctx, ORL_BSDF_CACHE_KIND, cache_key->key);
            path[0] = '\0';
        }
    }
    *ret_info = info;
    return make_and_store(bsdf_calls, env, cache_key, path, ret_info, err);
}

/* ---- Serialisation --------------------------------------------------------------------------- */

/* Fixed-size header before the arrays. */
struct head {
    uint64_t paths, n_directions, xml_size;
    struct orl_bsdf_share diffuse[2][2];
    double worst, merge_error, lost, cell[4], depth[2];
    uint32_t reached, has_errors;
};

enum { PARTS = 4, WORD = 4 };

static struct head head_of(const struct orl_bsdf_make_result *m)
{
    struct head h = {.paths = m->paths,
                     .n_directions = m->n_directions,
                     .xml_size = m->xml_size,
                     .worst = m->worst,
                     .merge_error = m->merge_error,
                     .lost = m->lost,
                     .reached = m->reached,
                     .has_errors = m->errors[0][0] != NULL};
    memcpy(h.diffuse, m->diffuse, sizeof h.diffuse);
    memcpy(h.cell, m->cell, sizeof h.cell);
    memcpy(h.depth, m->depth, sizeof h.depth);
    return h;
}

static size_t directions_size(const struct head *h)
{
    return h->n_directions * sizeof(struct orl_bsdf_make_direction);
}

static size_t errors_size(const struct head *h)
{
    return h->has_errors ? h->n_directions * h->n_directions * sizeof(float) : 0;
}

/* Returns the size in whole words; the text ends with at least one 0. */
static size_t panel_size(const struct head *h)
{
    return sizeof *h + directions_size(h) + PARTS * errors_size(h) +
           (h->xml_size / WORD + 1) * WORD;
}

static char *pack_made(const struct orl_bsdf_make_result *m, size_t *ret_size)
{
    const struct head h = head_of(m);
    char *data = calloc(1, panel_size(&h)), *to = data;
    if (!data)
        return NULL;
    memcpy(to, &h, sizeof h);
    to += sizeof h;
    if (h.n_directions > 0)
        memcpy(to, m->directions, directions_size(&h));
    to += directions_size(&h);
    for (int i = 0; i < PARTS && h.has_errors; i++, to += errors_size(&h))
        memcpy(to, m->errors[i / 2][i % 2], errors_size(&h));
    memcpy(to, m->xml, h.xml_size);
    *ret_size = panel_size(&h);
    return data;
}

static void *copy_bytes(const char **from, size_t size)
{
    void *to = malloc(size + 1);
    if (to)
        memcpy(to, *from, size);
    *from += size;
    return to;
}

/* Returns false if the data are malformed or memory is exhausted. */
static bool unpack_made(const char *data, size_t size, struct orl_bsdf_make_result *ret_result)
{
    enum { MOST_DIRECTIONS = 4096 };
    struct head h;
    struct orl_bsdf_make_result m = {0};
    if (size < sizeof h)
        return false;
    memcpy(&h, data, sizeof h);
    if (h.n_directions > MOST_DIRECTIONS || h.xml_size > size || size != panel_size(&h))
        return false;
    const char *from = data + sizeof h;
    m = (struct orl_bsdf_make_result){.xml_size = h.xml_size,
                                      .n_directions = h.n_directions,
                                      .worst = h.worst,
                                      .merge_error = h.merge_error,
                                      .reached = h.reached != 0,
                                      .paths = h.paths,
                                      .lost = h.lost};
    memcpy(m.diffuse, h.diffuse, sizeof m.diffuse);
    memcpy(m.cell, h.cell, sizeof m.cell);
    memcpy(m.depth, h.depth, sizeof m.depth);
    m.directions = copy_bytes(&from, directions_size(&h));
    bool whole = m.directions != NULL;
    for (int i = 0; i < PARTS && h.has_errors; i++) {
        m.errors[i / 2][i % 2] = copy_bytes(&from, errors_size(&h));
        whole = whole && m.errors[i / 2][i % 2];
    }
    m.xml = copy_bytes(&from, h.xml_size + 1);
    if (whole && m.xml && m.xml[h.xml_size] == '\0') {
        *ret_result = m;
        return true;
    }
    orl_bsdf_make_result_done(&m);
    return false;
}

/* ---- The panel ------------------------------------------------------------------------------- */

struct panel {
    const struct orl_bsdf_make_request *request;
    const struct orl_bsdf_make_env *env;
    struct orl_bsdf_make_result *result;
};

static int make_panel(void *ctx, struct orl_error *err)
{
    const struct panel *p = ctx;
    return orl_bsdf_make(p->request, p->env, p->result, err);
}

static char *pack_panel(const void *ctx, size_t *ret_size, uint64_t *ret_effort)
{
    const struct panel *p = ctx;
    *ret_effort = p->result->paths;
    return pack_made(p->result, ret_size);
}

static bool unpack_panel(void *ctx, const char *data, size_t size)
{
    const struct panel *p = ctx;
    return unpack_made(data, size, p->result);
}

int orl_bsdf_make_cached(const struct orl_bsdf_make_request *request,
                         const struct orl_bsdf_make_env *env,
                         const struct orl_bsdf_cache_key *cache_key, struct orl_map_info *ret_info,
                         struct orl_bsdf_make_result *ret_result, struct orl_error *err)
{
    struct panel panel = {request, env, ret_result};
    if (request->want_errors)
        return orl_error_set(err, ORL_ERR_INVALID, "errors as XML are not kept");
    const struct orl_made_bsdf_calls bsdf_calls = {&panel, make_panel, pack_panel, unpack_panel};
    return orl_made_bsdf_get(&bsdf_calls, env, cache_key, ret_info, err);
}

/* Serialises a BSDF fitted to measurements; only for the machine that wrote it. */

/* Returns the total size: the struct without pointers, its scans, and the text with at least
 * one 0. */
static size_t fit_size(const struct orl_bsdf_fit_result *f)
{
    return sizeof *f + f->n_scans * sizeof *f->scans + (f->xml_size / WORD + 1) * WORD;
}

struct fit {
    const struct orl_bsdf_fit_request *request;
    const struct orl_bsdf_make_env *env;
    struct orl_bsdf_fit_result *result;
};

static int make_fit(void *ctx, struct orl_error *err)
{
    const struct fit *fit = ctx;
    return orl_bsdf_fit(fit->request, fit->env, fit->result, err);
}

static char *pack_fit(const void *ctx, size_t *ret_size, uint64_t *ret_effort)
{
    const struct fit *fit = ctx;
    const struct orl_bsdf_fit_result *f = fit->result;
    struct orl_bsdf_fit_result *head = calloc(1, fit_size(f));
    *ret_effort = f->rows;
    if (!head)
        return NULL;
    *head = *f;
    head->xml = NULL;
    head->scans = NULL;
    char *to = (char *)(head + 1);
    memcpy(to, f->scans, f->n_scans * sizeof *f->scans);
    memcpy(to + f->n_scans * sizeof *f->scans, f->xml, f->xml_size);
    *ret_size = fit_size(f);
    return (char *)head;
}

static bool unpack_fit(void *ctx, const char *data, size_t size)
{
    const struct fit *fit = ctx;
    struct orl_bsdf_fit_result f;
    if (size < sizeof f)
        return false;
    memcpy(&f, data, sizeof f);
    if (f.n_scans > size / sizeof *f.scans || f.xml_size > size || size != fit_size(&f))
        return false;
    const char *from = data + sizeof f;
    const size_t scans = f.n_scans * sizeof *f.scans;
    f.scans = malloc(scans + 1);
    f.xml = malloc(f.xml_size + 1);
    if (!f.scans || !f.xml) {
        orl_bsdf_fit_result_done(&f);
        return false;
    }
    memcpy(f.scans, from, scans);
    memcpy(f.xml, from + scans, f.xml_size + 1);
    f.xml[f.xml_size] = '\0';
    *fit->result = f;
    return true;
}

int orl_bsdf_fit_cached(const struct orl_bsdf_fit_request *request,
                        const struct orl_bsdf_make_env *env,
                        const struct orl_bsdf_cache_key *cache_key, struct orl_map_info *ret_info,
                        struct orl_bsdf_fit_result *ret_result, struct orl_error *err)
{
    struct fit fit = {request, env, ret_result};
    const struct orl_made_bsdf_calls bsdf_calls = {&fit, make_fit, pack_fit, unpack_fit};
    return orl_made_bsdf_get(&bsdf_calls, env, cache_key, ret_info, err);
}
