#include "project/main_files.h"

#include <jansson.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include <oriel/base/limits.h>
#include <oriel/job/run.h>

#include "project/main_order.h"

static bool ends_in(const char *name, const char *suffix)
{
    const size_t length = strlen(name), size = strlen(suffix);
    return length > size && strcasecmp(name + length - size, suffix) == 0;
}

static size_t folder_length(const char *name)
{
    const char *slash = strrchr(name, '/');
    return slash ? (size_t)(slash - name) + 1 : 0;
}

/* Returns the index of the name made of folder and name, or count if there is none. */
static size_t find_name(const char *const *names, size_t count, const char *folder, size_t length,
                        const char *name)
{
    size_t i = 0;
    while (i < count &&
           (strncmp(names[i], folder, length) != 0 || strcmp(names[i] + length, name) != 0))
        i++;
    return i;
}

/* Resolves the scene files that a job document lists. Returns 0 if doc is no such document, or if
 * a file is missing or listed twice. */
static size_t read_document(const json_t *doc, const char *const *names, size_t count,
                            const char *folder, size_t length, size_t *ret_chosen)
{
    const json_t *list = json_object_get(json_object_get(doc, "scene"), "files");
    const size_t listed = json_array_size(list);
    for (size_t i = 0; i < listed; i++) {
        const char *name = json_string_value(json_array_get(list, i));
        const size_t found = name ? find_name(names, count, folder, length, name) : count;
        if (found == count || listed > count)
            return 0;
        for (size_t k = 0; k < i; k++)
            if (ret_chosen[k] == found)
                return 0;
        ret_chosen[i] = found;
    }
    return listed;
}

/* Chooses the files by the job documents in the top folder, where the file top lies. *ret_count
 * stays 0 if there is none. */
static int choose_by_documents(const char *const *names, size_t count, const char *top,
                               const struct orl_files *files, size_t *ret_chosen, size_t *ret_count,
                               struct orl_error *err)
{
    const size_t length = folder_length(top);
    bool by_render = false;
    int code = 0;
    size_t *chosen = malloc((count + 1) * sizeof *chosen);
    if (!chosen)
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory for %zu files", count);
    for (size_t i = 0; i < count && code == 0 && !by_render; i++) {
        struct orl_file text;
        if (!ends_in(names[i], ".json") || folder_length(names[i]) != length ||
            strncmp(names[i], top, length) != 0)
            continue;
        code = files->open(files->ctx, names[i], &text, err);
        if (code < 0)
            break;
        json_t *doc =
            text.size <= ORL_LIMIT_JOB_BYTES ? json_loadb(text.data, text.size, 0, NULL) : NULL;
        files->close(files->ctx, &text);
        const char *kind = json_string_value(json_object_get(doc, "kind"));
        const bool render = !kind || strcmp(kind, "render") == 0;
        const size_t listed = read_document(doc, names, count, top, length, chosen);
        json_decref(doc);
        if (listed > 0 && (render || *ret_count == 0)) {
            memcpy(ret_chosen, chosen, listed * sizeof *chosen);
            *ret_count = listed;
            by_render = render;
        }
    }
    free(chosen);
    return code;
}

int orl_main_files_choose(const char *const *names, size_t count, const struct orl_files *files,
                          size_t *ret_chosen, size_t *ret_count, struct orl_error *err)
{
    bool *is_main = calloc(count + 1, sizeof *is_main);
    size_t top = 0;
    *ret_count = 0;
    if (!is_main)
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory for %zu files", count);
    int code = orl_scene_guess_main(names, count, files, is_main, err);
    while (top < count && !is_main[top])
        top++;
    if (code == 0 && top < count)
        code = choose_by_documents(names, count, names[top], files, ret_chosen, ret_count, err);
    if (code == 0 && *ret_count == 0)
        code = orl_main_order(names, count, is_main, files, ret_chosen, ret_count, err);
    free(is_main);
    return code;
}

int orl_main_files_ranks(const char *const *names, size_t count, const struct orl_files *files,
                         unsigned *ret_ranks, struct orl_error *err)
{
    size_t *chosen = malloc((count + 1) * sizeof *chosen), n = 0;
    if (!chosen)
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory for %zu files", count);
    const int code = orl_main_files_choose(names, count, files, chosen, &n, err);
    memset(ret_ranks, 0, count * sizeof *ret_ranks);
    for (size_t i = 0; i < n && code == 0; i++)
        ret_ranks[chosen[i]] = (unsigned)i + 1;
    free(chosen);
    return code;
}
