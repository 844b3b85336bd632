#include "photon/surface/footprint.h"

enum { SECTORS = ORL_FOOTPRINT_SECTORS, FREE_RAYS = 8, MOST_FACETS = 48 };

/* A wall is steeper than 45 degrees to the surface it stands on. */
static const double cosine_45 = 0.7071067811865476;
/* A sheet continues while its normal has turned by less; photons count up to 30 degrees. */
static const double cosine_28 = 0.8829475928589269;
/* The sheet also ends where chords do not fit the mean normal; orl_same_sheet allows a slope of
 * 0.05. */
static const double bend = 0.04;
/* Height of the upper rays above the surface, over the radius. */
static const double rise = 0.25;
/* Multiple of the facet's offset for small steps: above the surface, past an edge, and down from
 * there. */
static const double hair = 8;

/* Values of the C library, slightly off the axes: for an edge along an axis the same number of
 * sectors must begin on either side. */
const double orl_footprint_azimuths[SECTORS][2] = {{1.0, 0.0},
                                                   {0.9807852804032304, 0.19509032201612825},
                                                   {0.9238795325112867, 0.3826834323650898},
                                                   {0.8314696123025452, 0.5555702330196022},
                                                   {0.7071067811865476, 0.7071067811865475},
                                                   {0.5555702330196023, 0.8314696123025452},
                                                   {0.38268343236508984, 0.9238795325112867},
                                                   {0.19509032201612833, 0.9807852804032304},
                                                   {6.123233995736766e-17, 1.0},
                                                   {-0.1950903220161282, 0.9807852804032304},
                                                   {-0.3826834323650897, 0.9238795325112867},
                                                   {-0.555570233019602, 0.8314696123025455},
                                                   {-0.7071067811865475, 0.7071067811865476},
                                                   {-0.8314696123025453, 0.5555702330196022},
                                                   {-0.9238795325112867, 0.3826834323650899},
                                                   {-0.9807852804032304, 0.1950903220161286},
                                                   {-1.0, 1.2246467991473532e-16},
                                                   {-0.9807852804032304, -0.19509032201612836},
                                                   {-0.9238795325112868, -0.38268343236508967},
                                                   {-0.8314696123025455, -0.555570233019602},
                                                   {-0.7071067811865477, -0.7071067811865475},
                                                   {-0.5555702330196022, -0.8314696123025452},
                                                   {-0.38268343236509034, -0.9238795325112865},
                                                   {-0.19509032201612866, -0.9807852804032303},
                                                   {-1.8369701987210297e-16, -1.0},
                                                   {0.1950903220161283, -0.9807852804032304},
                                                   {0.38268343236509, -0.9238795325112866},
                                                   {0.5555702330196018, -0.8314696123025455},
                                                   {0.7071067811865474, -0.7071067811865477},
                                                   {0.8314696123025452, -0.5555702330196022},
                                                   {0.9238795325112865, -0.3826834323650904},
                                                   {0.9807852804032303, -0.19509032201612872}};

/* The end of one ray of the star. */
struct spoke {
    double length;
    struct orl_line line; /* the straight border it ends on, if any */
    bool ended;
};

static struct orl_frame frame_of(const struct orl_surface_point *surface_point)
{
    return orl_frame_about(surface_point->normal);
}

static double clearance_of(const struct orl_surface_point *surface_point)
{
    return hair * orl_facet_offset(surface_point->lit_scene->geometry, surface_point->facet);
}

static struct orl_vec3 in_plane(const struct orl_frame *frame, const double direction[2])
{
    return orl_add(orl_scale(frame->u, direction[0]), orl_scale(frame->v, direction[1]));
}

static bool is_flat(const struct orl_lit_scene *lit_scene, uint32_t facet)
{
    return orl_surface_kind_is_flat(orl_facet_kind(lit_scene->geometry, facet));
}

static bool is_diffuse(const struct orl_lit_scene *lit_scene, const struct orl_hit *hit)
{
    return orl_rgb_max(orl_material_diffuse(orl_lit_scene_material(lit_scene, hit), hit)) > 0;
}

bool orl_surface_point_find(const struct orl_lit_scene *lit_scene, struct orl_vec3 point,
                            struct orl_vec3 normal, double tolerance,
                            struct orl_surface_point *ret_surface_point)
{
    struct orl_hit hit;
    if (!orl_geometry_intersect(lit_scene->geometry, orl_madd(point, normal, tolerance),
                                orl_neg(normal), 2 * tolerance, &hit) ||
        fabs(orl_dot(hit.normal, normal)) < cosine_28)
        return false;
    *ret_surface_point = (struct orl_surface_point){.lit_scene = lit_scene,
                                                    .point = hit.point,
                                                    .normal = orl_hit_facing(&hit),
                                                    .facet = hit.facet};
    return true;
}

