/* Files of rad: projects with names fit for a bundle, and commands that are files by their names.
 */
#include <stdlib.h>
#include <string.h>

#include <jansson.h>

#include "fuzz/fuzz.h"
#include "rif.h"

static bool has_file(const json_t *project, const char *name)
{
    const json_t *file;
    size_t i;
    json_array_foreach(json_object_get(project, "files"), i, file)
    {
        if (strcmp(json_string_value(file), name) == 0)
            return true;
    }
    return false;
}

static void check_project(const json_t *project)
{
    static const char *const lists[] = {"files", "grids", "views", "skies", "left_out", "commands"};
    const json_t *each;
    size_t i;
    for (i = 0; i < sizeof lists / sizeof *lists; i++)
        FUZZ_PROMISE(json_is_array(json_object_get(project, lists[i])));
    json_array_foreach(json_object_get(project, "files"), i, each)
        FUZZ_PROMISE(json_string_length(each) > 0);
    json_array_foreach(json_object_get(project, "views"), i, each)
    {
        FUZZ_PROMISE(json_string_length(json_object_get(each, "name")) > 0);
        FUZZ_PROMISE(json_object_get(each, "view") || json_object_get(each, "file"));
    }
    json_array_foreach(json_object_get(project, "commands"), i, each)
        FUZZ_PROMISE(has_file(project, json_string_value(json_object_get(each, "name"))));
}

bool fuzz_rif(const uint8_t *data, size_t size)
{
    json_t *project = NULL;
    struct orl_error err = {0};
    char *exact = malloc(size ? size : 1);
    FUZZ_PROMISE(exact != NULL);
    if (size > 0)
        memcpy(exact, data, size);
    const int code = orl_rif_read("room.rif", exact, size, &project, &err);
    free(exact);
    if (code < 0) {
        fuzz_check_error(code, &err);
        FUZZ_PROMISE(project == NULL);
        return false;
    }
    check_project(project);
    json_decref(project);
    return true;
}
