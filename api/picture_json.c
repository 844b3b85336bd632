#include "picture_json.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <oriel/limits.h>

#include "decode.h"
#include "encode.h"

/* "a" of "views[0]": views[0].a */
static const char *path_of(const char *path, const char *member, char ret_path[ORL_JSON_PATH_MAX])
{
    snprintf(ret_path, ORL_JSON_PATH_MAX, "%.120s.%s", path, member);
    return ret_path;
}

static int decode_formats(const json_t *value, const char *path, uint32_t *ret_formats,
                          struct orl_error *err)
{
    uint32_t formats = 0;
    const json_t *name;
    size_t i;
    if (!value)
        return 0;
    const int rc = orl_json_array(value, path, ORL_PICTURES, err);
    if (rc)
        return rc;
    json_array_foreach(value, i, name)
    {
        enum orl_picture picture;
        if (!json_is_string(name) || !orl_picture_format(json_string_value(name), &picture)) {
            orl_json_fail(err, ORL_ERR_INVALID, path, "element %zu is no format that is known", i);
            orl_error_hint(err, "Formats are \"hdr\", \"png\", \"png16\", \"exr\" and "
                                "\"exr_float\"");
            return ORL_ERR_INVALID;
        }
        formats |= ORL_PICTURE_BIT(picture);
    }
    if (formats == 0)
        return orl_json_fail(err, ORL_ERR_INVALID, path, "no format is named");
    *ret_formats = formats;
    return 0;
}

/* One of so many words. */
static int decode_word(const json_t *value, const char *path, const char *const *words,
                       size_t count, size_t *ret_index, struct orl_error *err)
{
    char list[160] = "";
    for (size_t i = 0; i < count; i++) {
        if (json_is_string(value) && strcmp(json_string_value(value), words[i]) == 0) {
            *ret_index = i;
            return 0;
        }
        const size_t length = strlen(list);
        snprintf(list + length, sizeof list - length, "%s\"%s\"", i ? ", " : "", words[i]);
    }
    return orl_json_fail(err, ORL_ERR_INVALID, path, "one of %s is wanted here", list);
}

/* A number within bounds. */
static int decode_within(const json_t *value, const char *path, double low, double high,
                         double *ret_value, struct orl_error *err)
{
    double number = 0;
    int rc = orl_json_real(value, path, &number, err);
    if (rc == 0 && !(number >= low && number <= high))
        rc = orl_json_fail(err, ORL_ERR_RANGE, path, "it is from %g to %g", low, high);
    if (rc == 0)
        *ret_value = number;
    return rc;
}

static int decode_exposure(const json_t *value, const char *path, struct orl_display *display,
                           struct orl_error *err)
{
    char at[ORL_JSON_PATH_MAX];
    const json_t *factor = json_object_get(value, "exposure"), *ev = json_object_get(value, "ev");
    if (!factor && !ev)
        return 0;
    if ((factor && ev) || json_object_get(value, "tone"))
        return orl_json_fail(err, ORL_ERR_INVALID, path,
                             "one of \"tone\", \"exposure\" and \"ev\" is wanted here");
    display->tone = ORL_TONE_EXPOSURE;
    if (factor)
        return decode_within(factor, path_of(path, "exposure", at), 1e-9, 1e9, &display->exposure,
                             err);
    double stops = 0;
    const int rc = decode_within(ev, path_of(path, "ev", at), -20, 30, &stops, err);
    display->exposure = orl_exposure_of_ev(stops);
    return rc;
}

static int decode_display(const json_t *value, const char *path, struct orl_display *display,
                          struct orl_error *err)
{
    static const char *const allowed[] = {"tone",   "exposure",   "ev", "veil",
                                          "acuity", "color_loss", NULL};
    static const char *const tones[] = {"human", "linear"};
    char at[ORL_JSON_PATH_MAX];
    if (!value)
        return 0;
    size_t tone = 0;
    int rc = orl_json_object(value, path, allowed, err);
    if (rc == 0 && json_object_get(value, "tone"))
        rc = decode_word(json_object_get(value, "tone"), path_of(path, "tone", at), tones, 2, &tone,
                         err);
    display->tone = tone == 0 ? ORL_TONE_HUMAN : ORL_TONE_LINEAR;
    if (rc == 0)
        rc = decode_exposure(value, path, display, err);
    bool *const flags[] = {&display->veil, &display->acuity, &display->color_loss};
    for (size_t i = 0; i < 3 && rc == 0; i++) {
        const json_t *flag = json_object_get(value, allowed[3 + i]);
        if (!flag)
            continue;
        rc = orl_json_bool(flag, path_of(path, allowed[3 + i], at), flags[i], err);
        if (rc == 0 && *flags[i] && display->tone != ORL_TONE_HUMAN)
            rc = orl_json_fail(err, ORL_ERR_INVALID, at, "it belongs to the tone \"human\"");
    }
    return rc;
}

