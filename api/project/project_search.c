#include "project/project_search.h"

#include <stdlib.h>
#include <string.h>

#include "json/decode.h"

int orl_project_no_memory(const struct orl_project_search *f)
{
    return orl_error_set(f->err, ORL_ERR_NOMEM, "out of memory");
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
