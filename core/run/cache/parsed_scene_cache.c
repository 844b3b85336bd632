/* Caches data in the store that take long to load: BSDFs read from XML, and parsed scenes. */
#include "run/cache/scene_cache.h"

#include <sodium.h>
#include <stdio.h>
#include <string.h>

#include <oriel/base/sha256.h>

#include "bsdf/loaded_bsdf.h"
#include "run/diagnostics/diagnostics.h"
#include "run/estimate/progress.h"
#include "run/run_state.h"
#include "scene/built/scene.h"
#include "scene/cache/scene_cache_file.h"
#include "scene/parse/parse.h"

struct orl_file_cache_entry {
    const char *kind, *key;  /* names in the store */
    const char *what, *name; /* "BSDF", "pane.xml", for messages */
    /* True if it also depends on files that the key does not include, so that ORL_ERR_VERSION
     * causes no warning. */
    bool may_be_outdated;
    void *ctx;
    int (*open)(void *ctx, const char *path, struct orl_error *err);
    int (*make)(void *ctx, struct orl_error *err);
    /* Returns true if the data are worth storing. NULL: always. */
    bool (*is_worth_storing)(void *ctx);
    /* Writes the data, and fills the info's bytes and stored. */
    int (*write)(void *ctx, const char *path, struct orl_map_info *info, struct orl_error *err);
};

/* Writes to the path that the store supplied, and commits. */
static int write_and_commit(struct orl_run_state *state, const struct orl_file_cache_entry *entry,
                            const char *path, double seconds, struct orl_error *err)
{
    const struct orl_map_store *const store = state->env->store;
    struct orl_map_info info = {.seconds = seconds};
    snprintf(info.kind, sizeof info.kind, "%s", entry->kind);
    snprintf(info.key, sizeof info.key, "%s", entry->key);
    const int code = entry->write(entry->ctx, path, &info, err);
    return code < 0 ? code : store->commit(store->ctx, &info, err);
}

static int make_and_store(struct orl_run_state *state, const struct orl_file_cache_entry *entry,
                          const char *path, struct orl_error *err)
{
    const struct orl_run_env *const env = state->env;
    const struct orl_map_store *const store = env->store;
    const double started = env->now_s(env->ctx);
    struct orl_error why = {0};
    const int code = entry->make(entry->ctx, err);
    if (code < 0 || (entry->is_worth_storing && !entry->is_worth_storing(entry->ctx))) {
        store->abandon(store->ctx, entry->kind, entry->key);
        return code;
    }
    if (write_and_commit(state, entry, path, env->now_s(env->ctx) - started, &why) == 0) {
        store->release(store->ctx, entry->kind, entry->key);
    } else {
        store->abandon(store->ctx, entry->kind, entry->key);
        orl_run_warn(state, "the %s '%s' could not be cached for later jobs: %s", entry->what,
                     entry->name, why.message);
    }
    return 0;
}

/* Opens or makes the data. The state's env must have a store. Returns the codes of open and make,
 * or ORL_ERR_CANCELLED. */
static int orl_file_cache_get(struct orl_run_state *state, const struct orl_file_cache_entry *entry,
                              struct orl_error *err)
{
    const struct orl_map_store *const store = state->env->store;
    struct orl_map_info info;
    char path[4096];
    bool hit = true;
    for (int attempt = 0; attempt < 2 && hit; attempt++) {
        int code = store->acquire(store->ctx, entry->kind, entry->key, state->env->cancel, path,
                                  &hit, &info, err);
        if (code == ORL_ERR_CANCELLED)
            return code;
        if (code < 0)
            break;
        if (!hit)
            return make_and_store(state, entry, path, err);
        code = entry->open(entry->ctx, path, err);
        if (code == 0 || code == ORL_ERR_CANCELLED) {
            store->release(store->ctx, entry->kind, entry->key);
            return code;
        }
        if (code != ORL_ERR_VERSION || !entry->may_be_outdated)
            orl_run_warn(state, "the cached %s '%s' is damaged or out of date: it is read again",
                         entry->what, entry->name);
        store->abandon(store->ctx, entry->kind, entry->key);
    }
    memset(err, 0, sizeof *err);
    return entry->make(entry->ctx, err);
}

enum { LEAST_BSDF_BYTES = 1 << 20 };

/*
 * Loads BSDFs through the store: the XML is read once, and the result is stored as
 * kind "bsdf", for later jobs to map (bsdf/loaded_bsdf.h). Small files, which load as fast as a
 * look-up, are not stored; without a store none are.
 */

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
    return orl_error_set(err, ORL_ERR_CORRUPT, "the stored file is damaged");
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

static int open_cached_bsdf(void *ctx, const char *path, struct orl_error *err)
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
                                               .open = open_cached_bsdf,
                                               .make = make_bsdf,
                                               .write = write_bsdf};
    cancellable.cancel = state->env->cancel;
    cancellable.pool = state->env->pool;
    orl_run_report_progress(state, 0);
    if (!state->env->store || given->size < LEAST_BSDF_BYTES)
        return orl_bsdf_load(&cancellable, ret_bsdf, err);
    make_key(content, key);
    const int code = orl_file_cache_get(state, &entry, err);
    if (code == 0)
        *ret_bsdf = r.bsdf;
    return code;
}

/* Returns a loader that borrows the state, which must outlive it. */
static struct orl_bsdf_loader orl_run_bsdf_loader(struct orl_run_state *state)
{
    return (struct orl_bsdf_loader){state, load, state->env->cancel};
}

enum { LEAST_SURFACES = 10000, LEAST_SCENE_BYTES = 1 << 18 };

