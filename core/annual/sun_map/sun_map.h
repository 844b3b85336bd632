/* Map of sunlight on surfaces inside a sealed building, and the texels that hold it. */
#ifndef ORL_ANNUAL_SUN_MAP_SUN_MAP_H
#define ORL_ANNUAL_SUN_MAP_SUN_MAP_H

#include <oriel/annual/annual.h>
#include <oriel/base/thread_pool.h>

#include "annual/sun_map/sun_beams.h"
#include "base/sampling/sampling.h"
#include "light/lit_scene.h"
#include "scene/geometry/geometry.h"

/*
 * Texels of surfaces, identified by number: the texel that a hit falls into, and the surface area
 * in it. Polygons are divided in their plane, round surfaces by angle and height (orl_hit_uv).
 */

/* Division of a polygon into rows and columns that fit its extent, so that no slivers remain. */
struct orl_sun_texel_grid {
    float along[3]; /* the first axis, unit; the second is perpendicular to it in the plane */
    float low[2], step[2];
};

struct orl_sun_texels {
    const struct orl_geometry *geometry;    /* borrowed */
    struct orl_sun_texel_grid *texel_grids; /* by facet that is not instanced */
    double width;
};

/* Divides surfaces into texels of about this width. Strips narrower than three widths get eight
 * rows of longer cells. Returns 0 or ORL_ERR_NOMEM. */
int orl_sun_texels_init(struct orl_sun_texels *texels, const struct orl_geometry *geometry,
                        double width);
void orl_sun_texels_done(struct orl_sun_texels *texels);

/* Returns the identifier of the hit's texel, on the side that was hit; never 0. */
uint64_t orl_sun_texel_of(const struct orl_sun_texels *texels, const struct orl_hit *hit);

/* Returns the surface area in the texel that a hit falls into. */
double orl_sun_texel_area(const struct orl_sun_texels *texels, const struct orl_hit *hit);

/*
 * Map of sunlight on surfaces inside a sealed building, for each beam (sun_beams.h). It holds the
 * light that reaches each texel of a surface through ports, mirrors and lobes, but no diffuse
 * surface. A whole map includes diffuse interreflection (contribution photons,
 * oriel/annual/annual.h). Photons pass straight through clear panes, are deflected or scattered by
 * BSDFs, and are reflected by surfaces that are not diffuse. All sensors share the map. A path that
 * hits a surface looks up the light of all nodes there, without shadow rays.
 *
 * A texel lies on one side of a facet. It is a small fraction of a window wide, or of a slat's
 * width. It stores flux divided by the surface area in it, so no flux is lost at edges. Its value
 * is a mean, which suffices for light seen from elsewhere. A sensor's own direct light is not taken
 * from the map.
 *
 * Photons form ORL_SUN_PHOTON_BATCHES independent batches, which yield standard errors. The map
 * depends on seed and scene alone; immutable once made.
 */

struct orl_sun_map;

/* Limits of a map: texels, and entries. There is one entry for each beam that reaches a batch of a
 * texel. */
enum { ORL_SUN_MAP_MOST_TEXELS = 1 << 22, ORL_SUN_MAP_MOST_ENTRIES = ORL_ANNUAL_MOST_MAP_VALUES };

struct orl_sun_map_request {
    const struct orl_lit_scene *lit_scene; /* borrowed, also by the map */
    const struct orl_sobol *sobol;
    /* Frames in scene axes, n towards the sun; used during the call only. */
    const struct orl_frame *nodes;
    size_t n_nodes;
    uint64_t seed;
    uint32_t photons; /* photons per node, over all its beams and batches */
    uint32_t of_beam; /* least photons per beam */
    /* By port of the lit scene (annual_scene.h), used during the call only; NULL: one window
     * group. */
    const uint16_t *window_group_of_port;
    bool interreflection; /* true if light between diffuse surfaces is included */
};

/* Builds a map. *ret_map is NULL if there is nothing to map: an open scene, no ports or no nodes.
 * Returns 0, ORL_ERR_NOMEM, ORL_ERR_CANCELLED, or ORL_ERR_LIMIT beyond the limits above. */
int orl_sun_map_new(const struct orl_sun_map_request *request, struct orl_thread_pool *pool,
                    struct orl_sun_map **ret_map);
/* Restores a map from the data that orl_sun_map_save wrote for an equal request. Returns 0 or
 * ORL_ERR_NOMEM. */
int orl_sun_map_load(const struct orl_sun_map_request *request, const void *data, size_t size,
                     struct orl_sun_map **ret_map);
/* Serialises a map. Returns data owned by the caller, of a multiple of 4 bytes; NULL when out of
 * memory. */
void *orl_sun_map_save(const struct orl_sun_map *map, size_t *ret_size);
void orl_sun_map_free(struct orl_sun_map *map); /* NULL is allowed */

/* Returns the map's beams, in the order in which sums hold them. */
const struct orl_sun_beams *orl_sun_map_beams(const struct orl_sun_map *map);

/*
 * Adds the light of every beam on the hit side of the surface, times weight, to beams: luma, for a
 * sun with a normal illuminance of 1. Adds the estimate of each batch alone to photon_batches,
 * [beam][batch].
 */
void orl_sun_map_add(const struct orl_sun_map *map, const struct orl_hit *hit,
                     struct orl_rgb weight, double *beams, float *photon_batches);

#endif
