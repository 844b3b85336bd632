#include "recipe/weather_rows.h"

#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <oriel/base/limits.h>

enum { LINE_MAX_BYTES = 4096, EPW_HEADER = 8 };

/* A reader of lines, of both files. */
struct line_reader {
    const char *name, *at, *end;
    int line;
    char text[LINE_MAX_BYTES];
    struct orl_error *err;
};

/* Reads the next line into text, without its end. Returns 0 at the end of the file. */
static int next_line(struct line_reader *reader)
{
    if (reader->at >= reader->end)
        return 0;
    const char *end = memchr(reader->at, '\n', (size_t)(reader->end - reader->at));
    size_t length = (size_t)((end ? end : reader->end) - reader->at);
    const size_t kept = length < LINE_MAX_BYTES - 1 ? length : LINE_MAX_BYTES - 1;
    memcpy(reader->text, reader->at, kept);
    reader->text[kept] = '\0';
    reader->text[strcspn(reader->text, "\r")] = '\0';
    reader->at += length + 1;
    reader->line++;
    return 1;
}

static int fail(const struct line_reader *reader, const char *what)
{
    orl_error_set(reader->err, ORL_ERR_SYNTAX, "%s", what);
    orl_error_at(reader->err, reader->name, reader->line, NULL);
    return ORL_ERR_SYNTAX;
}

static int add_row(struct orl_weather_rows *weather, const struct orl_recipe_weather_row *row)
{
    if (weather->count >= ORL_LIMIT_YEAR_ROWS)
        return 0;
    if ((weather->count & (weather->count - 1)) == 0) { /* grows at powers of two */
        struct orl_recipe_weather_row *grown =
            realloc(weather->rows, 2 * (weather->count + 1) * sizeof *grown);
        if (!grown)
            return ORL_ERR_NOMEM;
        weather->rows = grown;
    }
    weather->rows[weather->count++] = *row;
    return 0;
}

static int add_checked(const struct line_reader *reader, struct orl_weather_rows *weather,
                       const struct orl_recipe_weather_row *row)
{
    if (row->month < 1 || row->month > 12 || row->day < 1 || row->day > 31)
        return fail(reader, "the row has no date");
    return add_row(weather, row) ? orl_error_no_memory(reader->err) : 0;
}

/* Reads the numbers of a line's fields, NaN where a field is no number. Returns the fields read. */
static size_t read_fields(const char *text, const char *separators, double *ret_values, size_t most)
{
    size_t n = 0;
    while (*text && n < most) {
        char *end;
        const double value = strtod(text, &end);
        ret_values[n++] = end != text ? value : NAN;
        text += strcspn(text, separators);
        text += *text == ',' ? 1 : strspn(text, separators);
    }
    return n;
}

/* Makes a row from month, day, hour and irradiances. Returns false if one is no number. */
static bool make_row(const double values[5], struct orl_recipe_weather_row *ret_row)
{
    for (int i = 0; i < 5; i++)
        if (!(fabs(values[i]) < 1e6)) /* NaN, too */
            return false;
    *ret_row = (struct orl_recipe_weather_row){.month = (int)values[0],
                                               .day = (int)values[1],
                                               .hour = values[2],
                                               .direct_normal = values[3],
                                               .diffuse_horizontal = values[4]};
    return true;
}

/* Fields of EPW's lines: EnergyPlus's Auxiliary Programs, "EPW CSV Format". */
enum { EPW_LATITUDE = 6, EPW_PLACE = 9, EPW_MONTH = 1, EPW_DIRECT = 14, EPW_FIELDS = 16 };