struct scene_reader {
    struct orl_run_state *state;
    struct orl_bsdf_loader loader;
    struct orl_sources sources;                      /* main files, once opened */
    struct orl_parsed_scene *parsed_scene;           /* owned by the caller */
    unsigned char content[ORL_CHECKED_FILE_CONTENT]; /* digest of all that the scene depends on */
};

/* Initialises the sources unless they exist. */
static void init_sources(struct scene_reader *r)
{
    if (!r->sources.arena)
        orl_sources_init(&r->sources, r->state->env->files, &r->loader, orl_arena_new());
}

/* ---- Key ------------------------------------------------------------------------------------- */

/* Returns true if the text names other files of surfaces, so that its size says little. */
static bool names_other_files(const struct orl_file *file)
{
    static const char *const endings[] = {".rad", ".oct", ".rtm",  ".obj",
                                          ".stl", ".glb", ".gltf", ".mgf"};
    for (size_t i = 0; i < sizeof endings / sizeof *endings; i++)
        if (memmem(file->data, file->size, endings[i], strlen(endings[i])))
            return true;
    return false;
}

/* Hashes the scene's own files that the job names; *ret_large: the scene may be worth storing. */
static int digest_files(struct scene_reader *r, struct orl_sha256 *hash, bool *ret_large)
{
    const struct orl_job *const job = r->state->job;
    size_t bytes = 0;
    int code = r->sources.arena ? 0 : ORL_ERR_NOMEM;
    *ret_large = false;
    for (size_t i = 0; i < job->n_scene_files && code == 0; i++) {
        const char *const name = job->scene_files[i];
        size_t index = 0;
        orl_sha256_add(hash, name, strlen(name) + 1);
        if (orl_sources_is_resource(name))
            continue;
        code = orl_sources_find(&r->sources, "", name, &index, NULL);
        if (code < 0)
            break;
        const struct orl_source *const item = &r->sources.items[index];
        orl_sha256_add(hash, item->content, sizeof item->content);
        bytes += item->file.size;
        *ret_large = *ret_large || bytes >= LEAST_SCENE_BYTES || names_other_files(&item->file);
    }
    return code;
}

/* Computes the key. Returns false if the scene is not to be stored. */
static bool compute_key(struct scene_reader *r)
{
    static const char start[] = "oriel scene";
    const struct orl_run_state *const state = r->state;
    struct orl_sha256 hash;
    bool large;
    if (!state->env->store)
        return false;
    orl_sha256_init(&hash);
    orl_sha256_add(&hash, start, sizeof start);
    if (!orl_program_id_add(&hash))
        return false;
    init_sources(r);
    if (digest_files(r, &hash, &large) < 0 || !large)
        return false;
    if (state->material_overrides)
        orl_material_overrides_digest(state->material_overrides, &hash);
    orl_sha256_finish(&hash, r->content);
    return true;
}

/* ---- Reading and storing --------------------------------------------------------------------- */

static int make_scene(void *ctx, struct orl_error *err)
{
    struct scene_reader *const r = ctx;
    const struct orl_run_state *const state = r->state;
    const struct orl_job *const job = state->job;
    struct orl_parsed_scene *const d = r->parsed_scene;
    init_sources(r);
    int code = orl_scene_parse_opened((const char *const *)job->scene_files, job->n_scene_files,
                                      &r->sources, state->material_overrides != NULL, d, err);
    d->cancel = state->env->cancel;
    if (code == 0 && state->material_overrides)
        code = orl_material_overrides_apply(state->material_overrides, job->n_scene_files, d, err);
    if (code == 0)
        code = orl_scene_remove_coincident(d, err);
    return code;
}

static bool is_worth_storing(void *ctx)
{
    const struct scene_reader *const r = ctx;
    return r->parsed_scene->n_read >= LEAST_SURFACES &&
           orl_parsed_scene_is_cacheable(r->parsed_scene);
}

static int write_scene(void *ctx, const char *path, struct orl_map_info *info,
                       struct orl_error *err)
{
    const struct scene_reader *const r = ctx;
    info->stored = r->parsed_scene->n_read;
    return orl_parsed_scene_save(r->parsed_scene, r->content, path, &info->bytes, err);
}

static int open_cached_scene(void *ctx, const char *path, struct orl_error *err)
{
    struct scene_reader *const r = ctx;
    init_sources(r);
    const int code = orl_parsed_scene_load(path, r->content, &r->sources, r->parsed_scene, err);
    if (code == 0)
        r->parsed_scene->cancel = r->state->env->cancel;
    return code;
}

int orl_run_read_scene(struct orl_run_state *state, struct orl_parsed_scene *ret_parsed_scene,
                       struct orl_error *err)
{
    struct scene_reader r = {
        .state = state, .loader = orl_run_bsdf_loader(state), .parsed_scene = ret_parsed_scene};
    char key[ORL_DIGEST_HEX + 1];
    const struct orl_file_cache_entry entry = {
        .kind = "scene",
        .key = key,
        .what = "scene",
        .name = state->job->n_scene_files > 0 ? state->job->scene_files[0] : "",
        .may_be_outdated = true,
        .ctx = &r,
        .open = open_cached_scene,
        .make = make_scene,
        .is_worth_storing = is_worth_storing,
        .write = write_scene};
    if (!compute_key(&r))
        return make_scene(&r, err);
    sodium_bin2hex(key, sizeof key, r.content, sizeof r.content);
    const int code = orl_file_cache_get(state, &entry, err);
    if (r.sources.arena) { /* cancelled while another job read it */
        struct orl_arena *const arena = r.sources.arena;
        orl_sources_done(&r.sources);
        orl_arena_free(arena);
    }
    return code;
}
