/*
 * The scene's surfaces as a ray tracer sees them, on top of Embree (3 or 4, robust mode).
 *
 * Coordinates: the scene is moved by -center, in double, before it becomes Embree's floats. All of
 * the core beyond this header works in these moved coordinates; orl_geometry.center is added or
 * subtracted only where a job's sensors and views come in. Units are the scene file's.
 *
 * Hits: the point is projected back onto the true surface in double, so that its error does not
 * grow with distance. Rays that start on a surface are to start at orl_hit_leave(hit, direction):
 * clear of the surface, and of what a BSDF with a thickness stands for.
 *
 * What the scene has in several places it keeps once (placed.h): numbers of facets and triangles go
 * on beyond the scene's own, and arrays do not.
 *
 * Surfaces that antimatter cuts are met where they are left (antimatter.h).
 *
 * Where two polygons of opposite fronts lie in one place, a hit is on the one whose front the ray
 * meets; in all other cases of two in one place, one has been cut away (coincident.h).
 *
 * Triangles are kept two by two: those of a polygon, or of two polygons that follow each other and
 * share an edge; so some of their numbers are of none (orl_triangle_is_none). Where there are many,
 * facets and corners are kept packed (packed.h): ask for them by their numbers.
 *
 * Determinism: the hierarchy is built by one thread, so that ties are broken the same way each
 * time. Threads: immutable once built; intersect and occluded may be called from any thread.
 */
#ifndef ORL_SCENE_GEOMETRY_GEOMETRY_H
#define ORL_SCENE_GEOMETRY_GEOMETRY_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <oriel/error.h>

#include "scene/description.h"

/* A surface as it is shot at: the description's, moved, with what hits need at hand. */
struct orl_facet {
    enum orl_surface_kind kind : 4;
    bool bent : 1;     /* a polygon whose triangles do not lie in one plane, as rounded numbers make
                          them */
    bool has_more : 1; /* orl_facet_more_of */
    unsigned step : 2; /* polygons: of their triangles' numbers */
    bool stands_off : 1;            /* orl_facet_beyond is not 0 */
    unsigned n_triangles : 23;      /* polygons; else 0 */
    uint32_t first_triangle;        /* polygons: see orl_facet_triangle */
    uint32_t material, surface;     /* indices into the description's; see orl_facet_surface */
    struct orl_vec3 normal;         /* polygons and rings: unit, the declared front */
    const struct orl_curved *round; /* all but polygons: in orl_geometry.rounds; never NULL */
    double offset; /* how far from the surface a ray must start to be clear of it */
    double area;
};

/* What few facets have. */
struct orl_facet_more {
    uint32_t facet;
    uint32_t first_rival, n_rivals; /* into orl_geometry.rivals: facets in the same place that face
                                       the other way */
    double beyond; /* BSDF: what it stands for lies this far behind it (negative: in front) */
};

/*
 * Two triangles, of the corners 3 0 1 and 1 2 3 in orl_geometry.corners, which all that meet there
 * share; each is listed from its first, second or third on. Where the second is none, the last two
 * corners are one.
 */
struct orl_couple {
    uint32_t corners[4];                   /* first: Embree reads them in place */
    uint32_t facet : 27;                   /* the first's */
    uint32_t next : 1;                     /* the second is of the one after it */
    uint32_t turn : 2, turn_of_second : 2; /* which each is listed from */
};

struct orl_triangle {
    struct orl_vec3 a, b, c;
};

/* A triangle as its couple has it. */
struct orl_listed {
    uint32_t corners[3], facet;
};

/* Of a polygon whose outline its triangles do not tell (orl_outline_of_facet). */
struct orl_own_outline {
    uint32_t facet, first, n; /* corners, by orl_geometry.outline_corners */
};

struct orl_holes;
struct orl_packed;
struct orl_placed;

