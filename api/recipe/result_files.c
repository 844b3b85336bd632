#include "recipe/result_files.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include <oriel/base/files.h>

#include "distributed/atomic_files.h"

int orl_result_path(const struct orl_result_folder *folder, char ret_path[ORL_RESULT_PATH],
                    struct orl_error *err, const char *format, ...)
{
    char name[ORL_RESULT_PATH], *slash;
    va_list args;
    va_start(args, format);
    const int length = vsnprintf(name, sizeof name, format, args);
    va_end(args);
    if (length < 0 || (size_t)length >= sizeof name)
        return orl_error_set(err, ORL_ERR_LIMIT, "the path '%.200s...' is too long", name);
    int rc = orl_join_path(folder->path, name, ret_path, ORL_RESULT_PATH, err);
    slash = rc == 0 ? strrchr(ret_path, '/') : NULL;
    if (!slash)
        return rc;
    *slash = '\0';
    rc = orl_make_folder(ret_path, err);
    *slash = '/';
    return rc;
}

int orl_result_numbers(const char *path, const double *values, size_t n, int digits,
                       struct orl_error *err)
{
    struct orl_atomic_file file;
    const int rc = orl_atomic_file_open(&file, path, err);
    if (rc)
        return rc;
    for (size_t i = 0; i < n; i++)
        fprintf(file.stream, "%.*f\n", digits, values[i]);
    return orl_atomic_file_commit(&file, err);
}

int orl_result_json(const char *path, json_t *json, struct orl_error *err)
{
    const int rc = orl_write_json(path, json, err);
    json_decref(json);
    return rc;
}

int orl_result_text(const char *path, const char *text, size_t size, struct orl_error *err)
{
    return orl_write_text(path, text, size, err);
}

int orl_result_copy(const char *path, const char *from, struct orl_error *err)
{
    const struct orl_files here = orl_files_from_folder(".");
    struct orl_file file;
    int rc = here.open(here.ctx, from, &file, err);
    if (rc)
        return rc;
    rc = orl_write_text(path, file.data, file.size, err);
    here.close(here.ctx, &file);
    return rc;
}

/* ---- Legends --------------------------------------------------------------------------------- */

/* Ladybug Tools' colour sets (ladybug.color.Colorset), as RGB. */
enum { MOST_COLORS = 11 };
static const struct {
    int count;
    unsigned rgb[MOST_COLORS];
} color_sets[] = {
    [ORL_COLORS_COMFORT] = {5, {0x000000, 0x6e0099, 0xff0000, 0xffff66, 0xffffff}},
    [ORL_COLORS_NUANCED] = {11,
                            {0x313695, 0x4575b4, 0x74add1, 0xabd9e9, 0xe0f3f8, 0xffffbf, 0xfee090,
                             0xfdae61, 0xf46d43, 0xd73027, 0xa50026}},
    [ORL_COLORS_GLARE] = {5, {0x9cd9ff, 0xfff34d, 0xff7300, 0xff0000, 0x000000}},
    [ORL_COLORS_ORIGINAL] = {10,
                             {0x4b6ba9, 0x7393ca, 0xaac8f7, 0xc1d5d0, 0xf5ef67, 0xfce64a, 0xef9c15,
                              0xea7b00, 0xea4a00, 0xea2600}}};

static json_t *colors_to_json(enum orl_result_colors set)
{
    json_t *colors = json_array();
    for (int i = 0; i < color_sets[set].count; i++) {
        const unsigned rgb = color_sets[set].rgb[i];
        json_array_append_new(colors, json_pack("{s:i, s:i, s:i, s:i, s:s}", "r", (int)(rgb >> 16),
                                                "g", (int)(rgb >> 8 & 255), "b", (int)(rgb & 255),
                                                "a", 255, "type", "Color"));
    }
    return colors;
}

json_t *orl_result_data_type(const char *name, const char *data_type)
{
    if (strcmp(data_type, "GenericType") == 0) /* a type of its own has its unit, too */
        return json_pack("{s:s, s:s, s:s, s:s}", "name", name, "data_type", data_type, "base_unit",
                         "", "type", "GenericDataType");
    return json_pack("{s:s, s:s, s:s}", "name", name, "data_type", data_type, "type", "DataType");
}

int orl_result_legend(const char *path, const char *title, const char *data_type, const char *unit,
                      double most, enum orl_result_colors colors, struct orl_error *err)
{
    json_t *legend = json_pack("{s:s, s:i, s:f, s:o}", "type", "LegendParameters", "min", 0, "max",
                               most, "colors", colors_to_json(colors));
    return orl_result_json(path,
                           json_pack("{s:s, s:o, s:s, s:o}", "type", "VisualizationMetaData",
                                     "data_type", orl_result_data_type(title, data_type), "unit",
                                     unit, "legend_parameters", legend),
                           err);
}
