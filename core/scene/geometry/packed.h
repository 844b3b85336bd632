/*
 * Facets and corners of a geometry of many triangles (orl_geometry_is_vast), in 24 bytes and 15,
 * where others take 64 and, with Embree's copy of them, 36. Numbers are rounded by less than what
 * rays are rounded to: corners to 2^-33 of a coordinate, of which Embree has 2^-25; normals to half
 * a billionth of a radian; areas to floats; offsets upwards, by a fifth at most.
 */
#ifndef ORL_SCENE_GEOMETRY_PACKED_H
#define ORL_SCENE_GEOMETRY_PACKED_H

#include <string.h>

#include "scene/geometry/geometry.h"

struct orl_packed_facet {
    enum orl_surface_kind kind : 4;
    bool bent : 1;
    bool has_more : 1;
    unsigned step : 2;
    bool stands_off : 1;
    unsigned n_triangles : 23;
    uint32_t first; /* polygons: triangle; else surface, by which those of polygons are known */
    uint32_t material : 24;
    uint32_t offset : 8; /* orl_packed_offset */
    int32_t normal[2];   /* on an octahedron, whose lower half is folded out over the upper one */
    float area;
};

struct orl_packed {
    struct orl_packed_facet *facets;
    float (*high)[3]; /* corners as Embree has them: it reads these, and one past the last */
    int8_t (*low)[3]; /* what is missing, in steps of 2^-31 of the power of two below */
};

/* Steps from the octahedron's middle to a corner of it, and what stands for no normal. */
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

/* By fourths of an octave. */
enum { ORL_PACKED_FOURTHS = 4, ORL_PACKED_LEAST = -44 };
static inline double orl_packed_offset(const struct orl_packed_facet *facet)
{
    static const double fourths[ORL_PACKED_FOURTHS] = {1, 1.189207115002721, 1.4142135623730951,
                                                       1.681792830507429};
    const uint64_t bits =
        (uint64_t)(1023 + ORL_PACKED_LEAST + (int)(facet->offset / ORL_PACKED_FOURTHS)) << 52;
    double octave;
    memcpy(&octave, &bits, sizeof octave);
    return octave * fourths[facet->offset % ORL_PACKED_FOURTHS];
}

/* A step of what a float lacks. */
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

/* Packs one that is vast, and leaves others alone. False: out of memory. */
bool orl_geometry_pack(struct orl_geometry *geometry);
void orl_packed_free(struct orl_packed *packed); /* NULL is allowed */

/* All facets and corners as they were, for a copy: as many as there are, and one. */
void orl_geometry_unpack(const struct orl_geometry *geometry, struct orl_facet *ret_facets,
                         struct orl_vec3 *ret_corners);

#endif
