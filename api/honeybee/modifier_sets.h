/*
 * Which modifier an object without one of its own has: by what it is, that of its room's set, or
 * the generic one (modifiers.h).
 */
#ifndef ORL_API_HONEYBEE_MODIFIER_SETS_H
#define ORL_API_HONEYBEE_MODIFIER_SETS_H

#include "honeybee/modifiers.h"

/* What a surface is; of pairs the second is of surfaces inside: between rooms, or in them. */
enum orl_hb_use {
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
    ORL_HB_CONTEXT /* in no set: generic */
};

/* The model's sets by identifier, once its modifiers are read. */
int orl_hb_sets_read(struct orl_hb *hb);
/* The set of a room; NULL: it has none. */
int orl_hb_set_of_room(struct orl_hb *hb, const json_t *room, const struct orl_hb_at *at,
                       const json_t **ret_set);
/* set may be NULL. */
int orl_hb_set_modifier(struct orl_hb *hb, const json_t *set, enum orl_hb_use use,
                        size_t *ret_place);

#endif
