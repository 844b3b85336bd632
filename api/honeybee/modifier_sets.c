#include "honeybee/modifier_sets.h"

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
        return orl_error_set(hb->err, ORL_ERR_NOMEM, "out of memory");
    int rc = orl_hb_walk(hb, orl_hb_radiance(hb->model), &radiance, "modifier_sets", &sets);
    for (json_t *set; rc == 0 && (set = orl_hb_next(&sets));) {
        const struct orl_hb_at named = {&sets.here, "identifier", 0};
        const char *identifier = json_string_value(json_object_get(set, "identifier"));
        if (!identifier)
            rc = orl_hb_fail(&named, hb->err, ORL_ERR_INVALID, "an identifier is wanted here");
        else if (json_object_set(hb->modifier_sets, identifier, set))
            rc = orl_error_set(hb->err, ORL_ERR_NOMEM, "out of memory");
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
