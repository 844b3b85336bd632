#include "honeybee/model_objects.h"

#include <stdlib.h>
#include <string.h>

#include <oriel/base/array.h>

#include "honeybee/modifiers.h"

static const char *const folders[] = {"model/aperture_group", "model/scene_dynamic",
                                      "model/scene_dynamic/indoor"};
enum { FOLDERS = sizeof folders / sizeof *folders };

static size_t folder_of(const struct orl_hb_group *group)
{
    return !group->shades ? 0 : group->inside ? 2 : 1;
}

/* ---- Collecting ------------------------------------------------------------------------------ */

void orl_hb_groups_done(struct orl_hb_groups *groups)
{
    for (size_t i = 0; i < groups->count; i++)
        free(groups->items[i].members);
    free(groups->items);
    json_decref(groups->group_index);
}

static int find_group(struct orl_hb *hb, struct orl_hb_groups *groups, const char *identifier,
                      bool shade, struct orl_hb_group **ret_group)
{
    char key[128];
    snprintf(key, sizeof key, "%s %s", shade ? "shade" : "window", identifier);
    const json_t *index = json_object_get(groups->group_index, key);
    if (index) {
        *ret_group = &groups->items[json_integer_value(index)];
        return 0;
    }
    if (!orl_array_reserve(&groups->items, &groups->room, groups->count, sizeof *groups->items))
        return orl_error_no_memory(hb->err);
    if (!groups->group_index)
        groups->group_index = json_object();
    if (json_object_set_new(groups->group_index, key, json_integer((json_int_t)groups->count)))
        return orl_error_no_memory(hb->err);
    *ret_group = &groups->items[groups->count++];
    **ret_group = (struct orl_hb_group){.identifier = identifier, .shades = shade, .inside = shade};
    return 0;
}

int orl_hb_groups_add(struct orl_hb *hb, struct orl_hb_groups *groups,
                      const struct orl_hb_member *member, bool shade, bool inside,
                      const struct orl_hb_at *at, bool *ret_is_dynamic)
{
    const struct orl_hb_at properties = {at, "properties", 0},
                           radiance = {&properties, "radiance", 0},
                           here = {&radiance, "dynamic_group_identifier", 0};
    const json_t *named = orl_hb_get(orl_hb_radiance(member->json), "dynamic_group_identifier");
    struct orl_hb_group *group = NULL;
    const char *identifier = NULL;
    *ret_is_dynamic = named;
    if (!named)
        return 0;
    int rc = orl_hb_identifier(hb, named, &here, &identifier);
    if (rc == 0)
        rc = find_group(hb, groups, identifier, shade, &group);
    if (rc || !group)
        return rc;
    if (!orl_array_reserve(&group->members, &group->room, group->count, sizeof *group->members))
        return orl_error_no_memory(hb->err);
    group->members[group->count++] = *member;
    group->inside = group->inside && inside;
    return 0;
}

/* ---- Writing --------------------------------------------------------------------------------- */

static const json_t *states_of(const json_t *object)
{
    return orl_hb_get(orl_hb_radiance(object), "states");
}

static size_t count_states(const struct orl_hb_group *group)
{
    size_t most = 1;
    for (size_t i = 0; i < group->count; i++) {
        const size_t n = json_array_size(states_of(group->members[i].json));
        most = n > most ? n : most;
    }
    return most;
}

/* Writes a polygon with its modifier; a void surface is not written. */
static int write_surface(struct orl_hb *hb, const struct orl_hb_member *surface,
                         const struct orl_hb_at *at, struct orl_hb_polygon *polygon,
                         struct orl_hb_file *file)
{
    const size_t modifier = surface->modifier;
    const char *name = json_string_value(json_object_get(surface->json, "identifier"));
    int rc = orl_hb_polygon_read(hb, json_object_get(surface->json, "geometry"), at, polygon);
    if (rc || orl_hb_modifier_is_void(hb, modifier))
        return rc;
    orl_hb_polygon_orient(polygon, surface->front);
    rc = orl_hb_modifier_write(hb, modifier, file);
    return rc ? rc
              : orl_hb_polygon_write(hb, polygon, hb->modifiers[modifier].identifier,
                                     name ? name : "unnamed", file);
}

