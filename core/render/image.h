/*
 * One view by the gather technique: irradiance records in rounds from coarse to fine, then pixels
 * in tiles, each pixel from a few rays on a regular grid.
 */
#ifndef ORL_RENDER_IMAGE_H
#define ORL_RENDER_IMAGE_H

#include <stdatomic.h>

#include "render/film.h"
#include "render/gather.h"

struct orl_image_env {
    const struct orl_gather *gather;
    struct orl_crew *crew;
    struct orl_search *searches; /* one per crew member */
    atomic_bool *cancel;
    uint64_t index; /* of the view in the job: names its random numbers */
    void (*progress)(void *ctx, double fraction);
    void *ctx;
};

/* Renders into film. The view is in the files' coordinates. ORL_ERR_CANCELLED or ORL_ERR_NOMEM. */
int orl_image_render(const struct orl_image_env *env, const struct orl_view *view,
                     struct orl_film *film, struct orl_error *err);

#endif
