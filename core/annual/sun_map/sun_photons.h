/*
 * Photons of beams (sun_beams.h). They start on the sun's disc, pass the ports of a kind and go on
 * by specular and glossy reflection and transmission. Optionally diffuse surfaces scatter them,
 * too, until they are absorbed. At each diffuse surface inside the photon's flux is recorded.
 */
#ifndef ORL_ANNUAL_SUN_MAP_SUN_PHOTONS_H
#define ORL_ANNUAL_SUN_MAP_SUN_PHOTONS_H

#include "annual/sun_map/sun_beams.h"
#include "base/sampling/sobol.h"

enum { ORL_SUN_PHOTON_BATCHES = 8 }; /* independent groups of photons */

/* Flux that a photon brings to a diffuse surface, W, for a sun with a normal irradiance of 1. */
struct orl_sun_deposit {
    uint32_t facet, batch;
    bool front;
    struct orl_vec3 point, normal;
    float flux[3]; /* RGB */
};

/* Photons of a beam that one task traces. */
struct orl_sun_photon_task {
    const struct orl_sun_beams *beams; /* borrowed, like all pointers down to sobol */
    const struct orl_frame *nodes;     /* frames in scene axes, n towards the sun */
    const struct orl_sobol *sobol;
    uint64_t seed;
    size_t beam;
    uint32_t photons;     /* photons per batch of the beam, over all tasks */
    uint32_t first, end;  /* photons of this task; the batch of a photon is index % batches */
    bool interreflection; /* true if diffuse surfaces scatter photons as well */
    struct orl_sun_deposit *deposits; /* owned; the order depends on the request alone */
    size_t n_deposits, room;
    int code; /* 0 or ORL_ERR_NOMEM */
};

/* Traces the task's photons and fills deposits and code; the caller has set the other fields. */
void orl_sun_photon_task_trace(struct orl_sun_photon_task *task);
void orl_sun_photon_task_done(struct orl_sun_photon_task *task);

#endif