static int read_epw(struct line_reader *reader, struct orl_weather_rows *weather)
{
    double fields[EPW_FIELDS];
    const char *city = strchr(reader->text, ',') + 1;
    snprintf(weather->place, sizeof weather->place, "%.*s", (int)strcspn(city, ","), city);
    if (read_fields(reader->text, ",", fields, EPW_PLACE) < EPW_PLACE ||
        isnan(fields[EPW_LATITUDE] + fields[EPW_LATITUDE + 1] + fields[EPW_LATITUDE + 2]))
        return fail(reader, "the line LOCATION lacks latitude, longitude and time zone");
    weather->latitude_deg = fields[EPW_LATITUDE];
    weather->longitude_deg = fields[EPW_LATITUDE + 1];
    weather->time_zone_h = fields[EPW_LATITUDE + 2];
    while (reader->line < EPW_HEADER && next_line(reader))
        ;
    int rc = 0;
    while (rc == 0 && next_line(reader)) {
        struct orl_recipe_weather_row row;
        if (reader->text[0] == '\0')
            continue;
        if (read_fields(reader->text, ",", fields, EPW_FIELDS) < EPW_FIELDS)
            return fail(reader, "the row lacks direct normal and diffuse horizontal radiation");
        const double values[5] = {fields[EPW_MONTH], fields[EPW_MONTH + 1],
                                  fields[EPW_MONTH + 2] - 0.5, fields[EPW_DIRECT],
                                  fields[EPW_DIRECT + 1]};
        rc = make_row(values, &row)
                 ? add_checked(reader, weather, &row)
                 : fail(reader, "the row lacks direct normal and diffuse horizontal radiation");
    }
    return rc;
}

/* Reads the lines of a WEA file (gendaymtx(1)), where longitudes are west. */
static int read_wea(struct line_reader *reader, struct orl_weather_rows *weather)
{
    const struct {
        const char *name;
        double *value, factor;
    } members[] = {{"latitude ", &weather->latitude_deg, 1},
                   {"longitude ", &weather->longitude_deg, -1},
                   {"time_zone ", &weather->time_zone_h, -1.0 / 15}};
    int rc = 0;
    snprintf(weather->place, sizeof weather->place, "%.63s", reader->text + strlen("place "));
    while (rc == 0 && next_line(reader)) {
        struct orl_recipe_weather_row row;
        double values[5];
        for (size_t i = 0; i < sizeof members / sizeof *members; i++)
            if (strncmp(reader->text, members[i].name, strlen(members[i].name)) == 0)
                *members[i].value =
                    members[i].factor * strtod(reader->text + strlen(members[i].name), NULL);
        if (read_fields(reader->text, " \t", values, 5) == 5 && make_row(values, &row))
            rc = add_checked(reader, weather, &row);
    }
    return rc;
}

int orl_weather_rows_read(const char *name, const char *text, size_t size,
                          struct orl_weather_rows *ret_weather, struct orl_error *err)
{
    struct line_reader reader = {.name = name, .at = text, .end = text + size, .err = err};
    struct orl_weather_rows weather = {.rows = NULL};
    int rc = 0;
    if (next_line(&reader) && strncmp(reader.text, "LOCATION,", strlen("LOCATION,")) == 0)
        rc = read_epw(&reader, &weather);
    else if (strncmp(reader.text, "place ", strlen("place ")) == 0)
        rc = read_wea(&reader, &weather);
    else
        rc = fail(&reader, "the file is no weather file: EPW begins with LOCATION, WEA with place");
    if (rc == 0 && weather.count == 0)
        rc = fail(&reader, "the weather file has no rows");
    if (rc)
        orl_weather_rows_done(&weather);
    else
        *ret_weather = weather;
    return rc;
}

void orl_weather_rows_done(struct orl_weather_rows *weather)
{
    free(weather->rows);
    *weather = (struct orl_weather_rows){.rows = NULL};
}

char *orl_weather_rows_constant(const struct orl_weather_rows *weather, double direct_normal,
                                double diffuse_horizontal)
{
    char *text = NULL;
    size_t size = 0;
    FILE *stream = open_memstream(&text, &size);
    if (!stream)
        return NULL;
    fprintf(stream,
            "place %s\nlatitude %.4f\nlongitude %.4f\ntime_zone %.1f\nsite_elevation 0\n"
            "weather_data_file_units 1\n",
            weather->place, weather->latitude_deg, -weather->longitude_deg,
            -15 * weather->time_zone_h);
    for (size_t i = 0; i < weather->count; i++)
        fprintf(stream, "%d %d %.3f %g %g\n", weather->rows[i].month, weather->rows[i].day,
                weather->rows[i].hour, direct_normal, diffuse_horizontal);
    if (ferror(stream) | fclose(stream)) {
        free(text);
        return NULL;
    }
    return text;
}
