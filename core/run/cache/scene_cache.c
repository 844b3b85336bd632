#include "run/cache/scene_cache.h"

#include <sodium.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <oriel/base/sha256.h>

#include "render/film/film.h"
#include "run/diagnostics/diagnostics.h"
#include "run/estimate/progress.h"
#include "run/request/job_inputs.h"
#include "run/run_state.h"
#include "scene/built/scene.h"
#include "scene/geometry/antimatter/antimatter.h"
#include <oriel/base/memory_cache.h>

/* ---- The cache
   ------------------------------------------------------------------------------- */

static void *reference_scene(void *scene)
{
    return orl_scene_hold(scene);
}

static void release_scene(void *scene)
{
    orl_scene_release(scene);
}

static const struct orl_reference_calls sharing = {reference_scene, release_scene};

/* Makes the key from the caller's id of the files and the names of the main ones. Returns false if
 * the memory cache is not used. */
static bool cache_key_text(const struct orl_run_state *state, char ret_key[ORL_MEMORY_CACHE_KEY])
{
    unsigned char digest[ORL_SHA256_BYTES];
    char hex[ORL_DIGEST_HEX + 1];
    struct orl_sha256 hash;
    const struct orl_job *job = state->job;
    if (!state->env->memory_cache || !state->env->files_id)
        return false;
    orl_sha256_init(&hash);
    orl_sha256_add(&hash, state->env->files_id, strlen(state->env->files_id) + 1);
    for (size_t i = 0; i < job->n_scene_files; i++)
        orl_sha256_add(&hash, job->scene_files[i], strlen(job->scene_files[i]) + 1);
    if (state->material_overrides)
        orl_material_overrides_digest(state->material_overrides, &hash);
    orl_sha256_finish(&hash, digest);
    sodium_bin2hex(hex, sizeof hex, digest, sizeof digest);
    snprintf(ret_key, ORL_MEMORY_CACHE_KEY, "scene-%s", hex);
    return true;
}

/* ---- Faults of the scene --------------------------------------------------------------------- */

/* Warns of BSDFs with a thickness that may be placed wrongly. */
static void warn_of_proxies(struct orl_run_state *state)
{
    const struct orl_scene *scene = state->scene;
    const struct orl_proxy_pairing *pairings[] = {&scene->paired, &scene->not_paired};
    if (scene->proxies && scene->n_hidden == 0)
        orl_run_warn(state, "there are BSDFs with a thickness, but no surface lies within this "
                            "thickness behind them: views show nothing there");
    for (int i = 0; i < 2; i++) {
        const struct orl_proxy_pairing *p = pairings[i];
        if (p->count == 0)
            continue;
        orl_run_warn(state,
                     "the BSDFs '%s' and '%s' face away from each other, are %.4g apart and up to "
                     "%.4g thick: %s%s",
                     orl_scene_name_of(scene, p->facets[0]), orl_scene_name_of(scene, p->facets[1]),
                     p->apart, p->thick,
                     i == 0 ? "they are treated as one system that represents the same geometry, "
                              "and scatter light once"
                            : "they are treated as two systems that scatter light one after the "
                              "other; if they represent the same geometry, make them thicker",
                     p->count > 1 ? " (and others)" : "");
    }
}

/* Lists sensors, evenly thinned out, and eyes, in moved coordinates. The caller frees the list;
 * NULL if out of memory. */
static struct orl_vec3 *list_places(const struct orl_run_state *state, size_t *ret_n)
{
    enum { MOST_SENSORS = 4096 };
    const struct orl_vec3 center = state->scene->geometry->center;
    const size_t step = state->n_sensors / MOST_SENSORS + 1;
    struct orl_vec3 *const list =
        malloc((state->n_sensors / step + state->job->n_views + 2) * sizeof *list);
    size_t n = 0;
    for (size_t i = 0; list && i < state->n_sensors; i += step)
        list[n++] = orl_sub(state->sensors[i].position, center);
    for (size_t i = 0; list && i < state->job->n_views; i++) {
        struct orl_view view;
        if (orl_view_parse(state->job->views[i].view, &view, NULL) == 0)
            list[n++] = orl_sub(view.point, center);
    }
    *ret_n = n;
    return list;
}

/* Warns if rooms are treated as matter: a lining that is removed, or that may stand in the room. */
static void warn_of_lining(struct orl_run_state *state, size_t antimatter,
                           const struct orl_vec3 *places, size_t n)
{
    static const char mend[] = "write 'void' as the first of its modifiers, or make the rooms' "
                               "surfaces face into the rooms";
    const struct orl_scene *const scene = state->scene;
    uint32_t material, facet;
    orl_lining_of(scene->geometry, antimatter, &material, &facet);
    const char *const name = scene->parsed_scene.materials[material].name;
    const struct orl_surface_label at = orl_scene_label_of(scene, facet);
    if (orl_lining_is_omitted(scene->geometry, antimatter))
        orl_run_warn(state,
                     "the lining of the antimatter '%.100s' ('%.100s' in %.200s:%d) is left out, "
                     "because windows face it: the rooms' surfaces may face outwards, so that "
                     "rooms count as matter; to be sure, %s",
                     name, at.name, at.file, at.line, mend);
    for (size_t i = 0; i < n; i++) {
        if (!orl_lining_matter_contains(scene->geometry, antimatter, places[i]))
            continue;
        const struct orl_vec3 p = orl_add(places[i], scene->geometry->center);
        orl_run_warn(state,
                     "the antimatter '%.100s' ('%.100s' in %.200s:%d) treats the point (%.6g %.6g "
                     "%.6g) as inside the matter that it cuts: if that is a room, the lining "
                     "stands in it, and results there are wrong; %s",
                     name, at.name, at.file, at.line, p.x, p.y, p.z, mend);
        return;
    }
}

