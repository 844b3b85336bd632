/*
 * The render stage under way: sensors by stretches, views one by one. render.c goes through all of
 * them; what hands them to others as pieces is in shared_sensors.c and shared_views.c.
 */
#ifndef ORL_RUN_RENDERING_H
#define ORL_RUN_RENDERING_H

#include <stdatomic.h>

#include "base/scatter.h"
#include "render/film/film.h"
#include "run/pieces.h"

/* Sensors at a time, at the most, so that cancelling is heard in between. */
enum { ORL_STRETCH = 128 };

/* Where one view stands among all that is rendered. */
struct orl_view_progress {
    const struct orl_run_state *state;
    double before, share; /* of the stage; until it is painted */
};

/* What is rendered at the moment: its technique and how much of the stage came before. */
struct orl_rendering {
    struct orl_run_state *state;
    const struct orl_renderer *renderer;
    size_t stretch; /* sensors of each, but for the last one */
    size_t first;   /* sensor of this stretch, in their order */
    double share;   /* of the stage: the sensors' */
    size_t stride;  /* of their order */
    uint64_t samples;
    atomic_uint_fast64_t taken; /* of the sensors' samples */
    double by_lead;             /* of those: the crew's lead's */
    double elsewhere;           /* samples that are taken, with those that others have made */
    struct orl_view_progress *views;
    struct orl_sensor_found found[ORL_STRETCH];
};

/* The sensor at that place in their order. */
static inline size_t orl_sensor_at(const struct orl_rendering *rendering, size_t place)
{
    return orl_scatter(place, rendering->stride, rendering->state->n_sensors);
}

static inline size_t orl_stretch_size(const struct orl_rendering *rendering, size_t first)
{
    const size_t left = rendering->state->n_sensors - first;
    return left < rendering->stretch ? left : rendering->stretch;
}

/* Sensors of a stretch as a piece of a job that is shared: so few that a thousand parts find some
 * each. Results do not depend on it. */
static inline size_t orl_shared_stretch(size_t n_sensors)
{
    enum { STRETCHES = 2000, LEAST = 8 };
    const size_t size = n_sensors / STRETCHES;
    return size < LEAST ? LEAST : size < ORL_STRETCH ? size : ORL_STRETCH;
}

/* Progress. */
void orl_tell_sensors(const struct orl_rendering *rendering);
/* Computes and books a stretch; what came of it is in rendering. */
int orl_compute_stretch(struct orl_rendering *rendering, size_t first, struct orl_error *err);
/* All of them, as pieces of a run that is shared. */
int orl_share_sensors(struct orl_rendering *rendering, struct orl_error *err);

/* A view's picture, empty yet: what there is to warn of is said. *ret_film is the caller's. */
int orl_open_view(struct orl_run_state *state, size_t index, struct orl_view *ret_view,
                  struct orl_film *ret_film, struct orl_error *err);
/* The same, and paints it. */
int orl_paint_view(struct orl_rendering *rendering, size_t index, struct orl_film *ret_film,
                   struct orl_error *err);
/* Where a picture goes when it is finished. started_s: when it was begun. */
int orl_finish_view(struct orl_rendering *rendering, size_t index, const struct orl_film *film,
                    double started_s, struct orl_error *err);
/* Those views, as pieces of a run that is shared. */
int orl_share_views(struct orl_rendering *rendering, const size_t *views, size_t n,
                    struct orl_error *err);

#endif
