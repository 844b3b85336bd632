#include "run/request/job_inputs.h"

#include <ctype.h>
#include <stdlib.h>
#include <string.h>

#include <oriel/base/limits.h>

#include "run/run_state.h"

enum { NAME_MAX_BYTES = 200 };

/* ---- Checks ---------------------------------------------------------------------------------- */

/* Returns true for slash-separated parts, none of which is hidden or "..". */
static bool is_name(const char *name)
{
    const size_t length = name ? strlen(name) : 0;
    if (length == 0 || length > NAME_MAX_BYTES || name[length - 1] == '/')
        return false;
    for (size_t i = 0; i < length; i++) {
        const bool first = i == 0 || name[i - 1] == '/';
        if (!isalnum((unsigned char)name[i]) && !strchr(first ? "-_" : "-_./", name[i]))
            return false;
    }
    return true;
}

static int compare_names(const void *a, const void *b)
{
    return strcmp(*(const char *const *)a, *(const char *const *)b);
}

static int check_unique(const struct orl_job *job, struct orl_error *err)
{
    const char **names = malloc((job->n_grids + 1) * sizeof *names);
    int code = 0;
    if (!names)
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
    for (size_t i = 0; i < job->n_grids; i++)
        names[i] = job->grids[i].name;
    qsort(names, job->n_grids, sizeof *names, compare_names);
    for (size_t i = 1; i < job->n_grids && code == 0; i++)
        if (strcmp(names[i - 1], names[i]) == 0)
            code = orl_error_set(err, ORL_ERR_INVALID, "two grids are named '%s'", names[i]);
    free(names);
    return code;
}

int orl_grids_validate(const struct orl_job *job, struct orl_error *err)
{
    size_t inlined = 0;
    if (job->n_grids == 0)
        return 0;
    if (job->sensors_file)
        return orl_error_set(err, ORL_ERR_INVALID,
                             "a job can have either sensors or sensor grids, not both");
    if (job->n_grids > ORL_LIMIT_GRIDS)
        return orl_error_set(err, ORL_ERR_LIMIT, "%zu grids; at most %u are allowed", job->n_grids,
                             ORL_LIMIT_GRIDS);
    for (size_t i = 0; i < job->n_grids; i++) {
        const struct orl_grid_request *grid = &job->grids[i];
        if (!is_name(grid->name))
            return orl_error_set(err, ORL_ERR_INVALID,
                                 "grid %zu needs a name of 1 to %d characters: letters, digits, "
                                 "'-', '_', '.', and '/' between folders",
                                 i, NAME_MAX_BYTES);
        if (!grid->file && (grid->count == 0 || grid->first != inlined))
            return orl_error_set(err, ORL_ERR_INVALID, "the grid '%s' has no sensors", grid->name);
        inlined += grid->file ? 0 : grid->count;
    }
    if (inlined != job->n_sensors)
        return orl_error_set(err, ORL_ERR_INVALID, "all sensors must belong to grids");
    return check_unique(job, err);
}

/* ---- Sensors --------------------------------------------------------------------------------- */

struct sensor_array {
    struct orl_sensor *list; /* owned */
    size_t count;
};

static int add_sensors(struct sensor_array *all, const struct orl_sensor *more, size_t count,
                       struct orl_error *err)
{
    if (all->count + count > ORL_LIMIT_SENSORS)
        return orl_error_set(err, ORL_ERR_LIMIT, "more than %lu sensors", ORL_LIMIT_SENSORS);
    memcpy(all->list + all->count, more, count * sizeof *more);
    all->count += count;
    return 0;
}

/* Ensures capacity, doubled each time, so that many small grids cost no more than a large one. */
static int reserve_sensors(struct sensor_array *all, size_t *capacity, size_t count,
                           struct orl_error *err)
{
    if (all->list && all->count + count <= *capacity)
        return 0;
    *capacity = 2 * (all->count + count);
    struct orl_sensor *grown = realloc(all->list, *capacity * sizeof *grown);
    if (!grown) {
        orl_error_set(err, ORL_ERR_NOMEM, "out of memory for %zu sensors", *capacity);
        return ORL_ERR_NOMEM;
    }
    all->list = grown;
    return 0;
}

static int read_grid_sensors(const struct orl_job *job, const struct orl_files *files,
                             const atomic_bool *cancel, struct orl_grid_request *grid,
                             struct sensor_array *all, size_t *capacity, struct orl_error *err)
{
    struct orl_sensor *read = NULL;
    size_t count = grid->count;
    int code = grid->file ? orl_sensors_load(files, grid->file, cancel, &read, &count, err) : 0;
    if (code == 0)
        code = reserve_sensors(all, capacity, count, err);
    const size_t first = all->count;
    if (code == 0)
        code = add_sensors(all, read ? read : job->sensors + grid->first, count, err);
    free(read);
    *grid = (struct orl_grid_request){grid->name, NULL, first, count};
    return code;
}

int orl_grids_read(const struct orl_job *job, const struct orl_files *files,
                   const atomic_bool *cancel, struct orl_grid_request **ret_grids,
                   struct orl_sensor **ret_sensors, size_t *ret_count, struct orl_error *err)
{
    struct orl_grid_request *grids = malloc(job->n_grids * sizeof *grids);
    struct sensor_array all = {NULL, 0};
    size_t capacity = 0;
    int code = grids ? 0 : ORL_ERR_NOMEM;
    if (code < 0)
        orl_error_set(err, code, "out of memory");
    for (size_t i = 0; i < job->n_grids && code == 0; i++) {
        grids[i] = job->grids[i];
        code = read_grid_sensors(job, files, cancel, &grids[i], &all, &capacity, err);
    }
    if (code < 0) {
        free(grids);
        free(all.list);
        return code;
    }
    *ret_grids = grids;
    *ret_sensors = all.list;
    *ret_count = all.count;
    return 0;
}

int orl_run_load_grids(struct orl_run_state *state, struct orl_error *err)
{
    const struct orl_job *job = state->job;
    struct orl_result *result = state->result;
    struct orl_grid_request *grids = NULL;
    int code = orl_grids_read(job, state->env->files, state->env->cancel, &grids, &state->sensors,
                              &state->n_sensors, err);
    if (code < 0)
        return code;
    state->sensors_owned = true;
    result->grids = calloc(job->n_grids, sizeof *result->grids);
    for (size_t i = 0; i < job->n_grids && result->grids; i++) {
        struct orl_grid_result *grid = &result->grids[result->n_grids++];
        *grid = (struct orl_grid_result){
            .name = strdup(grids[i].name), .first = grids[i].first, .count = grids[i].count};
        if (!grid->name)
            code = orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
    }
    if (!result->grids)
        code = orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
    free(grids);
    return code;
}

void orl_grid_results_done(struct orl_result *result)
{
    for (size_t i = 0; i < result->n_grids; i++) {
        free(result->grids[i].name);
        free(result->grids[i].res);
        free(result->grids[i].npy);
        free(result->grids[i].map);
    }
    free(result->grids);
    free(result->grids_info);
}
