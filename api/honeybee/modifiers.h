/*
 * A model's modifiers, by identifier, and the generic ones that objects without a modifier have:
 * those of Honeybee's "Generic Interior Visible" set. Reflectances: walls, doors and indoor shades
 * 0.5, floors 0.2, ceilings and roofs 0.8, outdoor shades 0.35, context 0.2; transmittances at
 * normal incidence: exterior windows 0.64, interior ones 0.88.
 *
 * Supported types are Plastic, Metal, Trans, Glass, Mirror, Glow, Light, BSDF and aBSDF. Modifiers
 * that they depend on are written before them. Other types are refused by name.
 */
#ifndef ORL_API_HONEYBEE_MODIFIERS_H
#define ORL_API_HONEYBEE_MODIFIERS_H

#include "honeybee/hb_writer.h"

struct orl_hb_modifier {
    const char *identifier;
    const json_t *json;    /* NULL for a generic modifier */
    uint32_t written;      /* number of the last file that has it */
    bool is_being_written; /* true while it is being written, to detect circular dependencies */
    bool has_file;         /* true if its BSDF file is written */
};

/* Reads all modifiers of the model, and adds the generic ones. */
int orl_hb_modifiers_read(struct orl_hb *hb);
void orl_hb_modifiers_done(struct orl_hb *hb);

/* Finds a modifier given by an identifier of the model or by itself. *ret_index: its index in
 * hb->modifiers. */
int orl_hb_modifier_find(struct orl_hb *hb, const json_t *value, const struct orl_hb_at *at,
                         size_t *ret_index);
/* Returns the index of a generic modifier. */
size_t orl_hb_modifier_generic(const struct orl_hb *hb, const char *identifier);
bool orl_hb_modifier_is_void(const struct orl_hb *hb, size_t index);
/* Writes the modifier to the file, unless the file has it. */
int orl_hb_modifier_write(struct orl_hb *hb, size_t index, struct orl_hb_file *file);

/* ---- Shared by modifiers.c and modifier_text.c ----------------------------------------------- */

/* Returns the object's "type", or "". */
const char *orl_hb_type_of(const json_t *json);
/* Writes a generic modifier. */
void orl_hb_generic_write(const struct orl_hb_modifier *modifier, FILE *stream);

/*
 * Chooses the modifier of an object without one of its own: that of its room's set for the
 * object's use, or the generic one.
 */

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