/* A word that is drawn: of what fonts have. */
static int decode_label(const json_t *value, const char *path,
                        char ret_label[ORL_PICTURE_LABEL_MAX], struct orl_error *err)
{
    char *text = NULL;
    int rc = orl_json_string(value, path, ORL_PICTURE_LABEL_MAX - 1, &text, err);
    for (const char *c = text; rc == 0 && *c; c++)
        if (*c < ' ' || *c > '~')
            rc = orl_json_fail(err, ORL_ERR_INVALID, path,
                               "it is of letters, digits and signs of ASCII");
    if (rc == 0)
        memcpy(ret_label, text, strlen(text) + 1);
    free(text);
    return rc;
}

static int decode_point(const json_t *value, const char *path,
                        const struct orl_view_request *request, struct orl_picture_point *point,
                        struct orl_error *err)
{
    static const char *const allowed[] = {"name", "x", "y", NULL};
    char at[ORL_JSON_PATH_MAX];
    int rc = orl_json_object(value, path, allowed, err);
    if (rc == 0)
        rc = decode_label(json_object_get(value, "name"), path_of(path, "name", at), point->name,
                          err);
    if (rc == 0)
        rc = decode_within(json_object_get(value, "x"), path_of(path, "x", at), 0, request->width,
                           &point->x, err);
    if (rc == 0)
        rc = decode_within(json_object_get(value, "y"), path_of(path, "y", at), 0, request->height,
                           &point->y, err);
    return rc;
}

static int decode_points(const json_t *value, const char *path, struct orl_view_request *request,
                         struct orl_error *err)
{
    struct orl_false_color *colors = &request->false_color;
    char at[ORL_JSON_PATH_MAX];
    if (!value)
        return 0;
    int rc = orl_json_array(value, path, ORL_LIMIT_PICTURE_POINTS, err);
    if (rc)
        return rc;
    const size_t count = json_array_size(value);
    colors->points = calloc(count + 1, sizeof *colors->points);
    if (!colors->points)
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
    for (size_t i = 0; i < count && rc == 0; i++) {
        snprintf(at, sizeof at, "%.120s[%zu]", path, i);
        rc = decode_point(json_array_get(value, i), at, request, &colors->points[i], err);
        colors->n_points += rc == 0;
    }
    return rc;
}

static int decode_drawn(const json_t *value, const char *path, uint32_t *ret_pictures,
                        struct orl_error *err)
{
    static const char *const drawn[] = {"fill", "lines", "bands"};
    const json_t *word;
    size_t i;
    if (!value)
        return 0;
    int rc = orl_json_array(value, path, 3, err);
    json_array_foreach(value, i, word)
    {
        size_t which = 0;
        rc = rc ? rc : decode_word(word, path, drawn, 3, &which, err);
        *ret_pictures |= ORL_PICTURE_BIT(ORL_PICTURE_FALSE + which);
    }
    return rc;
}

/* The scale: a number, or "auto". */
static int decode_scale(const json_t *value, const char *path, double *ret_scale,
                        struct orl_error *err)
{
    if (json_is_string(value) && strcmp(json_string_value(value), "auto") == 0)
        return 0;
    return value ? decode_within(value, path, 1e-9, 1e12, ret_scale, err) : 0;
}

