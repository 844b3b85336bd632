#include "run/bsdfs.h"

#include <sodium.h>
#include <stdio.h>
#include <string.h>

#include <oriel/sha256.h>

#include "bsdf/compiled.h"

enum { LEAST_BYTES = 1 << 20 };

static const char kind[] = "bsdf";

/* What is kept depends on the XML and on how it is kept. */
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

/* One BSDF that is asked for. */
struct request {
    struct orl_run_state *state;
    const struct orl_bsdf_xml *xml;
    const unsigned char *content;
    char path[4096];
    char key[ORL_DIGEST_HEX + 1];
};

/* Where the digest was told and not worked out, the XML may be another by now. */
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

/* From XML, into the path that the store gave. */
static int load_and_keep(struct request *r, struct orl_bsdf **ret_bsdf, struct orl_error *err)
{
    const struct orl_run_env *env = r->state->env;
    const struct orl_map_store *store = env->store;
    const double started = env->now_s(env->ctx);
    struct orl_map_info info = {.kind = "", .key = ""};
    struct orl_bsdf_info about;
    struct orl_error why = {0};
    int code = check_content(r, err);
    if (code == 0)
        code = orl_bsdf_load(r->xml, ret_bsdf, err);
    if (code < 0) {
        store->abandon(store->ctx, kind, r->key);
        return code;
    }
    orl_bsdf_describe(*ret_bsdf, &about);
    info.stored = about.values;
    memcpy(info.kind, kind, sizeof kind);
    memcpy(info.key, r->key, sizeof info.key);
    code = orl_bsdf_write(*ret_bsdf, r->content, r->path, &info.bytes, &why);
    info.seconds = env->now_s(env->ctx) - started;
    if (code == 0)
        code = store->commit(store->ctx, &info, &why);
    if (code == 0) {
        store->release(store->ctx, kind, r->key);
    } else {
        store->abandon(store->ctx, kind, r->key);
        orl_run_warn(r->state, "the BSDF '%s' could not be kept for later jobs: %s", r->xml->name,
                     why.message);
    }
    return 0;
}

static int load(void *ctx, const struct orl_bsdf_xml *given,
                const unsigned char content[ORL_SHA256_BYTES], struct orl_bsdf **ret_bsdf,
                struct orl_error *err)
{
    struct request r = {.state = ctx, .content = content};
    struct orl_bsdf_xml heeding = *given;
    const struct orl_bsdf_xml *const xml = r.xml = &heeding;
    const struct orl_map_store *store = r.state->env->store;
    struct orl_map_info info;
    bool hit = true;
    heeding.cancel = r.state->env->cancel;
    heeding.crew = r.state->env->crew;
    orl_run_progress(r.state, 0);
    if (!store || xml->size < LEAST_BYTES)
        return orl_bsdf_load(xml, ret_bsdf, err);
    make_key(content, r.key);
    for (int attempt = 0; attempt < 2 && hit; attempt++) {
        int code =
            store->acquire(store->ctx, kind, r.key, r.state->env->cancel, r.path, &hit, &info, err);
        if (code == ORL_ERR_CANCELLED)
            return code;
        if (code < 0)
            break;
        if (!hit)
            return load_and_keep(&r, ret_bsdf, err);
        code = orl_bsdf_open(r.path, content, ret_bsdf, err);
        if (code == 0) {
            store->release(store->ctx, kind, r.key);
            return 0;
        }
        orl_run_warn(r.state,
                     "the BSDF '%s' was kept, but damaged or out of date: it is read again",
                     xml->name);
        store->abandon(store->ctx, kind, r.key);
    }
    memset(err, 0, sizeof *err);
    return orl_bsdf_load(xml, ret_bsdf, err);
}

struct orl_bsdf_loader orl_run_bsdf_loader(struct orl_run_state *state)
{
    return (struct orl_bsdf_loader){state, load, state->env->cancel};
}
