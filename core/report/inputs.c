/* What a year is made from: sensors of grids, and a note of every file. */
#include <oriel/annual_report.h>

#include <sodium.h>
#include <stdlib.h>
#include <string.h>

#include <oriel/limits.h>
#include <oriel/sha256.h>

#include "base/grow.h"
#include "run/stages.h"

/* ---- Grids ----------------------------------------------------------------------------------- */

static int append(struct orl_sensor **sensors, size_t *count, const struct orl_sensor *more,
                  size_t n, struct orl_error *err)
{
    if (n > ORL_LIMIT_SENSORS - *count)
        return orl_error_set(err, ORL_ERR_LIMIT, "the grids have more than %lu sensors",
                             ORL_LIMIT_SENSORS);
    struct orl_sensor *grown = realloc(*sensors, (*count + n + 1) * sizeof *grown);
    if (!grown)
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory for %zu sensors", *count + n);
    if (n > 0)
        memcpy(grown + *count, more, n * sizeof *more);
    *sensors = grown;
    *count += n;
    return 0;
}

int orl_annual_grids_read(struct orl_annual_request *request, char *const *names,
                          const struct orl_files *files, struct orl_error *err)
{
    struct orl_sensor *sensors = NULL;
    size_t count = 0;
    int code = 0;
    for (size_t g = 0; g < request->n_grids && code == 0; g++) {
        struct orl_annual_grid *grid = &request->grids[g];
        struct orl_sensor *read = NULL;
        size_t n = grid->count;
        if (names[g])
            code = orl_sensors_load(files, names[g], &read, &n, err);
        const size_t first = count;
        if (code == 0)
            code =
                append(&sensors, &count, names[g] ? read : request->sensors + grid->first, n, err);
        grid->first = first;
        grid->count = n;
        free(read);
    }
    if (code < 0) {
        free(sensors);
        return code;
    }
    free(request->sensors);
    request->sensors = sensors;
    request->n_sensors = count;
    return 0;
}

/* ---- Notes ----------------------------------------------------------------------------------- */

static int note(struct orl_annual_inputs *inputs, const char *name, const struct orl_file *file,
                struct orl_error *err)
{
    unsigned char digest[ORL_SHA256_BYTES];
    for (size_t i = 0; i < inputs->count; i++)
        if (strcmp(inputs->items[i].name, name) == 0)
            return 0;
    if (!orl_grow(&inputs->items, &inputs->room, inputs->count, sizeof *inputs->items))
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
    struct orl_annual_input *item = &inputs->items[inputs->count];
    *item = (struct orl_annual_input){.name = strdup(name), .bytes = file->size};
    if (!item->name)
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
    orl_sha256(file->data, file->size, digest);
    sodium_bin2hex(item->digest, sizeof item->digest, digest, sizeof digest);
    inputs->count++;
    return 0;
}

static int noting_open(void *ctx, const char *name, struct orl_file *ret_file,
                       struct orl_error *err)
{
    struct orl_annual_inputs *inputs = ctx;
    int code = inputs->files->open(inputs->files->ctx, name, ret_file, err);
    if (code < 0)
        return code;
    code = note(inputs, name, ret_file, err);
    if (code < 0)
        inputs->files->close(inputs->files->ctx, ret_file);
    return code;
}

static void noting_close(void *ctx, struct orl_file *file)
{
    const struct orl_annual_inputs *inputs = ctx;
    inputs->files->close(inputs->files->ctx, file);
}

struct orl_files orl_annual_inputs_of(struct orl_annual_inputs *inputs,
                                      const struct orl_files *files)
{
    *inputs = (struct orl_annual_inputs){.files = files};
    return (struct orl_files){.ctx = inputs, .open = noting_open, .close = noting_close};
}

void orl_annual_inputs_done(struct orl_annual_inputs *inputs)
{
    if (!inputs)
        return;
    for (size_t i = 0; i < inputs->count; i++)
        free(inputs->items[i].name);
    free(inputs->items);
    *inputs = (struct orl_annual_inputs){.count = 0};
}