struct orl_geometry {
    struct orl_vec3 center;    /* subtracted from the files' coordinates */
    struct orl_vec3 low, high; /* bounds, moved coordinates */
    double radius;             /* of the bounding sphere about the moved origin */
    struct orl_facet *facets;  /* NULL: packed */
    size_t n_facets;
    size_t n_plain;            /* as many, or none: packed */
    struct orl_curved *rounds; /* of the facets that are not polygons, from the last one back */
    size_t n_rounds;
    struct orl_couple *couples;
    size_t n_couples;
    struct orl_vec3 *corners; /* NULL: packed */
    size_t n_corners;
    struct orl_packed *packed;        /* packed.h; or NULL */
    struct orl_own_outline *outlines; /* by facet; where triangles are listed, of every facet */
    size_t n_outlines;
    uint32_t *outline_corners;
    size_t n_outline_corners;
    struct orl_facet_more *more; /* by facet */
    size_t n_more;
    uint32_t *rivals;
    size_t n_rivals;
    struct orl_geometry **prototypes; /* owned: what stands in several places (placed.h) */
    size_t n_prototypes;
    struct orl_placed *placed; /* those places */
    size_t n_placed;
    size_t n_places;           /* a prototype's: how many; else 0 */
    size_t first_place;        /* a prototype's: which of those places is the first that it has */
    bool curved;               /* it has facets that are not polygons, or what is placed has */
    struct orl_holes *holes;   /* antimatter.h: facets that are not there everywhere; NULL: none */
    uint32_t *met;             /* Embree's numbers are of these triangles; NULL: of couples */
    struct orl_listed *listed; /* triangles, and ... */
    double *areas;             /* ... theirs; NULL: of so many, none are kept */
    void *scene;               /* Embree's */
};

/* What a ray has met, and where: all that a material is asked at. */
struct orl_hit {
    double distance;
    struct orl_vec3 point;  /* on the surface */
    struct orl_vec3 normal; /* unit, the declared front */
    uint32_t facet;
    uint32_t triangle; /* of polygons, as orl_triangle_of numbers them; else 0 */
    uint32_t instance; /* of the scene's parts that it holds more than once: which, from 1; or 0 */
    bool front;        /* the ray met the front: dot(direction, normal) < 0 */
};

/*
 * A hit that stands for all of a surface of that front normal: what is asked of a material there is
 * its mean over the surface.
 */
static inline struct orl_hit orl_hit_anywhere(struct orl_vec3 normal, bool front)
{
    return (struct orl_hit){.normal = normal, .instance = UINT32_MAX, .front = front};
}
static inline bool orl_hit_is_anywhere(const struct orl_hit *hit)
{
    return hit->instance == UINT32_MAX;
}

/* placed.c: of a number beyond the scene's own. */
struct orl_triangle orl_placed_triangle(const struct orl_geometry *geometry, size_t index);

/* packed.c: of facets, corners and triangles that are packed; and elsewhere.c: of facets that are
 * packed, or of what is placed. */
const struct orl_facet *orl_facet_unpacked(const struct orl_geometry *geometry, size_t facet,
                                           struct orl_facet *room);
double orl_facet_area_unpacked(const struct orl_geometry *geometry, size_t facet);
uint32_t orl_facet_surface_unpacked(const struct orl_geometry *geometry, size_t facet);
uint32_t orl_facet_surface_elsewhere(const struct orl_geometry *geometry, size_t facet);
const struct orl_facet *orl_facet_of_elsewhere(const struct orl_geometry *geometry, size_t facet,
                                               struct orl_facet *room);
enum orl_surface_kind orl_facet_kind_elsewhere(const struct orl_geometry *geometry, size_t facet);
uint32_t orl_facet_material_elsewhere(const struct orl_geometry *geometry, size_t facet);
double orl_facet_clear_elsewhere(const struct orl_geometry *geometry, uint32_t facet, double side);
double orl_facet_offset_elsewhere(const struct orl_geometry *geometry, size_t facet);
struct orl_vec3 orl_corner_unpacked(const struct orl_geometry *geometry, size_t corner);
struct orl_triangle orl_triangle_unpacked(const struct orl_geometry *geometry, size_t index);