static int decode_numbers(const json_t *value, const char *path, struct orl_false_color *colors,
                          struct orl_error *err)
{
    char at[ORL_JSON_PATH_MAX];
    const json_t *decades = json_object_get(value, "decades");
    const json_t *divisions = json_object_get(value, "divisions");
    const json_t *multiplier = json_object_get(value, "multiplier");
    uint64_t count = 0;
    int rc = decode_scale(json_object_get(value, "scale"), path_of(path, "scale", at),
                          &colors->scale, err);
    if (rc == 0 && decades)
        rc = decode_within(decades, path_of(path, "decades", at), 0, 12, &colors->decades, err);
    if (rc == 0 && multiplier)
        rc = decode_within(multiplier, path_of(path, "multiplier", at), 1e-9, 1e9,
                           &colors->multiplier, err);
    if (rc == 0 && divisions)
        rc = orl_json_whole(divisions, path_of(path, "divisions", at), 2, ORL_LIMIT_DIVISIONS,
                            &count, err);
    colors->divisions = (uint32_t)count;
    return rc;
}

static int decode_palette(const json_t *value, const char *path, enum orl_palette *ret_palette,
                          struct orl_error *err)
{
    const char *palettes[ORL_PALETTES];
    size_t palette = *ret_palette;
    for (int i = 0; i < ORL_PALETTES; i++)
        palettes[i] = orl_palette_name((enum orl_palette)i);
    const int rc = value ? decode_word(value, path, palettes, ORL_PALETTES, &palette, err) : 0;
    *ret_palette = (enum orl_palette)palette;
    return rc;
}

static int decode_false_color(const json_t *value, const char *path,
                              struct orl_view_request *request, struct orl_error *err)
{
    static const char *const allowed[] = {"scale",      "decades",  "divisions", "palette",
                                          "label",      "isolines", "extrema",   "draw",
                                          "multiplier", "points",   NULL};
    struct orl_false_color *colors = &request->false_color;
    char at[ORL_JSON_PATH_MAX];
    if (!value)
        return 0;
    int rc = orl_json_object(value, path, allowed, err);
    colors->asked = true;
    if (rc == 0)
        rc = decode_numbers(value, path, colors, err);
    if (rc == 0)
        rc = decode_palette(json_object_get(value, "palette"), path_of(path, "palette", at),
                            &colors->palette, err);
    if (rc == 0 && json_object_get(value, "label"))
        rc = decode_label(json_object_get(value, "label"), path_of(path, "label", at),
                          colors->label, err);
    bool *const flags[] = {&colors->isolines, &colors->extrema};
    for (size_t i = 0; i < 2 && rc == 0; i++)
        if (json_object_get(value, allowed[5 + i]))
            rc = orl_json_bool(json_object_get(value, allowed[5 + i]),
                               path_of(path, allowed[5 + i], at), flags[i], err);
    if (rc == 0)
        rc = decode_drawn(json_object_get(value, "draw"), path_of(path, "draw", at),
                          &colors->pictures, err);
    return rc ? rc
              : decode_points(json_object_get(value, "points"), path_of(path, "points", at),
                              request, err);
}

/* ---- Heat maps ------------------------------------------------------------------------------- */

static int decode_thresholds(const json_t *value, struct orl_heat_map_request *request,
                             struct orl_error *err)
{
    const json_t *number;
    size_t i;
    if (!value)
        return 0;
    int rc = orl_json_array(value, "heat_map.thresholds", ORL_HEAT_MAP_THRESHOLDS, err);
    json_array_foreach(value, i, number)
    {
        char at[ORL_JSON_PATH_MAX];
        snprintf(at, sizeof at, "heat_map.thresholds[%zu]", i);
        if (rc == 0)
            rc = decode_within(number, at, 1e-6, 1e9, &request->thresholds_lx[i], err);
        request->n_thresholds += rc == 0;
    }
    return rc;
}

/* The scene's unit of length. */
static int decode_unit(const json_t *value, struct orl_heat_map_request *request,
                       struct orl_error *err)
{
    char label[ORL_PICTURE_LABEL_MAX];
    static const char path[] = "heat_map.length_unit";
    if (!value)
        return 0;
    int rc = decode_label(value, path, label, err);
    if (rc == 0 && strlen(label) >= ORL_LENGTH_UNIT_MAX)
        rc = orl_json_fail(err, ORL_ERR_INVALID, path, "it has at most %d letters",
                           ORL_LENGTH_UNIT_MAX - 1);
    if (rc == 0)
        memcpy(request->length_unit, label, strlen(label) + 1);
    return rc;
}

