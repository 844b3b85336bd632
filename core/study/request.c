/* Requests of studies: defaults, checks, clean-up. */
#include <stdlib.h>
#include <string.h>

#include <oriel/limits.h>

#include "study/series.h"

void orl_study_request_init(struct orl_study_request *request)
{
    memset(request, 0, sizeof *request);
    orl_job_init(&request->job);
    request->repeats = 3;
    request->reference_runs = 8;
}

void orl_study_free_given(struct orl_study_given *given, size_t count)
{
    for (size_t i = 0; given && i < count; i++)
        free(given[i].name);
    free(given);
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
    orl_study_free_given(request->given, request->n_given);
    memset(request, 0, sizeof *request);
}

bool orl_study_heeds_photons(enum orl_technique technique)
{
    return technique != ORL_TECHNIQUE_BACKWARD;
}

bool orl_study_heeds_samples(enum orl_technique technique, bool of_views)
{
    /* Views by photon maps choose their own rays; sensors read maps directly but for a gather. */
    return technique == ORL_TECHNIQUE_BACKWARD || (technique == ORL_TECHNIQUE_GATHER && !of_views);
}

bool orl_study_can_show(double value)
{
    return value >= 1e-12 && value <= 1e12;
}

bool orl_study_of_views(const struct orl_study_request *request)
{
    return request->job.n_views > 0;
}

/* How many settings of a technique there are; 0 where one of its lists is empty. */
static size_t count_settings(const struct orl_study_request *request, enum orl_technique technique)
{
    const bool of_views = orl_study_of_views(request);
    return (orl_study_heeds_photons(technique) ? request->n_photons : 1) *
           (orl_study_heeds_samples(technique, of_views) ? request->n_samples : 1);
}

static int check_technique(const struct orl_study_request *request, size_t index,
                           struct orl_error *err)
{
    const enum orl_technique technique = request->techniques[index];
    const char *name = orl_technique_name(technique);
    if (technique == ORL_TECHNIQUE_AUTO)
        return orl_error_set(err, ORL_ERR_INVALID,
                             "a study names its techniques: \"auto\" is none");
    for (size_t i = 0; i < index; i++)
        if (request->techniques[i] == technique)
            return orl_error_set(err, ORL_ERR_INVALID, "technique \"%s\" is named twice", name);
    if (count_settings(request, technique) > 0)
        return 0;
    return orl_error_set(err, ORL_ERR_INVALID, "technique \"%s\" needs a list of %s", name,
                         orl_study_heeds_photons(technique) && request->n_photons == 0 ? "photons"
                                                                                       : "samples");
}

static int check_job(const struct orl_job *job, struct orl_error *err)
{
    const bool sensors = job->n_sensors > 0 || job->sensors_file;
    if (sensors == (job->n_views > 0)) {
        orl_error_set(err, ORL_ERR_INVALID, "a study measures either sensors or views%s",
                      sensors ? ", not both" : ", but names none");
        orl_error_hint(err, "Times would otherwise be of both, errors of one");
        return ORL_ERR_INVALID;
    }
    return orl_job_validate(job, err);
}

int orl_study_request_validate(const struct orl_study_request *request, struct orl_error *err)
{
    size_t settings = 0;
    int code = check_job(&request->job, err);
    if (code == 0 && request->n_techniques == 0)
        code = orl_error_set(err, ORL_ERR_INVALID, "the study names no technique");
    for (size_t i = 0; i < request->n_techniques && code == 0; i++) {
        code = check_technique(request, i, err);
        settings += code == 0 ? count_settings(request, request->techniques[i]) : 0;
    }
    if (code == 0 &&
        (request->repeats == 0 || request->reference_samples == 0 || request->reference_runs == 0))
        code = orl_error_set(err, ORL_ERR_INVALID, "a study needs repeats, and a reference");
    if (code == 0 && orl_study_of_views(request) && request->reference_runs < 2)
        code = orl_error_set(err, ORL_ERR_INVALID,
                             "a reference of views needs two runs: they tell its error");
    if (code == 0 &&
        (uint64_t)settings * request->repeats + request->reference_runs > ORL_LIMIT_STUDY_RUNS)
        code = orl_error_set(err, ORL_ERR_LIMIT,
                             "%zu settings with %u seeds each are more than %u runs", settings,
                             request->repeats, ORL_LIMIT_STUDY_RUNS);
    for (size_t i = 0; i < request->n_given && code == 0; i++)
        if (!orl_study_can_show(request->given[i].seconds) ||
            !orl_study_can_show(request->given[i].rms))
            code = orl_error_set(err, ORL_ERR_RANGE,
                                 "point \"%s\": seconds and rms are from 1e-12 to 1e12",
                                 request->given[i].name);
    return code;
}

int orl_study_list_settings(const struct orl_study_request *request,
                            struct orl_study_setting **ret_settings, size_t *ret_count,
                            struct orl_error *err)
{
    const bool of_views = orl_study_of_views(request);
    struct orl_study_setting *settings;
    size_t count = 0, at = 0;
    for (size_t i = 0; i < request->n_techniques; i++)
        count += count_settings(request, request->techniques[i]);
    settings = calloc(count ? count : 1, sizeof *settings);
    if (!settings)
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
    for (size_t i = 0; i < request->n_techniques; i++) {
        const enum orl_technique technique = request->techniques[i];
        const bool photons = orl_study_heeds_photons(technique);
        const bool samples = orl_study_heeds_samples(technique, of_views);
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
