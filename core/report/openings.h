/*
 * What a view goes out by (oriel/view_out.h): which panes are clear, which ports belong to one
 * opening, and which surfaces are ground.
 */
#ifndef ORL_REPORT_OPENINGS_H
#define ORL_REPORT_OPENINGS_H

#include <oriel/view_out.h>

#include "light/scene.h"

struct orl_openings {
    const struct orl_scene *scene;        /* borrowed */
    const struct orl_view_out_wish *wish; /* borrowed */
    bool *clear, *ground; /* of each facet of the scene's own; owned, as what follows */
    uint32_t *of_port;    /* the opening that each port is of */
    size_t count;         /* of openings */
};

/* ORL_ERR_NOT_FOUND (a name is of nothing), ORL_ERR_NOMEM, ORL_ERR_CANCELLED. */
int orl_openings_find(const struct orl_view_out_wish *wish, const struct orl_scene *scene,
                      const atomic_bool *cancel, struct orl_openings *ret_openings,
                      struct orl_error *err);
/* Of any facet. */
bool orl_openings_is_ground(const struct orl_openings *openings, uint32_t facet);
void orl_openings_done(struct orl_openings *openings); /* zeros are fine */

#endif
