/* Reads replies leniently: an absent or mistyped member gives the default. */
#ifndef ORL_CLIENT_HTTP_JSON_GET_H
#define ORL_CLIENT_HTTP_JSON_GET_H

#include <stdbool.h>

#include <jansson.h>

static inline const char *orl_get_text(const json_t *object, const char *key)
{
    const char *text = json_string_value(json_object_get(object, key));

    return text ? text : "";
}

static inline double orl_get_number(const json_t *object, const char *key, double otherwise)
{
    const json_t *value = json_object_get(object, key);

    return json_is_number(value) ? json_number_value(value) : otherwise;
}

static inline bool orl_get_true(const json_t *object, const char *key)
{
    return json_is_true(json_object_get(object, key));
}

#endif
