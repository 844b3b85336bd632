#include "view_json.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <oriel/limits.h>

#include "decode.h"
#include "glare_json.h"
#include "picture_json.h"

enum { VIEW_TEXT_MAX = 4096, VIEW_NAME_MAX = 128, VIEW_FILE_MAX = 1024, ENTRY_MAX = 63 };

/* Where a member is, for messages. */
struct place {
    size_t index;
    char path[ORL_JSON_PATH_MAX];
};

static const char *at(struct place *place, const char *member)
{
    snprintf(place->path, sizeof place->path, "views[%zu].%s", place->index, member);
    return place->path;
}

/* A number, from 1, or a name; as text either way. */
static int decode_entry(const json_t *value, struct place *place, char **ret_entry,
                        struct orl_error *err)
{
    uint64_t number = 0;
    char text[24];
    if (!value)
        return 0;
    if (json_is_string(value))
        return orl_json_string(value, at(place, "entry"), ENTRY_MAX, ret_entry, err);
    const int rc = orl_json_whole(value, at(place, "entry"), 1, 1000000, &number, err);
    if (rc)
        return rc;
    snprintf(text, sizeof text, "%u", (unsigned)number);
    *ret_entry = strdup(text);
    return *ret_entry ? 0 : orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
}

/* The options, or the file that has them. */
static int decode_options(const json_t *doc, struct place *place, struct orl_view_request *view,
                          struct orl_error *err)
{
    const json_t *options = json_object_get(doc, "view"), *file = json_object_get(doc, "file");
    const json_t *entry = json_object_get(doc, "entry");
    if (options && (file || entry))
        return orl_json_fail(err, ORL_ERR_INVALID, at(place, "view"),
                             "either this or a \"file\" is wanted");
    if (entry && !file)
        return orl_json_fail(err, ORL_ERR_INVALID, at(place, "entry"), "it goes with a \"file\"");
    if (!file)
        return orl_json_string(options, at(place, "view"), VIEW_TEXT_MAX, &view->view, err);
    const int rc = orl_json_string(file, at(place, "file"), VIEW_FILE_MAX, &view->file, err);
    return rc ? rc : decode_entry(entry, place, &view->entry, err);
}

static int decode_size(const json_t *doc, struct place *place, struct orl_view_request *view,
                       struct orl_error *err)
{
    static const char *const sides[] = {"width", "height"};
    uint32_t *const sizes[] = {&view->width, &view->height};
    const json_t *aspect = json_object_get(doc, "pixel_aspect");
    struct orl_error unsound;
    /* Options that are wrong are told of when the job is looked at as a whole. */
    if (view->view)
        orl_view_text_size(view->view, &view->width, &view->height, &unsound);
    int rc = 0;
    for (size_t k = 0; k < 2 && rc == 0; k++) {
        const json_t *side = json_object_get(doc, sides[k]);
        uint64_t size = 0;
        if (!side && *sizes[k] > 0)
            continue;
        rc = orl_json_whole(side, at(place, sides[k]), 1, ORL_LIMIT_IMAGE_SIDE, &size, err);
        *sizes[k] = (uint32_t)size;
    }
    if (rc == 0 && aspect)
        rc = orl_json_real(aspect, at(place, "pixel_aspect"), &view->pixel_aspect, err);
    if (rc == 0 && aspect && !(view->pixel_aspect >= 0.001 && view->pixel_aspect <= 1000))
        rc = orl_json_fail(err, ORL_ERR_RANGE, at(place, "pixel_aspect"),
                           "it is from 0.001 to 1000");
    return rc;
}

int orl_view_from_json(const json_t *doc, size_t index, struct orl_view_request *view,
                       struct orl_error *err)
{
    static const char *const allowed[] = {
        "name",    "view",    "file",       "entry",       "width",   "height", "pixel_aspect",
        "formats", "display", "irradiance", "false_color", "metrics", "glare",  NULL};
    struct place place = {.index = index};
    snprintf(place.path, sizeof place.path, "views[%zu]", index);
    int rc = orl_json_object(doc, place.path, allowed, err);
    if (rc == 0)
        rc = orl_json_string(json_object_get(doc, "name"), at(&place, "name"), VIEW_NAME_MAX,
                             &view->name, err);
    if (rc == 0)
        rc = decode_options(doc, &place, view, err);
    if (rc == 0)
        rc = decode_size(doc, &place, view, err);
    if (rc == 0 && json_object_get(doc, "irradiance"))
        rc = orl_json_bool(json_object_get(doc, "irradiance"), at(&place, "irradiance"),
                           &view->irradiance, err);
    if (rc == 0)
        rc = orl_glare_metrics_from_json(json_object_get(doc, "metrics"), at(&place, "metrics"),
                                         &view->metrics, err);
    if (rc == 0)
        rc = orl_glare_settings_from_json(json_object_get(doc, "glare"), at(&place, "glare"),
                                          &view->glare, err);
    snprintf(place.path, sizeof place.path, "views[%zu]", index);
    return rc ? rc : orl_pictures_from_json(doc, place.path, view, err);
}
