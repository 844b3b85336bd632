#include "checks/job_inputs.h"

#include <string.h>

static bool is_sensors(const struct orl_named_file *file)
{
    return strcmp(file->place, "sensors.file") == 0;
}

static bool is_view(const struct orl_named_file *file)
{
    return strncmp(file->place, "views[", 6) == 0 && strstr(file->place, "].file");
}

/* Pictures are read when the job runs. */
static bool is_mask(const struct orl_named_file *file)
{
    return strstr(file->place, "].glare.mask");
}

int orl_job_inputs_check(const struct orl_job_brief *brief, const struct orl_bundle *scene,
                         struct orl_error *err)
{
    for (size_t i = 0; i < brief->n_files; i++) {
        const struct orl_named_file *file = &brief->files[i];
        if (orl_bundle_find(scene, file->name))
            continue;
        orl_error_set(err, ORL_ERR_NOT_FOUND,
                      "the scene was uploaded without a file named '%.200s'", file->name);
        orl_error_at(err, NULL, 0, file->place);
        orl_error_hint(err, is_sensors(file)
                                ? "Upload it as a resource, or give the sensors as an array"
                                : "Upload it with the scene as a resource");
        return ORL_ERR_NOT_FOUND;
    }
    return 0;
}

static int note_view(const char *name, const char *entry, struct orl_job_inputs *inputs,
                     struct orl_error *err)
{
    if (!inputs->views)
        inputs->views = json_array();
    return json_array_append_new(inputs->views, json_pack("[s, s?]", name, entry))
               ? orl_error_set(err, ORL_ERR_NOMEM, "out of memory")
               : 0;
}

void orl_job_inputs_done(struct orl_job_inputs *inputs)
{
    orl_bundle_done(&inputs->files);
    json_decref(inputs->views);
    *inputs = (struct orl_job_inputs){0};
}

int orl_job_inputs_note(const struct orl_job_brief *brief, const struct orl_bundle *scene,
                        struct orl_job_inputs *inputs, struct orl_error *err)
{
    struct orl_bundle *files = &inputs->files;
    for (size_t i = 0; i < brief->n_files; i++) {
        const struct orl_named_file *named = &brief->files[i];
        if (is_mask(named))
            continue;
        const struct orl_bundle_file *file = orl_bundle_find(scene, named->name);
        const bool is_weather = !is_sensors(named) && !is_view(named);
        size_t at = 0; /* all skies of a year name the same one */
        while (at < files->count && strcmp(files->files[at].name, file->name) != 0)
            at++;
        int rc = at < files->count ? 0
                                   : orl_bundle_add(files, file->name, is_weather, file->path,
                                                    file->bytes, file->sha, false, err);
        if (rc == 0 && is_view(named))
            rc = note_view(file->name, named->entry, inputs, err);
        if (rc)
            return rc;
        files->files[at].resource = files->files[at].resource || is_weather;
        if (is_sensors(named))
            inputs->sensors = files->files[at].name;
    }
    return 0;
}