/* Whether a facet is one of what the scene has in several places (placed.h). */
static inline bool orl_facet_is_placed(const struct orl_geometry *geometry, size_t facet)
{
    return facet >= geometry->n_facets;
}

/* One of the scene's own: all but its surface. Where it is packed it is written to room. */
static inline const struct orl_facet *orl_facet_own(const struct orl_geometry *geometry,
                                                    size_t facet, struct orl_facet *room)
{
    return geometry->facets ? &geometry->facets[facet] : orl_facet_unpacked(geometry, facet, room);
}

/* Of any: what is placed has its prototype's kind, material and area; nothing else is its own. */
static inline const struct orl_facet *orl_facet_of(const struct orl_geometry *geometry,
                                                   size_t facet, struct orl_facet *room)
{
    return facet < geometry->n_plain ? &geometry->facets[facet]
                                     : orl_facet_of_elsewhere(geometry, facet, room);
}

static inline struct orl_vec3 orl_facet_normal(const struct orl_geometry *geometry, size_t facet)
{
    struct orl_facet own;
    return orl_facet_own(geometry, facet, &own)->normal;
}

static inline double orl_facet_area(const struct orl_geometry *geometry, size_t facet)
{
    return geometry->facets ? geometry->facets[facet].area
                            : orl_facet_area_unpacked(geometry, facet);
}

/* Of these what is placed has some, too: surface, kind and material are as its prototype says. */
static inline uint32_t orl_facet_surface(const struct orl_geometry *geometry, size_t facet)
{
    return facet < geometry->n_plain ? geometry->facets[facet].surface
                                     : orl_facet_surface_elsewhere(geometry, facet);
}

static inline enum orl_surface_kind orl_facet_kind(const struct orl_geometry *geometry,
                                                   size_t facet)
{
    return facet < geometry->n_plain ? geometry->facets[facet].kind
                                     : orl_facet_kind_elsewhere(geometry, facet);
}

static inline uint32_t orl_facet_material(const struct orl_geometry *geometry, size_t facet)
{
    return facet < geometry->n_plain ? geometry->facets[facet].material
                                     : orl_facet_material_elsewhere(geometry, facet);
}

static inline double orl_facet_offset(const struct orl_geometry *geometry, size_t facet)
{
    return facet < geometry->n_plain ? geometry->facets[facet].offset
                                     : orl_facet_offset_elsewhere(geometry, facet);
}

/* Distances up to this are rounding errors: no facet's offset is more than a quarter of it. */
static inline double orl_geometry_resolution(const struct orl_geometry *geometry)
{
    return geometry->radius * 0x1p-18;
}

/* To be done before anything asks for it. */
void orl_facet_set_material(struct orl_geometry *geometry, size_t facet, uint32_t material);

static inline struct orl_vec3 orl_corner_of(const struct orl_geometry *geometry, size_t corner)
{
    return geometry->corners ? geometry->corners[corner] : orl_corner_unpacked(geometry, corner);
}

/* Numbers of triangles are less than that. */
static inline size_t orl_geometry_triangles_end(const struct orl_geometry *geometry)
{
    return 2 * geometry->n_couples;
}

/* A polygon's i-th triangle. */
static inline uint32_t orl_facet_triangle(const struct orl_facet *facet, uint32_t i)
{
    return facet->first_triangle + i * facet->step;
}

/* All of these are of the scene's own. */
static inline bool orl_triangle_is_none(const struct orl_geometry *geometry, size_t index)
{
    const struct orl_couple *const couple = &geometry->couples[index / 2];
    return index % 2 == 1 && couple->corners[2] == couple->corners[3];
}

static inline uint32_t orl_couple_facet(const struct orl_couple *couple, bool second)
{
    return couple->facet + (second ? couple->next : 0U);
}

static inline uint32_t orl_triangle_facet(const struct orl_geometry *geometry, size_t index)
{
    return geometry->listed ? geometry->listed[index].facet
                            : orl_couple_facet(&geometry->couples[index / 2], index % 2);
}

