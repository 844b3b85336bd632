#include "job/grids_json.h"

#include <stdlib.h>
#include <string.h>

#include <oriel/base/limits.h>

#include "job/sensors_json.h"
#include "json/members.h"

enum { NAME_MAX_BYTES = 200 };

/* A grid while it is decoded. */
struct draft {
    char *name;
    struct orl_job part; /* holds only the grid's sensors */
};

static int decode_sensors(const json_t *value, const char *path, void *into, struct orl_error *err)
{
    struct draft *draft = into;
    const int rc = orl_job_sensors_from_json(value, path, &draft->part, err);
    if (rc == 0 && draft->part.n_sensors == 0 && !draft->part.sensors_file)
        return orl_json_fail(err, ORL_ERR_INVALID, path, "there are no sensors");
    return rc;
}

static int decode_grid(const json_t *value, const char *path, void *into, struct orl_error *err)
{
    struct draft *draft = into;
    const struct orl_json_member members[] = {
        {"name", .text = &draft->name, .longest = NAME_MAX_BYTES, .required = true},
        {"sensors", .decode = decode_sensors, .into = draft, .required = true},
        {0}};
    return orl_json_members(value, path, members, err);
}

/* Moves names and files into job, and appends copies of the sensors to the job's. */
static int move_drafts_to_job(struct draft *drafts, size_t n, struct orl_job *job,
                              struct orl_error *err)
{
    size_t sensors = job->n_sensors;
    for (size_t i = 0; i < n; i++)
        sensors += drafts[i].part.n_sensors;
    struct orl_sensor *grown = realloc(job->sensors, (sensors + 1) * sizeof *grown);
    if (grown)
        job->sensors = grown;
    job->grids = calloc(n + 1, sizeof *job->grids);
    if (!grown || !job->grids)
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
    for (size_t i = 0; i < n; i++) {
        struct orl_job *part = &drafts[i].part;
        job->grids[job->n_grids++] = (struct orl_grid_request){drafts[i].name, part->sensors_file,
                                                               job->n_sensors, part->n_sensors};
        if (part->n_sensors > 0)
            memcpy(job->sensors + job->n_sensors, part->sensors,
                   part->n_sensors * sizeof *part->sensors);
        job->n_sensors += part->n_sensors;
        drafts[i].name = NULL;
        part->sensors_file = NULL;
    }
    return 0;
}

int orl_grids_from_json(const json_t *value, const char *path, void *into, struct orl_error *err)
{
    struct orl_job *job = into;
    struct draft *drafts = NULL;
    size_t n = 0;
    const struct orl_json_list list = {.items = &drafts,
                                       .count = &n,
                                       .size = sizeof *drafts,
                                       .most = ORL_LIMIT_GRIDS,
                                       .each = decode_grid,
                                       .empty = "the list is empty"};
    int rc = orl_json_list(value, path, &list, err);
    if (rc == 0 && (job->n_sensors > 0 || job->sensors_file))
        rc = orl_json_fail(err, ORL_ERR_INVALID, path,
                           "a job has \"sensors\" or \"grids\" of them, not both");
    if (rc == 0)
        rc = move_drafts_to_job(drafts, n, job, err);
    for (size_t i = 0; drafts && i < n; i++) {
        free(drafts[i].name);
        orl_job_done(&drafts[i].part);
    }
    free(drafts);
    return rc;
}

json_t *orl_grids_to_json(const struct orl_result *result)
{
    json_t *grids = result->n_grids > 0 ? json_array() : NULL;
    for (size_t i = 0; i < result->n_grids && grids; i++) {
        const struct orl_grid_result *grid = &result->grids[i];
        if (json_array_append_new(grids, json_pack("{s:s, s:I, s:I, s:s*, s:s*}", "name",
                                                   grid->name, "first", (json_int_t)grid->first,
                                                   "count", (json_int_t)grid->count, "res",
                                                   grid->res, "npy", grid->npy))) {
            json_decref(grids);
            return NULL;
        }
    }
    return grids;
}
