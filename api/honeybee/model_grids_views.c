#include "honeybee/model_objects.h"

#include <stdlib.h>
#include <string.h>

enum { NAME_SIZE = 256 };

/* Reads "GROUP/IDENTIFIER", or the identifier alone; groups may be nested. */
static int read_name(struct orl_hb *hb, const json_t *asset, const struct orl_hb_at *at,
                     char ret_name[NAME_SIZE])
{
    const struct orl_hb_at named = {at, "identifier", 0}, grouped = {at, "group_identifier", 0};
    const json_t *group = orl_hb_get(asset, "group_identifier");
    const char *text, *identifier;
    size_t length = 0;
    int rc = orl_hb_identifier(hb, json_object_get(asset, "identifier"), &named, &identifier);
    if (rc)
        return rc;
    if (group && !json_is_string(group))
        return orl_hb_fail(&grouped, hb->err, ORL_ERR_INVALID, "a name is expected here");
    text = group ? json_string_value(group) : "";
    while (*text && rc == 0) {
        const size_t n = strcspn(text, "/\\");
        json_t *part = json_stringn(text, n);
        const char *checked;
        rc = orl_hb_identifier(hb, part, &grouped, &checked);
        json_decref(part);
        if (rc == 0 && length + n + 2 + strlen(identifier) >= NAME_SIZE)
            rc = orl_hb_fail(&grouped, hb->err, ORL_ERR_LIMIT, "the name is too long");
        if (rc == 0)
            length +=
                (size_t)snprintf(ret_name + length, NAME_SIZE - length, "%.*s/", (int)n, text);
        text += n + (text[n] != '\0');
    }
    snprintf(ret_name + length, NAME_SIZE - length, "%s", identifier);
    return rc;
}

/* ---- Grids ----------------------------------------------------------------------------------- */

struct grid {
    char name[NAME_SIZE];
    size_t index; /* index in the document */
};

static int compare_grids(const void *a, const void *b)
{
    const struct grid *x = a, *y = b;
    const int order = strcmp(x->name, y->name);
    return order ? order : x->index < y->index ? -1 : 1;
}

static int put_sensor(struct orl_hb *hb, struct orl_vec3 p, struct orl_vec3 d,
                      const struct orl_hb_at *at, FILE *stream)
{
    if (!(orl_length(d) > 1e-100))
        return orl_hb_fail(at, hb->err, ORL_ERR_RANGE, "the direction has no length");
    fprintf(stream, "%.17g %.17g %.17g %.17g %.17g %.17g\n", p.x, p.y, p.z, d.x, d.y, d.z);
    return 0;
}

static int put_sensors(struct orl_hb *hb, const json_t *sensors, const struct orl_hb_at *at,
                       struct orl_hb_file *file)
{
    const struct orl_hb_at list = {at, "sensors", 0};
    int rc = 0;
    for (size_t i = 0; i < json_array_size(sensors) && rc == 0; i++) {
        const struct orl_hb_at here = {&list, NULL, i}, in_pos = {&here, "pos", 0},
                               in_dir = {&here, "dir", 0};
        const json_t *sensor = json_array_get(sensors, i);
        struct orl_vec3 position, direction;
        rc = orl_hb_point(hb, json_object_get(sensor, "pos"), &in_pos, &position);
        if (rc == 0)
            rc = orl_hb_point(hb, json_object_get(sensor, "dir"), &in_dir, &direction);
        if (rc == 0)
            rc = put_sensor(hb, position, direction, &in_dir, file->stream);
        rc = rc ? rc : orl_hb_check(hb, file);
    }
    return rc;
}

