#include "project/project_search.h"

#include <ctype.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <oriel/base/scanner.h>
#include <oriel/base/suggest.h>

#include "json/decode.h"

int orl_project_no_memory(const struct orl_project_search *f)
{
    return orl_error_no_memory(f->err);
}

bool orl_project_ends_with(const char *name, const char *ending)
{
    const size_t length = strlen(name), tail = strlen(ending);
    return length > tail && strcmp(name + length - tail, ending) == 0;
}

const char *orl_project_below(const struct orl_project_search *f, const char *name,
                              const char *folder)
{
    const size_t length = strlen(folder);
    if (strncmp(name, f->root, f->root_length) != 0 ||
        strncmp(name + f->root_length, folder, length) != 0)
        return NULL;
    return name + f->root_length + length;
}

int orl_project_compare_names(const void *a, const void *b)
{
    return strcmp(*(const char *const *)a, *(const char *const *)b);
}

const char *orl_project_name(const struct orl_project_search *f, const char *name,
                             size_t *ret_index)
{
    const char *const *found =
        f->names ? bsearch(&name, f->names, f->count, sizeof *f->names, orl_project_compare_names)
                 : NULL;
    if (found)
        *ret_index = (size_t)(found - (const char *const *)f->names);
    return found ? *found : NULL;
}

int orl_project_json(const struct orl_project_search *f, const char *name, json_t **ret_doc)
{
    struct orl_file text;
    int rc = f->files->open(f->files->ctx, name, &text, f->err);
    if (rc)
        return rc;
    if (text.size > ORL_PROJECT_INFO_BYTES)
        rc = orl_error_set(f->err, ORL_ERR_LIMIT, "'%.200s' is larger than %d MiB", name,
                           ORL_PROJECT_INFO_BYTES >> 20);
    else
        rc = orl_json_parse(name, text.data, text.size, ret_doc, f->err);
    f->files->close(f->files->ctx, &text);
    return rc;
}

int orl_project_add_main(struct orl_project_search *f, size_t index)
{
    if (f->is_main[index])
        return 0;
    f->used[index] = f->is_main[index] = true;
    return json_array_append_new(f->main, json_string(f->names[index])) ? orl_project_no_memory(f)
                                                                        : 0;
}

/* ---- Grids, views, skies --------------------------------------------------------------------- */

/* Makes a name from the file's path below its folder without ending, with the characters that
 * jobs allow. */
static void name_after(const char *path, const char *more, char ret_name[ORL_PROJECT_NAME])
{
    const char *dot = strrchr(path, '.');
    const size_t length = dot ? (size_t)(dot - path) : strlen(path);
    size_t i = 0;
    for (; i < length && i + 1 < 200; i++) {
        const unsigned char c = (unsigned char)path[i];
        const bool first = i == 0 || path[i - 1] == '/';
        ret_name[i] =
            (c < 0x80 && isalnum(c)) || (strchr(more, c) && !(first && (c == '.' || c == '/')))
                ? (char)c
                : '_';
    }
    ret_name[i] = '\0';
}

/* Reads the list that Honeybee writes beside grids, as an object with the names as members.
 * NULL if there is no list: then every grid counts. */
static int index_info(const struct orl_project_search *f, json_t **ret_listed)
{
    static const char *const members[] = {"full_id", "identifier"};
    char name[ORL_PROJECT_NAME];
    json_t *info = NULL;
    const json_t *grid;
    size_t index, i;
    snprintf(name, sizeof name, "%.*sgrid/_info.json", (int)f->root_length, f->root);
    if (!orl_project_name(f, name, &index))
        return 0;
    int rc = orl_project_json(f, name, &info);
    if (rc == 0 && !(*ret_listed = json_object()))
        rc = orl_project_no_memory(f);
    json_array_foreach(info, i, grid)
    {
        for (size_t k = 0; k < 2 && rc == 0; k++) {
            const char *own = json_string_value(json_object_get(grid, members[k]));
            if (own && json_object_set_new(*ret_listed, own, json_true()))
                rc = orl_project_no_memory(f);
        }
    }
    json_decref(info);
    return rc;
}

static bool is_listed(const json_t *listed, const char *path)
{
    return !listed || json_object_getn(listed, path, strlen(path) - strlen(".pts"));
}

int orl_project_add_grids(struct orl_project_search *f)
{
    json_t *listed = NULL;
    char name[ORL_PROJECT_NAME];
    int rc = index_info(f, &listed);
    for (size_t i = 0; i < f->count && rc == 0; i++) {
        const char *path = orl_project_below(f, f->names[i], "grid/");
        if (!path || !orl_project_ends_with(path, ".pts") || !is_listed(listed, path))
            continue;
        name_after(path, "._-/", name);
        f->used[i] = true;
        if (json_array_append_new(f->grids, json_pack("{s:s, s:{s:s}}", "name", name, "sensors",
                                                      "file", f->names[i])))
            rc = orl_project_no_memory(f);
    }
    json_decref(listed);
    return rc;
}

