#include "scene/parse/gltf/gltf_json.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>

int orl_gltf_fail(const struct orl_gltf_item *at, int code, struct orl_error *err,
                  const char *format, ...)
{
    va_list args;
    va_start(args, format);
    orl_error_vset(err, code, format, args);
    va_end(args);
    orl_error_hint(err, "the file is damaged, or what wrote it is at fault: export it again");
    orl_error_at(err, at->file, 0, at->name);
    return code;
}

int orl_gltf_find(const struct orl_gltf_item *at, const char *list, size_t index,
                  struct orl_gltf_item *ret_item, struct orl_error *err)
{
    const json_t *const object = json_array_get(json_object_get(at->root, list), index);
    if (!json_is_object(object))
        return orl_gltf_fail(at, ORL_ERR_SYNTAX, err, "there is no %s[%zu], which is named here",
                             list, index);
    *ret_item = (struct orl_gltf_item){at->file, at->root, object, ""};
    snprintf(ret_item->name, sizeof ret_item->name, "%s[%zu]", list, index);
    return 0;
}

static void name_inner(const struct orl_gltf_item *at, const char *key,
                       struct orl_gltf_item *ret_inner)
{
    *ret_inner = (struct orl_gltf_item){at->file, at->root, json_object_get(at->object, key), ""};
    snprintf(ret_inner->name, sizeof ret_inner->name, "%.50s%s%.30s", at->name,
             at->name[0] ? "." : "", key);
}

int orl_gltf_element(const struct orl_gltf_item *at, const char *list, size_t index,
                     struct orl_gltf_item *ret_part, struct orl_error *err)
{
    struct orl_gltf_item all;
    name_inner(at, list, &all);
    *ret_part = (struct orl_gltf_item){at->file, at->root, json_array_get(all.object, index), ""};
    snprintf(ret_part->name, sizeof ret_part->name, "%.70s[%zu]", all.name, index);
    return json_is_object(ret_part->object)
               ? 0
               : orl_gltf_fail(ret_part, ORL_ERR_SYNTAX, err, "an object is wanted here");
}

int orl_gltf_member(const struct orl_gltf_item *at, const char *key,
                    struct orl_gltf_item *ret_inner, struct orl_error *err)
{
    name_inner(at, key, ret_inner);
    return !ret_inner->object || json_is_object(ret_inner->object)
               ? 0
               : orl_gltf_fail(ret_inner, ORL_ERR_SYNTAX, err, "an object is wanted here");
}

int orl_gltf_length(const struct orl_gltf_item *at, const char *list, size_t *ret_length,
                    struct orl_error *err)
{
    struct orl_gltf_item all;
    name_inner(at, list, &all);
    *ret_length = json_array_size(all.object);
    return !all.object || json_is_array(all.object)
               ? 0
               : orl_gltf_fail(&all, ORL_ERR_SYNTAX, err, "a list is wanted here");
}

static bool read_whole(const json_t *value, size_t *ret_value)
{
    const double number = json_number_value(value);
    if (!json_is_number(value) || !(number >= 0 && number <= 0x1p53) || number != floor(number))
        return false;
    *ret_value = (size_t)number;
    return true;
}

int orl_gltf_integer(const struct orl_gltf_item *at, const char *key, size_t *value,
                     struct orl_error *err)
{
    const json_t *const member = json_object_get(at->object, key);
    return !member || read_whole(member, value)
               ? 0
               : orl_gltf_fail(at, ORL_ERR_SYNTAX, err, "'%s' is no whole number from 0 on", key);
}

int orl_gltf_integer_in_list(const struct orl_gltf_item *at, const char *list, size_t i,
                             size_t *ret_value, struct orl_error *err)
{
    const json_t *const member = json_array_get(json_object_get(at->object, list), i);
    return read_whole(member, ret_value)
               ? 0
               : orl_gltf_fail(at, ORL_ERR_SYNTAX, err,
                               "'%s' has a member that is no whole number from 0 on", list);
}

int orl_gltf_numbers(const struct orl_gltf_item *at, const char *key, size_t n, double *values,
                     bool *ret_given, struct orl_error *err)
{
    const json_t *const array = json_object_get(at->object, key);
    bool sound = json_is_array(array) && json_array_size(array) == n;
    *ret_given = array != NULL;
    for (size_t i = 0; sound && i < n; i++) {
        const json_t *const value = json_array_get(array, i);
        sound = json_is_number(value);
        values[i] = json_number_value(value);
    }
    return !array || sound
               ? 0
               : orl_gltf_fail(at, ORL_ERR_SYNTAX, err, "'%s' is not %zu numbers", key, n);
}

const char *orl_gltf_text(const struct orl_gltf_item *at, const char *key)
{
    return json_string_value(json_object_get(at->object, key));
}
