/* Viewpoints: named positions of people with their view directions. */
#ifndef ORIEL_ANNUAL_VIEWPOINT_H
#define ORIEL_ANNUAL_VIEWPOINT_H

#include <stddef.h>

#include <oriel/base/vec.h>

struct orl_viewpoint {
    char *name;                  /* owned */
    struct orl_vec3 at, towards; /* scene units; `towards` need not be unit */
};

/* Most viewpoints in a request; and viewpoints whose views are in memory together
 * (annual/viewpoints/viewpoints.c). */
enum { ORL_GLARE_MOST_VIEWPOINTS = 256, ORL_GLARE_VIEWPOINTS_AT_ONCE = 4 };
struct orl_viewpoint_request {
    struct orl_viewpoint *viewpoints; /* owned; none: no glare is computed */
    size_t n_viewpoints;
};
void orl_viewpoint_request_done(
    struct orl_viewpoint_request *viewpoint_request); /* zeros are fine */

#endif
