/* The scene of a year with its window groups in given states, and the sizes of such scenes. */
#include "annual/shades/shaded_year.h"

#include <stdlib.h>
#include <string.h>

#include <oriel/annual/annual.h>

#include "run/cache/scene_cache.h"

/* ---- Files ----------------------------------------------------------------------------------- */

static int compare_names(const void *a, const void *b)
{
    return strcmp(*(char *const *)a, *(char *const *)b);
}

static size_t count_files(const struct orl_annual_request *request)
{
    size_t n = 0;
    for (size_t g = 0; g < request->n_groups; g++)
        for (size_t s = 0; s < request->groups[g].n_states; s++)
            n += request->groups[g].states[s].n_files;
    return n;
}

/* Returns the names of all states' files, sorted. */
static char **list_files(const struct orl_annual_request *request, size_t n)
{
    char **names = malloc((n + 1) * sizeof *names);
    size_t at = 0;
    if (!names)
        return NULL;
    for (size_t g = 0; g < request->n_groups; g++)
        for (size_t s = 0; s < request->groups[g].n_states; s++) {
            const struct orl_shade_state *state = &request->groups[g].states[s];
            for (size_t i = 0; i < state->n_files; i++)
                names[at++] = state->files[i];
        }
    qsort(names, n, sizeof *names, compare_names);
    return names;
}

/* Chooses the scene's files except those that any state names, then the files of the given
 * states. */
static int choose_files(struct orl_shaded_scene *v, const struct orl_annual_request *request,
                        const unsigned char *states)
{
    const size_t n = count_files(request);
    char **named = list_files(request, n);
    v->files = malloc((request->n_scene_files + n + 1) * sizeof *v->files);
    v->items = calloc(request->n_groups + 1, sizeof *v->items);
    v->request.n_scene_files = 0;
    v->request.scene_files = v->files;
    if (!named || !v->files || !v->items) {
        free(named);
        return ORL_ERR_NOMEM;
    }
    for (size_t i = 0; i < request->n_scene_files; i++)
        if (!bsearch(&request->scene_files[i], named, n, sizeof *named, compare_names))
            v->files[v->request.n_scene_files++] = request->scene_files[i];
    for (size_t g = 0; g < request->n_groups; g++) {
        const struct orl_shade_state *state = &request->groups[g].states[states[g]];
        v->items[g].first_file = v->request.n_scene_files;
        v->items[g].n_files = state->n_files;
        for (size_t i = 0; i < state->n_files; i++)
            v->files[v->request.n_scene_files++] = state->files[i];
    }
    free(named);
    return 0;
}

/* ---- Materials ------------------------------------------------------------------------------- */

static void choose_materials(struct orl_shaded_scene *v, const struct orl_annual_request *request,
                             const unsigned char *states)
{
    for (size_t g = 0; g < request->n_groups; g++) {
        const struct orl_window_group *group = &request->groups[g];
        const struct orl_shade_state *state = &group->states[states[g]];
        struct orl_material_override *override = &v->items[g];
        override->of = group->name;
        override->names = group->windows;
        override->n_names = group->n_windows;
        override->kind = state->dark       ? ORL_OVERRIDE_BLACK
                         : state->material ? ORL_OVERRIDE_MATERIAL
                                           : ORL_OVERRIDE_NONE;
        override->material = state->material;
    }
    v->material_overrides.at = v->items;
    v->material_overrides.count = request->n_groups;
}

int orl_shaded_scene_init(struct orl_shaded_scene *v, const struct orl_annual_request *request,
                          const unsigned char *states, bool by_window_group, struct orl_error *err)
{
    *v = (struct orl_shaded_scene){.request = *request};
    v->request.groups = NULL;
    v->request.n_groups = 0;
    v->material_overrides.by_window_group = by_window_group;
    const int code = choose_files(v, request, states);
    if (code == 0)
        choose_materials(v, request, states);
    else
        return orl_error_set(err, code, "out of memory for a year");
    if (v->request.n_scene_files == 0)
        return orl_error_set(err, ORL_ERR_INVALID,
                             "no scene file is left for this combination of shade states: all "
                             "files belong to other states");
    return 0;
}

void orl_shaded_scene_done(struct orl_shaded_scene *v)
{
    free(v->files);
    free(v->items);
    *v = (struct orl_shaded_scene){.files = NULL};
}

/*
 * Scene sizes of a year with shades, measured before the year begins.
 *
 * Every state occurs in one of the measured scenes: scene i has each group in its i-th state, or in
 * its last one. These bound the largest combination of states. Sizes add up over files, so a
 * combination has no more than the scene's own files and the largest state of each group.
 */

size_t orl_shades_most_states(const struct orl_annual_request *request)
{
    size_t most = 1;
    for (size_t g = 0; g < request->n_groups; g++)
        if (request->groups[g].n_states > most)
            most = request->groups[g].n_states;
    return most;
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
    const size_t rounds = orl_shades_most_states(request);
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
