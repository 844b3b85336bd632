#include "project/project.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <oriel/base/limits.h>
#include <oriel/base/suggest.h>

#include "project/project_search.h"
#include "json/decode.h"

/* Returns true if folder, such as "scene/x.rad", names a file that a model folder has. */
static bool is_of_model(const char *folder)
{
    /* the only such files of a model without faces */
    static const char *const alone[] = {"aperture/aperture.rad", "aperture_group/states.json",
                                        "scene_dynamic/states.json",
                                        "scene_dynamic/indoor/states.json"};
    for (size_t k = 0; k < sizeof alone / sizeof *alone; k++)
        if (strcmp(folder, alone[k]) == 0)
            return true;
    return strncmp(folder, "scene/", strlen("scene/")) == 0 &&
           orl_project_ends_with(folder, ".rad");
}

/* Finds the shortest prefix, "" or "a/b/", of such a file. */
static bool find_root(struct orl_project_search *f)
{
    f->root = NULL;
    for (size_t i = 0; i < f->count; i++) {
        const char *name = f->names[i], *folder = name;
        while (folder && !is_of_model(folder)) {
            folder = strchr(folder, '/');
            folder = folder ? folder + 1 : NULL;
        }
        const size_t length = folder ? (size_t)(folder - name) : 0;
        if (folder && (!f->root || length < f->root_length)) {
            f->root = name;
            f->root_length = length;
        }
    }
    return f->root;
}

/* Returns true if there is more than a folder "scene", which alone makes no project. */
static bool has_more(const struct orl_project_search *f)
{
    static const char *const more[] = {"aperture/", "aperture_group/", "scene_dynamic/",
                                       "grid/",     "view/",           "folder.cfg"};
    for (size_t i = 0; i < f->count; i++) {
        if (orl_project_below(f, f->names[i], "scene/") &&
            orl_project_ends_with(f->names[i], ".mat"))
            return true;
        for (size_t k = 0; k < sizeof more / sizeof *more; k++)
            if (orl_project_below(f, f->names[i], more[k]))
                return true;
    }
    return false;
}

/* ---- The scene ------------------------------------------------------------------------------- */

/* Returns true for "ies/__NAME__.rad" if there is an "ies/NAME.rad", which places it. */
static bool is_put_by_another(const struct orl_project_search *f, size_t file)
{
    const char *own = orl_project_below(f, f->names[file], "ies/__");
    const size_t length = own ? strlen(own) : 0, tail = strlen("__.rad");
    char name[ORL_PROJECT_NAME];
    size_t index;
    return length > tail && orl_project_ends_with(own, "__.rad") &&
           snprintf(name, sizeof name, "%.*sies/%.*s.rad", (int)f->root_length, f->root,
                    (int)(length - tail), own) < ORL_PROJECT_NAME &&
           orl_project_name(f, name, &index);
}

static int add_static(struct orl_project_search *f, const char *ending)
{
    static const char *const folders[] = {"scene/", "aperture/", "ies/"};
    int rc = 0;
    for (size_t k = 0; k < sizeof folders / sizeof *folders; k++)
        for (size_t i = 0; i < f->count && rc == 0; i++)
            if (!f->used[i] && orl_project_below(f, f->names[i], folders[k]) &&
                orl_project_ends_with(f->names[i], ending) && !is_put_by_another(f, i))
                rc = orl_project_add_main(f, i);
    return rc;
}

/* ---- States ---------------------------------------------------------------------------------- */

/* Finds the file "./FILE" beside states.json. */
static int find_state_file(const struct orl_project_search *f, const char *list, const char *file,
                           const char *group, size_t *ret_index)
{
    const char *slash = strrchr(list, '/');
    const int folder = slash ? (int)(slash + 1 - list) : 0;
    char name[ORL_PROJECT_NAME];
    while (file && strncmp(file, "./", 2) == 0)
        file += 2;
    if (file && snprintf(name, sizeof name, "%.*s%s", folder, list, file) < ORL_PROJECT_NAME &&
        orl_project_name(f, name, ret_index))
        return 0;
    orl_error_set(f->err, ORL_ERR_INVALID, "a state of the group '%.100s' has no file '%.200s'",
                  group, file ? file : "");
    orl_error_at(f->err, list, 0, NULL);
    return ORL_ERR_INVALID;
}

