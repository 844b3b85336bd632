/* Requests of studies: defaults, validation, freeing, the list of settings, and estimates of
 * cost. */
#include "render/technique/technique.h"
#include "study/study_runs.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <oriel/base/limits.h>

void orl_study_request_init(struct orl_study_request *request)
{
    memset(request, 0, sizeof *request);
    orl_job_init(&request->job);
    request->repeats = 3;
    request->reference_runs = 8;
}

void orl_study_free_external(struct orl_study_external *external, size_t count)
{
    for (size_t i = 0; external && i < count; i++)
        free(external[i].name);
    free(external);
}

void orl_study_request_done(struct orl_study_request *request)
{
    if (!request)
        return;
    orl_job_done(&request->job);
    free(request->techniques);
    free(request->photons);
    free(request->samples);
    free(request->title);
    free(request->note);
    orl_study_free_external(request->external, request->n_external);
    memset(request, 0, sizeof *request);
}

bool orl_study_uses_photons(enum orl_technique technique)
{
    return orl_technique_reads_maps(technique);
}

bool orl_study_uses_samples(enum orl_technique technique, bool of_views)
{
    /* Views by photon maps choose their own rays. Sensors read maps directly, except with a
     * gather. */
    const struct orl_technique_facts *facts = orl_technique_facts(technique);
    return facts->samples_paths || (facts->final_gather == ORL_GATHER_EVERYWHERE && !of_views);
}

bool orl_study_can_show(double value)
{
    return value >= ORL_STUDY_LEAST && value <= ORL_STUDY_MOST;
}

bool orl_study_of_views(const struct orl_study_request *request)
{
    return request->job.n_views > 0;
}

/* Counts the settings of a technique; 0 if one of its lists is empty. */
static size_t count_settings(const struct orl_study_request *request, enum orl_technique technique)
{
    const bool of_views = orl_study_of_views(request);
    return (orl_study_uses_photons(technique) ? request->n_photons : 1) *
           (orl_study_uses_samples(technique, of_views) ? request->n_samples : 1);
}

size_t orl_study_count_settings(const struct orl_study_request *request)
{
    size_t count = 0;
    for (size_t i = 0; i < request->n_techniques; i++)
        count += count_settings(request, request->techniques[i]);
    return count;
}

/* Sets an error about that member of the document, and returns its code. */
__attribute__((format(printf, 4, 5))) static int
fail_member(struct orl_error *err, int code, const char *member, const char *format, ...)
{
    va_list args;
    va_start(args, format);
    orl_error_vset(err, code, format, args);
    va_end(args);
    orl_error_at(err, NULL, 0, member);
    return code;
}

static int check_technique(const struct orl_study_request *request, size_t index,
                           struct orl_error *err)
{
    const enum orl_technique technique = request->techniques[index];
    const char *name = orl_technique_name(technique);
    char at[48];
    snprintf(at, sizeof at, "techniques[%zu]", index);
    if (technique == ORL_TECHNIQUE_AUTO)
        return fail_member(err, ORL_ERR_INVALID, at,
                           "a study needs named techniques: \"auto\" is not allowed");
    for (size_t i = 0; i < index; i++)
        if (request->techniques[i] == technique)
            return fail_member(err, ORL_ERR_INVALID, at, "technique \"%s\" is named twice", name);
    if (count_settings(request, technique) > 0)
        return 0;
    if (orl_study_uses_photons(technique) && request->n_photons == 0)
        return fail_member(err, ORL_ERR_INVALID, "photons",
                           "technique \"%s\" needs a list of photons", name);
    return fail_member(err, ORL_ERR_INVALID,
                       orl_study_of_views(request) ? "pixel_samples" : "gather_samples",
                       "technique \"%s\" needs a list of samples", name);
}

static int check_job(const struct orl_job *job, struct orl_error *err)
{
    const bool sensors = job->n_sensors > 0 || job->sensors_file;
    if (sensors == (job->n_views > 0)) {
        fail_member(err, ORL_ERR_INVALID, "views", "a study measures either sensors or views%s",
                    sensors ? ", not both" : ", but the job has neither");
        orl_error_hint(err, "Otherwise times would include both, but errors only one of them");
        return ORL_ERR_INVALID;
    }
    return orl_job_validate(job, err);
}

static int check_counts(const struct orl_study_request *request, struct orl_error *err)
{
    if (request->repeats == 0)
        return fail_member(err, ORL_ERR_INVALID, "repeats",
                           "a study needs \"repeats\" of at least 1");
    if (request->reference_samples == 0 || request->reference_runs == 0)
        return fail_member(err, ORL_ERR_INVALID, "reference", "a study needs a reference");
    if (orl_study_of_views(request) && request->reference_runs < 2)
        return fail_member(err, ORL_ERR_INVALID, "reference.runs",
                           "a reference of views needs at least two runs, to estimate its error");
    return orl_study_check_runs(request, ORL_LIMIT_STUDY_RUNS, err);
}

