/*
 * A model's modifiers, by identifier, and the generic ones that objects without a modifier have:
 * those of Honeybee's "Generic Interior Visible" set. Reflectances: walls, doors and indoor shades
 * 0.5, floors 0.2, ceilings and roofs 0.8, outdoor shades 0.35, context 0.2; transmittances at
 * normal incidence: exterior windows 0.64, interior ones 0.88.
 *
 * Written are Plastic, Metal, Trans, Glass, Mirror, Glow, Light, BSDF and aBSDF, with the modifiers
 * that they depend on in front. Others are refused by name.
 */
#ifndef ORL_API_HONEYBEE_MODIFIERS_H
#define ORL_API_HONEYBEE_MODIFIERS_H

#include "honeybee/writing.h"

struct orl_hb_modifier {
    const char *identifier;
    const json_t *json; /* NULL: a generic one */
    uint32_t written;   /* the last file that has it */
    bool under_way;     /* being written: a modifier that depends on itself meets it again */
    bool has_file;      /* its BSDF is among the files */
};

/* All of the model, and the generic ones. */
int orl_hb_modifiers_read(struct orl_hb *hb);
void orl_hb_modifiers_done(struct orl_hb *hb);

/* An identifier of the model's, or the modifier itself: where it is in hb->modifiers. */
int orl_hb_modifier_find(struct orl_hb *hb, const json_t *value, const struct orl_hb_at *at,
                         size_t *ret_place);
/* A generic one. */
size_t orl_hb_modifier_generic(const struct orl_hb *hb, const char *identifier);
bool orl_hb_modifier_is_void(const struct orl_hb *hb, size_t place);
/* Into the file, unless it is there. */
int orl_hb_modifier_write(struct orl_hb *hb, size_t place, struct orl_hb_file *file);

/* ---- Shared by modifiers.c and modifier_text.c ----------------------------------------------- */

/* "type", or "". */
const char *orl_hb_type_of(const json_t *json);
/* One of the generic ones. */
void orl_hb_generic_write(const struct orl_hb_modifier *modifier, FILE *stream);

#endif