/* Lists the states of a group, and suggests one. */
static void hint_state(const json_t *states, const char *given, struct orl_error *err)
{
    struct orl_suggestion suggestion = {.word = given ? given : ""};
    char names[300] = "";
    size_t i, length = 0;
    const json_t *state;
    json_array_foreach(states, i, state)
    {
        orl_suggestion_add(&suggestion, json_string_value(state));
        if (length < sizeof names)
            length += (size_t)snprintf(names + length, sizeof names - length, "%s%.60s",
                                       i > 0 ? ", " : "", json_string_value(state));
    }
    orl_error_hint(err, "its states are %s", names);
    orl_suggestion_hint(&suggestion, err);
}

/* Chooses a group's state. *ret_state_list lists all states; add_group adds their files. */
static int choose_state(const struct orl_project_search *f, const char *list, const char *group,
                        const json_t *states, size_t *ret_chosen, json_t **ret_state_list)
{
    const json_t *chosen_state = json_object_get(f->choice->states, group), *state;
    const char *state_name = json_string_value(chosen_state);
    json_t *of = json_array();
    size_t i, chosen = state_name ? json_array_size(states) : 0;
    json_array_foreach(states, i, state)
    {
        const char *name = json_string_value(json_object_get(state, "identifier"));
        json_array_append_new(of, json_string(name ? name : ""));
        if (state_name && name && strcmp(name, state_name) == 0)
            chosen = i;
    }
    if (json_array_size(of) != json_array_size(states) || chosen >= json_array_size(states)) {
        orl_error_set(f->err, ORL_ERR_INVALID, "the group '%.100s' has no state '%.100s'", group,
                      state_name ? state_name : "");
        orl_error_at(f->err, list, 0, NULL);
        hint_state(of, state_name, f->err);
        json_decref(of);
        return ORL_ERR_INVALID;
    }
    *ret_chosen = chosen;
    *ret_state_list =
        json_pack("{s:O, s:o, s:[]}", "chosen", json_array_get(of, chosen), "of", of, "files");
    return *ret_state_list ? 0 : orl_project_no_memory(f);
}

static int add_group(struct orl_project_search *f, const char *list, const char *group,
                     const json_t *states)
{
    size_t chosen = 0, index = 0;
    json_t *state_list = NULL;
    int rc = choose_state(f, list, group, states, &chosen, &state_list);
    if (rc)
        return rc;
    if (json_object_set_new(f->states, group, state_list))
        return orl_project_no_memory(f);
    for (size_t i = 0; i < json_array_size(states) && rc == 0; i++) {
        const json_t *state = json_array_get(states, i);
        const char *file = json_string_value(json_object_get(state, "default"));
        rc = find_state_file(f, list, file, group, &index);
        if (rc == 0 && json_array_append_new(json_object_get(state_list, "files"),
                                             json_string(f->names[index])))
            rc = orl_project_no_memory(f);
        if (rc == 0 && i == chosen)
            rc = orl_project_add_main(f, index);
        else if (rc == 0)
            f->used[index] = true; /* listed under "states" */
    }
    return rc;
}

static int add_states(struct orl_project_search *f)
{
    int rc = 0;
    for (size_t i = 0; i < f->count && rc == 0; i++) {
        const char *name = f->names[i], *slash = strrchr(name, '/');
        json_t *doc = NULL, *states;
        const char *group;
        if (!orl_project_below(f, name, "") || strcmp(slash ? slash + 1 : name, "states.json") != 0)
            continue;
        f->used[i] = true;
        rc = orl_project_json(f, name, &doc);
        json_object_foreach(doc, group, states)
        {
            rc = rc ? rc : add_group(f, name, group, states);
        }
        json_decref(doc);
    }
    return rc;
}

/* Fails, and suggests a group of the project. */
static int refuse_group(const struct orl_project_search *f, const char *given)
{
    struct orl_suggestion suggestion = {.word = given};
    const char *group;
    json_t *state;
    orl_json_fail(f->err, ORL_ERR_INVALID, "states", "the project has no group '%.100s'", given);
    json_object_foreach(f->states, group, state)
    {
        orl_suggestion_add(&suggestion, group);
    }
    orl_suggestion_hint(&suggestion, f->err);
    return ORL_ERR_INVALID;
}

static int check_choice(const struct orl_project_search *f)
{
    const char *group;
    json_t *chosen_state;
    json_object_foreach((json_t *)(uintptr_t)f->choice->states, group, chosen_state)
    {
        if (!json_is_string(chosen_state))
            return orl_json_fail(f->err, ORL_ERR_INVALID, "states",
                                 "the name of a state must be a string");
        if (!json_object_get(f->states, group))
            return refuse_group(f, group);
    }
    return 0;
}

