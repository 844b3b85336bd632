#include <stdlib.h>

#include "photon/map/map_layout.h"
#include "photon/surface/flat_facets.h"

static struct orl_vec3 corner_of(const struct orl_geometry *g, uint32_t triangle, uint32_t k)
{
    return orl_corner_get(g, orl_triangle_corner(g, triangle, k));
}

static void build_plane(struct orl_planes *planes, uint32_t facet, uint32_t first)
{
    const struct orl_geometry *g = planes->geometry;
    struct orl_facet own;
    const struct orl_facet *f = orl_facet_get_own(g, facet, &own);
    struct orl_plane *plane = &planes->planes[facet];
    double low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY};
    *plane = (struct orl_plane){
        .frame = orl_frame_about(f->normal), .first = first, .triangles = f->n_triangles};
    planes->is_flat[facet] = f->n_triangles > 0 && f->area > 0;
    if (!planes->is_flat[facet])
        return;
    for (uint32_t i = 0; i < 3 * f->n_triangles; i++) {
        const struct orl_vec3 a = corner_of(g, orl_facet_triangle(f, i / 3), i % 3);
        const double x = orl_dot(a, plane->frame.u), y = orl_dot(a, plane->frame.v);
        low[0] = orl_smaller(low[0], x);
        low[1] = orl_smaller(low[1], y);
        high[0] = orl_larger(high[0], x);
        high[1] = orl_larger(high[1], y);
    }
    plane->wide = high[0] - low[0];
    plane->high = high[1] - low[1];
    const double level = orl_dot(corner_of(g, orl_facet_triangle(f, 0), 0), f->normal);
    plane->origin =
        orl_add(orl_scale(f->normal, level),
                orl_add(orl_scale(plane->frame.u, low[0]), orl_scale(plane->frame.v, low[1])));
    for (uint32_t i = 0; i < f->n_triangles; i++)
        for (uint32_t k = 0; k < 3; k++)
            planes->plane_triangles[first + i].corners[k] =
                orl_plane_project(plane, corner_of(g, orl_facet_triangle(f, i), k));
}

bool orl_planes_init(struct orl_planes *planes, const struct orl_geometry *geometry)
{
    const size_t most = orl_geometry_triangles_end(geometry);
    uint32_t first = 0;
    *planes =
        (struct orl_planes){.geometry = geometry,
                            .planes = malloc((geometry->n_facets + 1) * sizeof *planes->planes),
                            .plane_triangles = malloc((most + 1) * sizeof *planes->plane_triangles),
                            .is_flat = calloc(geometry->n_facets + 1, sizeof *planes->is_flat)};
    if (!planes->planes || !planes->plane_triangles || !planes->is_flat)
        return false;
    for (size_t i = 0; i < geometry->n_facets; i++) {
        struct orl_facet own;
        build_plane(planes, (uint32_t)i, first);
        first += orl_facet_get_own(geometry, i, &own)->n_triangles;
    }
    return true;
}

void orl_planes_done(struct orl_planes *planes)
{
    free(planes->planes);
    free(planes->plane_triangles);
    free(planes->is_flat);
}

struct outline {
    struct orl_plane_point corners[8]; /* a triangle clipped four times */
    uint32_t count;
};

/* Clips the outline to the part where a x + b y <= c (Sutherland and Hodgman 1974). */
static void clip_outline(struct outline *outline, double a, double b, double c)
{
    struct outline kept = {.count = 0};
    for (uint32_t i = 0; i < outline->count; i++) {
        const struct orl_plane_point p = outline->corners[i];
        const struct orl_plane_point q = outline->corners[(i + 1) % outline->count];
        const double at_p = a * p.x + b * p.y - c, at_q = a * q.x + b * q.y - c;
        if (at_p <= 0 && kept.count < 8)
            kept.corners[kept.count++] = p;
        if ((at_p < 0) != (at_q < 0) && at_p != at_q && kept.count < 8) {
            const double share = at_p / (at_p - at_q);
            kept.corners[kept.count++] =
                (struct orl_plane_point){p.x + share * (q.x - p.x), p.y + share * (q.y - p.y)};
        }
    }
    *outline = kept;
}

static double area_of(const struct outline *outline)
{
    double sum = 0;
    for (uint32_t i = 2; i < outline->count; i++)
        sum += orl_plane_cross(outline->corners[0], outline->corners[i - 1], outline->corners[i]);
    return 0.5 * fabs(sum);
}

