/*
 * A document of any kind (JSON) -> what it asks for: a render job (job_json.h), a study
 * (study_json.h), a year (annual_json.h) or a panel's BSDF (bsdf_make_json.h), told apart by its
 * "kind"; without one it is a render job.
 *
 * Of any kind, "priority": 0 to 9, larger goes first in the daemon's queue; 5 when left out; and
 * "name" and "tags" (labels_json.h).
 *
 * Rules, ownership, threads and errors as in job_json.h.
 */
#ifndef ORL_API_TASK_JSON_H
#define ORL_API_TASK_JSON_H

#include <jansson.h>

#include <oriel/study.h>

#include "annual_json.h"
#include "bsdf_fit_json.h"
#include "bsdf_make_json.h"
#include "job_json.h"
#include "labels_json.h"

enum orl_task_kind {
    ORL_TASK_RENDER,
    ORL_TASK_STUDY,
    ORL_TASK_ANNUAL,
    ORL_TASK_BSDF_MAKE,
    ORL_TASK_BSDF_FIT,
    ORL_TASK_KIND_COUNT
};
/* "render", "study", "annual", "bsdf_make", "bsdf_fit" */
const char *orl_task_kind_name(enum orl_task_kind kind);
/* ORL_TASK_KIND_COUNT when there is no such kind. */
enum orl_task_kind orl_task_kind_from_name(const char *name);

enum { ORL_PRIORITY_MAX = 9, ORL_PRIORITY_DEFAULT = 5 };

struct orl_task {
    enum orl_task_kind kind;
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
void orl_task_done(struct orl_task *task);

/* Decodes doc and checks it as far as that goes without the scene. */
int orl_task_from_json(const json_t *doc, enum orl_job_origin origin, struct orl_task *ret_task,
                       char **ret_scene_id, struct orl_error *err);

/* The job itself, or the one that a study's runs are made from: scene, sky, sensors, views. NULL:
 * it is made of none. */
const struct orl_job *orl_task_job(const struct orl_task *task);

/* ---- Files ----------------------------------------------------------------------------------- */

/* The main files of its scene, borrowed; none of a document that names an id. */
char *const *orl_task_scene(const struct orl_task *task, size_t *ret_count);
/* Gives it such names where it has none; both are taken. */
void orl_task_set_scene(struct orl_task *task, char **files, size_t count);

enum orl_file_role {
    ORL_FILE_SENSORS,
    ORL_FILE_WEATHER,   /* for some hours of it */
    ORL_FILE_VIEW,      /* lines of views */
    ORL_FILE_MASK,      /* a picture, of a view's glare */
    ORL_FILE_YEAR,      /* weather, for all of it */
    ORL_FILE_OCCUPANCY, /* of that year's hours */
    ORL_FILE_SCENE,     /* scene text, of a state of its shades */
    ORL_FILE_MATRIX,    /* of a year's light, or a BSDF in its place */
    ORL_FILE_SCHEDULE,  /* of its shades */
    ORL_FILE_ROLES
};

/* A file that the document names beside its scene's. */
struct orl_task_file {
    enum orl_file_role role;
    const char *name;
    const char *place; /* where it does: "sky.weather.file" */
    const char *entry; /* of views: which of them is wanted; of weather: its year; or NULL */
};

/* Calls visit with each of them, valid during the call, the year before its occupancy; a negative
 * orl_err of it ends that. */
int orl_task_files(const struct orl_task *task,
                   int (*visit)(void *ctx, const struct orl_task_file *file, struct orl_error *err),
                   void *ctx, struct orl_error *err);

#endif