/* ---- Walls ----------------------------------------------------------------------------------- */

/* Computes two heights above the surface at which walls are searched: just above it, and a share
 * of the radius that is unobstructed. */
static void heights_of(const struct orl_surface_point *surface_point, double radius,
                       double ret_heights[2])
{
    const double low = clearance_of(surface_point);
    const struct orl_vec3 start = orl_madd(surface_point->point, surface_point->normal, low / hair);
    double high = rise * radius;
    struct orl_hit hit;
    if (orl_geometry_intersect(surface_point->lit_scene->geometry, start, surface_point->normal,
                               high, &hit))
        high = 0.5 * hit.distance;
    ret_heights[0] = orl_smaller(low, orl_larger(high, low / hair));
    ret_heights[1] = high;
}

/* The ray starts a small step ahead, so that at an edge it does not hit the wall that it leaves. */
static bool meets_wall(const struct orl_surface_point *surface_point, double height,
                       struct orl_vec3 direction, double length, struct orl_hit *ret_hit)
{
    const struct orl_geometry *geometry = surface_point->lit_scene->geometry;
    const double step = orl_smaller(orl_facet_offset(geometry, surface_point->facet), 0.5 * length);
    const struct orl_vec3 over = orl_madd(surface_point->point, surface_point->normal, height);
    if (!orl_geometry_intersect(geometry, orl_madd(over, direction, step), direction, length - step,
                                ret_hit) ||
        fabs(orl_dot(ret_hit->normal, surface_point->normal)) >= cosine_45)
        return false;
    ret_hit->distance += step;
    return true;
}

/* Returns the line on which a plane through the hit cuts the tangent plane. */
static struct orl_line foot_of_wall(const struct orl_surface_point *surface_point,
                                    const struct orl_frame *frame, const struct orl_hit *hit)
{
    const struct orl_vec3 way = orl_sub(hit->point, surface_point->point);
    const double x = orl_dot(hit->normal, frame->u), y = orl_dot(hit->normal, frame->v);
    const double length = sqrt(x * x + y * y);
    const double offset = (x * orl_dot(way, frame->u) + y * orl_dot(way, frame->v)) / length;
    const double sign = offset < 0 ? -1 : 1;
    return (struct orl_line){{sign * x / length, sign * y / length}, sign * offset};
}

static void stop_at_walls(const struct orl_surface_point *surface_point,
                          const struct orl_frame *frame, const double heights[2],
                          const double direction[2], struct spoke *spoke)
{
    for (int i = 0; i < 2; i++) {
        struct orl_hit hit;
        if (!meets_wall(surface_point, heights[i], in_plane(frame, direction), spoke->length, &hit))
            continue;
        spoke->length = hit.distance;
        spoke->line = foot_of_wall(surface_point, frame, &hit);
        spoke->ended = true;
    }
}

bool orl_surface_point_is_clear(const struct orl_surface_point *surface_point, double radius)
{
    const struct orl_frame frame = frame_of(surface_point);
    /* Eight rays as long as the corners of the octagon around the disc: no long wall cuts the
     * disc and passes between them. */
    const double length = radius / cos(ORL_PI / FREE_RAYS);
    double heights[2];
    if (orl_geometry_is_cut(surface_point->lit_scene->geometry, surface_point->facet) ||
        orl_outline_clearance(surface_point->lit_scene, surface_point->facet,
                              surface_point->point) < radius)
        return false;
    heights_of(surface_point, radius, heights);
    for (int i = 0; i < FREE_RAYS; i++) {
        const double *direction = orl_footprint_azimuths[(2 * i + 1) * SECTORS / (2 * FREE_RAYS)];
        struct orl_hit hit;
        for (int k = 0; k < 2; k++)
            if (meets_wall(surface_point, heights[k], in_plane(&frame, direction), length, &hit))
                return false;
    }
    return true;
}

double orl_surface_point_flat_radius(const struct orl_surface_point *surface_point)
{
    return is_flat(surface_point->lit_scene, surface_point->facet) &&
                   !orl_geometry_is_cut(surface_point->lit_scene->geometry, surface_point->facet)
               ? orl_outline_clearance(surface_point->lit_scene, surface_point->facet,
                                       surface_point->point)
               : 0;
}

