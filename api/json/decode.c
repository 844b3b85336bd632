#include "json/decode.h"

#include <errno.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <oriel/base/json_read.h>
#include <oriel/base/limits.h>
#include <oriel/base/suggest.h>
#include <oriel/base/thread_pool.h>

int orl_json_fail(struct orl_error *err, int code, const char *path, const char *what, ...)
{
    char text[ORL_ERROR_TEXT_MAX];
    va_list args;
    va_start(args, what);
    vsnprintf(text, sizeof text, what, args);
    va_end(args);
    orl_error_set(err, code, "%s: %s", path, text);
    orl_error_at(err, NULL, 0, path);
    return code;
}

static _Thread_local const atomic_bool *cancel_flag;

void orl_json_set_cancel(const atomic_bool *cancel)
{
    cancel_flag = cancel;
}

static int fail_cancelled(struct orl_error *err)
{
    return orl_error_set(err, ORL_ERR_CANCELLED, "cancelled while reading JSON");
}

/* Returns ORL_ERR_CANCELLED, with err filled in, if the cancel flag is set. */
static int poll_cancel(struct orl_error *err)
{
    return orl_is_cancelled(cancel_flag) ? fail_cancelled(err) : 0;
}

int orl_json_parse(const char *name, const char *text, size_t size, json_t **ret_doc,
                   struct orl_error *err)
{
    if (size > ORL_LIMIT_JOB_BYTES)
        return orl_error_set(err, ORL_ERR_LIMIT, "the document has %zu bytes; the limit is %lu",
                             size, ORL_LIMIT_JOB_BYTES);
    const uint64_t weight = orl_json_memory_estimate(text, size);
    if (weight > ORL_LIMIT_JSON_MEMORY)
        return orl_error_set(
            err, ORL_ERR_LIMIT,
            "the document's values would take %llu MiB of memory; the limit is %lu",
            (unsigned long long)weight >> 20, ORL_LIMIT_JSON_MEMORY >> 20);
    /* Editors and shells of Windows put a byte-order mark in front of a text. */
    const size_t mark = size >= 3 && memcmp(text, "\xef\xbb\xbf", 3) == 0 ? 3 : 0;
    json_error_t where;
    json_t *doc =
        orl_json_read_until(text + mark, size - mark, JSON_REJECT_DUPLICATES, cancel_flag, &where);
    if (doc) {
        *ret_doc = doc;
        return 0;
    }
    if (errno == ECANCELED)
        return fail_cancelled(err);
    if (errno == ENOMEM)
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory reading JSON");
    orl_error_set(err, ORL_ERR_SYNTAX, "not valid JSON, column %d: %s", where.column, where.text);
    orl_error_at(err, name, where.line > 0 ? where.line : 1, NULL);
    return ORL_ERR_SYNTAX;
}

static const char *type_name(const json_t *value)
{
    static const char *const names[] = {"an object", "an array", "a string", "a number",
                                        "a number",  "true",     "false",    "null"};
    return value ? names[json_typeof(value)] : "nothing";
}

int orl_json_wrong_type(const json_t *value, const char *path, const char *wanted,
                        struct orl_error *err)
{
    return orl_json_fail(err, ORL_ERR_INVALID, path, "%s is expected here, not %s", wanted,
                         type_name(value));
}

int orl_json_array(const json_t *value, const char *path, size_t max, struct orl_error *err)
{
    if (!json_is_array(value))
        return orl_json_wrong_type(value, path, "an array", err);
    if (json_array_size(value) > max)
        return orl_json_fail(err, ORL_ERR_LIMIT, path, "%zu elements; the limit is %zu",
                             json_array_size(value), max);
    return 0;
}

