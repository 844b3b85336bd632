#include "view/view_json.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <oriel/base/limits.h>
#include <oriel/base/suggest.h>

#include "schemas.h"
#include "json/encode.h"

/* Lists the formats, and suggests one for the given name (NULL: it is no text). */
static void hint_format(const char *given, struct orl_error *err)
{
    static const char *const known[] = {"hdr", "png", "png16", "exr", "exr_float"};
    struct orl_suggestion suggestion = {.word = given ? given : ""};
    for (size_t k = 0; k < sizeof known / sizeof *known; k++)
        orl_suggestion_add(&suggestion, known[k]);
    orl_error_hint(err, "Formats are \"hdr\", \"png\", \"png16\", \"exr\" and \"exr_float\"");
    orl_suggestion_hint(&suggestion, err);
}

/* Decodes formats; sets bits of a uint32_t. */
static int decode_formats(const json_t *value, const char *path, void *ret_formats,
                          struct orl_error *err)
{
    uint32_t formats = 0;
    const json_t *name;
    size_t i;
    const int rc = orl_json_array_of(value, path, &orl_schema_view_formats, err);
    if (rc)
        return rc;
    json_array_foreach(value, i, name)
    {
        enum orl_picture picture;
        if (!json_is_string(name) || !orl_picture_format(json_string_value(name), &picture)) {
            orl_json_fail(err, ORL_ERR_INVALID, path, "element %zu is not a known format", i);
            hint_format(json_string_value(name), err);
            return ORL_ERR_INVALID;
        }
        formats |= ORL_PICTURE_BIT(picture);
    }
    *(uint32_t *)ret_formats = formats;
    return 0;
}

/* ---- Displays -------------------------------------------------------------------------------- */

/* Fails if options of the human observer are given without that tone mapper. */
static int check_human(const char *path, const struct orl_display *display, struct orl_error *err)
{
    char at[ORL_JSON_PATH_MAX];
    const char *given = display->veil         ? "veil"
                        : display->acuity     ? "acuity"
                        : display->color_loss ? "color_loss"
                                              : NULL;
    if (!given || display->tone == ORL_TONE_HUMAN)
        return 0;
    return orl_json_fail(err, ORL_ERR_INVALID, orl_json_path(path, given, at),
                         "it requires the tone \"human\"");
}

/* Decodes into a struct orl_display of zeros. */
static int decode_display(const json_t *value, const char *path, void *into, struct orl_error *err)
{
    struct orl_display *display = into;
    double stops = 0;
    const struct orl_json_member members[] = {{"tone", .word = &display->tone},
                                              {"exposure", .real = &display->exposure},
                                              {"ev", .real = &stops},
                                              {"veil", .flag = &display->veil},
                                              {"acuity", .flag = &display->acuity},
                                              {"color_loss", .flag = &display->color_loss},
                                              {0}};
    const int rc = orl_json_members(value, path, &orl_schema_display, members, err);
    if (rc)
        return rc;
    const bool exposure = json_object_get(value, "exposure"), ev = json_object_get(value, "ev");
    if (!!json_object_get(value, "tone") + exposure + ev > 1)
        return orl_json_fail(err, ORL_ERR_INVALID, path,
                             "one of \"tone\", \"exposure\" and \"ev\" is expected here");
    if (exposure || ev)
        display->tone = ORL_TONE_EXPOSURE;
    if (ev)
        display->exposure = orl_exposure_of_ev(stops);
    return check_human(path, display, err);
}

/* ---- False colours --------------------------------------------------------------------------- */

int orl_label_from_json(const json_t *value, const char *path, void *ret_label,
                        struct orl_error *err)
{
    char *text = NULL;
    int rc = orl_json_text_of(value, path, &orl_schema_picture_label, &text, err);
    for (const char *c = text; rc == 0 && *c; c++)
        if (*c < ' ' || *c > '~')
            rc = orl_json_fail(err, ORL_ERR_INVALID, path,
                               "it can only have printable ASCII characters");
    if (rc == 0)
        memcpy(ret_label, text, strlen(text) + 1);
    free(text);
    return rc;
}

int orl_scale_from_json(const json_t *value, const char *path, void *ret_scale,
                        struct orl_error *err)
{
    const struct orl_json_member number = {.real = ret_scale};
    if (json_is_string(value) && strcmp(json_string_value(value), "auto") == 0)
        return 0;
    return orl_json_value(value, path, &orl_schema_scale, &number, err);
}

int orl_palette_from_json(const json_t *value, const char *path, void *ret_palette,
                          struct orl_error *err)
{
    return orl_json_word(value, path, orl_schema_palette.words, ret_palette, err);
}

static int decode_point(const json_t *value, const char *path, void *into, struct orl_error *err)
{
    struct orl_view_request *view = into;
    struct orl_picture_point *point = &view->false_color.points[view->false_color.n_points];
    char at[ORL_JSON_PATH_MAX];
    const struct orl_json_member members[] = {
        {"name", .decode = orl_label_from_json, .into = point->name},
        {"x", .real = &point->x},
        {"y", .real = &point->y},
        {0}};
    int rc = orl_json_members(value, path, &orl_schema_picture_point, members, err);
    const char *outside = point->x > view->width ? "x" : point->y > view->height ? "y" : NULL;
    if (rc == 0 && outside)
        rc = orl_json_fail(err, ORL_ERR_RANGE, orl_json_path(path, outside, at),
                           "the point lies outside the picture of %u by %u pixels", view->width,
                           view->height);
    view->false_color.n_points += rc == 0;
    return rc;
}

