/*
 * Photons of beams (sun_beams.h): from the sun's disc through the ports of a kind, and on by
 * mirrors and lobes until no lobe sends them further; or by diffuse surfaces, too, until they are
 * absorbed. At every diffuse surface inside that one comes to, its flux is noted.
 */
#ifndef ORL_ANNUAL_SUN_PHOTONS_H
#define ORL_ANNUAL_SUN_PHOTONS_H

#include "annual/sun_beams.h"
#include "base/sobol.h"

enum { ORL_SUN_MAP_LOTS = 8 }; /* groups of photons, independent of each other */

/* What one brought to a diffuse surface, W for a sun that gives 1 to what faces it. */
struct orl_sun_deposit {
    uint32_t facet, lot;
    bool front;
    struct orl_vec3 point, normal;
    float flux[3]; /* RGB */
};

/* A batch of a beam's photons. */
struct orl_sun_shot {
    const struct orl_sun_beams *beams; /* borrowed, as all pointers down to seed are */
    const struct orl_frame *nodes;     /* towards them, as the scene has it */
    const struct orl_sobol *sobol;
    uint64_t seed;
    size_t beam;
    uint32_t photons;                 /* of each lot of the beam, all batches together */
    uint32_t first, end;              /* photons of the batch, of all lots: lot is index % lots */
    bool whole;                       /* diffuse surfaces send them on as well */
    struct orl_sun_deposit *deposits; /* owned; in no order but the same one every time */
    size_t n_deposits, room;
    int code; /* 0 or ORL_ERR_NOMEM */
};

/* Fills deposits and code of a shot that has the rest. */
void orl_sun_shoot(struct orl_sun_shot *shot);
void orl_sun_shot_done(struct orl_sun_shot *shot);

#endif
