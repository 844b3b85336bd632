#include "honeybee/modifiers.h"

#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include <oriel/base/array.h>
#include <oriel/base/limits.h>

static const struct {
    const char *identifier, *type;
    size_t n;
    double values[7];
} generics[] = {
    {"generic_floor_0.20", "plastic", 5, {0.2, 0.2, 0.2}},
    {"generic_wall_0.50", "plastic", 5, {0.5, 0.5, 0.5}},
    {"generic_ceiling_0.80", "plastic", 5, {0.8, 0.8, 0.8}},
    {"generic_opaque_door_0.50", "plastic", 5, {0.5, 0.5, 0.5}},
    {"generic_interior_shade_0.50", "plastic", 5, {0.5, 0.5, 0.5}},
    {"generic_exterior_shade_0.35", "plastic", 5, {0.35, 0.35, 0.35}},
    {"generic_context_0.20", "plastic", 5, {0.2, 0.2, 0.2}},
    {"generic_interior_window_vis_0.88",
     "glass",
     3,
     {0.9584154328610596, 0.9584154328610596, 0.9584154328610596}},
    {"generic_exterior_window_vis_0.64",
     "glass",
     3,
     {0.6975761815384331, 0.6975761815384331, 0.6975761815384331}},
    {"air_boundary", "trans", 7, {1, 1, 1, 0, 0, 1, 1}},
    {"black", "plastic", 5, {0}},
    {"white_glow", "glow", 4, {1, 1, 1, 0}},
};

/* ---- Look-up --------------------------------------------------------------------------------- */

static int add_modifier(struct orl_hb *hb, const char *identifier, const json_t *json,
                        size_t *ret_index)
{
    if (!orl_array_reserve(&hb->modifiers, &hb->modifier_room, hb->n_modifiers,
                           sizeof *hb->modifiers))
        return orl_error_no_memory(hb->err);
    *ret_index = hb->n_modifiers;
    hb->modifiers[hb->n_modifiers] =
        (struct orl_hb_modifier){.identifier = identifier, .json = json};
    return json_object_set_new(hb->modifier_indices, identifier,
                               json_integer((json_int_t)hb->n_modifiers++))
               ? orl_error_no_memory(hb->err)
               : 0;
}

/* Adds a modifier of the document. If an identifier occurs several times outside the list, the
 * first modifier counts. */
static int add_own(struct orl_hb *hb, const json_t *json, const struct orl_hb_at *at, bool in_list,
                   size_t *ret_index)
{
    const struct orl_hb_at named = {at, "identifier", 0};
    const char *identifier = NULL;
    if (!json_is_object(json))
        return orl_hb_fail(at, hb->err, ORL_ERR_INVALID, "a modifier is expected here");
    int rc = orl_hb_identifier(hb, json_object_get(json, "identifier"), &named, &identifier);
    if (rc)
        return rc;
    const json_t *known = json_object_get(hb->modifier_indices, identifier);
    if (!known)
        return add_modifier(hb, identifier, json, ret_index);
    *ret_index = (size_t)json_integer_value(known);
    if (!hb->modifiers[*ret_index].json)
        orl_hb_warn(hb,
                    "modifier '%.100s': an object defines it with the identifier of Honeybee's "
                    "generic modifier; the generic one is used",
                    identifier);
    else if (!json_equal(hb->modifiers[*ret_index].json, json))
        orl_hb_warn(hb,
                    "modifier '%.100s': several different modifiers have this identifier; %s is "
                    "used for all",
                    identifier, in_list ? "the last in the list" : "the first");
    return 0;
}

