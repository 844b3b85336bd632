#include <oriel/bsdf/bsdf_cache.h>

#include <stdlib.h>
#include <string.h>

#include "run/cache/made_bsdf_cache.h"

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
static size_t size_of(const struct head *h)
{
    return sizeof *h + directions_size(h) + PARTS * errors_size(h) +
           (h->xml_size / WORD + 1) * WORD;
}

static char *pack_made(const struct orl_bsdf_make_result *m, size_t *ret_size)
{
    const struct head h = head_of(m);
    char *data = calloc(1, size_of(&h)), *to = data;
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
    *ret_size = size_of(&h);
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
    if (h.n_directions > MOST_DIRECTIONS || h.xml_size > size || size != size_of(&h))
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