bool orl_surface_point_unoccluded(const struct orl_surface_point *surface_point,
                                  struct orl_vec3 point)
{
    const struct orl_vec3 way = orl_sub(point, surface_point->point);
    const struct orl_vec3 flat =
        orl_madd(way, surface_point->normal, -orl_dot(way, surface_point->normal));
    const double length = orl_length(flat);
    double heights[2];
    struct orl_hit hit;
    if (!(length > 0))
        return true;
    heights_of(surface_point, length, heights);
    for (int k = 0; k < 2; k++)
        if (meets_wall(surface_point, heights[k], orl_scale(flat, 1 / length), length, &hit))
            return false;
    return true;
}

/* ---- Edges ----------------------------------------------------------------------------------- */

/* One ray of the star on its way along the surface. */
struct sheet_walk {
    const struct orl_surface_point *surface_point;
    const struct orl_frame *frame;
    const double *direction;
    uint32_t facet;          /* the current facet */
    struct orl_vec3 normal;  /* the current facet's normal, on the query's side */
    struct orl_vec3 through; /* a point of the current facet's plane */
};

/* Returns the point of the current facet's plane above a length in the tangent plane. */
static struct orl_vec3 point_at(const struct sheet_walk *m, double length)
{
    const struct orl_vec3 flat =
        orl_madd(m->surface_point->point, in_plane(m->frame, m->direction), length);
    const double height =
        orl_dot(orl_sub(m->through, flat), m->normal) / orl_dot(m->frame->n, m->normal);
    return orl_madd(flat, m->frame->n, height);
}

/* Returns true if photons of the current facet at that point count as on the surface point's sheet.
 */
static bool fits_sheet(const struct sheet_walk *m, struct orl_vec3 point)
{
    const struct orl_vec3 chord = orl_sub(point, m->surface_point->point);
    const struct orl_vec3 mean = orl_normalize(orl_add(m->surface_point->normal, m->normal));
    return orl_dot(m->surface_point->normal, m->normal) > cosine_28 &&
           fabs(orl_dot(chord, mean)) <= bend * orl_length(chord) + clearance_of(m->surface_point);
}

/* Steps over an edge onto the facet that continues the surface. Returns false if there is none. */
static bool step_over(struct sheet_walk *m, double length)
{
    const struct orl_lit_scene *lit_scene = m->surface_point->lit_scene;
    const double gap =
        orl_larger(hair * orl_facet_offset(lit_scene->geometry, m->facet), 0x1p-50 * length);
    struct orl_hit hit;
    const struct orl_vec3 above = orl_madd(point_at(m, length + gap), m->frame->n, gap);
    if (!orl_geometry_intersect(lit_scene->geometry, above, orl_neg(m->frame->n), 2 * gap, &hit) ||
        !is_flat(lit_scene, hit.facet) || !is_diffuse(lit_scene, &hit))
        return false;
    m->facet = hit.facet;
    m->normal = orl_hit_facing(&hit);
    m->through = hit.point;
    return fits_sheet(m, hit.point);
}

static void stop_at_edge(const struct sheet_walk *m, double length, const struct orl_line *line,
                         struct spoke *spoke)
{
    spoke->length = orl_smaller(spoke->length,
                                orl_length(orl_sub(point_at(m, length), m->surface_point->point)));
    spoke->line = *line;
    spoke->ended = true;
}

/* Shortens a spoke to where the surface ends, or bends away too far. */
static void stop_at_edges(const struct orl_surface_point *surface_point,
                          const struct orl_frame *frame, const double direction[2],
                          struct spoke *spoke)
{
    const struct orl_lit_scene *lit_scene = surface_point->lit_scene;
    struct sheet_walk m = {
        surface_point,       frame, direction, surface_point->facet, surface_point->normal,
        surface_point->point};
    struct sheet_walk before = m; /* the state on the facet before */
    struct orl_line edge = {{0, 0}, 0}, next;
    double at = 0, crossed = 0;
    for (int i = 0; i < MOST_FACETS; i++) {
        const bool flat = is_flat(lit_scene, m.facet);
        double exit =
            orl_outline_exit(lit_scene, m.facet, frame, surface_point->point, direction, at, &next);
        /* Every outline is closed: if no crossing is left, the edge is at the current length. */
        if (flat && !isfinite(exit))
            exit = at;
        /* A facet that bends away before its far end is left out from its near end on. */
        if (i > 0 && !fits_sheet(&m, point_at(&m, orl_smaller(exit, spoke->length))))
            break;
        if (exit >= spoke->length)
            return;
        crossed = exit;
        edge = next;
        before = m;
        if (!flat || !step_over(&m, exit))
            break;
        at = exit + 0.5 * hair * orl_facet_offset(lit_scene->geometry, m.facet);
    }
    stop_at_edge(&before, crossed, &edge, spoke);
}

