#include <stdlib.h>
#include <string.h>

#include <oriel/coordinates.h>
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

/* What is wrong with a sensor of so many words; 0: nothing. */
static int judge(int n, const double v[6], struct orl_error *err)
{
    if (n != 6)
        return orl_error_set(err, ORL_ERR_SYNTAX, "a sensor is six finite numbers: x y z dx dy dz");
    const int code = orl_check_point(orl_v3(v[0], v[1], v[2]), "sensor", err);
    return code < 0 ? code : orl_check_direction(orl_v3(v[3], v[4], v[5]), "sensor", err);
}

/* The next line from *at on, and its numbers; returns how many, 0 where there are none, or -1. */
static int next_line(const char *text, size_t size, size_t *at, double ret_values[6])
{
    const char *newline = memchr(text + *at, '\n', size - *at);
    const size_t length = newline ? (size_t)(newline - text) - *at : size - *at;
    char buffer[1024];
    const size_t taken = length < sizeof buffer - 1 ? length : sizeof buffer - 1;
    memcpy(buffer, text + *at, taken);
    buffer[taken] = '\0';
    *at += length + 1;
    return length > taken || memchr(buffer, '\0', taken) ? -1 : parse_line(buffer, ret_values);
}

/* Every sensor of the file goes to take, which may fail for want of memory. */
static int read_sensors(const char *name, const char *text, size_t size, const atomic_bool *cancel,
                        int (*take)(void *ctx, const double v[6]), void *ctx, size_t *ret_count,
                        struct orl_error *err)
{
    enum { POLL_LINES = 4096 };
    size_t count = 0;
    int line = 0, code = 0;
    for (size_t at = 0; at < size && code == 0;) {
        double v[6] = {0};
        const int n = next_line(text, size, &at, v);
        if (line++ % POLL_LINES == 0 && orl_is_cancelled(cancel))
            code = orl_error_set(err, ORL_ERR_CANCELLED, "cancelled while reading sensors");
        if (n == 0 || code < 0)
            continue;
        code = judge(n, v, err);
        if (code == 0 && count >= ORL_LIMIT_SENSORS)
            code = orl_error_set(err, ORL_ERR_LIMIT, "more than %lu sensors", ORL_LIMIT_SENSORS);
        else if (code == 0 && take && take(ctx, v) < 0)
            code = orl_error_set(err, ORL_ERR_NOMEM, "out of memory for sensors");
        count++;
    }
    if (code == 0 && count == 0) {
        line = 0;
        code = orl_error_set(err, ORL_ERR_SYNTAX, "the sensor file holds no sensors");
    }
    if (code < 0)
        orl_error_at(err, name, line, NULL);
    else
        *ret_count = count;
    return code;
}

int orl_sensors_check(const char *name, const char *text, size_t size, size_t *ret_count,
                      struct orl_error *err)
{
    return read_sensors(name, text, size, NULL, NULL, NULL, ret_count, err);
}

struct sensors {
    struct orl_sensor *list; /* owned */
    size_t count;
};

static int add_sensor(void *ctx, const double v[6])
{
    struct sensors *all = ctx;
    if ((all->count & (all->count - 1)) == 0) {
        struct orl_sensor *grown =
            realloc(all->list, (all->count ? 2 * all->count : 1) * sizeof *grown);
        if (!grown)
            return ORL_ERR_NOMEM;
        all->list = grown;
    }
    all->list[all->count++] =
        (struct orl_sensor){orl_v3(v[0], v[1], v[2]), orl_v3(v[3], v[4], v[5])};
    return 0;
}

static int parse(const char *name, const char *text, size_t size, const atomic_bool *cancel,
                 struct orl_sensor **ret_sensors, size_t *ret_count, struct orl_error *err)
{
    struct sensors all = {NULL, 0};
    const int code = read_sensors(name, text, size, cancel, add_sensor, &all, ret_count, err);
    if (code < 0)
        free(all.list);
    else
        *ret_sensors = all.list;
    return code;
}

int orl_sensors_parse(const char *name, const char *text, size_t size,
                      struct orl_sensor **ret_sensors, size_t *ret_count, struct orl_error *err)
{
    return parse(name, text, size, NULL, ret_sensors, ret_count, err);
}

int orl_sensors_load(const struct orl_files *files, const char *name, const atomic_bool *cancel,
                     struct orl_sensor **ret_sensors, size_t *ret_count, struct orl_error *err)
{
    struct orl_file file;
    int code = files->open(files->ctx, name, &file, err);
    if (code < 0)
        return code;
    code = parse(name, file.data, file.size, cancel, ret_sensors, ret_count, err);
    files->close(files->ctx, &file);
    return code;
}
