/* Files of a recipe's results, below one folder. Folders are made as needed. */
#ifndef ORL_API_RECIPE_RESULT_FILES_H
#define ORL_API_RECIPE_RESULT_FILES_H

#include <jansson.h>
#include <stddef.h>

#include <oriel/base/error.h>

enum { ORL_RESULT_PATH = 4096 };
struct orl_result_folder {
    char path[ORL_RESULT_PATH];
};

/* Joins a name, printed as by printf, to the folder's path, and makes the folders above it. */
int orl_result_path(const struct orl_result_folder *folder, char ret_path[ORL_RESULT_PATH],
                    struct orl_error *err, const char *format, ...)
    __attribute__((format(printf, 4, 5)));

/* Writes a number per line, with so many digits behind the point. */
int orl_result_numbers(const char *path, const double *values, size_t n, int digits,
                       struct orl_error *err);
/* Writes JSON and releases it; NULL: out of memory. */
int orl_result_json(const char *path, json_t *json, struct orl_error *err);
int orl_result_text(const char *path, const char *text, size_t size, struct orl_error *err);
int orl_result_copy(const char *path, const char *from, struct orl_error *err);

/* Colours of Ladybug Tools' legends. */
enum orl_result_colors {
    ORL_COLORS_COMFORT,
    ORL_COLORS_NUANCED,
    ORL_COLORS_GLARE,
    ORL_COLORS_ORIGINAL
};
/* Writes vis_metadata.json: title, unit and legend of a folder of results. data_type: a data type
 * of Ladybug Tools, "Fraction", "Time" or "GenericType". */
int orl_result_legend(const char *path, const char *title, const char *data_type, const char *unit,
                      double most, enum orl_result_colors colors, struct orl_error *err);
/* Returns {"name", "data_type", "type"}; a new reference. */
json_t *orl_result_data_type(const char *name, const char *data_type);

#endif
