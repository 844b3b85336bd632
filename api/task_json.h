/*
 * A document of any kind (JSON) -> what it asks for: a render job (job_json.h) or a study
 * (study_json.h), told apart by its "kind"; without one it is a render job.
 *
 * Of either kind, "priority": 0 to 9, larger goes first in the daemon's queue; 5 when left out.
 *
 * Rules, ownership, threads and errors as in job_json.h.
 */
#ifndef ORL_API_TASK_JSON_H
#define ORL_API_TASK_JSON_H

#include <jansson.h>

#include <oriel/study.h>

#include "job_json.h"

enum orl_task_kind { ORL_TASK_RENDER, ORL_TASK_STUDY, ORL_TASK_KIND_COUNT };
const char *orl_task_kind_name(enum orl_task_kind kind); /* "render", "study" */
/* ORL_TASK_KIND_COUNT when there is no such kind. */
enum orl_task_kind orl_task_kind_from_name(const char *name);

enum { ORL_PRIORITY_MAX = 9, ORL_PRIORITY_DEFAULT = 5 };

struct orl_task {
    enum orl_task_kind kind;
    int priority;
    union {
        struct orl_job render;
        struct orl_study_request study;
    } of;
};
/* NULL and all zeros are fine. */
void orl_task_done(struct orl_task *task);

/* The job itself, or the one that a study's runs are made from: scene, sky, sensors, views. */
struct orl_job *orl_task_job(struct orl_task *task);

/* Decodes doc and checks it as far as that goes without the scene. */
int orl_task_from_json(const json_t *doc, enum orl_job_origin origin, struct orl_task *ret_task,
                       char **ret_scene_id, struct orl_error *err);

#endif
