/* What a map is called: digests of all that it depends on. */
#include <sodium.h>

#include "run/map_keys.h"

/* What a map's photons depend on beyond the scene: raised when their making changes. */
static const char recipe[] = "oriel photons 16";

/* And what precomputed irradiance does beyond its global map. */
static const char records_recipe[] = "oriel records 19";

/* From a digest of all but a number. */
static void make_key(const char *text, size_t length, const char digest_of_rest[ORL_DIGEST_HEX + 1],
                     uint64_t number, char ret_key[ORL_DIGEST_HEX + 1])
{
    unsigned char digest[crypto_hash_sha256_BYTES];
    crypto_hash_sha256_state hash;
    crypto_hash_sha256_init(&hash);
    crypto_hash_sha256_update(&hash, (const unsigned char *)text, length);
    crypto_hash_sha256_update(&hash, (const unsigned char *)digest_of_rest, ORL_DIGEST_HEX);
    crypto_hash_sha256_update(&hash, (const unsigned char *)&number, sizeof number);
    crypto_hash_sha256_final(&hash, digest);
    sodium_bin2hex(ret_key, ORL_DIGEST_HEX + 1, digest, sizeof digest);
}

/*
 * What the plan leaves out changes photons; what it leaves in is in the files. So that jobs share
 * maps whose plans differ in nothing that photons know, it is the world that counts, not the plan.
 */
static void add_plan(crypto_hash_sha256_state *hash, const struct orl_world *world,
                     enum orl_map_kind kind)
{
    const struct orl_omissions *omit = &world->omit;
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
                                caustic && world->caustics_lit,
                                world->n_suns,
                                world->n_domes,
                                world->n_emitters};
    crypto_hash_sha256_update(hash, (const unsigned char *)numbers, sizeof numbers);
    for (size_t i = 0; i < world->n_suns; i++) {
        const struct orl_vec3 n = world->suns[i].frame.n;
        const double sun[] = {n.x, n.y, n.z, world->suns[i].cos_half_angle};
        crypto_hash_sha256_update(hash, (const unsigned char *)sun, sizeof sun);
    }
    for (size_t i = 0; i < world->n_ports; i++) {
        const unsigned char silent = world->ports[i].silent;
        crypto_hash_sha256_update(hash, &silent, sizeof silent);
    }
}

static void make_family(const struct orl_run_state *state, enum orl_map_kind kind,
                        char ret_family[ORL_DIGEST_HEX + 1])
{
    const uint64_t numbers[3] = {ORL_MAP_VERSION, (uint64_t)kind, state->job->seed};
    unsigned char digest[crypto_hash_sha256_BYTES];
    crypto_hash_sha256_state hash;
    crypto_hash_sha256_init(&hash);
    crypto_hash_sha256_update(&hash, (const unsigned char *)recipe, sizeof recipe);
    crypto_hash_sha256_update(&hash, state->scene->description.digest,
                              sizeof state->scene->description.digest);
    crypto_hash_sha256_update(&hash, (const unsigned char *)numbers, sizeof numbers);
    if (state->job->sky.model != ORL_SKY_OF_SCENE)
        crypto_hash_sha256_update(&hash, state->sky_digest, sizeof state->sky_digest);
    add_plan(&hash, state->world, kind);
    crypto_hash_sha256_final(&hash, digest);
    sodium_bin2hex(ret_family, ORL_DIGEST_HEX + 1, digest, sizeof digest);
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
