#include "scene/geometry/packed.h"

#include <float.h>
#include <stdlib.h>
#include <string.h>

/* ---- Numbers --------------------------------------------------------------------------------- */

static void pack_normal(struct orl_vec3 n, int32_t packed[2])
{
    const double sum = fabs(n.x) + fabs(n.y) + fabs(n.z);
    double u = n.x / sum, v = n.y / sum;
    if (!(sum > 0)) {
        packed[0] = packed[1] = ORL_PACKED_NO_NORMAL;
        return;
    }
    if (n.z < 0)
        orl_packed_fold(&u, &v);
    packed[0] = (int32_t)lrint(u * ORL_PACKED_ONE);
    packed[1] = (int32_t)lrint(v * ORL_PACKED_ONE);
}

static void pack_coordinate(double x, float *ret_high, int8_t *ret_low)
{
    const float high = (float)x;
    const double step = orl_packed_step(high);
    const double low = step > 0 ? rint((x - (double)high) / step) : 0;
    *ret_high = high;
    /* Half of the float's last bit is 128 steps; clamping to 127 keeps this float the nearest
     * one. */
    *ret_low = (int8_t)fmax(-127, fmin(127, low));
}

struct orl_vec3 orl_corner_get_packed(const struct orl_geometry *geometry, size_t corner)
{
    return orl_packed_corner(geometry->packed, corner);
}

struct orl_triangle orl_triangle_get_packed(const struct orl_geometry *geometry, size_t index)
{
    struct orl_vec3 corners[3];
    for (unsigned k = 0; k < 3; k++)
        corners[k] = orl_corner_get_packed(geometry, orl_triangle_corner(geometry, index, k));
    return (struct orl_triangle){corners[0], corners[1], corners[2]};
}

/* ---- Facets ---------------------------------------------------------------------------------- */

/* Rounds to float, but keeps positive numbers above 0. */
static float rounded(double x)
{
    const float f = (float)x;
    return x > 0 && !(f > 0) ? FLT_MIN : f;
}

static uint8_t pack_offset(double offset)
{
    static const double hair = 1e-9; /* a value that was packed before is unchanged */
    const double fourths =
        ceil(ORL_PACKED_FOURTHS * (log2(offset) - ORL_PACKED_MIN_EXPONENT) - hair);
    return (uint8_t)fmax(0, fmin(UINT8_MAX, fourths));
}

static struct orl_packed_facet pack_facet(const struct orl_facet *facet)
{
    struct orl_packed_facet packed = {
        .kind = facet->kind,
        .nonplanar = facet->nonplanar,
        .has_extra = facet->has_extra,
        .step = facet->step,
        .has_proxy_offset = facet->has_proxy_offset,
        .n_triangles = facet->n_triangles,
        .first = facet->kind == ORL_SURFACE_POLYGON ? facet->first_triangle : facet->surface,
        .material = facet->material & 0xffffffU,
        .offset = pack_offset(facet->offset),
        .area = rounded(facet->area),
    };
    pack_normal(facet->normal, packed.normal);
    return packed;
}

const struct orl_facet *orl_facet_get_packed(const struct orl_geometry *geometry, size_t facet,
                                             struct orl_facet *room)
{
    const struct orl_packed_facet *const from = &geometry->packed->facets[facet];
    const bool flat = from->kind == ORL_SURFACE_POLYGON;
    *room = (struct orl_facet){
        .kind = from->kind,
        .nonplanar = from->nonplanar,
        .has_extra = from->has_extra,
        .step = from->step,
        .has_proxy_offset = from->has_proxy_offset,
        .n_triangles = from->n_triangles,
        .first_triangle = flat ? from->first : 0,
        .material = from->material,
        .normal = orl_packed_normal(from),
        .quadric = flat ? &orl_quadric_none : &geometry->quadrics[geometry->n_facets - 1 - facet],
        .offset = orl_packed_offset(from),
        .area = (double)from->area,
    };
    return room;
}

