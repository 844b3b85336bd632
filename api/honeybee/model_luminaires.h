/*
 * Writes a model's luminaires: IES files and their placements, by ies2rad and xform as in
 * Honeybee. All are in model/ies/luminaires.rad.
 */
#ifndef ORL_API_HONEYBEE_MODEL_LUMINAIRES_H
#define ORL_API_HONEYBEE_MODEL_LUMINAIRES_H

#include "honeybee/hb_writer.h"

int orl_hb_luminaires_write(struct orl_hb *hb);

#endif