/* Decodes points, which must lie in the picture; its size is already decoded. */
static int decode_points(const json_t *value, const char *path, void *into, struct orl_error *err)
{
    struct orl_view_request *view = into;
    const int rc = orl_json_array_of(value, path, &orl_schema_false_color_points, err);
    if (rc)
        return rc;
    view->false_color.points = calloc(json_array_size(value) + 1, sizeof(struct orl_picture_point));
    if (!view->false_color.points)
        return orl_error_no_memory(err);
    return orl_json_each(value, path, &orl_schema_false_color_points, decode_point, view, err);
}

static int decode_drawn(const json_t *value, const char *path, void *into, struct orl_error *err)
{
    uint32_t *pictures = into;
    int rc = orl_json_array_of(value, path, &orl_schema_false_color_draw, err);
    for (size_t i = 0; rc == 0 && i < json_array_size(value); i++) {
        unsigned which = 0;
        rc = orl_json_word(json_array_get(value, i), path, orl_schema_false_color_draw.items->words,
                           &which, err);
        *pictures |= ORL_PICTURE_BIT(ORL_PICTURE_FALSE + which);
    }
    return rc;
}

/* Decodes into a struct orl_view_request that has its size. The request owns the points, also after
 * a failure. */
static int decode_false_color(const json_t *value, const char *path, void *into,
                              struct orl_error *err)
{
    struct orl_view_request *view = into;
    struct orl_false_color *colors = &view->false_color;
    const struct orl_json_member members[] = {
        {"scale", .decode = orl_scale_from_json, .into = &colors->scale},
        {"decades", .real = &colors->decades},
        {"divisions", .whole_32 = &colors->divisions},
        {"palette", .decode = orl_palette_from_json, .into = &colors->palette},
        {"label", .decode = orl_label_from_json, .into = colors->label},
        {"isolines", .flag = &colors->isolines},
        {"extrema", .flag = &colors->extrema},
        {"draw", .decode = decode_drawn, .into = &colors->pictures},
        {"multiplier", .real = &colors->multiplier},
        {"points", .decode = decode_points, .into = view},
        {0}};
    colors->asked = true;
    return orl_json_members(value, path, &orl_schema_false_color, members, err);
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

/* Decodes a number from 1, or a name; the result is text either way. */
static int decode_entry(const json_t *value, const char *path, void *into, struct orl_error *err)
{
    char **entry = into, text[24];
    uint64_t number = 0;
    if (json_is_string(value))
        return orl_json_text_of(value, path, &orl_schema_view_entry, entry, err);
    const int rc = orl_json_whole(value, path, orl_schema_view_entry.from, orl_schema_view_entry.to,
                                  &number, err);
    if (rc)
        return rc;
    snprintf(text, sizeof text, "%u", (unsigned)number);
    *entry = strdup(text);
    return *entry ? 0 : orl_error_no_memory(err);
}

/* Fails if there is an entry without a file. */
static int check_source(const char *path, const struct orl_view_request *view,
                        struct orl_error *err)
{
    char at[ORL_JSON_PATH_MAX];
    if (view->entry && !view->file)
        return orl_json_fail(err, ORL_ERR_INVALID, orl_json_path(path, "entry", at),
                             "it requires a \"file\"");
    return 0;
}

/* Reads the size from the view options, if they have one. Wrong options are reported by
 * orl_job_validate. */
static void find_size(const json_t *options, struct orl_view_request *view)
{
    struct orl_error unsound;
    if (json_string_length(options) <= orl_schema_view_view.longest && json_is_string(options))
        orl_view_text_size(json_string_value(options), &view->width, &view->height, &unsound);
}

int orl_view_from_json(const json_t *value, const char *path, void *into, struct orl_error *err)
{
    struct orl_view_request *view = into;
    find_size(json_object_get(value, "view"), view);
    const bool elsewhere = json_object_get(value, "file") || json_object_get(value, "entry");
    const struct orl_json_member members[] = {
        {"name", .text = &view->name},
        {"view", .text = &view->view, .required = !elsewhere},
        {"file", .text = &view->file},
        {"entry", .decode = decode_entry, .into = &view->entry},
        {"width", .whole_32 = &view->width, .required = view->width == 0},
        {"height", .whole_32 = &view->height, .required = view->height == 0},
        {"pixel_aspect", .real = &view->pixel_aspect},
        {"formats", .decode = decode_formats, .into = &view->formats},
        {"display", .decode = decode_display, .into = &view->display},
        {"irradiance", .flag = &view->irradiance},
        {"false_color", .decode = decode_false_color, .into = view},
        {"metrics", .decode = orl_glare_metrics_from_json, .into = &view->metrics},
        {"glare", .decode = orl_glare_settings_from_json, .into = &view->glare},
        {0}};
    const int rc = orl_json_members(value, path, &orl_schema_view, members, err);
    return rc ? rc : check_source(path, view, err);
}
