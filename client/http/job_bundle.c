#include "http/job_bundle.h"

#include <stdlib.h>

/* Destination for files that the scene itself does not name. */
struct resources {
    struct orl_upload *bundle;
    const char *folder;
};

static int add_file(void *ctx, const struct orl_job_request_file *file, struct orl_error *err)
{
    const struct resources *resources = ctx;

    return orl_bundle_add(resources->bundle, resources->folder, file->name, err);
}

/* Collects references of a state's files, read after the scene, whose definitions they may use. */
static int collect_state(const struct resources *resources,
                         const struct orl_job_request *job_request,
                         const struct orl_shade_state *state, struct orl_error *err)
{
    size_t count;
    char *const *names = orl_job_request_scene(job_request, &count);
    const char **all = malloc((count + state->n_files + 1) * sizeof *all);
    int rc;

    if (!all)
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
    for (size_t i = 0; i < count; i++)
        all[i] = names[i];
    for (size_t i = 0; i < state->n_files; i++)
        all[count + i] = state->files[i];
    rc = orl_bundle_add_referenced(resources->bundle, resources->folder, all,
                                   count + state->n_files, err);
    free(all);
    return rc;
}

/* Collects references of all shade states. */
static int collect_shades(const struct resources *resources,
                          const struct orl_job_request *job_request, struct orl_error *err)
{
    const struct orl_annual_request *year = &job_request->of.annual.request;
    const size_t groups = job_request->kind == ORL_JOB_KIND_ANNUAL ? year->n_groups : 0;
    int rc = 0;

    for (size_t g = 0; g < groups; g++)
        for (size_t s = 0; s < year->groups[g].n_states && rc == 0; s++)
            if (year->groups[g].states[s].n_files > 0)
                rc = collect_state(resources, job_request, &year->groups[g].states[s], err);
    return rc;
}

int orl_job_bundle_collect(const char *folder, const struct orl_job_request *job_request,
                           struct orl_upload *ret_bundle, struct orl_error *err)
{
    const struct resources resources = {ret_bundle, folder};
    size_t count;
    const char *const *names = (const char *const *)orl_job_request_scene(job_request, &count);
    int rc = orl_bundle_collect(folder, names, count, ret_bundle, err);

    if (rc == 0)
        rc = orl_job_request_files(job_request, add_file, (void *)(uintptr_t)&resources, err);
    return rc ? rc : collect_shades(&resources, job_request, err);
}
