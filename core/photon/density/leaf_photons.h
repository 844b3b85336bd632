/*
 * The photons of one leaf that a density query may count: tests of distance, plane and normal for
 * the 16 photons of a leaf at once, which density_search.c and kernel_density.c share.
 *
 * The functions are inlined into the searches, so that they are compiled for the vectors that those
 * are compiled for (base/multiversion.h).
 */
#ifndef ORL_PHOTON_DENSITY_LEAF_PHOTONS_H
#define ORL_PHOTON_DENSITY_LEAF_PHOTONS_H

#include <math.h>
#include <string.h>

#include "base/multiversion.h"
#include "photon/density/density_estimate.h"
#include "photon/map/map_layout.h"
#include "photon/surface/footprint.h"

/* Filter of the photons that a density query counts. */
struct orl_photon_filter {
    const struct orl_photon_map *map;
    const struct orl_density_query *query;
    const struct orl_footprint *footprint; /* NULL: the whole disc */
    float at[3]; /* the query point, in cells, shifted so that cell corners represent centres */
    float normal[3];
    float flat2;          /* squared cells: nearer photons lie in the surface point's plane */
    uint16_t normal_code; /* code of the query's normal */
    uint32_t normal_bins; /* mask of the bins of normals to search */
};

/* Offsets of a leaf's photons from the query, in cells, and one bit per photon that may count. */
struct orl_leaf_matches {
    float x[ORL_MAP_LEAF], y[ORL_MAP_LEAF], z[ORL_MAP_LEAF], d2[ORL_MAP_LEAF];
    uint32_t near;         /* within the radius, and perhaps on the point's sheet */
    uint32_t to_be_tested; /* of these, the ones that orl_photon_counts decides */
};

static inline struct orl_photon_filter orl_photon_filter_make(const struct orl_photon_map *map,
                                                              const struct orl_density_query *query)
{
    struct orl_photon_filter filter = {
        .map = map,
        .query = query,
        .normal = {(float)query->normal.x, (float)query->normal.y, (float)query->normal.z},
        .normal_code = orl_normal_encode(query->normal),
        .normal_bins = orl_normal_bins_mask(&map->normal_bins, query->normal)};
    orl_box_locate(map, query->point, filter.at);
    if (query->surface_point) {
        const double flat = orl_surface_point_flat_radius(query->surface_point) / map->header->cell;
        filter.flat2 = (float)orl_smaller(flat * flat, 1e30);
    }
    return filter;
}

ORL_ALWAYS_INLINE void orl_leaf_find_offsets(const struct orl_photon_filter *filter, uint32_t leaf,
                                             struct orl_leaf_matches *ret_photons)
{
    const uint32_t *a = filter->map->places + (size_t)leaf * ORL_LEAF_WORDS, *b = a + ORL_MAP_LEAF;
    struct orl_leaf_matches *p = ret_photons;
    for (int i = 0; i < ORL_MAP_LEAF; i++) {
        p->x[i] = (float)(int32_t)(a[i] & 0xfffffU) - filter->at[0];
        p->y[i] = (float)(int32_t)(b[i] & 0xfffffU) - filter->at[1];
        p->z[i] = (float)(int32_t)((a[i] >> 24) << 12 | b[i] >> 20) - filter->at[2];
        p->d2[i] = p->x[i] * p->x[i] + p->y[i] * p->y[i] + p->z[i] * p->z[i];
    }
}

/* Returns a bit for each photon of a leaf whose coded normal is not the query's: mostly none. */
ORL_ALWAYS_INLINE uint32_t orl_leaf_find_other_normals(const struct orl_photon_filter *filter,
                                                       uint32_t leaf)
{
    const uint16_t *normals = filter->map->normals + (size_t)leaf * ORL_MAP_LEAF;
    const uint64_t own = filter->normal_code * UINT64_C(0x0001000100010001);
    uint64_t four[ORL_MAP_LEAF / 4], differ = 0;
    uint32_t others = 0;
    memcpy(four, normals, sizeof four);
    for (uint32_t i = 0; i < ORL_MAP_LEAF / 4; i++)
        differ |= four[i] ^ own;
    for (uint32_t i = 0; differ != 0 && i < ORL_MAP_LEAF; i++)
        others |= (uint32_t)(normals[i] != filter->normal_code) << i;
    return others;
}

/*
 * Finds a leaf's photons within a radius. Those with the query's own normal are tested as
 * orl_chord_fits does with the slope of flat sheets, in float; close to the query a photon must be
 * in its own plane, within rounding. The loop is for vectors: it is not unrolled, and tests all 16
 * photons.
 */
ORL_ALWAYS_INLINE void orl_leaf_find_near(const struct orl_photon_filter *filter, uint32_t leaf,
                                          float radius2, struct orl_leaf_matches *ret_photons)
{
    const float slope2 = (float)(orl_sheet_flat_slope * orl_sheet_flat_slope), rounding = 4;
    const float *normal = filter->normal, flat2 = filter->flat2;
    struct orl_leaf_matches *p = ret_photons;
    uint32_t fits = 0, inside = 0;
    orl_leaf_find_offsets(filter, leaf, p);
#pragma GCC unroll 1
    for (uint32_t i = 0; i < ORL_MAP_LEAF; i++) {
        const float d2 = p->d2[i];
        const float off =
            fabsf(p->x[i] * normal[0] + p->y[i] * normal[1] + p->z[i] * normal[2]) - rounding;
        fits |= (uint32_t)((off <= 0) | (off * off <= slope2 * d2)) << i;
        inside |= (uint32_t)((d2 < radius2) & ((d2 >= flat2) | (off <= 0))) << i;
    }
    const uint32_t others = orl_leaf_find_other_normals(filter, leaf);
    p->near = inside & (fits | others) & ((1U << orl_leaf_photons(filter->map, leaf)) - 1);
    p->to_be_tested = filter->footprint || filter->query->at_photon ? p->near : others;
}

/* Returns true if a near photon is not the query's own, and is on the point's sheet and in the
 * footprint. */
static inline bool orl_photon_counts(const struct orl_photon_filter *filter,
                                     const struct orl_leaf_matches *photons, uint32_t i,
                                     uint32_t photon)
{
    const double cell = filter->map->header->cell;
    const float chord[3] = {photons->x[i], photons->y[i], photons->z[i]};
    if (filter->query->at_photon && photon == filter->query->skip)
        return false;
    if (filter->map->normals[photon] != filter->normal_code &&
        !orl_same_sheet(filter->query->normal, filter->normal_code, filter->map->normals[photon],
                        chord))
        return false;
    return !filter->footprint ||
           orl_footprint_contains(filter->footprint,
                                  orl_v3(chord[0] * cell, chord[1] * cell, chord[2] * cell));
}

#endif
