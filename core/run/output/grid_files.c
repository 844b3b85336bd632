/* Result files of grids: tables for Honeybee's tools, and maps. */
#include "run/output/output_files.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "base/io/out_file.h"
#include "render/heat_map/heat_map.h"
#include "run/diagnostics/diagnostics.h"
#include "run/run_state.h"
#include "run/stages/rendering.h"

enum { PATH_SIZE = 4096 };

/* Returns the length of the folder name in a prefix: "SKY." before other files is the folder SKY
 * here. */
static int folder_length(const char *prefix)
{
    const size_t length = prefix ? strlen(prefix) : 0;
    return (int)(length > 0 && prefix[length - 1] == '.' ? length - 1 : length);
}

/* Makes the name below the output folder, owned by the caller, and its path. Creates the folders in
 * between. */
static int name_file(const struct orl_run_state *state, const char *grid, const char *ending,
                     char **ret_name, char ret_path[PATH_SIZE], struct orl_error *err)
{
    const char *prefix = state->env->file_prefix, *output = state->env->output_folder;
    const int folder = folder_length(prefix);
    if (asprintf(ret_name, "%.*s%sresults/%s%s", folder, folder ? prefix : "", folder ? "/" : "",
                 grid, ending) < 0) {
        *ret_name = NULL;
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
    }
    const int length = snprintf(ret_path, PATH_SIZE, "%s/%s", output, *ret_name);
    if (length >= PATH_SIZE)
        return orl_error_set(err, ORL_ERR_LIMIT, "the path of the output folder is too long");
    for (char *slash = strchr(ret_path + strlen(output) + 1, '/'); slash;
         slash = strchr(slash + 1, '/')) {
        *slash = '\0';
        const int made = mkdir(ret_path, 0777);
        if (made != 0 && errno != EEXIST)
            return orl_error_set(err, orl_err_of_errno(errno), "cannot create the folder '%s': %s",
                                 ret_path, strerror(errno));
        *slash = '/';
    }
    return 0;
}

static int write_res(const struct orl_run_state *state, const struct orl_grid_result *grid,
                     const char *path, struct orl_error *err)
{
    struct orl_out_file file = {.stream = NULL};
    const int code = orl_out_open(&file, path, err);
    if (code < 0)
        return code;
    file.cancel = state->env->cancel;
    for (size_t i = 0; i < grid->count && orl_out_continues(&file); i++)
        fprintf(file.stream, "%.6g\n", state->result->illuminance_lx[grid->first + i]);
    return orl_out_close(&file, 0, err);
}

static int write_npy(const struct orl_run_state *state, const struct orl_grid_result *grid,
                     const char *path, struct orl_error *err)
{
    float *values = malloc((grid->count + 1) * sizeof *values);
    if (!values)
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
    for (size_t i = 0; i < grid->count; i++)
        values[i] = (float)state->result->illuminance_lx[grid->first + i];
    const int code = orl_npy_write(path, values, grid->count, 0, state->env->cancel, err);
    free(values);
    return code;
}

/* Writes a grid's entry; names contain no characters that JSON escapes. */
static void put_info(FILE *stream, const struct orl_grid_result *grid, const char *between)
{
    const char *slash = strrchr(grid->name, '/');
    const char *own = slash ? slash + 1 : grid->name;
    const int group = slash ? (int)(slash - grid->name) : 0;
    fprintf(stream,
            "%s\n  {\"name\": \"%s\", \"identifier\": \"%s\", \"count\": %zu, \"group\": \"%.*s\", "
            "\"full_id\": \"%s\"}",
            between, own, own, grid->count, group, grid->name, grid->name);
}

static int write_info(const struct orl_result *result, const char *path, struct orl_error *err)
{
    struct orl_out_file file = {.stream = NULL};
    const int code = orl_out_open(&file, path, err);
    if (code < 0)
        return code;
    fputs("[", file.stream);
    for (size_t i = 0; i < result->n_grids; i++)
        put_info(file.stream, &result->grids[i], i ? "," : "");
    fputs("\n]\n", file.stream);
    return orl_out_close(&file, 0, err);
}

/* Draws the grid's map. A grid without enough sensors in one plane gets none. */
static int write_map(const struct orl_run_state *state, struct orl_grid_result *grid,
                     struct orl_error *err)
{
    const struct orl_job *job = state->job;
    const struct orl_result *result = state->result;
    struct orl_sensor_plane plane;
    char title[64], path[PATH_SIZE];
    size_t found = 0;
    snprintf(title, sizeof title, "Illuminance of %.40s", grid->name);
    int code = orl_sensor_planes_find(state->sensors + grid->first, grid->count, 1, &plane, &found);
    if (code < 0)
        orl_error_set(err, code, "out of memory for a map of %zu sensors", grid->count);
    const struct orl_heat_map map = {
        .geometry = state->lit_scene->geometry,
        .plane = &plane,
        .quantity = title,
        .unit = "lx",
        .values = result->illuminance_lx + grid->first,
        .intervals = (const double(*)[2])(result->interval_95_lx + grid->first),
        .how = job->heat_map.asked ? &job->heat_map : &orl_default_heat_map};
    if (code == 0 && found > 0)
        code = name_file(state, grid->name, ".png", &grid->map, path, err);
    if (code == 0 && found > 0)
        code = orl_heat_map_write(&map, ORL_CANVAS_PNG, path, err);
    orl_sensor_planes_done(&plane, found);
    return code;
}

/* Draws the maps of the first grids. */
static int write_grid_maps(struct orl_run_state *state, struct orl_error *err)
{
    struct orl_result *result = state->result;
    int code = 0;
    if (!state->job->sensor_files && !state->job->heat_map.asked)
        return 0;
    for (size_t i = 0; i < result->n_grids && i < ORL_GRID_MAPS && code == 0; i++)
        code = orl_is_cancelled(state->env->cancel)
                   ? orl_error_set(err, ORL_ERR_CANCELLED, "cancelled while drawing maps")
                   : write_map(state, &result->grids[i], err);
    if (result->n_grids > ORL_GRID_MAPS)
        orl_run_warn(state, "maps are drawn of the first %d of %zu grids", ORL_GRID_MAPS,
                     result->n_grids);
    return code;
}

int orl_run_write_grids(struct orl_run_state *state, struct orl_error *err)
{
    struct orl_result *result = state->result;
    char path[PATH_SIZE];
    int code = 0;
    for (size_t i = 0; i < result->n_grids && code == 0; i++) {
        struct orl_grid_result *grid = &result->grids[i];
        code = name_file(state, grid->name, ".res", &grid->res, path, err);
        if (code == 0)
            code = write_res(state, grid, path, err);
        if (code == 0)
            code = name_file(state, grid->name, ".npy", &grid->npy, path, err);
        if (code == 0)
            code = write_npy(state, grid, path, err);
    }
    if (code == 0 && result->n_grids > 0)
        code = name_file(state, "grids_info", ".json", &result->grids_info, path, err);
    if (code == 0 && result->n_grids > 0)
        code = write_info(result, path, err);
    return code == 0 ? write_grid_maps(state, err) : code;
}
