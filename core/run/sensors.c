#include <stdlib.h>
#include <string.h>

#include <oriel/limits.h>

#include "run/stages.h"

/* Six numbers of one line, NUL-terminated; returns how many words there were, or -1. */
static int parse_line(char *line, double values[6])
{
    char *save = NULL;
    int n = 0;
    for (char *word = strtok_r(line, " \t\r,", &save); word;
         word = strtok_r(NULL, " \t\r,", &save)) {
        char *end;
        if (word[0] == '#')
            break;
        const double value = strtod(word, &end);
        if (*end != '\0' || !isfinite(value))
            return -1;
        if (n < 6)
            values[n] = value;
        n++;
    }
    return n;
}

static int add_sensor(struct orl_sensor **sensors, size_t *count, const double v[6])
{
    if ((*count & (*count - 1)) == 0) {
        struct orl_sensor *grown = realloc(*sensors, (*count ? 2 * *count : 1) * sizeof **sensors);
        if (!grown)
            return ORL_ERR_NOMEM;
        *sensors = grown;
    }
    (*sensors)[(*count)++] =
        (struct orl_sensor){orl_v3(v[0], v[1], v[2]), orl_v3(v[3], v[4], v[5])};
    return 0;
}

int orl_sensors_parse(const char *name, const char *text, size_t size,
                      struct orl_sensor **ret_sensors, size_t *ret_count, struct orl_error *err)
{
    struct orl_sensor *sensors = NULL;
    size_t count = 0;
    int line = 0, code = 0;
    for (size_t at = 0; at < size && code == 0;) {
        const char *newline = memchr(text + at, '\n', size - at);
        const size_t length = newline ? (size_t)(newline - text) - at : size - at;
        char buffer[1024];
        double v[6];
        line++;
        const size_t taken = length < sizeof buffer - 1 ? length : sizeof buffer - 1;
        memcpy(buffer, text + at, taken);
        buffer[taken] = '\0';
        at += length + 1;
        const int n = length > taken || memchr(buffer, '\0', taken) ? -1 : parse_line(buffer, v);
        if (n == 0)
            continue;
        if (n != 6)
            code = orl_error_set(err, ORL_ERR_SYNTAX,
                                 "a sensor is six finite numbers: x y z dx dy dz");
        else if (!isnormal(v[3] * v[3] + v[4] * v[4] + v[5] * v[5]))
            code = orl_error_set(err, ORL_ERR_RANGE,
                                 "the sensor's direction has no length, or far too much");
        else if (!(orl_length(orl_v3(v[0], v[1], v[2])) < ORL_LIMIT_DISTANCE))
            code = orl_error_set(err, ORL_ERR_RANGE, "the sensor is too far away");
        else if (count >= ORL_LIMIT_SENSORS)
            code = orl_error_set(err, ORL_ERR_LIMIT, "more than %lu sensors", ORL_LIMIT_SENSORS);
        else if (add_sensor(&sensors, &count, v) < 0)
            code = orl_error_set(err, ORL_ERR_NOMEM, "out of memory for sensors");
    }
    if (code == 0 && count == 0) {
        line = 0;
        code = orl_error_set(err, ORL_ERR_SYNTAX, "the sensor file holds no sensors");
    }
    if (code < 0) {
        orl_error_at(err, name, line, NULL);
        free(sensors);
        return code;
    }
    *ret_sensors = sensors;
    *ret_count = count;
    return 0;
}

int orl_sensors_load(const struct orl_files *files, const char *name,
                     struct orl_sensor **ret_sensors, size_t *ret_count, struct orl_error *err)
{
    struct orl_file file;
    int code = files->open(files->ctx, name, &file, err);
    if (code < 0)
        return code;
    code = orl_sensors_parse(name, file.data, file.size, ret_sensors, ret_count, err);
    files->close(files->ctx, &file);
    return code;
}
