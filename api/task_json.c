#include "task_json.h"

#include <stdlib.h>
#include <string.h>

#include "decode.h"
#include "study_json.h"

static const char *const kind_names[ORL_TASK_KIND_COUNT] = {"render", "study"};

const char *orl_task_kind_name(enum orl_task_kind kind)
{
    return kind < ORL_TASK_KIND_COUNT ? kind_names[kind] : "unknown";
}

enum orl_task_kind orl_task_kind_from_name(const char *name)
{
    unsigned kind = 0;
    while (kind < ORL_TASK_KIND_COUNT && strcmp(kind_names[kind], name) != 0)
        kind++;
    return (enum orl_task_kind)kind;
}

void orl_task_done(struct orl_task *task)
{
    if (!task)
        return;
    if (task->kind == ORL_TASK_STUDY)
        orl_study_request_done(&task->of.study);
    else
        orl_job_done(&task->of.render);
}

struct orl_job *orl_task_job(struct orl_task *task)
{
    return task->kind == ORL_TASK_STUDY ? &task->of.study.job : &task->of.render;
}

static int read_kind(const json_t *doc, enum orl_task_kind *ret_kind, struct orl_error *err)
{
    const json_t *value = json_object_get(doc, "kind");
    const char *name = json_string_value(value);
    *ret_kind = !value ? ORL_TASK_RENDER
                : name ? orl_task_kind_from_name(name)
                       : ORL_TASK_KIND_COUNT;
    if (*ret_kind < ORL_TASK_KIND_COUNT)
        return 0;
    return orl_json_fail(err, ORL_ERR_INVALID, "kind",
                         "\"render\" (the default) or \"study\" is wanted here");
}

static int read_priority(const json_t *doc, int *ret_priority, struct orl_error *err)
{
    const json_t *value = json_object_get(doc, "priority");
    uint64_t priority = ORL_PRIORITY_DEFAULT;
    const int rc =
        value ? orl_json_whole(value, "priority", 0, ORL_PRIORITY_MAX, &priority, err) : 0;
    if (rc == 0)
        *ret_priority = (int)priority;
    return rc;
}

int orl_task_from_json(const json_t *doc, enum orl_job_origin origin, struct orl_task *ret_task,
                       char **ret_scene_id, struct orl_error *err)
{
    struct orl_task task = {.kind = ORL_TASK_RENDER};
    char *scene_id = NULL;
    int rc = read_kind(doc, &task.kind, err);
    if (rc == 0)
        rc = read_priority(doc, &task.priority, err);
    if (rc)
        return rc;
    if (task.kind == ORL_TASK_STUDY)
        rc = orl_study_from_json(doc, origin, &task.of.study, &scene_id, err);
    else
        rc = orl_job_from_json(doc, origin, &task.of.render, &scene_id, err);
    if (rc)
        return rc;
    rc = task.kind == ORL_TASK_STUDY ? orl_study_request_validate(&task.of.study, err)
                                     : orl_job_validate(&task.of.render, err);
    if (rc) {
        orl_task_done(&task);
        free(scene_id);
        return rc;
    }
    *ret_task = task;
    if (ret_scene_id)
        *ret_scene_id = scene_id;
    else
        free(scene_id);
    return 0;
}
