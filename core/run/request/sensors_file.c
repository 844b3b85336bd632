#include <stdlib.h>

#include <oriel/base/input_checks.h>
#include <oriel/base/limits.h>
#include <oriel/base/scanner.h>

#include "run/request/job_inputs.h"

enum { NUMBERS = 6, POLL_LINES = 4096 };

/* Reads the sensor of a line; *ret_any: false if the line is empty or only a comment. */
static int read_line(const struct orl_scanner *scanner, struct orl_slice line, double ret[NUMBERS],
                     bool *ret_any, struct orl_error *err)
{
    struct orl_cells cells;
    struct orl_slice cell;
    int n = 0, code = 0;
    orl_cells_init(&cells, orl_slice_before(line, '#'));
    for (; code == 0 && orl_cells_next(&cells, &cell); n++) {
        double value = 0;
        code = orl_scanner_number(scanner, cell, NULL, &value, err);
        if (n < NUMBERS)
            ret[n] = value;
    }
    *ret_any = n > 0;
    if (code < 0 || n == 0)
        return code;
    if (n != NUMBERS) {
        orl_scanner_fail(scanner, ORL_ERR_SYNTAX, err,
                         "a sensor needs six numbers, x y z dx dy dz, but this line has %d", n);
        orl_error_hint(err, "separate numbers with spaces or commas, and write 0.5, not 0,5");
        return ORL_ERR_SYNTAX;
    }
    code = orl_check_point(orl_v3(ret[0], ret[1], ret[2]), "sensor", err);
    return code < 0 ? code : orl_check_direction(orl_v3(ret[3], ret[4], ret[5]), "sensor", err);
}

static int read_sensors(struct orl_scanner *scanner, const atomic_bool *cancel,
                        int (*take)(void *ctx, const double v[NUMBERS]), void *ctx,
                        size_t *ret_count, struct orl_error *err)
{
    struct orl_slice line;
    size_t count = 0;
    while (orl_scanner_line(scanner, &line)) {
        double v[NUMBERS] = {0};
        bool any = false;
        if (scanner->line % POLL_LINES == 1 && orl_is_cancelled(cancel))
            return orl_error_set(err, ORL_ERR_CANCELLED, "cancelled while reading sensors");
        int code = read_line(scanner, line, v, &any, err);
        if (code == 0 && !any)
            continue;
        if (code == 0 && count >= ORL_LIMIT_SENSORS)
            code = orl_error_set(err, ORL_ERR_LIMIT, "more than %lu sensors", ORL_LIMIT_SENSORS);
        if (code == 0 && take && take(ctx, v) < 0)
            code = orl_error_set(err, ORL_ERR_NOMEM, "out of memory for sensors");
        if (code < 0) {
            orl_error_at(err, scanner->name, scanner->line, NULL);
            return code;
        }
        count++;
    }
    *ret_count = count;
    return 0;
}

static int read_file(const char *name, const char *text, size_t size, const atomic_bool *cancel,
                     int (*take)(void *ctx, const double v[NUMBERS]), void *ctx, size_t *ret_count,
                     struct orl_error *err)
{
    struct orl_scanner scanner;
    size_t count = 0;
    int code = orl_scanner_init(&scanner, name, text, size, 0, err);
    if (code == 0)
        code = read_sensors(&scanner, cancel, take, ctx, &count, err);
    if (code == 0 && count == 0) {
        code = orl_error_set(err, ORL_ERR_SYNTAX, "the sensor file has no sensors");
        orl_error_at(err, name, 0, NULL);
    }
    if (code == 0)
        *ret_count = count;
    return code;
}

int orl_sensors_read(const char *name, const char *text, size_t size,
                     int (*take)(void *ctx, const double v[6]), void *ctx, struct orl_error *err)
{
    size_t count;
    return read_file(name, text, size, NULL, take, ctx, &count, err);
}

int orl_sensors_check(const char *name, const char *text, size_t size, size_t *ret_count,
                      struct orl_error *err)
{
    return read_file(name, text, size, NULL, NULL, NULL, ret_count, err);
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

static int parse_sensors(const char *name, const char *text, size_t size, const atomic_bool *cancel,
                         struct orl_sensor **ret_sensors, size_t *ret_count, struct orl_error *err)
{
    struct sensors all = {NULL, 0};
    const int code = read_file(name, text, size, cancel, add_sensor, &all, ret_count, err);
    if (code < 0)
        free(all.list);
    else
        *ret_sensors = all.list;
    return code;
}

int orl_sensors_parse(const char *name, const char *text, size_t size,
                      struct orl_sensor **ret_sensors, size_t *ret_count, struct orl_error *err)
{
    return parse_sensors(name, text, size, NULL, ret_sensors, ret_count, err);
}

int orl_sensors_load(const struct orl_files *files, const char *name, const atomic_bool *cancel,
                     struct orl_sensor **ret_sensors, size_t *ret_count, struct orl_error *err)
{
    struct orl_file file;
    int code = files->open(files->ctx, name, &file, err);
    if (code < 0)
        return code;
    code = parse_sensors(name, file.data, file.size, cancel, ret_sensors, ret_count, err);
    files->close(files->ctx, &file);
    return code;
}
