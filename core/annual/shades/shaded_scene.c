#include "annual/shades/shaded_scene.h"

#include <stdlib.h>
#include <string.h>

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
                             "all files of the scene are of states, and none of the first ones");
    return 0;
}

void orl_shaded_scene_done(struct orl_shaded_scene *v)
{
    free(v->files);
    free(v->items);
    *v = (struct orl_shaded_scene){.files = NULL};
}