static void warn_of_linings(struct orl_run_state *state)
{
    const size_t end = orl_linings_count(state->scene->geometry);
    size_t n = 0;
    struct orl_vec3 *const places = end > 0 ? list_places(state, &n) : NULL;
    for (size_t i = 0; i < end; i++)
        warn_of_lining(state, i, places, places ? n : 0);
    free(places);
}

static void warn_of_faults(struct orl_run_state *state)
{
    const struct orl_parsed_scene *d = &state->scene->parsed_scene;
    for (size_t i = 0; i < d->n_warnings; i++)
        orl_run_warn(state, "%s", d->warnings[i]);
    orl_run_count_scene_faults(state, state->scene);
    warn_of_proxies(state);
    warn_of_linings(state);
    orl_run_warn_of_covered_panes(state);
    orl_run_warn_of_turned_panes(state);
}

/* ---- Reading --------------------------------------------------------------------------------- */

/* Returns ORL_ERR_CANCELLED if cancelled; called between steps that cannot be interrupted. */
static int check_cancel(const struct orl_run_state *state, struct orl_error *err)
{
    return orl_thread_pool_cancelled(state->env->pool)
               ? orl_error_set(err, ORL_ERR_CANCELLED, "cancelled while preparing the scene")
               : 0;
}

static int read_files(struct orl_run_state *state, struct orl_parsed_scene *ret_parsed_scene,
                      struct orl_error *err)
{
    const int code = orl_run_read_scene(state, ret_parsed_scene, err);
    return code < 0 ? code : check_cancel(state, err);
}

/* Gives ports that belong to no window group materials of their own. */
static int separate_ports(struct orl_scene *scene, struct orl_error *err)
{
    struct orl_parsed_scene *d = &scene->parsed_scene;
    const size_t n = d->n_materials;
    uint32_t *own = malloc((n + 1) * sizeof *own);
    int code = own ? 0 : ORL_ERR_NOMEM;
    if (own)
        memset(own, 0xff, (n + 1) * sizeof *own);
    for (size_t i = 0; i < scene->n_ports && code == 0; i++) {
        const uint32_t facet = scene->ports[i].facet;
        const uint32_t material = orl_facet_material(scene->geometry, facet);
        if (d->materials[material].window_group != 0)
            continue;
        if (own[material] == UINT32_MAX)
            code = orl_material_add_group_copy(d, material, ORL_WINDOW_GROUP_NONE, &own[material]);
        orl_facet_set_material(scene->geometry, facet, own[material]);
    }
    free(own);
    return code < 0 ? orl_error_set(err, code, "out of memory") : 0;
}

static int build_scene(struct orl_run_state *state, struct orl_parsed_scene *parsed_scene,
                       struct orl_error *err)
{
    int code = orl_scene_new(parsed_scene, &state->scene, err);
    if (code == 0)
        code = check_cancel(state, err);
    if (code == 0)
        code = orl_scene_find_ports(state->scene, state->env->pool, err);
    if (code == 0 && state->material_overrides && state->material_overrides->by_window_group)
        code = separate_ports(state->scene, err);
    if (code < 0) {
        orl_scene_release(state->scene);
        state->scene = NULL;
    }
    return code;
}

int orl_run_load_scene(struct orl_run_state *state, struct orl_error *err)
{
    struct orl_memory_cache *memory_cache = state->env->memory_cache;
    struct orl_parsed_scene parsed_scene = {0};
    struct orl_daylight daylight = {0};
    char key[ORL_MEMORY_CACHE_KEY];
    const bool is_cacheable = cache_key_text(state, key);
    int code = 0;
    if (!state->scene && is_cacheable)
        state->scene = orl_memory_cache_get_shared(memory_cache, key, &sharing);
    const bool found = state->scene != NULL;
    if (!found)
        code = read_files(state, &parsed_scene, err);
    if (code == 0)
        code = orl_run_load_sky(state, found ? &state->scene->parsed_scene : &parsed_scene,
                                &daylight, err);
    if (code < 0) {
        orl_parsed_scene_done(&parsed_scene);
        return code;
    }
    orl_run_begin_stage(state, ORL_STAGE_BVH);
    if (!found)
        code = build_scene(state, &parsed_scene, err);
    if (code < 0)
        return code;
    if (!found && is_cacheable)
        state->scene = orl_memory_cache_put_shared(memory_cache, key, state->scene,
                                                   orl_scene_bytes(state->scene), &sharing);
    warn_of_faults(state);
    if (code == 0)
        code = orl_lights_new(state->scene, state->result->sky_given ? &daylight : NULL,
                              &state->lights, err);
    return code < 0 ? code : check_cancel(state, err);
}