static uint32_t step_at(double at, double width, uint32_t most)
{
    return (uint32_t)orl_smaller(orl_larger(at / width, 0), most - 1);
}

/* Adds a triangle's area to the cells of one row. */
static void add_row(const struct orl_facet_grid *grid, const struct outline *row, uint32_t y,
                    float *areas)
{
    double low = INFINITY, high = -INFINITY;
    for (uint32_t i = 0; i < row->count; i++) {
        low = orl_smaller(low, row->corners[i].x);
        high = orl_larger(high, row->corners[i].x);
    }
    for (uint32_t x = step_at(low, grid->width, grid->columns);
         row->count > 2 && x <= step_at(high, grid->width, grid->columns); x++) {
        struct outline square = *row;
        clip_outline(&square, -1, 0, -(x * grid->width));
        clip_outline(&square, 1, 0, (x + 1) * grid->width);
        areas[grid->first + y * grid->columns + x] += (float)area_of(&square);
    }
}

void orl_facet_grid_add_areas(const struct orl_facet_grid *grid,
                              const struct orl_plane_triangle *plane_triangles, uint32_t triangles,
                              float *areas)
{
    for (uint32_t i = 0; i < triangles && grid->columns > 0; i++) {
        const struct orl_plane_triangle *t = &plane_triangles[i];
        const double low =
            orl_smaller(orl_smaller(t->corners[0].y, t->corners[1].y), t->corners[2].y);
        const double high =
            orl_larger(orl_larger(t->corners[0].y, t->corners[1].y), t->corners[2].y);
        for (uint32_t y = step_at(low, grid->height, grid->rows);
             y <= step_at(high, grid->height, grid->rows); y++) {
            struct outline row = {.count = 3};
            for (int k = 0; k < 3; k++)
                row.corners[k] = t->corners[k];
            clip_outline(&row, 0, -1, -(y * grid->height));
            clip_outline(&row, 0, 1, (y + 1) * grid->height);
            add_row(grid, &row, y, areas);
        }
    }
}

uint32_t orl_facet_grid_fullest(const struct orl_facet_grid *grid, const float *areas, uint32_t x,
                                uint32_t y)
{
    const int dx[4] = {-1, 1, 0, 0}, dy[4] = {0, 0, -1, 1};
    uint32_t best = grid->first + y * grid->columns + x;
    for (int i = 0; i < 4; i++) {
        const int64_t to_x = (int64_t)x + dx[i], to_y = (int64_t)y + dy[i];
        if (to_x < 0 || to_y < 0 || to_x >= grid->columns || to_y >= grid->rows)
            continue;
        const uint32_t other = grid->first + (uint32_t)to_y * grid->columns + (uint32_t)to_x;
        if (areas[other] > areas[best])
            best = other;
    }
    return best;
}

enum { LEAVES_A_CHUNK = 1024, RECENT = 4 };

/* The facets on which the last photons landed, and their coded normals. */
struct recent {
    uint32_t facets[RECENT];
    uint16_t codes[RECENT]; /* normals of the side that was lit */
    uint32_t count;
};

static bool is_on(const struct orl_planes *planes, uint32_t facet,
                  const struct orl_stored_photon *photon, double rounding)
{
    const struct orl_plane *plane = &planes->planes[facet];
    const struct orl_vec3 way = orl_sub(photon->point, plane->origin);
    if (fabs(orl_dot(way, plane->frame.n)) > rounding)
        return false;
    const struct orl_plane_point at = orl_plane_project(plane, photon->point);
    for (uint32_t i = 0; i < plane->triangles; i++)
        if (orl_plane_triangle_contains(&planes->plane_triangles[plane->first + i], at))
            return true;
    return false;
}

/* Returns a recent facet that the photon lies on; or ORL_NO_FACET_SIDE. */
static uint32_t find_recent(const struct orl_planes *planes, struct recent *recent,
                            const struct orl_stored_photon *photon, double rounding)
{
    for (uint32_t i = 0; i < recent->count; i++)
        if (recent->codes[i] == photon->code && is_on(planes, recent->facets[i], photon, rounding))
            return recent->facets[i];
    return ORL_NO_FACET_SIDE;
}

static void add_recent(struct recent *recent, uint32_t facet, uint16_t code)
{
    if (recent->count < RECENT)
        recent->count++;
    for (uint32_t i = recent->count; --i > 0;) {
        recent->facets[i] = recent->facets[i - 1];
        recent->codes[i] = recent->codes[i - 1];
    }
    recent->facets[0] = facet;
    recent->codes[0] = code;
}

