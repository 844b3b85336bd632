/*
 * Honeybee models; and, for input that is not a model, the lists beside its files: states.json and
 * grid/_info.json.
 */
#include <stdlib.h>
#include <string.h>

#include <oriel/base/limits.h>
#include <oriel/job/run.h>

#include "fuzz/fuzz.h"
#include "honeybee/hbjson.h"
#include "project/project.h"
#include "run/request/job_inputs.h"
#include "json/decode.h"

enum { MOST_FILES = 64 };

static bool ends_with(const char *name, const char *ending)
{
    const size_t length = strlen(name), tail = strlen(ending);
    return length > tail && strcmp(name + length - tail, ending) == 0;
}

/* Checks that the name is below model/ and has no "..", hidden or empty part. */
static void check_name(const char *name)
{
    FUZZ_PROMISE(strncmp(name, "model/", 6) == 0 && strlen(name) < 400);
    for (const char *c = name; *c; c++)
        FUZZ_PROMISE(!(c[0] == '/' && (c[1] == '.' || c[1] == '/' || c[1] == '\0')));
}

/* Returns true if the model brings text of its own (BSDF transforms, IES files) that xform or the
 * IES reader may refuse. */
static bool has_own_words(const struct orl_text_files *written)
{
    for (size_t i = 0; i < written->count; i++)
        if (ends_with(written->items[i].name, ".xml") || ends_with(written->items[i].name, ".ies"))
            return true;
    return false;
}

/* Checks that the written text parses as a scene; its contents may still be refused. */
static void check_scene(const char *const *names, size_t count, const struct orl_files *files,
                        bool own_words)
{
    struct orl_scene_summary summary = {0};
    struct orl_error err = {0};
    const int code = orl_scene_check(names, count, files, NULL, &summary, &err);
    if (code < 0)
        fuzz_check_error(code, &err);
    FUZZ_PROMISE(code != ORL_ERR_SYNTAX || own_words);
    orl_scene_summary_done(&summary);
}

static void check_sensors(const struct orl_text_file *file)
{
    struct orl_sensor *sensors = NULL;
    struct orl_error err = {0};
    size_t count = 0;
    if (!ends_with(file->name, ".pts") || file->size > 10000)
        return;
    const int code = orl_sensors_parse(file->name, file->text, file->size, &sensors, &count, &err);
    FUZZ_PROMISE(code == 0 || code == ORL_ERR_RANGE || code == ORL_ERR_LIMIT);
    free(sensors);
}

static void check_files(const struct orl_text_files *written)
{
    const char *names[MOST_FILES];
    struct orl_file contents[MOST_FILES];
    const size_t n = written->count < MOST_FILES ? written->count : MOST_FILES;
    struct orl_memory_files memory = {names, contents, n};
    const struct orl_files files = orl_files_from_memory(&memory);
    const struct orl_project_choice choice = {NULL, NULL};
    json_t *project = NULL;
    struct orl_error err = {0};
    for (size_t i = 0; i < written->count; i++) {
        check_name(written->items[i].name);
        check_sensors(&written->items[i]);
    }
    for (size_t i = 0; i < n; i++) {
        names[i] = written->items[i].name;
        contents[i] = (struct orl_file){written->items[i].text, written->items[i].size, NULL};
    }
    if (written->count > MOST_FILES)
        return;
    FUZZ_PROMISE(orl_project_find(names, n, &files, &choice, &project, &err) == 0);
    const json_t *mains = json_object_get(project, "files"), *name;
    const char *main_names[MOST_FILES];
    size_t i;
    json_array_foreach(mains, i, name)
    {
        main_names[i] = json_string_value(name);
    }
    if (json_array_size(mains) > 0)
        check_scene(main_names, json_array_size(mains), &files, has_own_words(written));
    json_decref(project);
}

static bool read_model(const json_t *model)
{
    struct orl_text_files files = {0};
    struct orl_error err = {0};
    const int code = orl_hbjson_translate(model, &files, &err);
    if (code < 0) {
        fuzz_check_error(code, &err);
        FUZZ_PROMISE(files.count == 0 && !files.items);
        return false;
    }
    check_files(&files);
    orl_text_files_done(&files);
    return true;
}

/* Reads the same bytes as both kinds of list. */
static bool read_lists(const uint8_t *data, size_t size)
{
    static const char *const names[] = {"model/scene/a.rad",
                                        "model/aperture_group/states.json",
                                        "model/aperture_group/a..default..0.rad",
                                        "model/aperture_group/a..default..1.rad",
                                        "model/grid/_info.json",
                                        "model/grid/g/desks.pts",
                                        "model/grid/old.pts"};
    enum { N = sizeof names / sizeof *names, STATES = 1, INFO = 4 };
    const struct orl_project_choice choice = {NULL, NULL};
    bool accepted = true;
    for (size_t k = STATES; k <= INFO; k += INFO - STATES) {
        struct orl_file contents[N] = {{NULL, 0, NULL}};
        struct orl_memory_files memory = {names, contents, N};
        const struct orl_files files = orl_files_from_memory(&memory);
        struct orl_error err = {0};
        json_t *project = NULL;
        contents[STATES] = contents[INFO] = (struct orl_file){"{}", 2, NULL};
        contents[k] = (struct orl_file){(const char *)data, size, NULL};
        const int code = orl_project_find(names, N, &files, &choice, &project, &err);
        if (code < 0)
            fuzz_check_error(code, &err);
        FUZZ_PROMISE((code == 0) == (project != NULL));
        FUZZ_PROMISE(json_array_size(json_object_get(project, "files")) <= N);
        accepted = accepted && code == 0;
        json_decref(project);
    }
    return accepted;
}

bool fuzz_hbjson(const uint8_t *data, size_t size)
{
    struct orl_error err = {0};
    json_t *doc = NULL;
    const int code = orl_json_parse("model.hbjson", (const char *)data, size, &doc, &err);
    if (code < 0) {
        fuzz_check_error(code, &err);
        return false;
    }
    const bool accepted = orl_hbjson_is_model(doc) ? read_model(doc) : read_lists(data, size);
    json_decref(doc);
    return accepted;
}
