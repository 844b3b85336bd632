#include "input/project_folder.h"

#include <stdbool.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>

#include <oriel/annual/annual_shades.h>

static int no_memory(struct orl_error *err)
{
    return orl_error_no_memory(err);
}

/* ---- Request --------------------------------------------------------------------------------- */

static bool any_names(const json_t *list, const char *what)
{
    const json_t *item;
    size_t i;
    json_array_foreach(list, i, item)
    {
        const char *text = json_string_value(item);
        if (text && strncasecmp(text, what, strlen(what)) == 0)
            return true;
    }
    return false;
}

/* Returns true if the document asks for sDA or LEED, which are defined for blinds drawn by
 * LM-83's rule. */
static bool asks_for_blinds(const json_t *doc)
{
    const char *verdict =
        json_string_value(json_object_get(json_object_get(doc, "accuracy"), "verdict"));
    return any_names(json_object_get(doc, "rules"), "LEED") ||
           any_names(json_object_get(doc, "targets"), "sDA") ||
           any_names(json_object_get(doc, "metrics"), "sDA") ||
           (verdict && strncasecmp(verdict, "sDA", strlen("sDA")) == 0);
}

/* ---- States ---------------------------------------------------------------------------------- */

static json_t *states_of(const json_t *group)
{
    const json_t *names = json_object_get(group, "of"), *files = json_object_get(group, "files"),
                 *name;
    json_t *states = json_array();
    size_t i;
    json_array_foreach(names, i, name)
    {
        json_array_append_new(
            states, json_pack("{s:O, s:[O]}", "name", name, "files", json_array_get(files, i)));
    }
    if (json_array_size(states) == json_array_size(names))
        return states;
    json_decref(states);
    return NULL;
}

static json_t *find_shade(json_t *shades, const char *group)
{
    json_t *shade;
    size_t i;
    json_array_foreach(shades, i, shade)
    {
        const char *name = json_string_value(json_object_get(shade, "name"));
        if (name && strcmp(name, group) == 0)
            return shade;
    }
    return NULL;
}

/* Returns true for a group of windows, false for a group of shades. */
static bool has_windows(const json_t *group)
{
    const char *file = json_string_value(json_array_get(json_object_get(group, "files"), 0));
    return file && strstr(file, "aperture_group/");
}

static json_t *make_shade(const char *name, const json_t *group, bool blinds)
{
    json_t *states = states_of(group),
           *shade = states ? json_pack("{s:s, s:o}", "name", name, "states", states) : NULL;
    if (shade && blinds && has_windows(group) &&
        json_object_set_new(shade, "control", json_pack("{s:s}", "by", "LM-83"))) {
        json_decref(shade);
        return NULL;
    }
    return shade;
}

static void print_shade(const char *name, const json_t *group, const json_t *shade)
{
    const json_t *of = json_object_get(group, "of");
    if (json_object_get(shade, "control"))
        fprintf(stderr, "group %s: closed to %s by LM-83's rule\n", name,
                json_string_value(json_array_get(of, 1)));
    else
        fprintf(stderr,
                "group %s: in %s all year; to change that, add a shade of that name with a "
                "\"schedule\", \"rules\" or a \"control\" to \"shades\"\n",
                name, json_string_value(json_array_get(of, 0)));
}

/* ---- Groups ---------------------------------------------------------------------------------- */

static int fill_group(const char *name, const json_t *group, bool blinds, json_t *shades,
                      struct orl_error *err)
{
    json_t *shade = find_shade(shades, name);
    if (shade && !json_object_get(shade, "states"))
        return json_object_set_new(shade, "states", states_of(group)) ? no_memory(err) : 0;
    if (shade)
        return 0;
    shade = make_shade(name, group, blinds);
    if (!shade || json_array_append_new(shades, shade))
        return no_memory(err);
    print_shade(name, group, shade);
    return 0;
}

/* Finds the document's shades, or creates an empty array. */
static int find_shades(json_t *doc, json_t **ret_shades, struct orl_error *err)
{
    json_t *shades = json_object_get(doc, "shades");
    if (shades && !json_is_array(shades))
        return orl_error_set(err, ORL_ERR_INVALID, "shades: a list is expected");
    *ret_shades = shades ? shades : json_array();
    if (!shades && json_object_set_new(doc, "shades", *ret_shades))
        return no_memory(err);
    return 0;
}

int orl_project_fill_shades(const json_t *states, const json_t *chosen, json_t *doc,
                            struct orl_error *err)
{
    const bool blinds = asks_for_blinds(doc);
    json_t *shades = NULL, *group;
    const char *name;
    int rc = find_shades(doc, &shades, err);
    json_object_foreach((json_t *)(uintptr_t)states, name, group)
    {
        const size_t n = json_array_size(json_object_get(group, "of"));
        if (n < 2 || json_object_get(chosen, name) ||
            (!find_shade(shades, name) && json_array_size(shades) >= ORL_SHADES_MOST_GROUPS))
            continue;
        rc = rc ? rc : fill_group(name, group, blinds, shades, err);
    }
    if (json_array_size(shades) == 0)
        json_object_del(doc, "shades");
    return rc;
}
