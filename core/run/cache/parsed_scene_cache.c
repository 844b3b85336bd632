#include "run/cache/parsed_scene_cache.h"

#include <sodium.h>
#include <string.h>

#include "base/program_id.h"
#include "run/cache/file_cache.h"
#include "run/cache/loaded_bsdf_cache.h"
#include "run/run_state.h"
#include "scene/built/scene.h"
#include "scene/cache/scene_cache_file.h"
#include "scene/parse/parse.h"

enum { LEAST_SURFACES = 10000, LEAST_BYTES = 1 << 18 };

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
        *ret_large = *ret_large || bytes >= LEAST_BYTES || names_other_files(&item->file);
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

static int open_cached(void *ctx, const char *path, struct orl_error *err)
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
        .open = open_cached,
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
