/* Names of maps: digests of the digests of all that they depend on. */
#include <sodium.h>

#include <oriel/base/sha256.h>

#include "run/run_state.h"
#include "run/stages/run_stages.h"

/* Version of photon tracing; raised when photons change for the same scene. */
static const char recipe[] = "oriel photons 23";

/* Version of precomputed irradiance, apart from its global map. */
static const char records_recipe[] = "oriel records 24";

/* Version of the photon pilot, apart from the photons themselves. */
static const char pilot_recipe[] = "oriel pilot 1";

static void finish_hex(struct orl_sha256 *hash, char ret_hex[ORL_DIGEST_HEX + 1])
{
    unsigned char digest[ORL_SHA256_BYTES];
    orl_sha256_finish(hash, digest);
    sodium_bin2hex(ret_hex, ORL_DIGEST_HEX + 1, digest, sizeof digest);
}

/* Makes a key from a number and the digest of everything else. */
static void make_key(const char *text, size_t length, const char digest_of_rest[ORL_DIGEST_HEX + 1],
                     uint64_t number, char ret_key[ORL_DIGEST_HEX + 1])
{
    struct orl_sha256 hash;
    orl_sha256_init(&hash);
    orl_sha256_add(&hash, text, length);
    orl_sha256_add(&hash, digest_of_rest, ORL_DIGEST_HEX);
    orl_sha256_add(&hash, &number, sizeof number);
    finish_hex(&hash, ret_key);
}

/* Digests the plan's omissions that affect photons. It uses the lit scene instead of the plan, so
 * that jobs whose plans differ only in what photons do not depend on share maps. */
static void digest_plan(const struct orl_lit_scene *lit_scene, enum orl_map_kind kind,
                        unsigned char ret_digest[ORL_SHA256_BYTES])
{
    const struct orl_omissions *omit = &lit_scene->omit;
    const bool caustic = kind == ORL_MAP_CAUSTIC;
    const uint64_t numbers[] = {omit->exterior,
                                omit->glossy,
                                omit->media,
                                omit->refraction,
                                omit->bleached,
                                omit->channels,
                                caustic ? 0 : omit->most_reflections,
                                caustic && omit->mirror_caustics,
                                caustic && omit->lobe_caustics,
                                !caustic && omit->counted_light,
                                caustic && lit_scene->caustics_lit,
                                lit_scene->n_suns,
                                lit_scene->n_domes,
                                lit_scene->n_emitters};
    struct orl_sha256 hash;
    orl_sha256_init(&hash);
    orl_sha256_add(&hash, numbers, sizeof numbers);
    for (size_t i = 0; i < lit_scene->n_suns; i++) {
        const struct orl_vec3 n = lit_scene->suns[i].frame.n;
        const double sun[] = {n.x, n.y, n.z, lit_scene->suns[i].cos_half_angle};
        orl_sha256_add(&hash, sun, sizeof sun);
    }
    for (size_t i = 0; i < lit_scene->n_ports; i++) {
        const unsigned char silent = lit_scene->ports[i].silent;
        orl_sha256_add(&hash, &silent, sizeof silent);
    }
    orl_sha256_finish(&hash, ret_digest);
}

/* Makes the family from separate digests of scene, lights and plan. */
static void make_family(const struct orl_run_state *state, enum orl_map_kind kind,
                        char ret_family[ORL_DIGEST_HEX + 1])
{
    const uint64_t numbers[3] = {ORL_MAP_VERSION, (uint64_t)kind, state->job->seed};
    unsigned char lights[ORL_SHA256_BYTES], plan[ORL_SHA256_BYTES];
    struct orl_sha256 hash;
    orl_lights_digest(state->lights, lights);
    digest_plan(state->lit_scene, kind, plan);
    orl_sha256_init(&hash);
    orl_sha256_add(&hash, recipe, sizeof recipe);
    orl_sha256_add(&hash, numbers, sizeof numbers);
    orl_sha256_add(&hash, state->scene->parsed_scene.digest, ORL_SHA256_BYTES);
    orl_scene_digest_build(state->scene, &hash);
    orl_sha256_add(&hash, lights, sizeof lights);
    orl_sha256_add(&hash, plan, sizeof plan);
    finish_hex(&hash, ret_family);
}

struct orl_map_name orl_run_map_name(const struct orl_run_state *state, enum orl_map_kind kind,
                                     uint64_t target)
{
    struct orl_map_name name = {.family = ""};
    if (kind == ORL_MAP_PRECOMPUTED) {
        const struct orl_map_name global = orl_run_map_name(state, ORL_MAP_GLOBAL, target);
        make_key(records_recipe, sizeof records_recipe, global.key, 0, name.key);
        return name;
    }
    make_family(state, kind, name.family);
    make_key(recipe, sizeof recipe, name.family, target, name.key);
    return name;
}

void orl_run_pilot_key(const struct orl_run_state *state, enum orl_photon_use use,
                       char ret_key[ORL_DIGEST_HEX + 1])
{
    char family[ORL_DIGEST_HEX + 1];
    struct orl_sha256 hash;
    orl_sha256_init(&hash);
    orl_sha256_add(&hash, pilot_recipe, sizeof pilot_recipe);
    orl_sha256_add(&hash, &use, sizeof use);
    make_family(state, ORL_MAP_GLOBAL, family);
    orl_sha256_add(&hash, family, ORL_DIGEST_HEX);
    make_family(state, ORL_MAP_CAUSTIC, family);
    orl_sha256_add(&hash, family, ORL_DIGEST_HEX);
    finish_hex(&hash, ret_key);
}
