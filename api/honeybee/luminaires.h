/*
 * Luminaires of a model: IES files, and where each of them hangs, as Honeybee has ies2rad and xform
 * place them. All of them are in model/ies/luminaires.rad.
 */
#ifndef ORL_API_HONEYBEE_LUMINAIRES_H
#define ORL_API_HONEYBEE_LUMINAIRES_H

#include "honeybee/writing.h"

int orl_hb_luminaires_write(struct orl_hb *hb);

#endif
