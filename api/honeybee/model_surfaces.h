/*
 * Writes a model's rooms, faces, apertures, doors and shades to its scene and aperture files,
 * and collects dynamic ones in groups.
 */
#ifndef ORL_API_HONEYBEE_MODEL_SURFACES_H
#define ORL_API_HONEYBEE_MODEL_SURFACES_H

#include "honeybee/aperture_groups.h"

int orl_hb_surfaces_write(struct orl_hb *hb, struct orl_hb_groups *groups);

#endif