/* Which of the geometry's corners its k-th is. */
static inline uint32_t orl_triangle_corner(const struct orl_geometry *geometry, size_t index,
                                           unsigned k)
{
    static const uint8_t order[2][5] = {{3, 0, 1, 3, 0}, {1, 2, 3, 1, 2}};
    if (geometry->listed)
        return geometry->listed[index].corners[k];
    const struct orl_couple *const couple = &geometry->couples[index / 2];
    const unsigned turn = index % 2 ? couple->turn_of_second : couple->turn;
    return couple->corners[order[index % 2][turn + k]];
}

static inline struct orl_triangle orl_triangle_of_own(const struct orl_geometry *geometry,
                                                      size_t index)
{
    const struct orl_vec3 *const corners = geometry->corners;
    if (!corners)
        return orl_triangle_unpacked(geometry, index);
    return (struct orl_triangle){corners[orl_triangle_corner(geometry, index, 0)],
                                 corners[orl_triangle_corner(geometry, index, 1)],
                                 corners[orl_triangle_corner(geometry, index, 2)]};
}

static inline double orl_triangle_area(const struct orl_triangle *t)
{
    return 0.5 * orl_length(orl_cross(orl_sub(t->b, t->a), orl_sub(t->c, t->a)));
}

/*
 * Whether it has so many triangles that what each takes counts for more than what is saved by
 * keeping what can be worked out.
 */
static inline bool orl_geometry_is_vast(const struct orl_geometry *geometry)
{
    return geometry->n_couples >= 1 << 16;
}

/* A polygon's corners, as the files list them: of the scene's own, and of one that can be met. */
struct orl_facet_outline {
    const struct orl_vec3 *corners; /* the geometry's; NULL: packed */
    const uint32_t *own;            /* which of them; or NULL: at */
    uint32_t n, at[4];
    const struct orl_geometry *geometry;
};
struct orl_facet_outline orl_outline_looked_up(const struct orl_geometry *geometry, uint32_t facet);
static inline struct orl_facet_outline orl_outline_of_facet(const struct orl_geometry *geometry,
                                                            uint32_t facet)
{
    if (!geometry->listed)
        return orl_outline_looked_up(geometry, facet);
    const struct orl_own_outline *const own = &geometry->outlines[facet];
    struct orl_facet_outline outline; /* without what is not read */
    outline.corners = geometry->corners;
    outline.own = geometry->outline_corners + own->first;
    outline.n = own->n;
    return outline;
}

static inline struct orl_vec3 orl_outline_corner(const struct orl_facet_outline *outline,
                                                 uint32_t i)
{
    const uint32_t corner = outline->own ? outline->own[i] : outline->at[i];
    return outline->corners ? outline->corners[corner]
                            : orl_corner_unpacked(outline->geometry, corner);
}

static inline struct orl_triangle orl_triangle_of(const struct orl_geometry *geometry, size_t index)
{
    return index < orl_geometry_triangles_end(geometry) ? orl_triangle_of_own(geometry, index)
                                                        : orl_placed_triangle(geometry, index);
}

/* What is kept of them beside couples, and the outlines of all facets, unless they are too many.
 * False: out of memory. */
bool orl_geometry_list_triangles(struct orl_geometry *geometry);

/* How many there are, of its own. */
size_t orl_geometry_count_triangles(const struct orl_geometry *geometry);

/* See orl_prepare_thread (oriel/run.h). */
int orl_geometry_prepare_thread(struct orl_error *err);

/* Returns 0 and a geometry the caller frees, or ORL_ERR_NOMEM, ORL_ERR_RANGE. */
int orl_geometry_new(const struct orl_description *description, struct orl_geometry **ret_geometry,
                     struct orl_error *err);
void orl_geometry_free(struct orl_geometry *geometry);

/* The nearest surface along the ray within max_distance; direction is unit. */
bool orl_geometry_intersect(const struct orl_geometry *geometry, struct orl_vec3 origin,
                            struct orl_vec3 direction, double max_distance,
                            struct orl_hit *ret_hit);