int orl_hb_modifiers_read(struct orl_hb *hb)
{
    const struct orl_hb_at properties = {NULL, "properties", 0},
                           radiance = {&properties, "radiance", 0};
    struct orl_hb_walk modifiers;
    size_t index = 0;
    hb->modifier_indices = json_object();
    if (!hb->modifier_indices)
        return orl_error_no_memory(hb->err);
    int rc = orl_hb_walk(hb, orl_hb_radiance(hb->model), &radiance, "modifiers", &modifiers);
    for (const json_t *modifier; rc == 0 && (modifier = orl_hb_next(&modifiers));) {
        rc = add_own(hb, modifier, &modifiers.here, true, &index);
        if (rc == 0)
            hb->modifiers[index].json = modifier; /* the last in the list counts, as in Honeybee */
    }
    for (size_t i = 0; i < sizeof generics / sizeof *generics && rc == 0; i++)
        if (!json_object_get(hb->modifier_indices, generics[i].identifier))
            rc = add_modifier(hb, generics[i].identifier, NULL, &index);
    return rc;
}

void orl_hb_modifiers_done(struct orl_hb *hb)
{
    free(hb->modifiers);
    json_decref(hb->modifier_indices);
    json_decref(hb->modifier_sets);
}

int orl_hb_modifier_find(struct orl_hb *hb, const json_t *value, const struct orl_hb_at *at,
                         size_t *ret_index)
{
    const char *identifier = json_string_value(value);
    const json_t *index = json_object_get(hb->modifier_indices, identifier ? identifier : "");
    if (json_is_object(value))
        return add_own(hb, value, at, false, ret_index);
    if (!identifier)
        return orl_hb_fail(at, hb->err, ORL_ERR_INVALID,
                           "a modifier's identifier is expected here");
    if (index) {
        *ret_index = (size_t)json_integer_value(index);
        return 0;
    }
    orl_hb_fail(at, hb->err, ORL_ERR_INVALID, "the model has no modifier '%.100s'", identifier);
    orl_error_hint(hb->err, "Add it to properties.radiance.modifiers");
    return ORL_ERR_INVALID;
}

size_t orl_hb_modifier_generic(const struct orl_hb *hb, const char *identifier)
{
    return (size_t)json_integer_value(json_object_get(hb->modifier_indices, identifier));
}

const char *orl_hb_type_of(const json_t *json)
{
    const char *type = json_string_value(json_object_get(json, "type"));
    return type ? type : "";
}

bool orl_hb_modifier_is_void(const struct orl_hb *hb, size_t index)
{
    const json_t *json = hb->modifiers[index].json;
    return json && strcasecmp(orl_hb_type_of(json), "Void") == 0;
}

void orl_hb_generic_write(const struct orl_hb_modifier *modifier, FILE *stream)
{
    size_t i = 0;
    while (strcmp(generics[i].identifier, modifier->identifier) != 0)
        i++;
    fprintf(stream, "void %s %s\n0\n0\n%zu", generics[i].type, modifier->identifier, generics[i].n);
    for (size_t k = 0; k < generics[i].n; k++)
        fprintf(stream, " %.17g", generics[i].values[k]);
    fputs("\n\n", stream);
}