int orl_json_whole(const json_t *value, const char *path, uint64_t min, uint64_t max,
                   uint64_t *ret_value, struct orl_error *err)
{
    /* 2^53: doubles above it do not represent every integer. */
    const double exact = 9007199254740992.0;
    uint64_t whole = 0;
    bool ok = false;
    if (json_is_integer(value)) {
        ok = json_integer_value(value) >= 0;
        whole = ok ? (uint64_t)json_integer_value(value) : 0;
    } else if (json_is_real(value)) {
        const double real = json_real_value(value);
        ok = real >= 0 && real <= exact && floor(real) == real;
        whole = ok ? (uint64_t)real : 0;
    } else {
        return orl_json_wrong_type(value, path, "a whole number", err);
    }
    if (!ok || whole < min || whole > max)
        return orl_json_fail(err, ORL_ERR_RANGE, path,
                             "a whole number from %llu to %llu is expected",
                             (unsigned long long)min, (unsigned long long)max);
    *ret_value = whole;
    return 0;
}

int orl_json_real(const json_t *value, const char *path, double *ret_value, struct orl_error *err)
{
    if (!json_is_number(value))
        return orl_json_wrong_type(value, path, "a number", err);
    const double real = json_number_value(value);
    if (!isfinite(real))
        return orl_json_fail(err, ORL_ERR_RANGE, path, "the number is not finite");
    *ret_value = real;
    return 0;
}

static int decode_bool(const json_t *value, const char *path, bool *ret_value,
                       struct orl_error *err)
{
    if (!json_is_boolean(value))
        return orl_json_wrong_type(value, path, "true or false", err);
    *ret_value = json_is_true(value);
    return 0;
}

int orl_json_string(const json_t *value, const char *path, size_t max, char **ret_text,
                    struct orl_error *err)
{
    if (!json_is_string(value))
        return orl_json_wrong_type(value, path, "a string", err);
    const size_t length = json_string_length(value);
    if (length == 0)
        return orl_json_fail(err, ORL_ERR_INVALID, path, "the string is empty");
    if (length > max)
        return orl_json_fail(err, ORL_ERR_LIMIT, path, "%zu bytes; the limit is %zu", length, max);
    char *copy = strdup(json_string_value(value));
    if (!copy)
        return orl_error_no_memory(err);
    *ret_text = copy;
    return 0;
}

int orl_json_return_text(char *text, char **ret_text, int rc)
{
    if (rc == 0 && ret_text)
        *ret_text = text;
    else
        free(text);
    return rc;
}

/* Suggests the word that was meant. words ends with NULL. */
static void hint_word(const char *given, const char *const *words, struct orl_error *err)
{
    struct orl_suggestion suggestion = {.word = given};
    for (; *words; words++)
        orl_suggestion_add(&suggestion, *words);
    orl_suggestion_hint(&suggestion, err);
}

int orl_json_word(const json_t *value, const char *path, const char *const *words, void *ret_index,
                  struct orl_error *err)
{
    const char *given = json_string_value(value);
    char list[ORL_ERROR_TEXT_MAX / 2] = "";
    size_t used = 0;
    for (unsigned i = 0; words[i]; i++) {
        if (given && strcmp(given, words[i]) == 0) {
            memcpy(ret_index, &i, sizeof i);
            return 0;
        }
        const char *before = i == 0 ? "" : words[i + 1] ? ", " : " or ";
        const int n = used < sizeof list
                          ? snprintf(list + used, sizeof list - used, "%s\"%s\"", before, words[i])
                          : 0;
        used += n > 0 ? (size_t)n : 0;
    }
    if (!given)
        return orl_json_fail(err, ORL_ERR_INVALID, path, "%s is expected here", list);
    orl_json_fail(err, ORL_ERR_INVALID, path, "%s is expected here, not \"%.60s\"", list, given);
    hint_word(given, words, err);
    return ORL_ERR_INVALID;
}

const char *orl_json_path(const char *path, const char *member, char ret_path[ORL_JSON_PATH_MAX])
{
    snprintf(ret_path, ORL_JSON_PATH_MAX, "%.120s%s%.60s", path, *path ? "." : "", member);
    return ret_path;
}

static bool is_known(const char *name, const struct orl_json_member *members)
{
    for (; members->name; members++)
        if (strcmp(name, members->name) == 0)
            return true;
    return false;
}

