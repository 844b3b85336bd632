#include "honeybee/hb_writer.h"

#include <math.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <oriel/base/array.h>
#include <oriel/base/limits.h>

#include "json/decode.h"

enum { IDENTIFIER_MAX_BYTES = 100, NAME_SIZE = 512 };

/* ---- Places ---------------------------------------------------------------------------------- */

/* Writes the path from the document down; cuts it off at the end if it does not fit. */
static size_t write_path(const struct orl_hb_at *at, char *text, size_t size)
{
    if (!at)
        return 0;
    const size_t before = write_path(at->up, text, size);
    if (before >= size)
        return size;
    const int more = at->member ? snprintf(text + before, size - before, "%s%.60s",
                                           before > 0 ? "." : "", at->member)
                                : snprintf(text + before, size - before, "[%zu]", at->index);
    return before + (size_t)more;
}

int orl_hb_fail(const struct orl_hb_at *at, struct orl_error *err, int code, const char *what, ...)
{
    char path[ORL_JSON_PATH_MAX] = "model", message[400];
    va_list args;
    write_path(at, path, sizeof path);
    va_start(args, what);
    vsnprintf(message, sizeof message, what, args);
    va_end(args);
    return orl_json_fail(err, code, path, "%s", message);
}

/* ---- Files ----------------------------------------------------------------------------------- */

void orl_text_files_done(struct orl_text_files *files)
{
    for (size_t i = 0; i < files->count; i++) {
        free(files->items[i].name);
        free(files->items[i].text);
    }
    free(files->items);
    *files = (struct orl_text_files){0};
}

int orl_hb_begin(struct orl_hb *hb, struct orl_hb_file *file)
{
    *file = (struct orl_hb_file){.number = ++hb->n_begun};
    file->stream = open_memstream(&file->text, &file->size);
    return file->stream ? 0 : orl_error_no_memory(hb->err);
}

int orl_hb_check(struct orl_hb *hb, const struct orl_hb_file *file)
{
    const long at = ftell(file->stream);
    if (ferror(file->stream) || at < 0)
        return orl_error_set(hb->err, ORL_ERR_NOMEM, "out of memory for the model's files");
    if (hb->bytes + (uint64_t)at <= ORL_LIMIT_FILE_BYTES)
        return 0;
    orl_error_set(hb->err, ORL_ERR_LIMIT, "the model's Radiance files would be larger than %lu MiB",
                  ORL_LIMIT_FILE_BYTES >> 20);
    orl_error_hint(hb->err,
                   "Groups with many objects and many states take most of it: reduce them");
    return ORL_ERR_LIMIT;
}

void orl_hb_discard(struct orl_hb_file *file)
{
    if (file->stream) {
        fclose(file->stream);
        free(file->text);
    }
    *file = (struct orl_hb_file){0};
}

int orl_hb_end(struct orl_hb *hb, struct orl_hb_file *file, const char *name, ...)
{
    char text[NAME_SIZE];
    va_list args;
    va_start(args, name);
    const int length = vsnprintf(text, sizeof text, name, args);
    va_end(args);
    int rc = orl_hb_check(hb, file);
    if (rc == 0 && length >= NAME_SIZE)
        rc = orl_error_set(hb->err, ORL_ERR_LIMIT, "the name of a file is too long: %.80s", text);
    if (rc == 0 && hb->files.count == ORL_LIMIT_SCENE_FILES)
        rc = orl_error_set(
            hb->err, ORL_ERR_LIMIT,
            "the model would need more than %u files: it has too many grids, views or states",
            ORL_LIMIT_SCENE_FILES);
    if (rc == 0 && !orl_array_reserve(&hb->files.items, &hb->files.room, hb->files.count,
                                      sizeof *hb->files.items))
        rc = orl_error_no_memory(hb->err);
    const int closed = fclose(file->stream);
    file->stream = NULL;
    if (rc == 0 && closed != 0)
        rc = orl_error_set(hb->err, ORL_ERR_NOMEM, "out of memory for the model's files");
    char *own = rc == 0 && file->size > 0 ? strdup(text) : NULL;
    if (rc == 0 && file->size > 0 && !own)
        rc = orl_error_no_memory(hb->err);
    if (!own) {
        free(file->text);
        return rc;
    }
    hb->bytes += file->size;
    hb->files.items[hb->files.count++] = (struct orl_text_file){own, file->text, file->size};
    return 0;
}

