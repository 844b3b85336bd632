/* Tables and maps of a job's sensors. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/io/out_file.h"
#include "render/heat_map/heat_map.h"
#include "run/diagnostics/run_warnings.h"
#include "run/output/output_files.h"
#include "run/run_state.h"

/* Makes a name with the run's prefix, owned by the caller, and its path. */
static int name_file(const struct orl_run_state *state, const char *name, char **ret_name,
                     char ret_path[4096], struct orl_error *err)
{
    const char *prefix = state->env->file_prefix ? state->env->file_prefix : "";
    const size_t size = strlen(prefix) + strlen(name) + 1;
    *ret_name = malloc(size);
    if (!*ret_name)
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
    snprintf(*ret_name, size, "%s%s", prefix, name);
    const int length = snprintf(ret_path, 4096, "%s/%s", state->env->output_folder, *ret_name);
    return length < 4096
               ? 0
               : orl_error_set(err, ORL_ERR_LIMIT, "the path of the output folder is too long");
}

/* ---- Tables ---------------------------------------------------------------------------------- */

/* Ends a line with the reasons why the value is unreliable. */
static void write_doubts(unsigned doubts, FILE *stream)
{
    const char *space = "";
    for (unsigned i = 0; i < ORL_DOUBTS; i++)
        if (doubts & 1U << i) {
            fprintf(stream, "%s%s", space, orl_doubt_name((enum orl_doubt)(1U << i)));
            space = " ";
        }
    fputc('\n', stream);
}

static int write_csv(const struct orl_run_state *state, const char *path, struct orl_error *err)
{
    const struct orl_result *r = state->result;
    struct orl_out_file file = {.stream = NULL};
    const int code = orl_out_open(&file, path, err);
    if (code < 0)
        return code;
    file.cancel = state->env->cancel;
    fputs("x,y,z,dx,dy,dz,illuminance_lx,standard_error_lx,bias_estimate_lx,low_95_lx,high_95_lx,"
          "unreliable\n",
          file.stream);
    for (size_t i = 0; i < r->n_sensors && orl_out_continues(&file); i++) {
        const struct orl_vec3 p = state->sensors[i].position, d = state->sensors[i].direction;
        fprintf(file.stream, "%.9g,%.9g,%.9g,%.9g,%.9g,%.9g,%.6g,%.4g,%.4g,%.6g,%.6g,", p.x, p.y,
                p.z, d.x, d.y, d.z, r->illuminance_lx[i], r->standard_error_lx[i],
                r->bias_estimate_lx[i], r->interval_95_lx[i][0], r->interval_95_lx[i][1]);
        write_doubts(r->doubts ? r->doubts[i] : 0, file.stream);
    }
    return orl_out_close(&file, 0, err);
}

/* Writes one value a line, in the sensors' order, as tools for Radiance do. */
static int write_res(const struct orl_run_state *state, const char *path, struct orl_error *err)
{
    struct orl_out_file file = {.stream = NULL};
    const int code = orl_out_open(&file, path, err);
    if (code < 0)
        return code;
    file.cancel = state->env->cancel;
    for (size_t i = 0; i < state->result->n_sensors && orl_out_continues(&file); i++)
        fprintf(file.stream, "%.6g\n", state->result->illuminance_lx[i]);
    return orl_out_close(&file, 0, err);
}

/* ---- Radiance's data files ------------------------------------------------------------------- */

/* A grid's values row by row, rows along v; values are owned. */
struct table {
    size_t size[2]; /* along u, along v */
    double low[2];
    double *values; /* NaN: no sensor there */
};

static double along(const struct orl_sensor_plane *p, size_t i, int axis)
{
    const double c = cos(p->angle), s = sin(p->angle);
    return axis == 0 ? p->at[i][0] * c + p->at[i][1] * s : p->at[i][1] * c - p->at[i][0] * s;
}

static void find_size(const struct orl_sensor_plane *p, struct table *table)
{
    for (int axis = 0; axis < 2; axis++) {
        double low = INFINITY, high = -INFINITY;
        for (size_t i = 0; i < p->count; i++) {
            low = fmin(low, along(p, i, axis));
            high = fmax(high, along(p, i, axis));
        }
        table->low[axis] = low;
        table->size[axis] = (size_t)lrint((high - low) / p->cell[axis]) + 1;
    }
}

/* Fills a table. Returns false if the sensors are no full grid or memory is exhausted; the table is
 * then omitted. */
