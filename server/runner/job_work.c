#include "runner/job_work.h"

#include <stdio.h>

#include "store/mapped_file.h"

/*
 * Rays that a sample of each kind takes on its way through a room, and how many of them a core
 * traces in a second: measured on the example's office.
 */
static const double rays_per_s = 1e6;
enum { PATH_RAYS = 8, GATHER_RAYS = 2, PHOTON_RAYS = 4 };

struct count {
    const struct orl_bundle *bundle;
    double sensors;
};

/* A line each, more or less. */
static int count_sensors(void *ctx, const struct orl_task_file *named, struct orl_error *err)
{
    struct count *count = ctx;
    const struct orl_bundle_file *stored = orl_bundle_find(count->bundle, named->name);
    struct orl_file file;
    (void)err;
    if (named->role != ORL_FILE_SENSORS || !stored || orl_map_file(stored->path, &file, NULL))
        return 0;
    const char *text = file.data;
    for (size_t i = 0; i < file.size; i++)
        count->sensors += text[i] == '\n';
    orl_unmap_file(&file);
    return 0;
}

static double photons_of(uint64_t target)
{
    return target == ORL_PHOTONS_BY_PLAN ? ORL_DEFAULT_PHOTONS : (double)target;
}

static double render_rays(const struct orl_job *job, double sensors)
{
    const bool backward = job->technique == ORL_TECHNIQUE_BACKWARD;
    const double samples = job->gather_samples ? job->gather_samples : ORL_DEFAULT_GATHER_SAMPLES;
    const double of_pixel = job->pixel_samples ? job->pixel_samples : ORL_DEFAULT_PIXEL_SAMPLES;
    double pixels = 0, rays = sensors * samples * (backward ? PATH_RAYS : GATHER_RAYS);
    for (size_t i = 0; i < job->n_views; i++)
        pixels += (double)job->views[i].width * job->views[i].height;
    rays += pixels * of_pixel * (backward ? PATH_RAYS : GATHER_RAYS);
    if (!backward)
        rays += PHOTON_RAYS * (photons_of(job->photons_global) + photons_of(job->photons_caustic));
    return job->n_skies > 0 ? rays * (double)job->n_skies : rays;
}

static double annual_rays(const struct orl_annual_request *year, double sensors)
{
    return sensors * (year->samples ? year->samples : ORL_ANNUAL_SAMPLES) * PATH_RAYS;
}

double orl_job_work_s(const struct orl_task *task, const struct orl_bundle *bundle)
{
    struct count count = {.bundle = bundle};
    const struct orl_job *render = &task->of.render;
    orl_task_files(task, count_sensors, &count, NULL);
    if (task->kind == ORL_TASK_ANNUAL)
        return annual_rays(&task->of.annual.request,
                           count.sensors + (double)task->of.annual.request.n_sensors) /
               rays_per_s;
    if (task->kind != ORL_TASK_RENDER || render->goal.relative_error > 0 ||
        render->goal.dgp_error > 0)
        return 0;
    return render_rays(render, count.sensors + (double)render->n_sensors) / rays_per_s;
}

bool orl_job_goes_in_parts(const struct orl_task *task, const struct orl_bundle *bundle,
                           double least_s, char ret_why[ORL_WHY_MAX])
{
    if (task->kind != ORL_TASK_RENDER && task->kind != ORL_TASK_ANNUAL) {
        snprintf(ret_why, ORL_WHY_MAX, "jobs of its kind are not done in parts");
        return false;
    }
    if (task->kind == ORL_TASK_RENDER && task->of.render.goal.deadline_s > 0) {
        snprintf(ret_why, ORL_WHY_MAX, "what it finds by its deadline depends on the machine");
        return false;
    }
    const double work = orl_job_work_s(task, bundle);
    if (work <= 0) {
        snprintf(ret_why, ORL_WHY_MAX, "how much work its accuracy takes is not known beforehand");
        return true;
    }
    const bool large = work >= least_s;
    snprintf(ret_why, ORL_WHY_MAX, "about %.3g s of one core, %s than the %.3g s of --least", work,
             large ? "no less" : "less", least_s);
    return large;
}
