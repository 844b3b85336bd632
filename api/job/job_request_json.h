/*
 * A document of any kind (JSON) -> struct orl_job_request. Its "kind" says which: a render job
 * (job_json.h), which is the default, a study (study_json.h), a year (annual_json.h), a panel's
 * BSDF or a BSDF fit (bsdf_json.h).
 *
 * Every kind may have "priority", "name" and "tags" (job_json.h). priority is 0 to 9, by
 * default 5; larger goes first in the daemon's queue.
 *
 * Rules, ownership, threads and errors as in job_json.h.
 */
#ifndef ORL_API_JOB_JOB_REQUEST_JSON_H
#define ORL_API_JOB_JOB_REQUEST_JSON_H

#include <jansson.h>

#include <oriel/job/study.h>

#include "annual_job/annual_json.h"
#include "bsdf_json/bsdf_json.h"
#include "job/job_json.h"

enum orl_job_request_kind {
    ORL_JOB_KIND_RENDER,
    ORL_JOB_KIND_STUDY,
    ORL_JOB_KIND_ANNUAL,
    ORL_JOB_KIND_BSDF_MAKE,
    ORL_JOB_KIND_BSDF_FIT,
    ORL_JOB_KIND_COUNT
};
/* Returns "render", "study", "annual", "bsdf_make" or "bsdf_fit". */
const char *orl_job_request_kind_name(enum orl_job_request_kind kind);
/* Returns ORL_JOB_KIND_COUNT if there is no such kind. */
enum orl_job_request_kind orl_job_request_kind_from_name(const char *name);

enum { ORL_PRIORITY_MAX = 9, ORL_PRIORITY_DEFAULT = 5 };

struct orl_job_request {
    enum orl_job_request_kind kind;
    int priority;
    struct orl_labels labels;
    union {
        struct orl_job render;
        struct orl_study_request study;
        struct orl_annual_job annual;
        struct orl_bsdf_make_request bsdf_make;
        struct orl_bsdf_fit_request bsdf_fit;
    } of;
};
/* NULL and all zeros are fine. */
void orl_job_request_done(struct orl_job_request *job_request);

/* Decodes doc and checks it as far as possible without the scene. */
int orl_job_request_from_json(const json_t *doc, enum orl_job_origin origin,
                              struct orl_job_request *ret_job_request, char **ret_scene_id,
                              struct orl_error *err);

/* Returns the render job, or the job from which a study's runs are made (scene, sky, sensors,
 * views). NULL for other kinds. */
const struct orl_job *orl_job_request_render_job(const struct orl_job_request *job_request);

/* ---- Files ----------------------------------------------------------------------------------- */

/* Returns the names of the scene's main files, borrowed; none for a document that names an id. */
char *const *orl_job_request_scene(const struct orl_job_request *job_request, size_t *ret_count);
/* Sets the names of the scene's main files, for a job request without any; takes files and its
 * strings. */
void orl_job_request_set_scene(struct orl_job_request *job_request, char **files, size_t count);

enum orl_file_role {
    ORL_FILE_SENSORS,
    ORL_FILE_WEATHER,   /* weather file, for some of its hours */
    ORL_FILE_VIEW,      /* view file, with lines of view options */
    ORL_FILE_MASK,      /* picture that masks a view for glare */
    ORL_FILE_YEAR,      /* weather file, for the whole year */
    ORL_FILE_OCCUPANCY, /* occupancy of that year's hours */
    ORL_FILE_SCENE,     /* scene file of a shade state */
    ORL_FILE_MATRIX,    /* matrix of a year's light, or a BSDF in its place */
    ORL_FILE_SCHEDULE,  /* schedule of a shade */
    ORL_FILE_ROLES
};

/* A file that the document names, other than the scene's main files. */
struct orl_job_request_file {
    enum orl_file_role role;
    const char *name;
    const char *location; /* JSON path that names it: "sky.weather.file" */
    const char *entry;    /* for views: entry in the file; for weather: its year; or NULL */
};

/* Calls visit with each file, which is valid during the call. A year's weather comes before its
 * occupancy. A negative orl_err of visit ends the calls and is returned. */
int orl_job_request_files(const struct orl_job_request *job_request,
                          int (*visit)(void *ctx, const struct orl_job_request_file *file,
                                       struct orl_error *err),
                          void *ctx, struct orl_error *err);

#endif
