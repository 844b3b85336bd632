/*
 * What can be known beforehand of a sun in a port: that nothing outside stands in its way, so that
 * emissions need no shadow ray; and tables of where the pane sends its light (scene/passage.h).
 */
#ifndef ORL_PHOTON_SUNWARD_H
#define ORL_PHOTON_SUNWARD_H

#include "photon/emit.h"

/* For all strata of suns in ports. Returns 0 or ORL_ERR_NOMEM. */
int orl_sunward_prepare(struct orl_emission *emission);
void orl_sunward_done(struct orl_emission *emission);

#endif
