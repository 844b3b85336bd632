#include "input/missing_files.h"

#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <oriel/base/files.h>
#include <oriel/job/run.h>

#include "input/input_folders.h"
#include "json/encode.h"

enum { MOST_MISSING = 1024 };

/* Stands for a missing BSDF: the smallest tensor tree that the reader accepts. */
static const char plain_bsdf[] =
    "<?xml version=\"1.0\"?><WindowElement><WindowElementType>System</WindowElementType><Optical>"
    "<Layer><Material><Name>none</Name><Manufacturer>none</Manufacturer></Material>"
    "<DataDefinition><IncidentDataStructure>TensorTree4</IncidentDataStructure></DataDefinition>"
    "<WavelengthData><LayerNumber>System</LayerNumber><Wavelength unit=\"Integral\">Visible"
    "</Wavelength><WavelengthDataBlock><WavelengthDataDirection>Transmission Front"
    "</WavelengthDataDirection><AngleBasis>LBNL/Shirley-Chiu</AngleBasis><ScatteringDataType>BTDF"
    "</ScatteringDataType><ScatteringData>{ 0.1 }</ScatteringData></WavelengthDataBlock>"
    "</WavelengthData></Layer></Optical></WindowElement>";

/*
 * A provider that stands in for files known to be missing, and notes the names that fail. The
 * reader tries a name in the folder of the file that names it, then in the scene's folder, then in
 * the library: a try that ends with the next one's name is not a name as it is spelled.
 */
struct stand_in {
    struct orl_files real;
    const json_t *missing; /* names of earlier passes */
    json_t *failed;        /* names of this pass; owned */
    char last[1024];       /* name that failed last and may be tried elsewhere; empty: none */
};

static bool is_missing(const json_t *missing, const char *name)
{
    const json_t *one;
    size_t i;
    json_array_foreach(missing, i, one)
    {
        if (strcmp(json_string_value(one), name) == 0)
            return true;
    }
    return false;
}

static void open_stand_in(const char *name, struct orl_file *ret_file)
{
    const bool is_bsdf = orl_name_has_ending(name, ".xml");
    *ret_file = (struct orl_file){.data = is_bsdf ? plain_bsdf : "",
                                  .size = is_bsdf ? sizeof plain_bsdf - 1 : 0};
}

/* Returns true if the name is the path's end, or all of it. */
static bool is_end_of(const char *path, const char *name)
{
    const size_t n = strlen(path), m = strlen(name);
    return n >= m && strcmp(path + n - m, name) == 0 && (n == m || path[n - m - 1] == '/');
}

/* Moves the last failure to the list. lamp.tab is optional (ies2rad(1)). */
static void keep_failure(struct stand_in *s)
{
    if (s->last[0] && !is_end_of(s->last, "lamp.tab") && !is_missing(s->failed, s->last))
        json_array_append_new(s->failed, json_string(s->last));
    s->last[0] = '\0';
}

static int note_outcome(struct stand_in *s, const char *name, int rc)
{
    if (!is_end_of(s->last, name))
        keep_failure(s);
    s->last[0] = '\0';
    if (rc == ORL_ERR_NOT_FOUND)
        snprintf(s->last, sizeof s->last, "%s", name);
    return rc;
}

static int open_file(void *ctx, const char *name, struct orl_file *ret_file, struct orl_error *err)
{
    struct stand_in *s = ctx;
    if (!is_missing(s->missing, name))
        return note_outcome(s, name, s->real.open(s->real.ctx, name, ret_file, err));
    open_stand_in(name, ret_file);
    return note_outcome(s, name, 0);
}

static int open_library(void *ctx, const char *name, struct orl_file *ret_file,
                        struct orl_error *err)
{
    struct stand_in *s = ctx;
    return note_outcome(s, name, s->real.library(s->real.ctx, name, ret_file, err));
}

/* Stand-ins have no handle. */
static void close_file(void *ctx, struct orl_file *file)
{
    const struct stand_in *s = ctx;
    if (file->handle)
        s->real.close(s->real.ctx, file);
}

