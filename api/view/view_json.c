#include "view/view_json.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <oriel/base/limits.h>

#include "view/glare_json.h"
#include "view/picture_json.h"

enum { VIEW_TEXT_MAX = 4096, VIEW_NAME_MAX = 128, VIEW_FILE_MAX = 1024, ENTRY_MAX = 63 };

/* Decodes a number from 1, or a name; the result is text either way. */
static int decode_entry(const json_t *value, const char *path, void *into, struct orl_error *err)
{
    char **entry = into, text[24];
    uint64_t number = 0;
    if (json_is_string(value))
        return orl_json_string(value, path, ENTRY_MAX, entry, err);
    const int rc = orl_json_whole(value, path, 1, 1000000, &number, err);
    if (rc)
        return rc;
    snprintf(text, sizeof text, "%u", (unsigned)number);
    *entry = strdup(text);
    return *entry ? 0 : orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
}

/* Fails if there is an entry without a file. */
static int check_source(const char *path, const struct orl_view_request *view,
                        struct orl_error *err)
{
    char at[ORL_JSON_PATH_MAX];
    if (view->entry && !view->file)
        return orl_json_fail(err, ORL_ERR_INVALID, orl_json_path(path, "entry", at),
                             "it goes with a \"file\"");
    return 0;
}

/* Reads the size from the view options, if they have one. Wrong options are reported by
 * orl_job_validate. */
static void find_size(const json_t *options, struct orl_view_request *view)
{
    struct orl_error unsound;
    if (json_string_length(options) <= VIEW_TEXT_MAX && json_is_string(options))
        orl_view_text_size(json_string_value(options), &view->width, &view->height, &unsound);
}

int orl_view_from_json(const json_t *value, const char *path, void *into, struct orl_error *err)
{
    struct orl_view_request *view = into;
    find_size(json_object_get(value, "view"), view);
    const bool elsewhere = json_object_get(value, "file") || json_object_get(value, "entry");
    const struct orl_json_member members[] = {
        {"name", .text = &view->name, .longest = VIEW_NAME_MAX, .required = true},
        {"view", .text = &view->view, .longest = VIEW_TEXT_MAX, .required = !elsewhere},
        {"file", .text = &view->file, .longest = VIEW_FILE_MAX},
        {"entry", .decode = decode_entry, .into = &view->entry},
        {"width", .whole_32 = &view->width, .from = 1, .to = ORL_LIMIT_IMAGE_SIDE,
         .required = view->width == 0},
        {"height", .whole_32 = &view->height, .from = 1, .to = ORL_LIMIT_IMAGE_SIDE,
         .required = view->height == 0},
        {"pixel_aspect", .real = &view->pixel_aspect, .least = 0.001, .most = 1000},
        {"formats", .decode = orl_formats_from_json, .into = &view->formats},
        {"display", .decode = orl_display_from_json, .into = &view->display},
        {"irradiance", .flag = &view->irradiance},
        {"false_color", .decode = orl_false_color_from_json, .into = view},
        {"metrics", .decode = orl_glare_metrics_from_json, .into = &view->metrics},
        {"glare", .decode = orl_glare_settings_from_json, .into = &view->glare},
        {0}};
    const int rc = orl_json_members(value, path, members, err);
    return rc ? rc : check_source(path, view, err);
}