static int unknown_member(const char *path, const char *name, const struct orl_json_member *members,
                          struct orl_error *err)
{
    struct orl_suggestion suggestion = {.word = name};
    char where[ORL_JSON_PATH_MAX], known[ORL_ERROR_TEXT_MAX] = "";
    size_t used = 0;
    for (const struct orl_json_member *m = members; m->name; m++)
        orl_suggestion_add(&suggestion, m->name);
    for (; members->name && used < sizeof known; members++) {
        const int n =
            snprintf(known + used, sizeof known - used, "%s%s", used ? ", " : "", members->name);
        used += n > 0 ? (size_t)n : 0;
    }
    orl_json_fail(err, ORL_ERR_INVALID, orl_json_path(path, name, where),
                  "there is no such member");
    orl_error_hint(err, "Known here: %s", known);
    orl_suggestion_hint(&suggestion, err);
    return ORL_ERR_INVALID;
}

/* Fails with the bounds of a number, and its meaning as the hint. */
static int out_of_bounds(const char *path, const struct orl_json_schema *schema,
                         struct orl_error *err)
{
    char low[40] = "", high[40] = "";
    const bool has_low = isfinite(schema->least), has_high = isfinite(schema->most);
    if (has_low && has_high && !schema->above && !schema->below) {
        orl_json_fail(err, ORL_ERR_RANGE, path, "it must be from %g to %g", schema->least,
                      schema->most);
    } else {
        if (has_low)
            snprintf(low, sizeof low, "%s %g", schema->above ? "above" : "at least", schema->least);
        if (has_high)
            snprintf(high, sizeof high, "%s %g", schema->below ? "below" : "at most", schema->most);
        orl_json_fail(err, ORL_ERR_RANGE, path, "it must be %s%s%s", low,
                      has_low && has_high ? " and " : "", high);
    }
    if (schema->meaning)
        orl_error_hint(err, "%s", schema->meaning);
    return ORL_ERR_RANGE;
}

static int decode_real(const json_t *value, const char *path, const struct orl_json_schema *schema,
                       double *ret_value, struct orl_error *err)
{
    double real = 0;
    const int rc = orl_json_real(value, path, &real, err);
    if (rc)
        return rc;
    if (real < schema->least || real > schema->most || (schema->above && real <= schema->least) ||
        (schema->below && real >= schema->most))
        return out_of_bounds(path, schema, err);
    *ret_value = real;
    return 0;
}

static int decode_whole(const json_t *value, const char *path, const struct orl_json_schema *schema,
                        const struct orl_json_member *m, struct orl_error *err)
{
    uint64_t whole = 0;
    const int rc = orl_json_whole(value, path, schema->from, schema->to, &whole, err);
    if (rc == ORL_ERR_RANGE && schema->meaning)
        orl_error_hint(err, "%s", schema->meaning);
    if (rc)
        return rc;
    if (m->whole)
        *m->whole = whole;
    else if (m->whole_32)
        *m->whole_32 = (uint32_t)whole;
    else
        *m->whole_int = (int)whole;
    return 0;
}

int orl_json_text_of(const json_t *value, const char *path, const struct orl_json_schema *schema,
                     char **ret_text, struct orl_error *err)
{
    return orl_json_string(value, path, schema->longest, ret_text, err);
}

int orl_json_value(const json_t *value, const char *path, const struct orl_json_schema *schema,
                   const struct orl_json_member *m, struct orl_error *err)
{
    if (m->real)
        return decode_real(value, path, schema, m->real, err);
    if (m->whole || m->whole_32 || m->whole_int)
        return decode_whole(value, path, schema, m, err);
    if (m->flag)
        return decode_bool(value, path, m->flag, err);
    if (m->text)
        return orl_json_text_of(value, path, schema, m->text, err);
    if (m->word)
        return orl_json_word(value, path, schema->words, m->word, err);
    if (m->members)
        return orl_json_members(value, path, schema, m->members, err);
    if (m->list)
        return orl_json_list(value, path, schema, m->list, err);
    return m->decode ? m->decode(value, path, m->into, err) : 0;
}