static bool fill_table(const struct orl_sensor_plane *p, const double *lux, struct table *table)
{
    static const double off_line = 0.02; /* tolerance, as a share of a cell */
    if (!p->grid)
        return false;
    find_size(p, table);
    if (table->size[0] * table->size[1] != p->count)
        return false;
    table->values = malloc(p->count * sizeof *table->values);
    bool full = table->values;
    for (size_t i = 0; full && i < p->count; i++)
        table->values[i] = NAN;
    for (size_t i = 0; full && i < p->count; i++) {
        const double u = (along(p, i, 0) - table->low[0]) / p->cell[0];
        const double v = (along(p, i, 1) - table->low[1]) / p->cell[1];
        double *value = &table->values[(size_t)lrint(v) * table->size[0] + (size_t)lrint(u)];
        full = fabs(u - rint(u)) < off_line && fabs(v - rint(v)) < off_line && isnan(*value);
        *value = lux[p->sensors[i]];
    }
    return full;
}

static int write_dat(const struct orl_sensor_plane *p, const struct table *table, const char *path,
                     struct orl_error *err)
{
    struct orl_out_file file = {.stream = NULL};
    const int code = orl_out_open(&file, path, err);
    if (code < 0)
        return code;
    fputs("2\n", file.stream);
    for (int axis = 1; axis >= 0; axis--)
        fprintf(file.stream, "%.9g %.9g %zu\n", table->low[axis],
                table->low[axis] + (double)(table->size[axis] - 1) * p->cell[axis],
                table->size[axis]);
    for (size_t i = 0; i < p->count; i++)
        fprintf(file.stream, "%.6g%c", table->values[i], (i + 1) % table->size[0] ? ' ' : '\n');
    return orl_out_close(&file, 0, err);
}

/* ---- Maps ------------------------------------------------------------------------------------ */

static int write_map(struct orl_run_state *state, const struct orl_sensor_plane *plane,
                     struct orl_error *err)
{
    struct orl_sensor_files *files = &state->result->sensor_files;
    const size_t at = files->n_maps++;
    const struct orl_heat_map map = {state->lit_scene->geometry,
                                     plane,
                                     "Illuminance",
                                     "lx",
                                     state->result->illuminance_lx,
                                     (const double(*)[2])state->result->interval_95_lx,
                                     &state->job->heat_map};
    struct table table = {.values = NULL};
    char name[32], number[16] = "", path[4096];
    files->maps[at].sensors = plane->count;
    if (at > 0)
        snprintf(number, sizeof number, "-%zu", at + 1);
    snprintf(name, sizeof name, "sensors.map%s.png", number);
    int code = name_file(state, name, &files->maps[at].png, path, err);
    if (code == 0)
        code = orl_heat_map_write(&map, ORL_CANVAS_PNG, path, err);
    snprintf(name, sizeof name, "sensors.map%s.svg", number);
    if (code == 0)
        code = name_file(state, name, &files->maps[at].svg, path, err);
    if (code == 0)
        code = orl_heat_map_write(&map, ORL_CANVAS_SVG, path, err);
    snprintf(name, sizeof name, "sensors.map%s.dat", number);
    if (code == 0 && fill_table(plane, state->result->illuminance_lx, &table)) {
        code = name_file(state, name, &files->maps[at].dat, path, err);
        if (code == 0)
            code = write_dat(plane, &table, path, err);
    }
    free(table.values);
    return code;
}

static int write_maps(struct orl_run_state *state, struct orl_error *err)
{
    struct orl_sensor_plane planes[ORL_HEAT_MAPS] = {{.count = 0}};
    size_t count = 0;
    int code =
        orl_sensor_planes_find(state->sensors, state->n_sensors, ORL_HEAT_MAPS, planes, &count);
    if (code < 0)
        orl_error_set(err, code, "out of memory for maps of %zu sensors", state->n_sensors);
    else if (count == 0)
        orl_run_warn(state, "no heat map: fewer than %d sensors lie in one plane",
                     ORL_LEAST_IN_PLANE);
    for (size_t i = 0; i < count && code == 0; i++)
        code = write_map(state, &planes[i], err);
    orl_sensor_planes_done(planes, count);
    return code;
}

int orl_run_write_sensors(struct orl_run_state *state, struct orl_error *err)
{
    struct orl_sensor_files *files = &state->result->sensor_files;
    char path[4096];
    if (!state->job->heat_map.asked || state->n_sensors == 0)
        return 0;
    int code = name_file(state, "sensors.csv", &files->csv, path, err);
    if (code == 0)
        code = write_csv(state, path, err);
    if (code == 0)
        code = name_file(state, "sensors.res", &files->res, path, err);
    if (code == 0)
        code = write_res(state, path, err);
    return code == 0 ? write_maps(state, err) : code;
}