/* ---- Files left out -------------------------------------------------------------------------- */

static const char *why_left_out(const struct orl_project_search *f, const char *name)
{
    const bool sensors = orl_project_ends_with(name, ".pts") || orl_project_ends_with(name, ".vf");
    const bool surfaces =
        orl_project_ends_with(name, ".rad") || orl_project_ends_with(name, ".mat");
    if (!orl_project_below(f, name, ""))
        return sensors || surfaces ? "it lies outside the model's folder" : NULL;
    if (orl_project_below(f, name, "ies/__"))
        return surfaces ? "another file places it" : NULL;
    if (orl_project_ends_with(name, ".blk"))
        return "black materials for the direct-sun calculation";
    if (strstr(name, "..direct..") || strstr(name, "..black.") || strstr(name, "..mtx"))
        return "copy of a state for matrices or direct light";
    if (orl_project_below(f, name, "grid/") && sensors)
        return "grid/_info.json does not name it";
    if (orl_project_below(f, name, "receiver/"))
        return "receiver for matrices";
    return sensors || surfaces ? "no file or list refers to it" : NULL;
}

/* Lists the unused files. BSDFs are found by the files that name them; lists and settings are
 * not part of a scene. */
static int list_unused(struct orl_project_search *f)
{
    for (size_t i = 0; i < f->count; i++) {
        const char *why = f->used[i] ? NULL : why_left_out(f, f->names[i]);
        if (why && json_array_append_new(f->left_out,
                                         json_pack("{s:s, s:s}", "file", f->names[i], "why", why)))
            return orl_project_no_memory(f);
    }
    return 0;
}

/* ---- Project --------------------------------------------------------------------------------- */

static int find_parts(struct orl_project_search *f)
{
    int rc = add_static(f, ".mat");
    if (rc == 0)
        rc = add_static(f, ".rad");
    if (rc == 0)
        rc = add_states(f);
    if (rc == 0)
        rc = check_choice(f);
    if (rc == 0)
        rc = orl_project_add_skies(f);
    if (rc == 0)
        rc = orl_project_add_grids(f);
    if (rc == 0)
        rc = orl_project_add_views(f);
    if (rc == 0)
        rc = orl_project_add_warnings(f);
    return rc ? rc : list_unused(f);
}

static int init_search(struct orl_project_search *f, const char *const *names)
{
    f->names = calloc(f->count + 1, sizeof *f->names);
    f->used = calloc(f->count + 1, sizeof *f->used);
    f->is_main = calloc(f->count + 1, sizeof *f->is_main);
    f->main = json_array();
    f->grids = json_array();
    f->views = json_array();
    f->states = json_object();
    f->skies = json_array();
    f->left_out = json_array();
    f->warnings = json_array();
    if (!f->names || !f->used || !f->is_main || !f->main || !f->grids || !f->views || !f->states ||
        !f->skies || !f->left_out || !f->warnings)
        return orl_project_no_memory(f);
    memcpy(f->names, names, f->count * sizeof *names);
    qsort(f->names, f->count, sizeof *f->names, orl_project_compare_names);
    return 0;
}

static json_t *pack_project(const struct orl_project_search *f)
{
    json_t *project =
        json_pack("{s:O, s:O, s:O, s:O, s:O, s:O}", "files", f->main, "grids", f->grids, "views",
                  f->views, "states", f->states, "skies", f->skies, "left_out", f->left_out);
    if (json_array_size(f->warnings) == 0 || !project)
        return project;
    if (json_object_set(project, "warnings", f->warnings) == 0)
        return project;
    json_decref(project);
    return NULL;
}

int orl_project_find(const char *const *names, size_t count, const struct orl_files *files,
                     const struct orl_project_choice *choice, json_t **ret_project,
                     struct orl_error *err)
{
    struct orl_project_search f = {.count = count, .files = files, .choice = choice, .err = err};
    int rc = init_search(&f, names);
    *ret_project = NULL;
    if (rc == 0 && find_root(&f) && has_more(&f)) {
        rc = find_parts(&f);
        if (rc == 0) {
            *ret_project = pack_project(&f);
            rc = *ret_project ? 0 : orl_project_no_memory(&f);
        }
    }
    json_decref(f.main);
    json_decref(f.grids);
    json_decref(f.views);
    json_decref(f.states);
    json_decref(f.skies);
    json_decref(f.left_out);
    json_decref(f.warnings);
    free(f.names);
    free(f.used);
    free(f.is_main);
    return rc;
}
