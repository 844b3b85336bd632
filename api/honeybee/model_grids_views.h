/* Writes a model's sensor grids and views, each to a file with its name. */
#ifndef ORL_API_HONEYBEE_MODEL_GRIDS_VIEWS_H
#define ORL_API_HONEYBEE_MODEL_GRIDS_VIEWS_H

#include "honeybee/hb_writer.h"

int orl_hb_grids_write(struct orl_hb *hb);
int orl_hb_views_write(struct orl_hb *hb);

#endif