/* ---- Cuts ------------------------------------------------------------------------------------ */

static bool has_surface_at(const struct orl_surface_point *surface_point,
                           const struct orl_frame *frame, const double direction[2], double length)
{
    const double gap = clearance_of(surface_point);
    const struct orl_vec3 point =
        orl_madd(surface_point->point, in_plane(frame, direction), length);
    struct orl_hit hit;
    return orl_geometry_intersect(surface_point->lit_scene->geometry,
                                  orl_madd(point, frame->n, gap), orl_neg(frame->n), 2 * gap, &hit);
}

/* Shortens a spoke to where antimatter has removed a flat surface; outlines do not show that. */
static void stop_at_cuts(const struct orl_surface_point *surface_point,
                         const struct orl_frame *frame, const double direction[2],
                         struct spoke *spoke)
{
    enum { PROBES = 16, HALVINGS = 12 };
    if (!is_flat(surface_point->lit_scene, surface_point->facet))
        return;
    for (int i = 1; i < PROBES; i++) {
        double low = spoke->length * (i - 1) / PROBES, high = spoke->length * i / PROBES;
        if (has_surface_at(surface_point, frame, direction, high))
            continue;
        for (int k = 0; k < HALVINGS; k++) {
            const double middle = 0.5 * (low + high);
            if (has_surface_at(surface_point, frame, direction, middle))
                low = middle;
            else
                high = middle;
        }
        *spoke = (struct spoke){.length = high, .ended = true};
        return;
    }
}

/* ---- Star of rays ---------------------------------------------------------------------------- */

static void cast_spokes(const struct orl_surface_point *surface_point,
                        const struct orl_frame *frame, double radius, struct spoke spokes[SECTORS],
                        double *ret_clear)
{
    double heights[2];
    heights_of(surface_point, radius, heights);
    *ret_clear = radius;
    for (int i = 0; i < SECTORS; i++) {
        const double *direction = orl_footprint_azimuths[i];
        /* Longer than the radius, so that rays meet a line that only just cuts the disc between
         * two of them. */
        spokes[i] = (struct spoke){.length = radius / cos(ORL_PI / SECTORS)};
        stop_at_walls(surface_point, frame, heights, direction, &spokes[i]);
        if (spokes[i].ended)
            *ret_clear = orl_smaller(*ret_clear, cos(ORL_PI / SECTORS) * spokes[i].length);
        stop_at_edges(surface_point, frame, direction, &spokes[i]);
        if (orl_geometry_is_cut(surface_point->lit_scene->geometry, surface_point->facet))
            stop_at_cuts(surface_point, frame, direction, &spokes[i]);
    }
}

/* Returns true if a spoke ends on the line, or the line is beyond the radius there. */
static bool ends_on_line(const struct spoke *spoke, const struct orl_line *line, double radius,
                         int at)
{
    const double *direction = orl_footprint_azimuths[at % SECTORS];
    const double slope = line->normal[0] * direction[0] + line->normal[1] * direction[1];
    const double there = slope > 0 ? line->offset / slope : INFINITY;
    if (!spoke->ended)
        return there >= radius;
    return fabs(there - spoke->length) <= 1e-4 * spoke->length;
}

static struct orl_wedge wedge_between(const struct spoke *a, const struct spoke *b, double radius,
                                      int at)
{
    struct orl_wedge wedge = {.radius = radius};
    const struct spoke *const both[2] = {a, b};
    if (!a->ended && !b->ended)
        return wedge;
    for (int i = 0; i < 2; i++) {
        const struct orl_line *line = &both[i]->line;
        if (both[i]->ended && (line->normal[0] != 0 || line->normal[1] != 0) &&
            ends_on_line(both[1 - i], line, radius, at + 1 - i)) {
            wedge.border = *line;
            return wedge;
        }
    }
    /* Limits the radius to the straight line through either end, whatever its direction. */
    wedge.radius =
        orl_smaller(radius, cos(2 * ORL_PI / SECTORS) * orl_smaller(a->length, b->length));
    return wedge;
}

