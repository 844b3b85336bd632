/*
 * Scene sizes of a year with shades, measured before the year begins.
 *
 * Every state occurs in one of the measured scenes: scene i has each group in its i-th state, or in
 * its last one. These bound the largest combination of states. Sizes add up over files, so a
 * combination has no more than the scene's own files and the largest state of each group.
 */
#include <oriel/annual/annual.h>

#include "annual/shades/shaded_scene.h"
#include "run/cache/scene_cache.h"

static size_t count_rounds(const struct orl_annual_request *request)
{
    size_t rounds = 1;
    for (size_t g = 0; g < request->n_groups; g++)
        if (request->groups[g].n_states > rounds)
            rounds = request->groups[g].n_states;
    return rounds;
}

/* Counts groups whose states have files. If there are several, all may be in their largest state at
 * once. */
static size_t count_groups_with_files(const struct orl_annual_request *request)
{
    size_t groups = 0;
    for (size_t g = 0; g < request->n_groups; g++) {
        bool any = false;
        for (size_t s = 0; s < request->groups[g].n_states; s++)
            any = any || request->groups[g].states[s].n_files > 0;
        groups += any;
    }
    return groups;
}

static int measure_files(const struct orl_shaded_scene *shaded_scene, size_t n_files,
                         const struct orl_files *files,
                         const struct orl_material_overrides *material_overrides,
                         struct orl_scene_size *ret_size, struct orl_error *err)
{
    struct orl_scene_summary summary;
    const int code = orl_run_measure_overridden((const char *const *)shaded_scene->files, n_files,
                                                files, material_overrides, &summary, err);
    if (code == 0)
        *ret_size = (struct orl_scene_size){summary.surfaces, summary.triangles};
    return code;
}

/* Measures one of the scenes. ret_own: size of the files that belong to no state; may be NULL. */
static int measure_round(const struct orl_annual_request *request, const struct orl_files *files,
                         size_t round, struct orl_scene_size *ret_size,
                         struct orl_scene_size *ret_own, struct orl_error *err)
{
    unsigned char states[ORL_SHADES_MOST_GROUPS] = {0};
    struct orl_shaded_scene shaded_scene;
    for (size_t g = 0; g < request->n_groups; g++) {
        const size_t n = request->groups[g].n_states;
        states[g] = (unsigned char)(round < n ? round : n - 1);
    }
    int code = orl_shaded_scene_init(&shaded_scene, request, states, true, err);
    if (code == 0)
        code = measure_files(&shaded_scene, shaded_scene.request.n_scene_files, files,
                             &shaded_scene.material_overrides, ret_size, err);
    const size_t n_own = code == 0 ? shaded_scene.items[0].first_file : 0;
    /* The size of these files is subtracted from a bound, so files that cannot stand alone count as
     * empty. */
    if (code == 0 && ret_own && n_own > 0 &&
        measure_files(&shaded_scene, n_own, files, NULL, ret_own, NULL) < 0)
        *ret_own = (struct orl_scene_size){0};
    orl_shaded_scene_done(&shaded_scene);
    return code;
}

static uint64_t max_of(uint64_t a, uint64_t b)
{
    return a > b ? a : b;
}

static uint64_t excess_over(uint64_t all, uint64_t own)
{
    return all > own ? all - own : 0;
}

int orl_shades_measure(const struct orl_annual_request *request, const struct orl_files *files,
                       struct orl_scene_size *ret_largest, struct orl_error *err)
{
    const size_t rounds = count_rounds(request);
    const bool several = count_groups_with_files(request) > 1;
    struct orl_scene_size own = {0}, sum = {0}, most = {0};
    if (request->n_groups > ORL_SHADES_MOST_GROUPS)
        return orl_shades_validate(request, err);
    for (size_t i = 0; i < rounds; i++) {
        struct orl_scene_size size = {0};
        const int code =
            measure_round(request, files, i, &size, several && i == 0 ? &own : NULL, err);
        if (code < 0)
            return code;
        sum.surfaces += excess_over(size.surfaces, own.surfaces);
        sum.triangles += excess_over(size.triangles, own.triangles);
        most.surfaces = max_of(most.surfaces, size.surfaces);
        most.triangles = max_of(most.triangles, size.triangles);
    }
    *ret_largest = several ? (struct orl_scene_size){own.surfaces + sum.surfaces,
                                                     own.triangles + sum.triangles}
                           : most;
    return 0;
}