double orl_facet_area_packed(const struct orl_geometry *geometry, size_t facet)
{
    return (double)geometry->packed->facets[facet].area;
}

/*
 * Polygons and others are numbered in the files' order, polygons from the start and others from the
 * end. The surface index of a polygon is its facet index plus the number of other surfaces before
 * it, found by binary search.
 */
uint32_t orl_facet_surface_packed(const struct orl_geometry *geometry, size_t facet)
{
    const struct orl_packed_facet *const last = &geometry->packed->facets[geometry->n_facets - 1];
    size_t low = 0, high = geometry->n_quadrics;
    if (geometry->packed->facets[facet].kind != ORL_SURFACE_POLYGON)
        return geometry->packed->facets[facet].first;
    while (low < high) {
        const size_t middle = low + (high - low) / 2;
        if (last[-(ptrdiff_t)middle].first - middle <= facet)
            low = middle + 1;
        else
            high = middle;
    }
    return (uint32_t)(facet + low);
}

void orl_facet_set_material(struct orl_geometry *geometry, size_t facet, uint32_t material)
{
    if (geometry->facets)
        geometry->facets[facet].material = material;
    else
        geometry->packed->facets[facet].material = material & 0xffffffU;
}

/* ---- Whole geometries ------------------------------------------------------------------------ */

void orl_packed_free(struct orl_packed *packed)
{
    if (!packed)
        return;
    free(packed->facets);
    free(packed->high);
    free(packed->low);
    free(packed);
}

static bool pack_corners(struct orl_geometry *g, struct orl_packed *packed)
{
    packed->high = malloc((g->n_corners + 1) * sizeof *packed->high);
    packed->low = malloc((g->n_corners + 1) * sizeof *packed->low);
    if (!packed->high || !packed->low)
        return false;
    for (size_t i = 0; i < g->n_corners; i++) {
        const double from[3] = {g->corners[i].x, g->corners[i].y, g->corners[i].z};
        for (int k = 0; k < 3; k++)
            pack_coordinate(from[k], &packed->high[i][k], &packed->low[i][k]);
    }
    memset(packed->high[g->n_corners], 0, sizeof *packed->high);
    free(g->corners);
    g->corners = NULL;
    return true;
}

static bool pack_facets(struct orl_geometry *g, struct orl_packed *packed)
{
    packed->facets = malloc((g->n_facets + 1) * sizeof *packed->facets);
    if (!packed->facets)
        return false;
    for (size_t i = 0; i < g->n_facets; i++)
        packed->facets[i] = pack_facet(&g->facets[i]);
    free(g->facets);
    g->facets = NULL;
    g->n_unpacked_facets = 0;
    return true;
}

/* Returns true if offsets (2^-20 of sizes) and materials, some of which may be added later, fit
 * their fields. */
static bool can_be_packed(const struct orl_geometry *g)
{
    static const double least = 0x1p-20, most = 0x1p39;
    static const uint32_t materials = 1 << 23;
    bool can = g->radius > least && g->radius < most;
    for (size_t i = 0; i < g->n_facets && can; i++)
        can = g->facets[i].material < materials;
    return can;
}

bool orl_geometry_pack(struct orl_geometry *geometry)
{
    if (!orl_geometry_is_vast(geometry) || !can_be_packed(geometry))
        return true;
    geometry->packed = calloc(1, sizeof *geometry->packed);
    return geometry->packed && pack_corners(geometry, geometry->packed) &&
           pack_facets(geometry, geometry->packed);
}

void orl_geometry_unpack(const struct orl_geometry *geometry, struct orl_facet *ret_facets,
                         struct orl_vec3 *ret_corners)
{
    for (size_t i = 0; i < geometry->n_facets; i++) {
        ret_facets[i] = *orl_facet_get_own(geometry, i, &ret_facets[i]);
        if (!geometry->facets)
            ret_facets[i].surface = orl_facet_surface_packed(geometry, i);
    }
    for (size_t i = 0; i < geometry->n_corners; i++)
        ret_corners[i] = orl_corner_get(geometry, i);
}