int orl_project_add_views(struct orl_project_search *f)
{
    char name[ORL_PROJECT_NAME];
    for (size_t i = 0; i < f->count; i++) {
        const char *path = orl_project_below(f, f->names[i], "view/");
        if (!path || !orl_project_ends_with(path, ".vf"))
            continue;
        name_after(path, "._-", name);
        f->used[i] = true;
        if (json_array_append_new(f->views,
                                  json_pack("{s:s, s:s}", "name", name, "file", f->names[i])))
            return orl_project_no_memory(f);
    }
    return 0;
}

/* Returns the path below sky/, in the model folder or beside it; else NULL. */
static const char *below_sky(const struct orl_project_search *f, const char *name)
{
    const char *path = orl_project_below(f, name, "sky/");
    return path ? path : strncmp(name, "sky/", 4) == 0 ? name + 4 : NULL;
}

static int refuse_sky(struct orl_project_search *f)
{
    struct orl_suggestion suggestion = {.word = f->choice->sky};
    const json_t *name;
    char names[200] = "";
    size_t i, length = 0;
    json_array_foreach(f->skies, i, name)
    {
        orl_suggestion_add(&suggestion, json_string_value(name));
        if (length < sizeof names)
            length += (size_t)snprintf(names + length, sizeof names - length, "%s%.60s",
                                       i > 0 ? ", " : "", json_string_value(name));
    }
    orl_json_fail(f->err, ORL_ERR_INVALID, "sky", "the project has no sky '%.100s'",
                  f->choice->sky);
    orl_error_hint(f->err,
                   "%s%s. A sky can also be given as JSON: {\"cie\": {\"type\": "
                   "\"overcast\", \"diffuse_horizontal_lx\": 10000}}",
                   names[0] ? "it has " : "it has no skies", names);
    orl_suggestion_hint(&suggestion, f->err);
    return ORL_ERR_INVALID;
}

int orl_project_add_skies(struct orl_project_search *f)
{
    char name[ORL_PROJECT_NAME];
    size_t only = f->count, chosen = f->count, found = 0;
    for (size_t i = 0; i < f->count; i++) {
        const char *path = below_sky(f, f->names[i]);
        if (!path || !(orl_project_ends_with(path, ".rad") || orl_project_ends_with(path, ".sky")))
            continue;
        name_after(path, "._-", name);
        f->used[i] = true;
        only = found++ == 0 ? i : f->count;
        if (f->choice->sky && strcmp(name, f->choice->sky) == 0)
            chosen = i;
        if (json_array_append_new(f->skies, json_string(name)))
            return orl_project_no_memory(f);
    }
    if (f->choice->sky && chosen == f->count)
        return refuse_sky(f);
    chosen = f->choice->sky ? chosen : only;
    return chosen < f->count ? orl_project_add_main(f, chosen) : 0;
}

/* ---- Warnings -------------------------------------------------------------------------------- */

static bool is_printable(struct orl_slice line)
{
    for (size_t i = 0; i < line.length; i++)
        if ((unsigned char)line.text[i] < ' ' || line.text[i] == 0x7f)
            return false;
    return line.length > 0;
}

/* Appends the lines that are plain text; skips others, because the file is untrusted. */
static int list_lines(const struct orl_project_search *f, const char *name,
                      const struct orl_file *file)
{
    enum { MOST = 100, LONGEST = 400 };
    struct orl_scanner scanner;
    struct orl_slice line;
    if (orl_scanner_init(&scanner, name, file->data, file->size, 0, NULL) < 0)
        return 0;
    while (json_array_size(f->warnings) < MOST && orl_scanner_line(&scanner, &line)) {
        json_t *text = line.length <= LONGEST && is_printable(line)
                           ? json_stringn(line.text, line.length)
                           : NULL;
        if (text && json_array_append_new(f->warnings, text))
            return orl_project_no_memory(f);
    }
    return 0;
}

int orl_project_add_warnings(struct orl_project_search *f)
{
    char name[ORL_PROJECT_NAME];
    struct orl_file file;
    size_t index;
    snprintf(name, sizeof name, "%.*swarnings.txt", (int)f->root_length, f->root);
    if (!orl_project_name(f, name, &index))
        return 0;
    f->used[index] = true;
    int rc = f->files->open(f->files->ctx, name, &file, f->err);
    if (rc)
        return rc;
    rc = list_lines(f, name, &file);
    f->files->close(f->files->ctx, &file);
    return rc;
}
