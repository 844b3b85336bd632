#include "output/sensor_table.h"

#include <math.h>
#include <string.h>

#include "http/json_get.h"
#include "output/style.h"

enum { NAME_LEAST = 12, NAME_MOST = 32, CELL = 32 };

/* ---- Sensors --------------------------------------------------------------------------------- */

/* Formats a value, "-" if unknown. */
static void format_value(double value, int digits, const char *unit, char ret_text[CELL])
{
    if (isfinite(value))
        snprintf(ret_text, CELL, "%.*f%s", digits, value, unit);
    else
        snprintf(ret_text, CELL, "-");
}

/* Returns half the width of the mean's 95 % interval, over the mean, in percent. */
static double error_of(const json_t *summary, double mean)
{
    const json_t *interval = json_object_get(summary, "interval_95_lx");
    const json_t *low = json_array_get(interval, 0), *high = json_array_get(interval, 1);
    if (!json_is_number(low) || !json_is_number(high) || !(mean > 0))
        return NAN;
    return 50 * (json_number_value(high) - json_number_value(low)) / mean;
}

/* Returns the decimals that give three significant digits or all whole ones. */
static int lux_digits(double lux)
{
    return lux < 10 ? 2 : lux < 100 ? 1 : 0;
}

static void print_row(FILE *to, int width, const char *name, size_t sensors, const json_t *summary)
{
    const double mean = orl_get_number(summary, "mean_lx", NAN);
    const double least = orl_get_number(summary, "minimum_lx", NAN);
    const double most = orl_get_number(summary, "maximum_lx", NAN);
    char cells[6][CELL];
    format_value(mean, lux_digits(mean), "", cells[0]);
    format_value(error_of(summary, mean), 1, " %", cells[1]);
    format_value(least, lux_digits(least), "", cells[2]);
    format_value(most, lux_digits(most), "", cells[3]);
    format_value(100 * orl_get_number(summary, "share_300", NAN), 1, " %", cells[4]);
    format_value(orl_get_number(summary, "uniformity", NAN), 2, "", cells[5]);
    fprintf(to, "%-*.*s %8zu %9s %8s %9s %9s %10s %11s\n", width, width, name, sensors, cells[0],
            cells[1], cells[2], cells[3], cells[4], cells[5]);
}

/* Returns the width of the names' column. */
static int name_width(const json_t *grids)
{
    size_t width = NAME_LEAST, i;
    const json_t *grid;
    json_array_foreach(grids, i, grid)
    {
        const size_t length = strlen(orl_get_text(grid, "name"));
        width = length > width ? length : width;
    }
    return width > NAME_MOST ? NAME_MOST : (int)width;
}

void orl_print_sensor_table(FILE *to, const json_t *result)
{
    const json_t *grids = json_object_get(result, "grids"), *grid;
    const json_t *summary = json_object_get(result, "summary");
    const int width = name_width(grids);
    size_t i;
    if (json_array_size(grids) == 0 && !summary)
        return;
    fprintf(to, "%s%-*s %8s %9s %8s %9s %9s %10s %11s%s\n", orl_style_begin(to, ORL_STYLE_HEADING),
            width, "grid", "sensors", "mean lx", "error", "min lx", "max lx", ">= 300 lx",
            "uniformity", orl_style_end(to));
    json_array_foreach(grids, i, grid)
    {
        print_row(to, width, orl_get_text(grid, "name"), (size_t)orl_get_number(grid, "count", 0),
                  json_object_get(grid, "summary"));
    }
    if (summary)
        print_row(to, width, "all sensors", json_array_size(json_object_get(result, "sensors")),
                  summary);
}

/* ---- Views ----------------------------------------------------------------------------------- */

static void print_glare(FILE *to, const json_t *view)
{
    const json_t *glare = json_object_get(view, "glare");
    const json_t *dgp = json_object_get(json_object_get(glare, "metrics"), "dgp");
    const json_t *interval = json_object_get(dgp, "interval_95");
    const json_t *low = json_array_get(interval, 0), *high = json_array_get(interval, 1);
    const char *class_name = orl_get_text(glare, "class");
    if (!dgp)
        return;
    fprintf(to, "view %s: DGP %.3f", orl_get_text(view, "name"), orl_get_number(dgp, "value", NAN));
    if (json_is_number(low) && json_is_number(high))
        fprintf(to, " [%.3f, %.3f]", json_number_value(low), json_number_value(high));
    fprintf(to, ", %s%s%s glare\n", orl_style_begin(to, orl_style_of_word(class_name)), class_name,
            orl_style_end(to));
}

void orl_print_glare_lines(FILE *to, const json_t *result)
{
    const json_t *view;
    size_t i;
    json_array_foreach(json_object_get(result, "views"), i, view)
    {
        print_glare(to, view);
    }
}

/* ---- Files ----------------------------------------------------------------------------------- */

static void print_path(FILE *to, const char *folder, const json_t *name)
{
    if (json_is_string(name))
        fprintf(to, "%s/%s\n", folder, json_string_value(name));
}

void orl_print_sensor_files(FILE *to, const json_t *result, const char *folder)
{
    const json_t *files = json_object_get(result, "sensor_files"), *one;
    size_t i;
    json_array_foreach(json_object_get(result, "grids"), i, one)
    {
        print_path(to, folder, json_object_get(one, "map"));
    }
    json_array_foreach(json_object_get(files, "maps"), i, one)
    {
        print_path(to, folder, json_object_get(one, "png"));
    }
    print_path(to, folder, json_object_get(files, "csv"));
}
