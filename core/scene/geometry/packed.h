/*
 * Facets and corners of a large geometry (orl_geometry_is_vast), packed to 24 and 15 bytes instead
 * of 64 and, with Embree's copy, 36. Rounding is below that of rays: corners to 2^-33 of a
 * coordinate, where Embree has 2^-25; normals to half a billionth of a radian; areas to floats;
 * offsets upwards, by a fifth at most.
 */
#ifndef ORL_SCENE_GEOMETRY_PACKED_H
#define ORL_SCENE_GEOMETRY_PACKED_H

#include <string.h>

#include "scene/geometry/geometry.h"

struct orl_packed_facet {
    enum orl_surface_kind kind : 4;
    bool nonplanar : 1;
    bool has_extra : 1;
    unsigned step : 2;
    bool has_proxy_offset : 1;
    unsigned n_triangles : 23;
    /* polygons: first triangle; others: surface, from which those of polygons follow */
    uint32_t first;
    uint32_t material : 24;
    uint32_t offset : 8; /* orl_packed_offset */
    int32_t normal[2];   /* octahedral map, with the lower half folded over the upper one */
    float area;
};

struct orl_packed {
    struct orl_packed_facet *facets;
    float (*high)[3]; /* corners as Embree reads them, with one extra at the end */
    int8_t (*low)[3]; /* remainders, in steps of 2^-31 of the next lower power of two */
};

/* Steps from the octahedron's centre to a corner of it; value that means no normal. */
#define ORL_PACKED_ONE 0x1p30
enum { ORL_PACKED_NO_NORMAL = INT32_MIN };

static inline void orl_packed_fold(double *u, double *v)
{
    const double x = 1 - fabs(*v), y = 1 - fabs(*u);
    *u = *u < 0 ? -x : x;
    *v = *v < 0 ? -y : y;
}

static inline struct orl_vec3 orl_packed_normal(const struct orl_packed_facet *facet)
{
    double u = facet->normal[0] * (1 / ORL_PACKED_ONE), v = facet->normal[1] * (1 / ORL_PACKED_ONE);
    const double z = 1 - fabs(u) - fabs(v);
    if (facet->normal[0] == ORL_PACKED_NO_NORMAL)
        return orl_v3(0, 0, 0);
    if (z < 0)
        orl_packed_fold(&u, &v);
    return orl_normalize(orl_v3(u, v, z));
}

/* Offsets are stored in quarters of an octave. */
enum { ORL_PACKED_FOURTHS = 4, ORL_PACKED_MIN_EXPONENT = -44 };
static inline double orl_packed_offset(const struct orl_packed_facet *facet)
{
    static const double fourths[ORL_PACKED_FOURTHS] = {1, 1.189207115002721, 1.4142135623730951,
                                                       1.681792830507429};
    const uint64_t bits =
        (uint64_t)(1023 + ORL_PACKED_MIN_EXPONENT + (int)(facet->offset / ORL_PACKED_FOURTHS))
        << 52;
    double octave;
    memcpy(&octave, &bits, sizeof octave);
    return octave * fourths[facet->offset % ORL_PACKED_FOURTHS];
}

/* Step of a float's remainder. */
static inline double orl_packed_step(float high)
{
    uint32_t bits;
    float power;
    memcpy(&bits, &high, sizeof bits);
    bits &= 0x7f800000U;
    memcpy(&power, &bits, sizeof power);
    return (double)power * 0x1p-31;
}

static inline double orl_packed_coordinate(float high, int8_t low)
{
    return (double)high + low * orl_packed_step(high);
}

static inline struct orl_vec3 orl_packed_corner(const struct orl_packed *packed, size_t corner)
{
    const float *const high = packed->high[corner];
    const int8_t *const low = packed->low[corner];
    return orl_v3(orl_packed_coordinate(high[0], low[0]), orl_packed_coordinate(high[1], low[1]),
                  orl_packed_coordinate(high[2], low[2]));
}

/* Packs a geometry that is vast; leaves others unchanged. Returns false if out of memory. */
bool orl_geometry_pack(struct orl_geometry *geometry);
void orl_packed_free(struct orl_packed *packed); /* NULL is allowed */

/* Unpacks all facets and corners, for a copy; the arrays need one extra item. */
void orl_geometry_unpack(const struct orl_geometry *geometry, struct orl_facet *ret_facets,
                         struct orl_vec3 *ret_corners);

#endif
