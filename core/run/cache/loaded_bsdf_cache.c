#include "run/cache/loaded_bsdf_cache.h"

#include <sodium.h>
#include <stdio.h>
#include <string.h>

#include <oriel/base/sha256.h>

#include "bsdf/compiled_bsdf.h"
#include "run/cache/file_cache.h"
#include "run/estimate/stage_progress.h"
#include "run/run_state.h"

enum { LEAST_BYTES = 1 << 20 };

/* Makes the key from the XML and the storage format. */
static void make_key(const unsigned char content[ORL_COMPILED_DIGEST],
                     char ret_key[ORL_DIGEST_HEX + 1])
{
    unsigned char digest[ORL_SHA256_BYTES];
    char text[16 + ORL_COMPILED_DIGEST];
    const int length = snprintf(text, 16, "oriel bsdf %d", ORL_COMPILED_VERSION);
    memcpy(text + length, content, ORL_COMPILED_DIGEST);
    orl_sha256(text, (size_t)length + ORL_COMPILED_DIGEST, digest);
    sodium_bin2hex(ret_key, ORL_DIGEST_HEX + 1, digest, sizeof digest);
}

/* A request for one BSDF. */
struct request {
    struct orl_run_state *state;
    const struct orl_bsdf_xml *xml;
    const unsigned char *content;
    struct orl_bsdf *bsdf; /* result, once loaded */
};

/* Verifies the XML if its digest was supplied by the caller: it may have changed since. */
static int check_content(const struct request *r, struct orl_error *err)
{
    unsigned char content[ORL_COMPILED_DIGEST];
    if (!r->state->env->files->digest)
        return 0;
    orl_sha256(r->xml->data, r->xml->size, content);
    if (memcmp(content, r->content, sizeof content) == 0)
        return 0;
    return orl_error_set(err, ORL_ERR_CORRUPT, "the file is damaged in the store");
}

static int make_bsdf(void *ctx, struct orl_error *err)
{
    struct request *const r = ctx;
    const int code = check_content(r, err);
    return code < 0 ? code : orl_bsdf_load(r->xml, &r->bsdf, err);
}

static int write_bsdf(void *ctx, const char *path, struct orl_map_info *info, struct orl_error *err)
{
    const struct request *const r = ctx;
    struct orl_bsdf_info about;
    orl_bsdf_describe(r->bsdf, &about);
    info->stored = about.values;
    return orl_bsdf_write(r->bsdf, r->content, path, &info->bytes, err);
}

static int open_cached(void *ctx, const char *path, struct orl_error *err)
{
    struct request *const r = ctx;
    return orl_bsdf_open(path, r->content, &r->bsdf, err);
}

static int load(void *ctx, const struct orl_bsdf_xml *given,
                const unsigned char content[ORL_SHA256_BYTES], struct orl_bsdf **ret_bsdf,
                struct orl_error *err)
{
    struct orl_run_state *const state = ctx;
    struct orl_bsdf_xml cancellable = *given;
    struct request r = {.state = state, .xml = &cancellable, .content = content};
    char key[ORL_DIGEST_HEX + 1];
    const struct orl_file_cache_entry entry = {.kind = "bsdf",
                                               .key = key,
                                               .what = "BSDF",
                                               .name = given->name,
                                               .ctx = &r,
                                               .open = open_cached,
                                               .make = make_bsdf,
                                               .write = write_bsdf};
    cancellable.cancel = state->env->cancel;
    cancellable.pool = state->env->pool;
    orl_run_report_progress(state, 0);
    if (!state->env->store || given->size < LEAST_BYTES)
        return orl_bsdf_load(&cancellable, ret_bsdf, err);
    make_key(content, key);
    const int code = orl_file_cache_get(state, &entry, err);
    if (code == 0)
        *ret_bsdf = r.bsdf;
    return code;
}

struct orl_bsdf_loader orl_run_bsdf_loader(struct orl_run_state *state)
{
    return (struct orl_bsdf_loader){state, load, state->env->cancel};
}