struct orl_ray {
    struct orl_vec3 origin, direction; /* unit */
};

/*
 * What each of many rays meets first, as orl_geometry_intersect says with no limit on the distance;
 * but for rays that pass through an edge, where it may be either side. They are done side by side;
 * alike: all of about one direction, which is several times as quick (and slower when untrue).
 */
void orl_geometry_intersect_many(const struct orl_geometry *geometry, const struct orl_ray *rays,
                                 size_t n, bool alike, struct orl_hit *ret_hits, bool *ret_found);

/* Whether anything at all, glass included, lies within max_distance. */
bool orl_geometry_occluded(const struct orl_geometry *geometry, struct orl_vec3 origin,
                           struct orl_vec3 direction, double max_distance);

/* Whether the facet may be missing in places, by antimatter. */
bool orl_geometry_is_cut(const struct orl_geometry *geometry, uint32_t facet);

/*
 * A copy of one that has nothing placed, in which only the facets to keep can be met; the others
 * have their places in the arrays, but no area. Returns 0 and a geometry the caller frees, or
 * ORL_ERR_NOMEM.
 */
int orl_geometry_subset(const struct orl_geometry *whole, const bool *keep,
                        struct orl_geometry **ret_geometry, struct orl_error *err);

/* Of the scene's own facets that have more. */
const struct orl_facet_more *orl_facet_more_of(const struct orl_geometry *geometry, uint32_t facet);

static inline double orl_facet_beyond(const struct orl_geometry *geometry, uint32_t facet)
{
    struct orl_facet own;
    return orl_facet_own(geometry, facet, &own)->stands_off
               ? orl_facet_more_of(geometry, facet)->beyond
               : 0;
}

/* Where a ray that leaves a point of a facet, of that front normal, along direction is to start. */
static inline struct orl_vec3 orl_facet_leave(const struct orl_geometry *geometry, uint32_t facet,
                                              struct orl_vec3 point, struct orl_vec3 normal,
                                              struct orl_vec3 direction)
{
    const double side = orl_dot(direction, normal) >= 0 ? 1 : -1;
    if (facet >= geometry->n_plain)
        return orl_madd(point, normal, side * orl_facet_clear_elsewhere(geometry, facet, side));
    const struct orl_facet *f = &geometry->facets[facet];
    /* To the side of what it stands for: beyond that. */
    const double beyond = f->stands_off ? orl_facet_more_of(geometry, facet)->beyond : 0;
    const double hidden = beyond * side < 0 ? fabs(beyond) : 0;
    return orl_madd(point, normal, side * (f->offset + hidden));
}

/* The normal on the side that the ray met. */
static inline struct orl_vec3 orl_hit_facing(const struct orl_hit *hit)
{
    return hit->front ? hit->normal : orl_neg(hit->normal);
}

/* Where a ray that leaves the hit point along direction is to start. */
static inline struct orl_vec3 orl_hit_leave(const struct orl_geometry *geometry,
                                            const struct orl_hit *hit, struct orl_vec3 direction)
{
    return orl_facet_leave(geometry, hit->facet, hit->point, hit->normal, direction);
}

/*
 * Texture coordinates of a hit, worked out when they are asked for. In a polygon's triangle the
 * shares of its corners b and c; on what is round the turn about the axis (0 to 1, from no
 * direction in particular) and the way along it: from the first centre to the second, from a
 * sphere's lowest point to its highest, from a ring's inner rim to its outer one.
 */
void orl_hit_uv(const struct orl_geometry *geometry, const struct orl_hit *hit, double ret_uv[2]);

/* A point uniform by area on a facet, with its front normal; u in [0,1)^2. Of the scene's own
 * alone, points of many pairs. */
void orl_facet_sample(const struct orl_geometry *geometry, uint32_t facet, const double u[2],
                      struct orl_vec3 *ret_point, struct orl_vec3 *ret_normal);
void orl_facet_sample_many(const struct orl_geometry *geometry, uint32_t facet,
                           const double (*u)[2], size_t n, struct orl_vec3 *ret_points);

#endif
