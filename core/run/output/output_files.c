/* Result files: tables and maps of sensors, and the files of a finished view. */
#include "run/output/output_files.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/io/out_file.h"
#include "render/film/image_files.h"
#include "render/heat_map/heat_map.h"
#include "render/picture/false_color.h"
#include "run/diagnostics/diagnostics.h"
#include "run/run_state.h"
#include "run/stages/rendering.h"

/* Tables and maps of a job's sensors. */

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

/* Writes the reasons why the value is unreliable. */
static void write_doubts(unsigned doubts, FILE *stream)
{
    const char *space = "";
    for (unsigned i = 0; i < ORL_DOUBTS; i++)
        if (doubts & 1U << i) {
            fprintf(stream, "%s%s", space, orl_doubt_name((enum orl_doubt)(1U << i)));
            space = " ";
        }
}

/* Returns the grid of a sensor, which is the one at *from or a later one; NULL: sensors have no
 * grids. */
static const char *grid_of(const struct orl_result *result, size_t sensor, size_t *from)
{
    while (*from < result->n_grids &&
           sensor >= result->grids[*from].first + result->grids[*from].count)
        ++*from;
    return *from < result->n_grids ? result->grids[*from].name : NULL;
}

/* Writes a line per sensor. Names of grids need no quotes. */
static int write_csv(const struct orl_run_state *state, const char *path, struct orl_error *err)
{
    const struct orl_result *r = state->result;
    size_t grid = 0;
    struct orl_out_file file = {.stream = NULL};
    const int code = orl_out_open(&file, path, err);
    if (code < 0)
        return code;
    file.cancel = state->env->cancel;
    fprintf(file.stream,
            "x,y,z,dx,dy,dz,illuminance_lx,standard_error_lx,bias_estimate_lx,low_95_lx,"
            "high_95_lx,unreliable%s\n",
            r->n_grids > 0 ? ",grid" : "");
    for (size_t i = 0; i < r->n_sensors && orl_out_continues(&file); i++) {
        const struct orl_vec3 p = state->sensors[i].position, d = state->sensors[i].direction;
        fprintf(file.stream, "%.9g,%.9g,%.9g,%.9g,%.9g,%.9g,%.6g,%.4g,%.4g,%.6g,%.6g,", p.x, p.y,
                p.z, d.x, d.y, d.z, r->illuminance_lx[i], r->standard_error_lx[i],
                r->bias_estimate_lx[i], r->interval_95_lx[i][0], r->interval_95_lx[i][1]);
        write_doubts(r->doubts ? r->doubts[i] : 0, file.stream);
        const char *const name = grid_of(r, i, &grid);
        fprintf(file.stream, "%s%s\n", name ? "," : "", name ? name : "");
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

/* Writes the map as SVG and as a table; only a request asks for them. */
static int write_other_forms(struct orl_run_state *state, const struct orl_heat_map *map, size_t at,
                             const char *number, struct orl_error *err)
{
    struct orl_sensor_files *files = &state->result->sensor_files;
    struct table table = {.values = NULL};
    char name[32], path[4096];
    snprintf(name, sizeof name, "sensors.map%s.svg", number);
    int code = name_file(state, name, &files->maps[at].svg, path, err);
    if (code == 0)
        code = orl_heat_map_write(map, ORL_CANVAS_SVG, path, err);
    snprintf(name, sizeof name, "sensors.map%s.dat", number);
    if (code == 0 && fill_table(map->plane, map->values, &table)) {
        code = name_file(state, name, &files->maps[at].dat, path, err);
        if (code == 0)
            code = write_dat(map->plane, &table, path, err);
    }
    free(table.values);
    return code;
}

static int write_map(struct orl_run_state *state, const struct orl_sensor_plane *plane,
                     struct orl_error *err)
{
    const bool asked = state->job->heat_map.asked;
    struct orl_sensor_files *files = &state->result->sensor_files;
    const size_t at = files->n_maps++;
    const struct orl_heat_map map = {state->lit_scene->geometry,
                                     plane,
                                     "Illuminance",
                                     "lx",
                                     state->result->illuminance_lx,
                                     (const double(*)[2])state->result->interval_95_lx,
                                     asked ? &state->job->heat_map : &orl_default_heat_map};
    char name[32], number[16] = "", path[4096];
    files->maps[at].sensors = plane->count;
    if (at > 0)
        snprintf(number, sizeof number, "-%zu", at + 1);
    snprintf(name, sizeof name, "sensors.map%s.png", number);
    int code = name_file(state, name, &files->maps[at].png, path, err);
    if (code == 0)
        code = orl_heat_map_write(&map, ORL_CANVAS_PNG, path, err);
    return code == 0 && asked ? write_other_forms(state, &map, at, number, err) : code;
}

static int write_maps(struct orl_run_state *state, struct orl_error *err)
{
    struct orl_sensor_plane planes[ORL_HEAT_MAPS] = {{.count = 0}};
    const size_t most = state->job->heat_map.asked ? ORL_HEAT_MAPS : 1; /* each takes some .03 s */
    size_t count = 0;
    int code = orl_sensor_planes_find(state->sensors, state->n_sensors, most, planes, &count);
    if (code < 0)
        orl_error_set(err, code, "out of memory for maps of %zu sensors", state->n_sensors);
    else if (count == 0 && state->job->heat_map.asked)
        orl_run_warn(state, "no heat map: fewer than %d sensors lie in one plane",
                     ORL_LEAST_IN_PLANE);
    for (size_t i = 0; i < count && code == 0; i++)
        code = write_map(state, &planes[i], err);
    orl_sensor_planes_done(planes, count);
    return code;
}

/* Returns true if a view has the name of a map. It is refused if heat maps are requested. */
static bool has_view_of_map(const struct orl_job *job)
{
    static const char prefix[] = "sensors.map";
    for (size_t i = 0; i < job->n_views; i++)
        if (strncmp(job->views[i].name, prefix, sizeof prefix - 1) == 0)
            return true;
    return false;
}

int orl_run_write_sensors(struct orl_run_state *state, struct orl_error *err)
{
    struct orl_sensor_files *files = &state->result->sensor_files;
    const bool asked = state->job->heat_map.asked;
    char path[4096];
    if ((!asked && !state->job->sensor_files) || state->n_sensors == 0)
        return 0;
    int code = name_file(state, "sensors.csv", &files->csv, path, err);
    if (code == 0)
        code = write_csv(state, path, err);
    if (code == 0 && asked)
        code = name_file(state, "sensors.res", &files->res, path, err);
    if (code == 0 && asked)
        code = write_res(state, path, err);
    const bool maps = asked || (state->result->n_grids == 0 && !has_view_of_map(state->job));
    return code == 0 && maps ? write_maps(state, err) : code;
}

/* The files of a finished view. */

/* Context of files written in parallel, and their results. */
struct view_writer {
    const struct orl_film *film;
    struct orl_view view;
    struct orl_tonemapped tonemapped; /* set if one of the files is tone-mapped */
    const struct orl_false_color *colors;
    struct orl_scale scale; /* scale of the false colours */
    size_t count;
    struct {
        enum orl_picture picture;
        char path[4096];
        struct orl_error err;
        int code;
    } files[ORL_PICTURES];
};

static int write_picture(const struct view_writer *w, enum orl_picture picture, const char *path,
                         struct orl_error *err)
{
    switch (picture) {
    case ORL_PICTURE_HDR:
        return orl_film_write_hdr(w->film, &w->view, path, err);
    case ORL_PICTURE_PNG:
        return orl_tonemapped_write_png(&w->tonemapped, 8, path, err);
    case ORL_PICTURE_PNG16:
        return orl_tonemapped_write_png(&w->tonemapped, 16, path, err);
    case ORL_PICTURE_EXR:
    case ORL_PICTURE_EXR_FLOAT:
        return orl_exr_write(w->film, &w->view, picture == ORL_PICTURE_EXR, path, err);
    case ORL_PICTURE_FALSE:
    case ORL_PICTURE_LINES:
    case ORL_PICTURE_BANDS:
        return orl_false_color_write(w->film, &w->tonemapped, &w->scale, w->colors, picture, path,
                                     err);
    case ORL_PICTURE_ERROR_HDR:
        return orl_film_write_error_hdr(w->film, &w->view, path, err);
    case ORL_PICTURE_ERROR_PNG:
        return orl_film_write_error_png(w->film, path, err);
    default:
        return orl_error_set(err, ORL_ERR_INTERNAL, "no such picture");
    }
}

static void write_file(void *arg, size_t index, uint32_t member)
{
    struct view_writer *w = arg;
    (void)member;
    w->files[index].code =
        write_picture(w, w->files[index].picture, w->files[index].path, &w->files[index].err);
}

static int path_of(const struct orl_run_state *state, const char *file, char ret_path[4096],
                   struct orl_error *err)
{
    const int length = snprintf(ret_path, 4096, "%s/%s", state->env->output_folder, file);
    if (length < 0 || length >= 4096)
        return orl_error_set(err, ORL_ERR_LIMIT, "the path of the output folder is too long");
    return 0;
}

/* Returns name.ending with the run's prefix, owned by the caller; NULL if out of memory. */
static char *file_name(const struct orl_run_state *state, const char *name, const char *ending)
{
    const char *prefix = state->env->file_prefix ? state->env->file_prefix : "";
    const size_t size = strlen(prefix) + strlen(name) + strlen(ending) + 2;
    char *file = malloc(size);
    if (file)
        snprintf(file, size, "%s%s.%s", prefix, name, ending);
    return file;
}

/* Returns the pictures to write, as bits. */
static uint32_t pictures_of(const struct orl_view_request *request, const struct orl_film *film)
{
    uint32_t pictures = request->formats ? request->formats : ORL_PICTURES_DEFAULT;
    if (request->false_color.asked)
        pictures |= request->false_color.pictures ? request->false_color.pictures
                                                  : ORL_PICTURE_BIT(ORL_PICTURE_FALSE);
    if (orl_film_has_errors(film))
        pictures |= ORL_PICTURE_BIT(ORL_PICTURE_ERROR_HDR) | ORL_PICTURE_BIT(ORL_PICTURE_ERROR_PNG);
    return pictures;
}

/* Tone-mapped pictures. */
static const uint32_t tone_mapped =
    ORL_PICTURE_BIT(ORL_PICTURE_PNG) | ORL_PICTURE_BIT(ORL_PICTURE_PNG16) |
    ORL_PICTURE_BIT(ORL_PICTURE_LINES) | ORL_PICTURE_BIT(ORL_PICTURE_BANDS);

/* Sets the files' names in the result, and their paths. */
static int name_files(const struct orl_run_state *state, uint32_t pictures,
                      struct orl_view_result *result, struct view_writer *view_writer,
                      struct orl_error *err)
{
    for (int i = 0; i < ORL_PICTURES; i++) {
        const enum orl_picture picture = (enum orl_picture)i;
        if (!(pictures & ORL_PICTURE_BIT(picture)))
            continue;
        result->files[i] = file_name(state, result->name, orl_picture_ending(picture));
        if (!result->files[i])
            return orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
        const size_t at = view_writer->count++;
        view_writer->files[at].picture = picture;
        const int code = path_of(state, result->files[i], view_writer->files[at].path, err);
        if (code < 0)
            return code;
    }
    return 0;
}

static int write_files(const struct orl_run_state *state, struct view_writer *view_writer,
                       struct orl_error *err)
{
    orl_parallel_for(state->env->pool, view_writer->count, write_file, view_writer);
    for (size_t i = 0; i < view_writer->count; i++)
        if (view_writer->files[i].code < 0) {
            if (err)
                *err = view_writer->files[i].err;
            return view_writer->files[i].code;
        }
    return 0;
}

/* Makes the scale of false colours, and evaluates the named points. */
static int make_color_scale(const struct orl_view_request *request, struct view_writer *view_writer,
                            struct orl_view_result *result, struct orl_error *err)
{
    const struct orl_false_color *colors = &request->false_color;
    view_writer->colors = colors;
    if (!colors->asked)
        return 0;
    result->points = calloc(colors->n_points + 1, sizeof *result->points);
    if (!result->points ||
        orl_scale_make(&view_writer->scale, view_writer->film, colors, request->irradiance) < 0)
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory for false colours");
    result->scale = view_writer->scale.top;
    for (; result->n_points < colors->n_points; result->n_points++) {
        const struct orl_picture_point *point = &colors->points[result->n_points];
        struct orl_point_value *value = &result->points[result->n_points];
        memcpy(value->name, point->name, sizeof value->name);
        value->value =
            orl_false_color_at(view_writer->film, &view_writer->scale, point->x, point->y);
    }
    return 0;
}

static int write_all(const struct orl_run_state *state, const struct orl_view_request *request,
                     struct orl_view_result *result, struct view_writer *view_writer,
                     struct orl_error *err)
{
    const uint32_t pictures = pictures_of(request, view_writer->film);
    int code = orl_view_parse(request->view, &view_writer->view, err);
    if (code == 0)
        code = name_files(state, pictures, result, view_writer, err);
    if (code == 0)
        code = make_color_scale(request, view_writer, result, err);
    if (code == 0 && (pictures & tone_mapped) &&
        orl_tonemapped_init(&view_writer->tonemapped, view_writer->film, &view_writer->view,
                            &request->display) < 0)
        code = orl_error_set(err, ORL_ERR_NOMEM, "out of memory for a picture");
    if (code == 0)
        code = write_files(state, view_writer, err);
    orl_tonemapped_done(&view_writer->tonemapped);
    return code;
}

static bool is_black(const struct orl_film *film)
{
    const size_t count = (size_t)film->width * film->height;
    for (size_t i = 0; i < count; i++)
        if (film->pixels[i][0] != 0 || film->pixels[i][1] != 0 || film->pixels[i][2] != 0)
            return false;
    return true;
}

int orl_run_write_view(struct orl_run_state *state, size_t index, const struct orl_film *film,
                       struct orl_error *err)
{
    const struct orl_view_request *request = &state->job->views[index];
    struct orl_view_result *result = &state->result->views[index];
    struct view_writer *view_writer = calloc(1, sizeof *view_writer);
    orl_view_result_done(result); /* from an earlier round */
    result->name = strdup(request->name);
    if (!result->name || !view_writer) {
        free(view_writer);
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
    }
    view_writer->film = film;
    result->black = is_black(film);
    int code = orl_run_evaluate_glare(state, index, film, err);
    if (code == 0)
        code = write_all(state, request, result, view_writer, err);
    if (code == 0 && result->files[ORL_PICTURE_EXR] && orl_exr_exceeds_halves(film))
        orl_run_warn_once(state,
                          "%s: radiances above %d W/sr/m2, the maximum of half floats, are stored "
                          "as this maximum; \"exr_float\" stores them exactly",
                          result->files[ORL_PICTURE_EXR], ORL_EXR_LARGEST_HALF);
    free(view_writer);
    return code;
}