/* Adds names of files. Returns true if the next pass can stand in for all of them. */
static bool add_missing(json_t *missing, const json_t *names, int *rc)
{
    static const char *const texts[] = {".rad", ".mat", ".xml", ".cal", ".blk"};
    const json_t *name;
    bool all = json_array_size(names) > 0;
    size_t i;
    json_array_foreach(names, i, name)
    {
        const char *const text = json_string_value(name);
        bool is_text = false;
        for (size_t k = 0; k < sizeof texts / sizeof *texts; k++)
            is_text = is_text || orl_name_has_ending(text, texts[k]);
        all = all && is_text && json_array_size(missing) < MOST_MISSING;
        if (!is_missing(missing, text) && json_array_size(missing) < MOST_MISSING)
            *rc |= json_array_append_new(missing, json_string(text));
    }
    return all && *rc == 0;
}

/* ---- The scene ------------------------------------------------------------------------------- */

/* Returns the names of the scene's files and of all states' files, an array that the caller frees;
 * the names are borrowed. NULL: out of memory. */
static const char **scene_names(const json_t *project, size_t *ret_count)
{
    const json_t *files = json_object_get(project, "files"), *file;
    const char **names = malloc((json_array_size(files) + 1) * sizeof *names);
    size_t i, count = 0;
    json_array_foreach(files, i, file)
    {
        if (names)
            names[count++] = json_string_value(file);
    }
    *ret_count = count;
    return names;
}

static int search_scene(const struct orl_project_folder *project_folder, json_t *missing,
                        struct orl_error *ret_unreadable)
{
    struct stand_in s = {.real = orl_raypath_files(project_folder->folder), .missing = missing};
    const struct orl_files files = {.ctx = &s,
                                    .open = open_file,
                                    .close = close_file,
                                    .library = s.real.library ? open_library : NULL};
    size_t count;
    const char **names = scene_names(project_folder->project, &count);
    int rc = names ? 0 : -1;
    for (bool goes_on = rc == 0 && count > 0; goes_on;) {
        struct orl_scene_summary summary = {0};
        struct orl_error why = {0};
        s.failed = json_array();
        const int code = orl_scene_check(names, count, &files, NULL, &summary, &why);
        keep_failure(&s);
        orl_scene_summary_done(&summary);
        goes_on = code == ORL_ERR_NOT_FOUND && add_missing(missing, s.failed, &rc);
        json_decref(s.failed);
        if (code && json_array_size(missing) == 0)
            *ret_unreadable = why;
    }
    free(names);
    return rc;
}

/* ---- Other files ----------------------------------------------------------------------------- */

static int search_name(const struct orl_project_folder *project_folder, const json_t *name,
                       json_t *missing)
{
    const struct orl_files files = orl_raypath_files(project_folder->folder);
    const char *text = json_string_value(name);
    struct orl_file file;
    if (!text || is_missing(missing, text))
        return 0;
    if (files.open(files.ctx, text, &file, NULL) != 0)
        return json_array_append_new(missing, json_string(text));
    files.close(files.ctx, &file);
    return 0;
}

static int search_lists(const struct orl_project_folder *project_folder, json_t *missing)
{
    const json_t *one, *file;
    json_t *group;
    const char *name;
    size_t i;
    int rc = 0;
    json_array_foreach(json_object_get(project_folder->project, "grids"), i, one)
    {
        const json_t *sensors = json_object_get(one, "sensors");
        rc |= search_name(project_folder, json_object_get(sensors, "file"), missing);
    }
    json_array_foreach(json_object_get(project_folder->project, "views"), i, one)
    {
        rc |= search_name(project_folder, json_object_get(one, "file"), missing);
    }
    json_object_foreach(json_object_get(project_folder->project, "states"), name, group)
    {
        json_array_foreach(json_object_get(group, "files"), i, file)
        {
            rc |= search_name(project_folder, file, missing);
        }
    }
    return rc;
}

int orl_find_missing_files(const struct orl_project_folder *project_folder, json_t **ret_missing,
                           struct orl_error *ret_unreadable, struct orl_error *err)
{
    json_t *missing = json_array();
    if (!missing || search_scene(project_folder, missing, ret_unreadable) ||
        search_lists(project_folder, missing)) {
        json_decref(missing);
        return orl_error_no_memory(err);
    }
    *ret_missing = missing;
    return 0;
}
