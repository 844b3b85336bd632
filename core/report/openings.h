/*
 * Openings for view out (oriel/annual/view_out.h): the clear panes, the ports that form one
 * opening, and the surfaces that are ground.
 */
#ifndef ORL_REPORT_OPENINGS_H
#define ORL_REPORT_OPENINGS_H

#include <oriel/annual/view_out.h>

#include "scene/built/scene.h"

struct orl_openings {
    const struct orl_scene *scene;                       /* borrowed */
    const struct orl_view_out_request *view_out_request; /* borrowed */
    bool *clear, *ground; /* by facet that is not instanced; owned, like of_port */
    uint32_t *of_port;    /* opening to which each port belongs */
    size_t count;         /* number of openings */
};

/* Finds the openings and the ground. Returns 0, ORL_ERR_NOT_FOUND (a name that nothing has),
 * ORL_ERR_NOMEM or ORL_ERR_CANCELLED. */
int orl_openings_find(const struct orl_view_out_request *view_out_request,
                      const struct orl_scene *scene, const atomic_bool *cancel,
                      struct orl_openings *ret_openings, struct orl_error *err);
/* Returns true if the facet is ground; instanced facets are allowed. */
bool orl_openings_is_ground(const struct orl_openings *openings, uint32_t facet);
void orl_openings_done(struct orl_openings *openings); /* zeros are allowed */

#endif