/* ---- Warnings -------------------------------------------------------------------------------- */

void orl_hb_warn(struct orl_hb *hb, const char *format, ...)
{
    enum { MOST = 100 };
    va_list args;
    if (hb->n_warnings++ >= MOST || (!hb->warnings.stream && orl_hb_begin(hb, &hb->warnings)))
        return;
    va_start(args, format);
    vfprintf(hb->warnings.stream, format, args);
    va_end(args);
    fputc('\n', hb->warnings.stream);
}

int orl_hb_warnings_end(struct orl_hb *hb)
{
    return hb->warnings.stream ? orl_hb_end(hb, &hb->warnings, "model/warnings.txt") : 0;
}

/* ---- Values ---------------------------------------------------------------------------------- */

const json_t *orl_hb_get(const json_t *object, const char *member)
{
    const json_t *value = json_object_get(object, member);
    return json_is_null(value) ? NULL : value;
}

int orl_hb_array(struct orl_hb *hb, const json_t *object, const struct orl_hb_at *at,
                 const char *member, const json_t **ret_array)
{
    const json_t *value = orl_hb_get(object, member);
    const struct orl_hb_at here = {at, member, 0};
    if (value && !json_is_array(value))
        return orl_hb_fail(&here, hb->err, ORL_ERR_INVALID, "a list is expected here");
    *ret_array = value;
    return 0;
}

int orl_hb_walk(struct orl_hb *hb, const json_t *object, const struct orl_hb_at *at,
                const char *member, struct orl_hb_walk *ret_walk)
{
    *ret_walk = (struct orl_hb_walk){.list = {at, member, 0}};
    return orl_hb_array(hb, object, at, member, &ret_walk->array);
}

json_t *orl_hb_next(struct orl_hb_walk *walk)
{
    const size_t i = walk->here.up ? walk->here.index + 1 : 0;
    walk->here = (struct orl_hb_at){&walk->list, NULL, i};
    return json_array_get(walk->array, i);
}

const json_t *orl_hb_radiance(const json_t *object)
{
    return orl_hb_get(orl_hb_get(object, "properties"), "radiance");
}

int orl_hb_identifier(struct orl_hb *hb, const json_t *value, const struct orl_hb_at *at,
                      const char **ret_text)
{
    static const char allowed[] =
        "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789._-";
    const char *text = json_string_value(value);
    const size_t length = text ? json_string_length(value) : 0;
    if (length > 0 && length <= IDENTIFIER_MAX_BYTES && text[0] != '.' &&
        strspn(text, allowed) == length) {
        *ret_text = text;
        return 0;
    }
    orl_hb_fail(at, hb->err, ORL_ERR_INVALID, "an identifier is expected here");
    orl_error_hint(hb->err, "Identifiers have 1 to 100 letters, digits, '.', '_' and '-', and do "
                            "not begin with a dot: rename it and all references to it");
    return ORL_ERR_INVALID;
}

int orl_hb_number(struct orl_hb *hb, const json_t *value, const struct orl_hb_at *at,
                  double *ret_number)
{
    static const double most = 1e12;
    const double number = json_number_value(value);
    if (!json_is_number(value) || !(fabs(number) <= most))
        return orl_hb_fail(at, hb->err, ORL_ERR_INVALID,
                           "a number from -1e12 to 1e12 is expected here");
    *ret_number = number;
    return 0;
}

int orl_hb_point(struct orl_hb *hb, const json_t *value, const struct orl_hb_at *at,
                 struct orl_vec3 *ret_point)
{
    double v[3] = {0};
    if (json_array_size(value) != 3)
        return orl_hb_fail(at, hb->err, ORL_ERR_INVALID, "three numbers are expected here");
    for (size_t i = 0; i < 3; i++) {
        const struct orl_hb_at here = {at, NULL, i};
        const int rc = orl_hb_number(hb, json_array_get(value, i), &here, &v[i]);
        if (rc)
            return rc;
    }
    *ret_point = orl_v3(v[0], v[1], v[2]);
    return 0;
}

bool orl_hb_flag(const json_t *object, const char *member)
{
    return json_is_true(json_object_get(object, member));
}
