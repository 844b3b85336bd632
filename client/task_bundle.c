#include "task_bundle.h"

#include <stdlib.h>

/* Destination for files that the scene itself does not name. */
struct resources {
    struct orl_upload *bundle;
    const char *folder;
};

static int add_file(void *ctx, const struct orl_task_file *file, struct orl_error *err)
{
    const struct resources *resources = ctx;

    return orl_bundle_add(resources->bundle, resources->folder, file->name, err);
}

/* Collects references of a state's files, read after the scene, whose definitions they may use. */
static int collect_state(const struct resources *resources, const struct orl_task *task,
                         const struct orl_shade_state *state, struct orl_error *err)
{
    size_t count;
    char *const *names = orl_task_scene(task, &count);
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
static int collect_shades(const struct resources *resources, const struct orl_task *task,
                          struct orl_error *err)
{
    const struct orl_annual_request *year = &task->of.annual.request;
    const size_t groups = task->kind == ORL_TASK_ANNUAL ? year->n_groups : 0;
    int rc = 0;

    for (size_t g = 0; g < groups; g++)
        for (size_t s = 0; s < year->groups[g].n_states && rc == 0; s++)
            if (year->groups[g].states[s].n_files > 0)
                rc = collect_state(resources, task, &year->groups[g].states[s], err);
    return rc;
}

int orl_task_bundle_collect(const char *folder, const struct orl_task *task,
                            struct orl_upload *ret_bundle, struct orl_error *err)
{
    const struct resources resources = {ret_bundle, folder};
    size_t count;
    const char *const *names = (const char *const *)orl_task_scene(task, &count);
    int rc = orl_bundle_collect(folder, names, count, ret_bundle, err);

    if (rc == 0)
        rc = orl_task_files(task, add_file, (void *)(uintptr_t)&resources, err);
    return rc ? rc : collect_shades(&resources, task, err);
}