/* Puts a sensor in the middle of every face. */
static int put_mesh_sensors(struct orl_hb *hb, const json_t *mesh, const struct orl_hb_at *at,
                            struct orl_hb_file *file)
{
    const struct orl_hb_at list = {at, "faces", 0};
    const json_t *faces = NULL;
    struct orl_vec3 *corners = NULL, f[4];
    size_t count = 0, n = 0;
    int rc = orl_hb_mesh_corners(hb, mesh, at, &corners, &count);
    if (rc == 0)
        rc = orl_hb_array(hb, mesh, at, "faces", &faces);
    for (size_t i = 0; i < json_array_size(faces) && rc == 0; i++) {
        const struct orl_hb_at here = {&list, NULL, i};
        rc = orl_hb_mesh_face(hb, json_array_get(faces, i), &here, corners, count, f, &n);
        if (rc)
            break;
        struct orl_vec3 middle = orl_v3(0, 0, 0);
        for (size_t k = 0; k < n; k++)
            middle = orl_add(middle, orl_scale(f[k], 1 / (double)n));
        const struct orl_vec3 normal = n == 4 ? orl_cross(orl_sub(f[2], f[0]), orl_sub(f[3], f[1]))
                                              : orl_cross(orl_sub(f[1], f[0]), orl_sub(f[2], f[0]));
        rc = put_sensor(hb, middle, normal, &here, file->stream);
        rc = rc ? rc : orl_hb_check(hb, file);
    }
    free(corners);
    return rc;
}

static int put_grid(struct orl_hb *hb, const json_t *grid, const struct orl_hb_at *at,
                    struct orl_hb_file *file)
{
    const struct orl_hb_at in_mesh = {at, "mesh", 0};
    const json_t *sensors = NULL, *mesh = orl_hb_get(grid, "mesh");
    const int rc = orl_hb_array(hb, grid, at, "sensors", &sensors);
    if (rc)
        return rc;
    return json_array_size(sensors) == 0 && mesh ? put_mesh_sensors(hb, mesh, &in_mesh, file)
                                                 : put_sensors(hb, sensors, at, file);
}

/* Writes all grids with the name of grid *from as one file, and moves *from past them. */
static int write_grid(struct orl_hb *hb, const json_t *list, const struct grid *grids, size_t n,
                      const struct orl_hb_at *at, size_t *from)
{
    const size_t first = *from;
    struct orl_hb_file file;
    int rc = orl_hb_begin(hb, &file);
    if (rc)
        return rc;
    for (; *from < n && strcmp(grids[*from].name, grids[first].name) == 0 && rc == 0; ++*from) {
        const struct orl_hb_at here = {at, NULL, grids[*from].index};
        rc = put_grid(hb, json_array_get(list, grids[*from].index), &here, &file);
    }
    if (rc) {
        orl_hb_discard(&file);
        return rc;
    }
    if (*from - first > 1)
        orl_hb_warn(hb,
                    "grid '%.100s': %zu sensor grids of the model have this identifier; their "
                    "sensors are joined into one grid, in the order of the model",
                    grids[first].name, *from - first);
    return orl_hb_end(hb, &file, "model/grid/%s.pts", grids[first].name);
}

int orl_hb_grids_write(struct orl_hb *hb)
{
    const struct orl_hb_at properties = {NULL, "properties", 0},
                           radiance = {&properties, "radiance", 0},
                           at = {&radiance, "sensor_grids", 0};
    const json_t *list = NULL;
    int rc = orl_hb_array(hb, orl_hb_radiance(hb->model), &radiance, "sensor_grids", &list);
    const size_t n = json_array_size(list);
    struct grid *grids = calloc(n + 1, sizeof *grids);
    if (!grids)
        return rc ? rc : orl_error_no_memory(hb->err);
    for (size_t i = 0; i < n && rc == 0; i++) {
        const struct orl_hb_at here = {&at, NULL, i};
        grids[i].index = i;
        rc = read_name(hb, json_array_get(list, i), &here, grids[i].name);
    }
    if (rc == 0)
        qsort(grids, n, sizeof *grids, compare_grids);
    for (size_t i = 0; i < n && rc == 0;)
        rc = write_grid(hb, list, grids, n, &at, &i);
    free(grids);
    return rc;
}

/* ---- Views ----------------------------------------------------------------------------------- */

static int put_vector(struct orl_hb *hb, const json_t *view, const char *member,
                      const struct orl_hb_at *at, const char *option, FILE *stream)
{
    const struct orl_hb_at here = {at, member, 0};
    struct orl_vec3 v;
    const int rc = orl_hb_point(hb, json_object_get(view, member), &here, &v);
    if (rc == 0)
        fprintf(stream, " %s %.17g %.17g %.17g", option, v.x, v.y, v.z);
    return rc;
}

