#include "job/heat_map_json.h"

#include <stdlib.h>
#include <string.h>

#include <oriel/base/limits.h>

#include "view/picture_json.h"

/* ---- Request --------------------------------------------------------------------------------- */

static int decode_threshold(const json_t *value, const char *path, void *into,
                            struct orl_error *err)
{
    struct orl_heat_map_request *request = into;
    const struct orl_json_member number = {
        .real = &request->thresholds_lx[request->n_thresholds], .least = 1e-6, .most = 1e9};
    const int rc = orl_json_value(value, path, &number, err);
    request->n_thresholds += rc == 0;
    return rc;
}

static int decode_thresholds(const json_t *value, const char *path, void *request,
                             struct orl_error *err)
{
    return orl_json_each(value, path, ORL_HEAT_MAP_THRESHOLDS, decode_threshold, request, err);
}

/* Decodes the scene's unit of length. */
static int decode_unit(const json_t *value, const char *path, void *ret_unit, struct orl_error *err)
{
    char label[ORL_PICTURE_LABEL_MAX];
    const int rc = orl_label_from_json(value, path, label, err);
    if (rc)
        return rc;
    if (strlen(label) >= ORL_LENGTH_UNIT_MAX)
        return orl_json_fail(err, ORL_ERR_INVALID, path, "it has at most %d letters",
                             ORL_LENGTH_UNIT_MAX - 1);
    memcpy(ret_unit, label, strlen(label) + 1);
    return 0;
}

int orl_heat_map_from_json(const json_t *value, const char *path, void *into, struct orl_error *err)
{
    struct orl_heat_map_request *request = into;
    struct orl_false_color *colors = &request->colors;
    const struct orl_json_member members[] = {
        {"scale", .decode = orl_scale_from_json, .into = &colors->scale},
        {"decades", .real = &colors->decades, .least = 0, .most = 12},
        {"divisions", .whole_32 = &colors->divisions, .from = 2, .to = ORL_LIMIT_DIVISIONS},
        {"palette", .decode = orl_palette_from_json, .into = &colors->palette},
        {"thresholds", .decode = decode_thresholds, .into = request},
        {"length_unit", .decode = decode_unit, .into = request->length_unit},
        {0}};
    request->asked = true;
    return orl_json_members(value, path, members, err);
}

/* ---- Result ---------------------------------------------------------------------------------- */

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