/* Returns the facet that a ray from above the photon hits; or ORL_NO_FACET_SIDE. */
static uint32_t trace_facet(const struct orl_geometry *g, const struct orl_stored_photon *photon,
                            double rounding)
{
    const struct orl_vec3 start = orl_madd(photon->point, photon->normal, 4 * rounding);
    struct orl_hit hit;
    return orl_geometry_intersect(g, start, orl_neg(photon->normal), 8 * rounding, &hit)
               ? hit.facet
               : ORL_NO_FACET_SIDE;
}

struct orl_stored_photon orl_stored_photon_get(const struct orl_photon_map *map, uint64_t index)
{
    const struct orl_map_header *h = map->header;
    const uint32_t *words = map->places + index / ORL_MAP_LEAF * ORL_LEAF_WORDS;
    const uint32_t at = (uint32_t)(index % ORL_MAP_LEAF);
    uint32_t cell[3];
    orl_position_unpack(words[at], words[at + ORL_MAP_LEAF], cell);
    const uint16_t code = map->normals[index];
    return (struct orl_stored_photon){orl_v3(h->low[0] + (cell[0] + 0.5) * h->cell,
                                             h->low[1] + (cell[1] + 0.5) * h->cell,
                                             h->low[2] + (cell[2] + 0.5) * h->cell),
                                      orl_normal_decode(code), code};
}

/*
 * Returns the facet of a photon. For the first photon of every leaf a ray is traced. If a recent
 * facet holds the photon and the ray hits another, the two coincide, and neither can have texels.
 */
static uint32_t facet_of(const struct orl_photon_facets *photon_facets,
                         const struct orl_stored_photon *photon, bool verify, struct recent *recent)
{
    const struct orl_planes *planes = photon_facets->planes;
    const double rounding =
        2 * photon_facets->map->header->cell + planes->geometry->radius * 0x1p-20;
    const uint32_t recent_facet = find_recent(planes, recent, photon, rounding);
    if (recent_facet != ORL_NO_FACET_SIDE && !verify)
        return recent_facet;
    const uint32_t hit_facet = trace_facet(planes->geometry, photon, rounding);
    if (hit_facet == ORL_NO_FACET_SIDE)
        return recent_facet;
    if (recent_facet != ORL_NO_FACET_SIDE && hit_facet != recent_facet) {
        atomic_store_explicit(&photon_facets->coincident[recent_facet], true, memory_order_relaxed);
        if (!orl_facet_is_instanced(planes->geometry, hit_facet))
            atomic_store_explicit(&photon_facets->coincident[hit_facet], true,
                                  memory_order_relaxed);
    }
    if (hit_facet != recent_facet && orl_planes_has(planes, hit_facet))
        add_recent(recent, hit_facet, photon->code);
    return hit_facet;
}

static void find_facets(void *arg, size_t chunk, uint32_t member)
{
    const struct orl_photon_facets *photon_facets = arg;
    const uint64_t photons = photon_facets->map->header->count;
    const uint64_t first = chunk * LEAVES_A_CHUNK * ORL_MAP_LEAF;
    const uint64_t end = first + (uint64_t)LEAVES_A_CHUNK * ORL_MAP_LEAF;
    struct recent recent = {.count = 0};
    (void)member;
    for (uint64_t i = first; i < end && i < photons; i++) {
        const struct orl_stored_photon photon = orl_stored_photon_get(photon_facets->map, i);
        const uint32_t facet = facet_of(photon_facets, &photon, i % ORL_MAP_LEAF == 0, &recent);
        photon_facets->places[i] = ORL_NO_FACET_SIDE;
        if (facet == ORL_NO_FACET_SIDE || !orl_planes_has(photon_facets->planes, facet))
            continue;
        const bool front = orl_dot(photon.normal, photon_facets->planes->planes[facet].frame.n) > 0;
        photon_facets->places[i] = 2 * facet + front;
    }
}

int orl_photon_facets_find(struct orl_photon_facets *photon_facets, struct orl_thread_pool *pool)
{
    const uint64_t leaves = (photon_facets->map->header->count + ORL_MAP_LEAF - 1) / ORL_MAP_LEAF;
    return orl_parallel_try(pool, (leaves + LEAVES_A_CHUNK - 1) / LEAVES_A_CHUNK, find_facets,
                            photon_facets);
}