int orl_study_check_runs(const struct orl_study_request *request, uint32_t most,
                         struct orl_error *err)
{
    const size_t settings = orl_study_count_settings(request);
    if ((uint64_t)settings * request->repeats + request->reference_runs <= most)
        return 0;
    fail_member(err, ORL_ERR_LIMIT, "repeats",
                "%zu settings with %u seeds each, and %u of the reference, are more than %u runs",
                settings, request->repeats, request->reference_runs, most);
    orl_error_hint(err, "List fewer photons or samples, or use fewer repeats");
    return ORL_ERR_LIMIT;
}

static int check_given(const struct orl_study_external *external, size_t index,
                       struct orl_error *err)
{
    char at[48];
    const bool seconds = orl_study_can_show(external->seconds),
               rms = orl_study_can_show(external->rms);
    if (seconds && rms && (external->rays_per_s == 0 || orl_study_can_show(external->rays_per_s)))
        return 0;
    snprintf(at, sizeof at, "points[%zu].%s", index,
             !seconds ? "seconds"
             : !rms   ? "rms"
                      : "rays_per_s");
    return fail_member(err, ORL_ERR_RANGE, at,
                       "point \"%s\": seconds, rms and rays_per_s must be from 1e-12 to 1e12",
                       external->name);
}

int orl_study_request_validate(const struct orl_study_request *request, struct orl_error *err)
{
    int code = check_job(&request->job, err);
    if (code == 0 && request->n_techniques == 0)
        code = fail_member(err, ORL_ERR_INVALID, "techniques", "the study names no technique");
    for (size_t i = 0; i < request->n_techniques && code == 0; i++)
        code = check_technique(request, i, err);
    if (code == 0)
        code = check_counts(request, err);
    for (size_t i = 0; i < request->n_external && code == 0; i++)
        code = check_given(&request->external[i], i, err);
    return code;
}

struct orl_study_setting orl_study_reference_setting(const struct orl_study_request *request)
{
    const uint32_t runs = request->reference_runs;
    return (struct orl_study_setting){.technique = ORL_TECHNIQUE_BACKWARD,
                                      .samples = (request->reference_samples + runs - 1) / runs};
}

uint64_t orl_study_reference_seed(const struct orl_study_request *request)
{
    return request->job.seed + request->repeats;
}

int orl_study_list_settings(const struct orl_study_request *request,
                            struct orl_study_setting **ret_settings, size_t *ret_count,
                            struct orl_error *err)
{
    const bool of_views = orl_study_of_views(request);
    struct orl_study_setting *settings;
    const size_t count = orl_study_count_settings(request);
    size_t at = 0;
    settings = calloc(count ? count : 1, sizeof *settings);
    if (!settings)
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
    for (size_t i = 0; i < request->n_techniques; i++) {
        const enum orl_technique technique = request->techniques[i];
        const bool photons = orl_study_uses_photons(technique);
        const bool samples = orl_study_uses_samples(technique, of_views);
        for (size_t p = 0; p < (photons ? request->n_photons : 1); p++)
            for (size_t s = 0; s < (samples ? request->n_samples : 1); s++)
                settings[at++] =
                    (struct orl_study_setting){technique, photons ? request->photons[p] : 0,
                                               samples ? request->samples[s] : 0};
    }
    *ret_settings = settings;
    *ret_count = count;
    return 0;
}

double orl_study_run_core_s(const struct orl_job *job, const struct orl_study_setting *setting,
                            double sensors)
{
    /* Microseconds: a photon of either kind, traced and indexed; a sample of a sensor; a path of a
     * pixel; the start of a run. */
    const double photon_us = 2, sample_us = 3, path_us = 10, start_us = 5e5;
    double values = 0;
    for (size_t i = 0; i < job->n_views; i++)
        values += (double)job->views[i].width * job->views[i].height;
    return 1e-6 *
           (start_us + photon_us * (double)setting->photons +
            (values > 0 ? values * path_us : sensors * sample_us) * (setting->samples + 1.0));
}

double orl_study_core_s(const struct orl_study_request *request, double sensors)
{
    const struct orl_study_setting reference = orl_study_reference_setting(request);
    struct orl_study_setting *settings = NULL;
    size_t n = 0;
    double sum = request->reference_runs * orl_study_run_core_s(&request->job, &reference, sensors);
    if (orl_study_list_settings(request, &settings, &n, NULL) < 0)
        return sum;
    for (size_t i = 0; i < n; i++)
        sum += request->repeats * orl_study_run_core_s(&request->job, &settings[i], sensors);
    free(settings);
    return sum;
}
