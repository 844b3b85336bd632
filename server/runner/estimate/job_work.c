#include "runner/estimate/job_estimate.h"

#include <stdio.h>

/*
 * Rays traced for a sample of each kind on its way through a room, and rays that a core traces per
 * second. In a room of a dozen surfaces the estimate is 0.8 to 1.3 times the measured time.
 */
static const double rays_per_s = 1e6;
enum { PATH_RAYS = 8, GATHER_RAYS = 2, PHOTON_RAYS = 4 };

struct count {
    const struct orl_files *files;
    double sensors;
};

/* Counts the sensors of a file: about one per line. */
static int count_sensors(void *ctx, const struct orl_job_request_file *named, struct orl_error *err)
{
    struct count *count = ctx;
    const struct orl_files *files = count->files;
    struct orl_file file;
    (void)err;
    if (named->role != ORL_FILE_SENSORS || files->open(files->ctx, named->name, &file, NULL))
        return 0; /* the run will report the error */
    const char *text = file.data;
    for (size_t i = 0; i < file.size; i++)
        count->sensors += text[i] == '\n';
    files->close(files->ctx, &file);
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

struct orl_job_work orl_job_work(const struct orl_job_request *job_request,
                                 const struct orl_files *files)
{
    struct count count = {.files = files};
    const struct orl_job *job = &job_request->of.render;
    const struct orl_annual_request *year = &job_request->of.annual.request;
    const struct orl_study_request *study = &job_request->of.study;
    const struct orl_bsdf_make_request *panel = &job_request->of.bsdf_make;
    if (job_request->kind == ORL_JOB_KIND_BSDF_FIT)
        return (struct orl_job_work){ORL_WORK_INDIVISIBLE, 0};
    if (job_request->kind == ORL_JOB_KIND_BSDF_MAKE)
        return (struct orl_job_work){panel->accuracy > 0 ? ORL_WORK_UNKNOWN : ORL_WORK_ESTIMATED,
                                     orl_bsdf_make_core_s(panel)};
    if (job_request->kind == ORL_JOB_KIND_RENDER && job->goal.deadline_s > 0)
        return (struct orl_job_work){ORL_WORK_DEADLINE, 0};
    if (job_request->kind == ORL_JOB_KIND_RENDER &&
        (job->goal.relative_error > 0 || job->goal.dgp_error > 0))
        return (struct orl_job_work){ORL_WORK_UNKNOWN, 0};
    orl_job_request_files(job_request, count_sensors, &count, NULL);
    double s = 0;
    if (job_request->kind == ORL_JOB_KIND_STUDY)
        s = orl_study_core_s(study, count.sensors + (double)study->job.n_sensors);
    else if (job_request->kind == ORL_JOB_KIND_ANNUAL)
        s = annual_rays(year, count.sensors + (double)year->n_sensors) / rays_per_s;
    else
        s = render_rays(job, count.sensors + (double)job->n_sensors) / rays_per_s;
    return (struct orl_job_work){ORL_WORK_ESTIMATED, s};
}

bool orl_job_is_split(const struct orl_job_work *work, double least_s, char ret_why[ORL_WHY_MAX])
{
    static const char *const plain[ORL_WORK_CLASS_COUNT] = {
        [ORL_WORK_INDIVISIBLE] =
            "a fit to measurements cannot be split: each value depends on all of them",
        [ORL_WORK_DEADLINE] = "what it computes before its deadline depends on the machine",
        [ORL_WORK_UNKNOWN] = "the work for its accuracy is not known beforehand"};
    const bool large = work->s >= least_s;
    if (plain[work->work_class])
        snprintf(ret_why, ORL_WHY_MAX, "%s", plain[work->work_class]);
    else
        snprintf(ret_why, ORL_WHY_MAX, "about %.3g s of one core, %s than the %.3g s of --least",
                 work->s, large ? "no less" : "less", least_s);
    return work->work_class == ORL_WORK_UNKNOWN ||
           (work->work_class == ORL_WORK_ESTIMATED && large);
}