int orl_heat_map_from_json(const json_t *value, struct orl_heat_map_request *request,
                           struct orl_error *err)
{
    static const char *const allowed[] = {"scale",      "decades",     "divisions", "palette",
                                          "thresholds", "length_unit", NULL};
    if (!value)
        return 0;
    int rc = orl_json_object(value, "heat_map", allowed, err);
    request->asked = true;
    if (rc == 0)
        rc = decode_numbers(value, "heat_map", &request->colors, err);
    if (rc == 0)
        rc = decode_palette(json_object_get(value, "palette"), "heat_map.palette",
                            &request->colors.palette, err);
    if (rc == 0)
        rc = decode_thresholds(json_object_get(value, "thresholds"), request, err);
    return rc ? rc : decode_unit(json_object_get(value, "length_unit"), request, err);
}

/* ---- Views ----------------------------------------------------------------------------------- */

int orl_pictures_from_json(const json_t *view, const char *path, struct orl_view_request *request,
                           struct orl_error *err)
{
    char at[ORL_JSON_PATH_MAX];
    int rc = decode_formats(json_object_get(view, "formats"), path_of(path, "formats", at),
                            &request->formats, err);
    if (rc == 0)
        rc = decode_display(json_object_get(view, "display"), path_of(path, "display", at),
                            &request->display, err);
    if (rc == 0)
        rc = decode_false_color(json_object_get(view, "false_color"),
                                path_of(path, "false_color", at), request, err);
    return rc;
}

/* ---- Results --------------------------------------------------------------------------------- */

static int points_to_json(const struct orl_view_result *view, json_t *json)
{
    json_t *points = json_array();
    for (size_t i = 0; i < view->n_points; i++)
        if (json_array_append_new(points,
                                  json_pack("{s:s, s:o}", "name", view->points[i].name, "value",
                                            orl_json_from_real(view->points[i].value)))) {
            json_decref(points);
            return -1;
        }
    return json_object_set_new(json, "points", points);
}

int orl_pictures_to_json(const struct orl_view_result *view, json_t *json)
{
    int rc = 0;
    for (int i = 0; i < ORL_PICTURES && rc == 0; i++)
        if (view->files[i])
            rc = json_object_set_new(json, orl_picture_name((enum orl_picture)i),
                                     json_string(view->files[i]));
    if (rc == 0 && view->scale > 0)
        rc = json_object_set_new(json, "scale", json_real(view->scale));
    return rc == 0 && view->n_points > 0 ? points_to_json(view, json) : rc;
}

static bool read_points(const json_t *points, struct orl_view_result *view)
{
    const json_t *point;
    size_t i;
    view->points = calloc(json_array_size(points) + 1, sizeof *view->points);
    if (!view->points)
        return false;
    json_array_foreach(points, i, point)
    {
        const char *name = json_string_value(json_object_get(point, "name"));
        const json_t *value = json_object_get(point, "value");
        struct orl_point_value *read = &view->points[view->n_points++];
        snprintf(read->name, sizeof read->name, "%s", name ? name : "");
        read->value = json_is_number(value) ? json_number_value(value) : (double)NAN;
    }
    return true;
}

bool orl_pictures_read_back(const json_t *json, struct orl_view_result *view)
{
    const json_t *points = json_object_get(json, "points");
    for (int i = 0; i < ORL_PICTURES; i++) {
        const char *file =
            json_string_value(json_object_get(json, orl_picture_name((enum orl_picture)i)));
        view->files[i] = file ? strdup(file) : NULL;
        if (file && !view->files[i])
            return false;
    }
    view->scale = json_number_value(json_object_get(json, "scale"));
    return !points || read_points(points, view);
}

/* ---- Sensors --------------------------------------------------------------------------------- */

json_t *orl_sensor_files_to_json(const struct orl_sensor_files *files)
{
    json_t *maps = json_array();
    if (!files->csv) {
        json_decref(maps);
        return NULL;
    }
    for (size_t i = 0; i < files->n_maps; i++)
        if (json_array_append_new(maps,
                                  json_pack("{s:s, s:s, s:s*, s:I}", "png", files->maps[i].png,
                                            "svg", files->maps[i].svg, "dat", files->maps[i].dat,
                                            "sensors", (json_int_t)files->maps[i].sensors))) {
            json_decref(maps);
            return NULL;
        }
    return json_pack("{s:s, s:s, s:o}", "csv", files->csv, "res", files->res, "maps", maps);
}