/* Writes the additional shades of a state, such as louvres or a film of snow. */
static int write_state_shades(struct orl_hb *hb, const json_t *state, const struct orl_hb_at *at,
                              struct orl_hb_polygon *polygon, struct orl_hb_file *file)
{
    struct orl_hb_walk shades;
    int rc = orl_hb_walk(hb, state, at, "shades", &shades);
    for (const json_t *shade; rc == 0 && (shade = orl_hb_next(&shades));) {
        const struct orl_hb_at in = {&shades.here, "modifier", 0};
        const json_t *named = orl_hb_get(shade, "modifier");
        struct orl_hb_member surface = {
            .json = shade, .modifier = orl_hb_modifier_generic(hb, "generic_exterior_shade_0.35")};
        if (named)
            rc = orl_hb_modifier_find(hb, named, &in, &surface.modifier);
        if (rc == 0)
            rc = write_surface(hb, &surface, &shades.here, polygon, file);
    }
    return rc;
}

/* Writes an object in one of its group's states. If it has fewer states, its last one is used. */
static int write_member(struct orl_hb *hb, const struct orl_hb_member *member, size_t number,
                        struct orl_hb_polygon *polygon, struct orl_hb_file *file)
{
    const json_t *states = states_of(member->json);
    const char *name = json_string_value(json_object_get(member->json, "identifier"));
    const struct orl_hb_at at = {NULL, name ? name : "unnamed", 0}, list = {&at, "states", 0};
    const size_t n = json_array_size(states), index = number < n ? number : n - 1;
    const struct orl_hb_at here = {&list, NULL, index}, in = {&here, "modifier", 0};
    const json_t *state = n > 0 ? json_array_get(states, index) : NULL;
    const json_t *named = orl_hb_get(state, "modifier");
    struct orl_hb_member surface = *member;
    int rc = 0;
    if (states && !json_is_array(states))
        return orl_hb_fail(&list, hb->err, ORL_ERR_INVALID, "a list is expected here");
    if (named)
        rc = orl_hb_modifier_find(hb, named, &in, &surface.modifier);
    if (rc == 0)
        rc = write_surface(hb, &surface, &at, polygon, file);
    return rc ? rc : write_state_shades(hb, state, &here, polygon, file);
}

static int write_state(struct orl_hb *hb, const struct orl_hb_group *group, size_t number,
                       struct orl_hb_polygon *polygon)
{
    struct orl_hb_file file;
    int rc = orl_hb_begin(hb, &file);
    if (rc)
        return rc;
    fprintf(file.stream, "# state %zu of %s\n\n", number, group->identifier);
    for (size_t i = 0; i < group->count && rc == 0; i++)
        rc = write_member(hb, &group->members[i], number, polygon, &file);
    if (rc) {
        orl_hb_discard(&file);
        return rc;
    }
    return orl_hb_end(hb, &file, "%s/%s..default..%zu.rad", folders[folder_of(group)],
                      group->identifier, number);
}

static void list_states(const struct orl_hb_group *group, const char *between, FILE *stream)
{
    const size_t n = count_states(group);
    fprintf(stream, "%s\n  \"%s\": [", between, group->identifier);
    for (size_t i = 0; i < n; i++)
        fprintf(stream,
                "%s\n    {\"identifier\": \"%zu_%s\", \"default\": \"./%s..default..%zu.rad\"}",
                i ? "," : "", i, group->identifier, group->identifier, i);
    fputs("]", stream);
}

static int write_lists(struct orl_hb *hb, const struct orl_hb_groups *groups)
{
    int rc = 0;
    for (size_t k = 0; k < FOLDERS && rc == 0; k++) {
        struct orl_hb_file file;
        size_t listed = 0;
        rc = orl_hb_begin(hb, &file);
        if (rc)
            return rc;
        for (size_t i = 0; i < groups->count; i++)
            if (folder_of(&groups->items[i]) == k)
                list_states(&groups->items[i], listed++ > 0 ? "," : "{", file.stream);
        if (listed > 0)
            fputs("\n}\n", file.stream);
        rc = orl_hb_end(hb, &file, "%s/states.json", folders[k]);
    }
    return rc;
}

int orl_hb_groups_write(struct orl_hb *hb, const struct orl_hb_groups *groups)
{
    struct orl_hb_polygon polygon = {0};
    int rc = 0;
    for (size_t i = 0; i < groups->count && rc == 0; i++) {
        const size_t n = count_states(&groups->items[i]);
        for (size_t k = 0; k < n && rc == 0; k++)
            rc = write_state(hb, &groups->items[i], k, &polygon);
    }
    orl_hb_polygon_done(&polygon);
    return rc ? rc : write_lists(hb, groups);
}