static int put_view(struct orl_hb *hb, const json_t *view, const struct orl_hb_at *at, FILE *stream)
{
    static const struct {
        const char *member, *option, *otherwise;
    } sizes[] = {{"h_size", "-vh", "60"}, {"v_size", "-vv", "60"},    {"shift", "-vs", NULL},
                 {"lift", "-vl", NULL},   {"fore_clip", "-vo", NULL}, {"aft_clip", "-va", NULL}};
    const struct orl_hb_at in_type = {at, "view_type", 0};
    const json_t *type = orl_hb_get(view, "view_type");
    const char *letter = type ? json_string_value(type) : "v";
    if (!letter || strlen(letter) != 1 || !strchr("vhlcas", *letter))
        return orl_hb_fail(&in_type, hb->err, ORL_ERR_INVALID,
                           "one of v, h, l, c, a and s is expected here");
    fprintf(stream, "rvu -vt%s", letter);
    int rc = put_vector(hb, view, "position", at, "-vp", stream);
    if (rc == 0)
        rc = put_vector(hb, view, "direction", at, "-vd", stream);
    if (rc == 0)
        rc = put_vector(hb, view, "up_vector", at, "-vu", stream);
    for (size_t i = 0; i < sizeof sizes / sizeof *sizes && rc == 0; i++) {
        const struct orl_hb_at here = {at, sizes[i].member, 0};
        const json_t *value = orl_hb_get(view, sizes[i].member);
        double number;
        rc = value ? orl_hb_number(hb, value, &here, &number) : 0;
        if (rc == 0 && value)
            fprintf(stream, " %s %.17g", sizes[i].option, number);
        else if (rc == 0 && sizes[i].otherwise)
            fprintf(stream, " %s %s", sizes[i].option, sizes[i].otherwise);
    }
    fputc('\n', stream);
    return rc;
}

/* Maps each name to the index of the last view with that name. */
static int list_names(struct orl_hb *hb, const json_t *views, const struct orl_hb_at *list,
                      json_t *ret_last)
{
    int rc = ret_last ? 0 : orl_error_no_memory(hb->err);
    for (size_t i = 0; i < json_array_size(views) && rc == 0; i++) {
        const struct orl_hb_at here = {list, NULL, i};
        char name[NAME_SIZE];
        rc = read_name(hb, json_array_get(views, i), &here, name);
        if (rc == 0 && json_object_set_new(ret_last, name, json_integer((json_int_t)i)))
            rc = orl_error_no_memory(hb->err);
    }
    return rc;
}

static int write_view(struct orl_hb *hb, const json_t *view, const struct orl_hb_at *at,
                      const char *name)
{
    struct orl_hb_file file;
    int rc = orl_hb_begin(hb, &file);
    if (rc)
        return rc;
    rc = put_view(hb, view, at, file.stream);
    if (rc == 0)
        return orl_hb_end(hb, &file, "model/view/%s.vf", name);
    orl_hb_discard(&file);
    return rc;
}

int orl_hb_views_write(struct orl_hb *hb)
{
    const struct orl_hb_at properties = {NULL, "properties", 0},
                           radiance = {&properties, "radiance", 0}, list = {&radiance, "views", 0};
    const json_t *views = NULL;
    json_t *last = json_object();
    int rc = orl_hb_array(hb, orl_hb_radiance(hb->model), &radiance, "views", &views);
    if (rc == 0)
        rc = list_names(hb, views, &list, last);
    for (size_t i = 0; i < json_array_size(views) && rc == 0; i++) {
        const struct orl_hb_at here = {&list, NULL, i};
        char name[NAME_SIZE];
        rc = read_name(hb, json_array_get(views, i), &here, name);
        if (rc == 0 && (size_t)json_integer_value(json_object_get(last, name)) != i)
            orl_hb_warn(hb,
                        "view '%.100s': several views of the model have this identifier; the last "
                        "one is used",
                        name);
        else if (rc == 0)
            rc = write_view(hb, json_array_get(views, i), &here, name);
    }
    json_decref(last);
    return rc;
}