static const struct {
    const char *part, *member, *generic;
} uses[] = {
    [ORL_HB_WALL] = {"wall_set", "exterior_modifier", "generic_wall_0.50"},
    [ORL_HB_WALL_INSIDE] = {"wall_set", "interior_modifier", "generic_wall_0.50"},
    [ORL_HB_FLOOR] = {"floor_set", "exterior_modifier", "generic_floor_0.20"},
    [ORL_HB_FLOOR_INSIDE] = {"floor_set", "interior_modifier", "generic_floor_0.20"},
    [ORL_HB_ROOF] = {"roof_ceiling_set", "exterior_modifier", "generic_ceiling_0.80"},
    [ORL_HB_ROOF_INSIDE] = {"roof_ceiling_set", "interior_modifier", "generic_ceiling_0.80"},
    [ORL_HB_WINDOW] = {"aperture_set", "window_modifier", "generic_exterior_window_vis_0.64"},
    [ORL_HB_WINDOW_INSIDE] = {"aperture_set", "interior_modifier",
                              "generic_interior_window_vis_0.88"},
    [ORL_HB_SKYLIGHT] = {"aperture_set", "skylight_modifier", "generic_exterior_window_vis_0.64"},
    [ORL_HB_OPERABLE] = {"aperture_set", "operable_modifier", "generic_exterior_window_vis_0.64"},
    [ORL_HB_DOOR] = {"door_set", "exterior_modifier", "generic_opaque_door_0.50"},
    [ORL_HB_DOOR_INSIDE] = {"door_set", "interior_modifier", "generic_opaque_door_0.50"},
    [ORL_HB_GLASS_DOOR] = {"door_set", "exterior_glass_modifier",
                           "generic_exterior_window_vis_0.64"},
    [ORL_HB_GLASS_DOOR_INSIDE] = {"door_set", "interior_glass_modifier",
                                  "generic_interior_window_vis_0.88"},
    [ORL_HB_OVERHEAD_DOOR] = {"door_set", "overhead_modifier", "generic_opaque_door_0.50"},
    [ORL_HB_SHADE] = {"shade_set", "exterior_modifier", "generic_exterior_shade_0.35"},
    [ORL_HB_SHADE_INSIDE] = {"shade_set", "interior_modifier", "generic_interior_shade_0.50"},
    [ORL_HB_CONTEXT] = {"", "", "generic_context_0.20"},
};

int orl_hb_sets_read(struct orl_hb *hb)
{
    const struct orl_hb_at properties = {NULL, "properties", 0},
                           radiance = {&properties, "radiance", 0};
    struct orl_hb_walk sets;
    hb->modifier_sets = json_object();
    if (!hb->modifier_sets)
        return orl_error_no_memory(hb->err);
    int rc = orl_hb_walk(hb, orl_hb_radiance(hb->model), &radiance, "modifier_sets", &sets);
    for (json_t *set; rc == 0 && (set = orl_hb_next(&sets));) {
        const struct orl_hb_at named = {&sets.here, "identifier", 0};
        const char *identifier = json_string_value(json_object_get(set, "identifier"));
        if (!identifier)
            rc = orl_hb_fail(&named, hb->err, ORL_ERR_INVALID, "an identifier is expected here");
        else if (json_object_set(hb->modifier_sets, identifier, set))
            rc = orl_error_no_memory(hb->err);
    }
    return rc;
}

int orl_hb_set_of_room(struct orl_hb *hb, const json_t *room, const struct orl_hb_at *at,
                       const json_t **ret_set)
{
    const struct orl_hb_at properties = {at, "properties", 0},
                           radiance = {&properties, "radiance", 0},
                           here = {&radiance, "modifier_set", 0};
    const json_t *named = orl_hb_get(orl_hb_radiance(room), "modifier_set");
    *ret_set = NULL;
    if (!named)
        return 0;
    *ret_set = json_is_object(named) ? named
               : json_is_string(named)
                   ? json_object_get(hb->modifier_sets, json_string_value(named))
                   : NULL;
    return *ret_set
               ? 0
               : orl_hb_fail(&here, hb->err, ORL_ERR_INVALID, "the model has no such modifier set");
}

int orl_hb_set_modifier(struct orl_hb *hb, const json_t *set, enum orl_hb_surface_use use,
                        size_t *ret_index)
{
    const json_t *value = orl_hb_get(orl_hb_get(set, uses[use].part), uses[use].member);
    const char *identifier = json_string_value(json_object_get(set, "identifier"));
    const struct orl_hb_at whole = {NULL, identifier ? identifier : "modifier_set", 0},
                           part = {&whole, uses[use].part, 0}, at = {&part, uses[use].member, 0};
    if (value)
        return orl_hb_modifier_find(hb, value, &at, ret_index);
    *ret_index = orl_hb_modifier_generic(hb, uses[use].generic);
    return 0;
}
