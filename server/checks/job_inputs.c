#include "checks/job_manifest.h"

#include <string.h>

#include <oriel/base/limits.h>

int orl_job_inputs_check(const struct orl_job_manifest *manifest, const struct orl_bundle *scene,
                         struct orl_error *err)
{
    char other[ORL_ERROR_TEXT_MAX];
    for (size_t i = 0; i < manifest->n_files; i++) {
        const struct orl_named_file *file = &manifest->files[i];
        if (orl_bundle_find(scene, file->name))
            continue;
        orl_error_set(err, ORL_ERR_NOT_FOUND,
                      "the scene was uploaded without a file named '%.200s'", file->name);
        orl_error_at(err, NULL, 0, file->location);
        if (orl_bundle_other_case(scene, file->name, other, sizeof other))
            orl_error_hint(err, "it has '%.200s': upper and lower case differ", other);
        else
            orl_error_hint(err, file->role == ORL_FILE_SENSORS
                                    ? "Upload it as a resource, or give the sensors as an array"
                                    : "Upload it with the scene as a resource");
        return ORL_ERR_NOT_FOUND;
    }
    return 0;
}

void orl_job_inputs_done(struct orl_job_inputs *inputs)
{
    orl_bundle_done(&inputs->files);
    json_decref(inputs->uses);
    *inputs = (struct orl_job_inputs){0};
}

void orl_job_inputs_counts(struct orl_job_inputs_found *found,
                           uint64_t *ret_places[ORL_JOB_INPUTS_COUNTS])
{
    uint64_t *const places[] = {&found->sensors, &found->year_rows, &found->surfaces,
                                &found->triangles, &found->matrix_bytes};
    memcpy(ret_places, places, sizeof places);
}

static int add_use(const struct orl_named_file *named, const char *name,
                   struct orl_job_inputs *inputs, struct orl_error *err)
{
    if (!inputs->uses)
        inputs->uses = json_array();
    return json_array_append_new(inputs->uses,
                                 json_pack("[s, i, s?]", name, (int)named->role, named->entry))
               ? orl_error_no_memory(err)
               : 0;
}

static int add_input(struct orl_bundle *files, const struct orl_bundle_file *file, bool resource,
                     struct orl_error *err)
{
    return orl_bundle_add(files, file->name, resource, file->path, file->bytes, file->sha, false,
                          err);
}

/* Adds all files of the scene, in their order. */
static int add_scene(const struct orl_bundle *scene, struct orl_job_inputs *inputs,
                     struct orl_error *err)
{
    int rc = 0;
    inputs->whole_scene = true;
    for (size_t i = 0; i < scene->count && rc == 0; i++)
        rc = add_input(&inputs->files, &scene->files[i], scene->files[i].resource, err);
    return rc;
}

static bool is_same_year(const struct orl_named_file *before, const struct orl_named_file *named)
{
    const char *const year = named->entry ? named->entry : "";
    return before && strcmp(before->entry ? before->entry : "", year) == 0;
}

int orl_job_inputs_collect(const struct orl_job_manifest *manifest, const struct orl_bundle *scene,
                           struct orl_job_inputs *inputs, struct orl_error *err)
{
    /* The last use for weather of each file: all skies of a day name the same file and year. */
    const struct orl_named_file *weather[ORL_LIMIT_SCENE_FILES] = {NULL};
    struct orl_bundle *files = &inputs->files;
    int rc = manifest->whole_scene ? add_scene(scene, inputs, err) : 0;
    for (size_t i = 0; i < manifest->n_files && rc == 0; i++) {
        const struct orl_named_file *named = &manifest->files[i];
        if (named->role == ORL_FILE_MASK || named->role == ORL_FILE_SCENE ||
            named->role == ORL_FILE_MATRIX || named->role == ORL_FILE_SCHEDULE)
            continue; /* these are read with the document */
        const struct orl_bundle_file *file = orl_bundle_find(scene, named->name);
        size_t at = 0;
        while (at < files->count && strcmp(files->files[at].name, file->name) != 0)
            at++;
        rc = at < files->count ? 0 : add_input(files, file, true, err);
        const bool again =
            rc == 0 && named->role == ORL_FILE_WEATHER && is_same_year(weather[at], named);
        if (rc == 0 && !again)
            rc = add_use(named, file->name, inputs, err);
        if (named->role == ORL_FILE_WEATHER)
            weather[at] = named;
    }
    return rc;
}