void orl_footprint_make(const struct orl_surface_point *surface_point, double radius,
                        struct orl_footprint *ret_footprint)
{
    struct spoke spokes[SECTORS];
    ret_footprint->frame = frame_of(surface_point);
    cast_spokes(surface_point, &ret_footprint->frame, radius, spokes, &ret_footprint->clearance);
    for (int i = 0; i < SECTORS; i++)
        ret_footprint->wedges[i] = wedge_between(&spokes[i], &spokes[(i + 1) % SECTORS], radius, i);
}

/* Returns the sector by comparisons, because it is called for each photon; each octant has four
 * sectors. */
static int sector_of(double x, double y)
{
    static const double tangents[3] = {0.1989123673796580, 0.4142135623730950, 0.6681786379192989};
    const double a = fabs(x), b = fabs(y), low = orl_smaller(a, b), high = orl_larger(a, b);
    int sector = 0;
    for (int i = 0; i < 3; i++)
        sector += low >= tangents[i] * high;
    if (b > a)
        sector = SECTORS / 4 - 1 - sector;
    if (x < 0)
        sector = SECTORS / 2 - 1 - sector;
    return y < 0 ? SECTORS - 1 - sector : sector;
}

bool orl_footprint_contains(const struct orl_footprint *footprint, struct orl_vec3 chord)
{
    const double x = orl_dot(chord, footprint->frame.u), y = orl_dot(chord, footprint->frame.v);
    const double flat2 = x * x + y * y, length2 = orl_dot(chord, chord);
    if (!(flat2 > 0))
        return true;
    const struct orl_wedge *wedge = &footprint->wedges[sector_of(x, y)];
    const double beyond = wedge->border.normal[0] * x + wedge->border.normal[1] * y;
    return length2 <= wedge->radius * wedge->radius &&
           (!(beyond > 0) || beyond * sqrt(length2) <= wedge->border.offset * sqrt(flat2));
}

static double cross_of(const double a[2], const double b[2])
{
    return a[0] * b[1] - a[1] * b[0];
}

/*
 * Returns the area of a wedge within a radius. Its border cuts off a part of the sector: of the
 * border, the part within the circle and the sector has a triangle below it, and the rest of the
 * sector is bounded by arcs.
 */
static double wedge_area(const struct orl_wedge *wedge, double radius, int at)
{
    const double width = 2 * ORL_PI / SECTORS, r = orl_smaller(radius, wedge->radius);
    const double *const n = wedge->border.normal, offset = wedge->border.offset;
    const double *const first = orl_footprint_azimuths[at];
    const double *const last = orl_footprint_azimuths[(at + 1) % SECTORS];
    if ((n[0] == 0 && n[1] == 0) || offset >= r)
        return 0.5 * width * r * r;
    /* The ends of the part of the border in the circle, in the order of angles. */
    const double half = sqrt(r * r - offset * offset);
    double from[2] = {offset * n[0] + half * n[1], offset * n[1] - half * n[0]};
    double to[2] = {offset * n[0] - half * n[1], offset * n[1] + half * n[0]};
    const double first_slope = n[0] * first[0] + n[1] * first[1];
    const double last_slope = n[0] * last[0] + n[1] * last[1];
    const bool first_is_cut = first_slope > 0 && r * first_slope >= offset;
    const bool last_is_cut = last_slope > 0 && r * last_slope >= offset;
    double arcs = 0;
    if (!first_is_cut && !last_is_cut && !(cross_of(first, n) > 0 && cross_of(n, last) > 0))
        return 0.5 * width * r * r;
    if (first_is_cut) {
        from[0] = offset / first_slope * first[0];
        from[1] = offset / first_slope * first[1];
    } else {
        arcs += asin(orl_smaller(orl_larger(cross_of(first, from) / r, 0), 1));
    }
    if (last_is_cut) {
        to[0] = offset / last_slope * last[0];
        to[1] = offset / last_slope * last[1];
    } else {
        arcs += asin(orl_smaller(orl_larger(cross_of(to, last) / r, 0), 1));
    }
    return 0.5 * (cross_of(from, to) + arcs * r * r);
}

double orl_footprint_area(const struct orl_footprint *footprint, double radius)
{
    double area = 0;
    for (int i = 0; i < SECTORS; i++)
        area += wedge_area(&footprint->wedges[i], radius, i);
    return area;
}
