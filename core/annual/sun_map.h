/*
 * Sunlight on surfaces inside a sealed building, of every beam (sun_beams.h): how much of it comes
 * through the ports and, by mirrors and lobes but no diffuse surface, to each square of a surface.
 * (Or by whatever way: contribution photons, oriel/annual.h.)
 * Photons bring it there: straight through clear panes, deflected or scattered by BSDFs, thrown on
 * by whatever is not diffuse. All sensors share it, and paths that come to a surface look up what
 * all nodes give it, without a shadow ray.
 *
 * Squares are of a side of a facet, a small share of a window wide, of slats a small share of their
 * width, and hold flux over the area of surface in them: none is lost at edges. What a square says
 * is its mean: seen from elsewhere that is as good, and a sensor's own direct light is not taken
 * from here.
 *
 * Photons are in as many groups as there are lots, independent of each other, for standard errors.
 * Depends on seed and scene alone; immutable once made.
 */
#ifndef ORL_ANNUAL_SUN_MAP_H
#define ORL_ANNUAL_SUN_MAP_H

#include <oriel/annual.h>
#include <oriel/crew.h>

#include "annual/sun_beams.h"
#include "annual/sun_photons.h"
#include "base/random.h"
#include "base/sobol.h"
#include "light/world.h"

struct orl_sun_map;

/* Bounds of a map: squares, and entries, one for each beam that comes to a lot of a square. */
enum { ORL_SUN_MAP_MOST_SQUARES = 1 << 22, ORL_SUN_MAP_MOST_ENTRIES = ORL_ANNUAL_MOST_MAP_VALUES };

struct orl_sun_map_request {
    const struct orl_world *world; /* borrowed, also by the map */
    const struct orl_sobol *sobol;
    const struct orl_frame *nodes; /* towards them, as the scene has it; for the call */
    size_t n_nodes;
    uint64_t seed;
    uint32_t photons;             /* of a node, all its beams and lots together */
    uint32_t of_beam;             /* of a beam, at the least */
    const uint16_t *part_of_port; /* of the world's (parts.h), for the call; NULL: there is one */
    bool whole;                   /* with what diffuse surfaces send from one to another */
};

/* *ret_map is NULL where there is nothing to map: an open scene, or no ports. Returns 0,
 * ORL_ERR_NOMEM, ORL_ERR_CANCELLED, or ORL_ERR_LIMIT beyond the bounds above. */
int orl_sun_map_new(const struct orl_sun_map_request *request, struct orl_crew *crew,
                    struct orl_sun_map **ret_map);
/* The same, of what orl_sun_map_save made of one for an equal request. ORL_ERR_NOMEM. */
int orl_sun_map_load(const struct orl_sun_map_request *request, const void *data,
                     struct orl_sun_map **ret_map);
/* ret_data is owned; a multiple of 4 bytes. ORL_ERR_NOMEM. */
int orl_sun_map_save(const struct orl_sun_map *map, void **ret_data, size_t *ret_size);
void orl_sun_map_free(struct orl_sun_map *map); /* NULL is allowed */

/* Its beams, in the order in which sums have them. */
const struct orl_sun_beams *orl_sun_map_beams(const struct orl_sun_map *map);

/*
 * Adds to the beams what a surface at that hit, on the side that was met, has of them, times the
 * weight: luma, for a sun that gives 1 to what faces it. And to lots the same, [beam][lot], as each
 * lot alone would have it.
 */
void orl_sun_map_add(const struct orl_sun_map *map, const struct orl_hit *hit,
                     struct orl_rgb weight, double *beams, float *lots);

#endif
