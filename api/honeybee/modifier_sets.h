/*
 * Chooses the modifier of an object without one of its own: that of its room's set for the
 * object's use, or the generic one (modifiers.h).
 */
#ifndef ORL_API_HONEYBEE_MODIFIER_SETS_H
#define ORL_API_HONEYBEE_MODIFIER_SETS_H

#include "honeybee/modifiers.h"

/* Use of a surface. The second of a pair is for interior surfaces: between rooms, or in them. */
enum orl_hb_surface_use {
    ORL_HB_WALL,
    ORL_HB_WALL_INSIDE,
    ORL_HB_FLOOR,
    ORL_HB_FLOOR_INSIDE,
    ORL_HB_ROOF,
    ORL_HB_ROOF_INSIDE,
    ORL_HB_WINDOW,
    ORL_HB_WINDOW_INSIDE,
    ORL_HB_SKYLIGHT,
    ORL_HB_OPERABLE,
    ORL_HB_DOOR,
    ORL_HB_DOOR_INSIDE,
    ORL_HB_GLASS_DOOR,
    ORL_HB_GLASS_DOOR_INSIDE,
    ORL_HB_OVERHEAD_DOOR,
    ORL_HB_SHADE,
    ORL_HB_SHADE_INSIDE,
    ORL_HB_CONTEXT /* in no set; always generic */
};

/* Reads the model's sets by identifier, after its modifiers are read. */
int orl_hb_sets_read(struct orl_hb *hb);
/* Finds the set of a room; NULL if it has none. */
int orl_hb_set_of_room(struct orl_hb *hb, const json_t *room, const struct orl_hb_at *at,
                       const json_t **ret_set);
/* Finds the modifier for a use. set may be NULL. */
int orl_hb_set_modifier(struct orl_hb *hb, const json_t *set, enum orl_hb_surface_use use,
                        size_t *ret_index);

#endif
