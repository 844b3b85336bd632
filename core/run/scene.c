#include "run/scene.h"

#include <sodium.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <oriel/sha256.h>

#include "base/shelf.h"
#include "light/scene.h"
#include "run/kept_scene.h"

/* ---- The shelf ------------------------------------------------------------------------------- */

static void *hold(void *scene)
{
    return orl_scene_hold(scene);
}

static void release(void *scene)
{
    orl_scene_release(scene);
}

static const struct orl_shelf_sharing sharing = {hold, release};

/* By what the caller says that the files are, and which of them are the main ones. */
static bool shelf_key(const struct orl_run_state *state, char ret_key[ORL_SHELF_KEY])
{
    unsigned char digest[ORL_SHA256_BYTES];
    char hex[ORL_DIGEST_HEX + 1];
    struct orl_sha256 hash;
    const struct orl_job *job = state->job;
    if (!state->env->shelf || !state->env->files_id)
        return false;
    orl_sha256_init(&hash);
    orl_sha256_add(&hash, state->env->files_id, strlen(state->env->files_id) + 1);
    for (size_t i = 0; i < job->n_scene_files; i++)
        orl_sha256_add(&hash, job->scene_files[i], strlen(job->scene_files[i]) + 1);
    if (state->swaps)
        orl_swaps_digest(state->swaps, &hash);
    orl_sha256_finish(&hash, digest);
    sodium_bin2hex(hex, sizeof hex, digest, sizeof digest);
    snprintf(ret_key, ORL_SHELF_KEY, "scene-%s", hex);
    return true;
}

/* ---- What is wrong with it --------------------------------------------------------------------
 */

/* What of BSDFs with a thickness may not be what is meant. */
static void warn_of_proxies(struct orl_run_state *state)
{
    const struct orl_scene *scene = state->scene;
    const struct orl_pairing *pairings[] = {&scene->paired, &scene->not_paired};
    if (scene->proxies && scene->n_hidden == 0)
        orl_run_warn(state,
                     "there are BSDFs with a thickness, but no surface lies within it behind "
                     "them: views see nothing in their place");
    for (int i = 0; i < 2; i++) {
        const struct orl_pairing *p = pairings[i];
        if (p->count == 0)
            continue;
        orl_run_warn(state,
                     "the BSDFs '%s' and '%s' face away from each other %.4g apart, and are up to "
                     "%.4g thick: %s%s",
                     orl_scene_name_of(scene, p->facets[0]), orl_scene_name_of(scene, p->facets[1]),
                     p->apart, p->thick,
                     i == 0
                         ? "they are taken to stand for the same geometry, and scatter light once"
                         : "they are taken as two, which scatter light one after the other; if "
                           "they stand for the same geometry, make them thicker",
                     p->count > 1 ? " (and others)" : "");
    }
}

static void tell_faults(struct orl_run_state *state)
{
    const struct orl_description *d = &state->scene->description;
    for (size_t i = 0; i < d->n_warnings; i++)
        orl_run_warn(state, "%s", d->warnings[i]);
    orl_run_count_scene(state, state->scene);
    warn_of_proxies(state);
}

/* ---- Reading it ------------------------------------------------------------------------------ */

/* Between steps that cannot be interrupted. */
static int heed_cancel(const struct orl_run_state *state, struct orl_error *err)
{
    return orl_crew_cancelled(state->env->crew)
               ? orl_error_set(err, ORL_ERR_CANCELLED, "cancelled while preparing the scene")
               : 0;
}

static int read_files(struct orl_run_state *state, struct orl_description *ret_description,
                      struct orl_error *err)
{
    const int code = orl_run_read_scene(state, ret_description, err);
    return code < 0 ? code : heed_cancel(state, err);
}

/* Ports of no part get materials that nothing but ports has. */
static int part_ports(struct orl_scene *scene, struct orl_error *err)
{
    struct orl_description *d = &scene->description;
    const size_t n = d->n_materials;
    uint32_t *own = malloc((n + 1) * sizeof *own);
    int code = own ? 0 : ORL_ERR_NOMEM;
    if (own)
        memset(own, 0xff, (n + 1) * sizeof *own);
    for (size_t i = 0; i < scene->n_ports && code == 0; i++) {
        const uint32_t facet = scene->ports[i].facet;
        const uint32_t material = orl_facet_material(scene->geometry, facet);
        if (d->materials[material].part != 0)
            continue;
        if (own[material] == UINT32_MAX)
            code = orl_material_part(d, material, ORL_PART_OF_NONE, &own[material]);
        orl_facet_set_material(scene->geometry, facet, own[material]);
    }
    free(own);
    return code < 0 ? orl_error_set(err, code, "out of memory") : 0;
}

static int build(struct orl_run_state *state, struct orl_description *description,
                 struct orl_error *err)
{
    int code = orl_scene_new(description, &state->scene, err);
    if (code == 0)
        code = heed_cancel(state, err);
    if (code == 0)
        code = orl_scene_find_ports(state->scene, state->env->crew, err);
    if (code == 0 && state->swaps && state->swaps->parted)
        code = part_ports(state->scene, err);
    if (code < 0) {
        orl_scene_release(state->scene);
        state->scene = NULL;
    }
    return code;
}

int orl_run_load(struct orl_run_state *state, struct orl_error *err)
{
    struct orl_shelf *shelf = state->env->shelf;
    struct orl_description description = {0};
    struct orl_daylight daylight = {0};
    char key[ORL_SHELF_KEY];
    const bool shelved = shelf_key(state, key);
    int code = 0;
    if (!state->scene && shelved)
        state->scene = orl_shelf_share(shelf, key, &sharing);
    const bool found = state->scene != NULL;
    if (!found)
        code = read_files(state, &description, err);
    if (code == 0)
        code =
            orl_run_sky(state, found ? &state->scene->description : &description, &daylight, err);
    if (code < 0) {
        orl_description_done(&description);
        return code;
    }
    orl_run_enter(state, ORL_STAGE_BVH);
    if (!found)
        code = build(state, &description, err);
    if (code < 0)
        return code;
    if (!found && shelved)
        state->scene =
            orl_shelf_put_shared(shelf, key, state->scene, orl_scene_bytes(state->scene), &sharing);
    tell_faults(state);
    if (code == 0)
        code = orl_lights_new(state->scene, state->result->sky_given ? &daylight : NULL,
                              &state->lights, err);
    return code < 0 ? code : heed_cancel(state, err);
}
