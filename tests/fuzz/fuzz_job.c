/*
 * Job documents, as the command line and the daemon read them, and the views in them; documents of
 * studies.
 */
#include <stdlib.h>
#include <string.h>

#include <oriel/base/limits.h>

#include "fuzz/fuzz.h"
#include "job/job_json.h"
#include "job/study_json.h"
#include "light/daylight/daylight.h"
#include "render/film/film.h"
#include "study/study_runs.h"
#include "json/decode.h"

static void check_rays(const struct orl_view *view)
{
    for (int i = 0; i <= 16; i++) {
        struct orl_vec3 origin, direction;
        if (!orl_view_ray(view, (i % 5) / 4.0, (i / 5) / 3.0, &origin, &direction))
            continue;
        fuzz_check_finite(origin);
        fuzz_check_unit(direction);
    }
}

/* Checks that an accepted view casts sound rays, and that its formatted text parses to the same
 * view. */
static bool check_view(const char *text)
{
    struct orl_view view, again;
    struct orl_error err = {0};
    char written[2][1024];
    int code = orl_view_parse(text, &view, &err);
    if (code < 0) {
        fuzz_check_error(code, &err);
        return false;
    }
    check_rays(&view);
    FUZZ_PROMISE(orl_view_pixel_aspect(&view, 40, 30) > 0);
    orl_view_format(&view, written[0], sizeof written[0]);
    FUZZ_PROMISE(strlen(written[0]) < sizeof written[0] - 1);
    code = orl_view_parse(written[0], &again, &err);
    FUZZ_PROMISE(code == 0);
    orl_view_format(&again, written[1], sizeof written[1]);
    FUZZ_PROMISE(again.type == view.type && strlen(written[1]) < sizeof written[1] - 1);
    return true;
}

/* Checks the sky of a valid job. fuzz_weather.c checks skies of weather files. */
static void check_sky(const struct orl_sky_request *sky)
{
    struct orl_daylight daylight;
    struct orl_error err = {0};
    if (sky->model == ORL_SKY_OF_SCENE || sky->model == ORL_SKY_BY_WEATHER)
        return;
    const int code = orl_daylight_from_request(sky, NULL, &daylight, &err);
    if (code < 0)
        fuzz_check_error(code, &err);
    else
        fuzz_check_daylight(&daylight);
}

/* Checks the first few skies only, because the hours of a sequence are much alike. */
static void check_skies(const struct orl_job *job)
{
    enum { SOME = 8 };
    check_sky(&job->sky);
    for (size_t i = 0; i < job->n_skies && i < SOME; i++) {
        FUZZ_PROMISE(job->skies[i].request.model != ORL_SKY_OF_SCENE);
        check_sky(&job->skies[i].request);
    }
}

static bool check_document(const json_t *doc, enum orl_job_origin origin)
{
    struct orl_error err = {0};
    struct orl_job job;
    char *id = NULL;
    int code = orl_job_from_json(doc, origin, &job, &id, &err);
    if (code < 0) {
        fuzz_check_error(code, &err);
        FUZZ_PROMISE(id == NULL);
        return false;
    }
    FUZZ_PROMISE((origin == ORL_JOB_REMOTE) == (id != NULL));
    FUZZ_PROMISE((origin == ORL_JOB_LOCAL) == (job.n_scene_files > 0));
    code = orl_job_validate(&job, &err);
    if (code < 0)
        fuzz_check_error(code, &err);
    else
        check_skies(&job);
    for (size_t i = 0; i < job.n_views; i++) {
        if (job.views[i].file)
            continue; /* the options of this kind are fuzzed elsewhere */
        const bool sound = check_view(job.views[i].view);
        FUZZ_PROMISE(code < 0 || sound);
    }
    orl_job_done(&job);
    free(id);
    return code == 0;
}

/* Checks that a valid study yields settings that can be listed, and no more runs than the limit. */
static bool check_study(const json_t *doc, enum orl_job_origin origin)
{
    struct orl_error err = {0};
    struct orl_study_request request;
    struct orl_study_setting *settings = NULL;
    char *id = NULL;
    size_t count = 0;
    int code = orl_study_from_json(doc, origin, &request, &id, &err);
    if (code < 0) {
        fuzz_check_error(code, &err);
        FUZZ_PROMISE(id == NULL);
        return false;
    }
    FUZZ_PROMISE((origin == ORL_JOB_REMOTE) == (id != NULL));
    code = orl_study_request_validate(&request, &err);
    if (code < 0) {
        fuzz_check_error(code, &err);
    } else {
        FUZZ_PROMISE(orl_study_list_settings(&request, &settings, &count, &err) == 0);
        FUZZ_PROMISE(count > 0 && count * request.repeats <= ORL_LIMIT_STUDY_RUNS);
        free(settings);
    }
    orl_study_request_done(&request);
    free(id);
    return code == 0;
}

bool fuzz_job(const uint8_t *data, size_t size)
{
    struct orl_error err = {0};
    json_t *doc = NULL;
    bool accepted = false;
    const int code = orl_json_parse("job.json", (const char *)data, size, &doc, &err);
    if (code < 0) {
        fuzz_check_error(code, &err);
        /* Not a document: tries the input as a bare view. */
        char *text = strndup((const char *)data, size);
        accepted = text && check_view(text);
        free(text);
        return accepted;
    }
    accepted = check_document(doc, ORL_JOB_LOCAL);
    accepted |= check_document(doc, ORL_JOB_REMOTE);
    accepted |= check_study(doc, ORL_JOB_LOCAL);
    accepted |= check_study(doc, ORL_JOB_REMOTE);
    json_decref(doc);
    return accepted;
}
