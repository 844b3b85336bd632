/* Serialises a BSDF fitted to measurements; only for the machine that wrote it. */
#include <stdlib.h>
#include <string.h>

#include "run/cache/made_bsdf_cache.h"

enum { WORD = 4 };

/* Returns the size of all parts: the struct without pointers, its scans, and the text with at least
 * one 0. */
static size_t size_of(const struct orl_bsdf_fit_result *f)
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
    struct orl_bsdf_fit_result *head = calloc(1, size_of(f));
    *ret_effort = f->rows;
    if (!head)
        return NULL;
    *head = *f;
    head->xml = NULL;
    head->scans = NULL;
    char *to = (char *)(head + 1);
    memcpy(to, f->scans, f->n_scans * sizeof *f->scans);
    memcpy(to + f->n_scans * sizeof *f->scans, f->xml, f->xml_size);
    *ret_size = size_of(f);
    return (char *)head;
}

static bool unpack_fit(void *ctx, const char *data, size_t size)
{
    const struct fit *fit = ctx;
    struct orl_bsdf_fit_result f;
    if (size < sizeof f)
        return false;
    memcpy(&f, data, sizeof f);
    if (f.n_scans > size / sizeof *f.scans || f.xml_size > size || size != size_of(&f))
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