static const struct orl_json_described *find_described(const struct orl_json_schema *schema,
                                                       const char *name)
{
    const struct orl_json_described *described = schema->members;
    while (described && described->name && strcmp(described->name, name) != 0)
        described++;
    return described && described->name ? described : NULL;
}

int orl_json_member(const json_t *object, const char *path, const struct orl_json_schema *schema,
                    const struct orl_json_member *row, struct orl_error *err)
{
    char at[ORL_JSON_PATH_MAX];
    const json_t *member = json_object_get(object, row->name);
    const struct orl_json_described *described = find_described(schema, row->name);
    orl_json_path(path, row->name, at);
    if (!described)
        return orl_json_fail(err, ORL_ERR_INTERNAL, at, "the member has no description");
    return member || row->required || described->required
               ? orl_json_value(member, at, described->schema, row, err)
               : 0;
}

int orl_json_members(const json_t *value, const char *path, const struct orl_json_schema *schema,
                     const struct orl_json_member *members, struct orl_error *err)
{
    if (!json_is_object(value))
        return orl_json_wrong_type(value, *path ? path : "document", "an object", err);
    const char *name;
    json_t *member;
    /* json_object_foreach needs a non-const object but does not change it. */
    json_object_foreach((json_t *)(uintptr_t)value, name, member)
    {
        if (!is_known(name, members))
            return unknown_member(path, name, members, err);
    }
    int rc = 0;
    for (; members->name && rc == 0; members++)
        rc = orl_json_member(value, path, schema, members, err);
    return rc;
}

/* Decodes one element of an array. */
static int decode_element(const json_t *value, const char *path, size_t index,
                          orl_json_decoder *decode, void *into, struct orl_error *err)
{
    enum { ELEMENTS_A_POLL = 1024 };
    char at[ORL_JSON_PATH_MAX];
    const int rc = index % ELEMENTS_A_POLL == 0 ? poll_cancel(err) : 0;
    if (rc)
        return rc;
    snprintf(at, sizeof at, "%.120s[%zu]", path, index);
    return decode(json_array_get(value, index), at, into, err);
}

int orl_json_array_of(const json_t *value, const char *path, const struct orl_json_schema *schema,
                      struct orl_error *err)
{
    const size_t count = json_array_size(value);
    const int rc = orl_json_array(value, path, schema->most_items, err);
    if (rc || count >= schema->fewest_items)
        return rc;
    if (count == 0)
        orl_json_fail(err, ORL_ERR_INVALID, path, "the list is empty");
    else
        orl_json_fail(err, ORL_ERR_INVALID, path, "%zu elements; at least %zu are expected", count,
                      schema->fewest_items);
    if (schema->meaning)
        orl_error_hint(err, "%s", schema->meaning);
    return ORL_ERR_INVALID;
}

int orl_json_each(const json_t *value, const char *path, const struct orl_json_schema *schema,
                  orl_json_decoder *each, void *into, struct orl_error *err)
{
    int rc = orl_json_array_of(value, path, schema, err);
    for (size_t i = 0; rc == 0 && i < json_array_size(value); i++)
        rc = decode_element(value, path, i, each, into, err);
    return rc;
}

int orl_json_list(const json_t *value, const char *path, const struct orl_json_schema *schema,
                  const struct orl_json_list *list, struct orl_error *err)
{
    const size_t count = json_array_size(value);
    int rc = orl_json_array_of(value, path, schema, err);
    if (rc)
        return rc;
    char *items = calloc(count ? count : 1, list->size);
    if (!items)
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory for %zu elements", count);
    memcpy(list->items, &items, sizeof items);
    for (size_t i = 0; rc == 0 && i < count; i++) {
        *list->count = i + 1;
        rc = decode_element(value, path, i, list->each, items + i * list->size, err);
    }
    return rc;
}
