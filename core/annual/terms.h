/*
 * Each sun (hours.h) as a sum over nodes and beams (sun_map.h): by place between nodes; of
 * beams also by how much more or less the ports let in from there than from the nodes, so that the
 * cosine at a window, and what its pane does with it, is the hour's own.
 *
 * Immutable once made.
 */
#ifndef ORL_ANNUAL_TERMS_H
#define ORL_ANNUAL_TERMS_H

#include "annual/hours.h"
#include "annual/nodes.h"
#include "annual/sun_map.h"

struct orl_sun_terms {
    uint32_t *first; /* by sun, and one more: into the next ones */
    uint32_t *which; /* node, or the number of nodes plus the beam */
    float *weights;
    float *apart; /* by how much these differ from the wide interpolation's (nodes.h) */
};

/* map may be NULL. Returns 0, ORL_ERR_NOMEM or _CANCELLED; orl_sun_terms_done in either case. */
int orl_sun_terms_init(struct orl_sun_terms *terms, const struct orl_year_suns *suns,
                       const struct orl_sun_nodes *nodes, const struct orl_frame *node_frames,
                       const struct orl_sun_map *map, struct orl_crew *crew);
void orl_sun_terms_done(struct orl_sun_terms *terms);

#endif
