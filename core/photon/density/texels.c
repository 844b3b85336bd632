#include "photon/density/irradiance_tables.h"

#include <stdlib.h>
#include <string.h>

#include "photon/map/quantization.h"
#include "photon/surface/flat_facets.h"

enum { MOST_ACROSS = 4096, LEAVES_A_CHUNK = 1024, SLICES = 16, LINE = 64 };

/* Minimum share of surface in a texel; texels with less are merged with their fullest neighbour. */
static const double least_share = 0.25;

struct orl_texels {
    const struct orl_lit_scene *lit_scene;
    struct orl_planes planes;     /* planes of the scene's facets */
    struct orl_facet_grid *sides; /* per facet: back, front; a cell is a texel */
    struct orl_texel *texels;
    bool *cut; /* per texel: an object stands on it */
    uint32_t count;
    double photons; /* average number in a texel */
};

/* Sums of a texel during building: flux, then irradiance. */
struct sum {
    float values[3], parts[ORL_MAP_BATCHES]; /* by channel; luma by batch */
};

/* Temporary data while texels are built. */
struct texel_builder {
    struct orl_texels *texels;
    struct sum *sums; /* per texel */
    const struct orl_photon_map *map;
    uint32_t *places;        /* per photon: its side, then its texel */
    atomic_bool *coincident; /* per facet: another coincides with it */
    float *areas;            /* per texel */
};

static uint32_t index_in(const struct orl_texels *texels, uint32_t side, struct orl_vec3 point)
{
    return orl_facet_grid_index(&texels->sides[side],
                                orl_plane_project(&texels->planes.planes[side / 2], point));
}

static uint32_t steps_across(double length, double width)
{
    return (uint32_t)fmin(fmax(round(length / width), 1), MOST_ACROSS);
}

/* Divides every side into texels, in proportion to its photons. */
static void lay_out_texels(struct texel_builder *m)
{
    struct orl_texels *texels = m->texels;
    const size_t n = texels->planes.geometry->n_facets;
    for (size_t i = 0; i < 2 * n; i++)
        texels->sides[i] = (struct orl_facet_grid){.first = 0};
    for (uint64_t i = 0; i < m->map->header->count; i++)
        if (m->places[i] != ORL_NO_FACET_SIDE)
            texels->sides[m->places[i]].first++;
    uint64_t count = 0;
    for (size_t i = 0; i < 2 * n; i++) {
        struct orl_facet_grid *side = &texels->sides[i];
        const struct orl_plane *plane = &texels->planes.planes[i / 2];
        const double landed = side->first;
        texels->planes.is_flat[i / 2] =
            texels->planes.is_flat[i / 2] && !atomic_load(&m->coincident[i / 2]);
        *side = (struct orl_facet_grid){.first = (uint32_t)count};
        if (!texels->planes.is_flat[i / 2] || !(landed > 0))
            continue;
        const double width =
            sqrt(orl_facet_area(texels->planes.geometry, i / 2) * texels->photons / landed);
        side->columns = steps_across(plane->wide, width);
        side->rows = steps_across(plane->high, width);
        side->width = plane->wide / side->columns;
        side->height = plane->high / side->rows;
        count += (uint64_t)side->columns * side->rows;
    }
    texels->count = count < ORL_NO_FACET_SIDE ? (uint32_t)count : 0;
}

static void find_texels(void *arg, size_t chunk, uint32_t member)
{
    const struct texel_builder *m = arg;
    const uint64_t photons = m->map->header->count, first = chunk * LEAVES_A_CHUNK * ORL_MAP_LEAF;
    const uint64_t end = first + (uint64_t)LEAVES_A_CHUNK * ORL_MAP_LEAF;
    (void)member;
    for (uint64_t i = first; i < end && i < photons; i++) {
        const uint32_t side = m->places[i];
        if (side == ORL_NO_FACET_SIDE)
            continue;
        m->places[i] = m->texels->sides[side].columns == 0
                           ? ORL_NO_FACET_SIDE
                           : index_in(m->texels, side, orl_stored_photon_get(m->map, i).point);
    }
}

/* Adds photons' flux to a slice of the texels. */
static void add_flux(void *arg, size_t slice, uint32_t member)
{
    const struct texel_builder *m = arg;
    const struct orl_photon_map *map = m->map;
    const uint64_t count = m->texels->count;
    const uint32_t from = (uint32_t)(count * slice / SLICES);
    const uint32_t room = (uint32_t)(count * (slice + 1) / SLICES) - from;
    (void)member;
    for (uint64_t i = 0; i < map->header->count; i++) {
        if (m->places[i] - from >= room) /* also true before it: unsigned numbers wrap */
            continue;
        const struct orl_rgb flux =
            orl_rgb_scale(orl_flux_unpack(map->fluxes[i]), map->header->flux_unit);
        struct sum *sum = &m->sums[m->places[i]];
        sum->values[0] += (float)flux.r;
        sum->values[1] += (float)flux.g;
        sum->values[2] += (float)flux.b;
        sum->parts[orl_photon_batch(map, (uint32_t)i)] += (float)orl_luma(flux);
    }
}

static void add_areas(void *arg, size_t index, uint32_t member)
{
    const struct texel_builder *m = arg;
    const struct orl_planes *planes = &m->texels->planes;
    const struct orl_plane *plane = &planes->planes[index / 2];
    (void)member;
    orl_facet_grid_add_areas(&m->texels->sides[index], &planes->plane_triangles[plane->first],
                             plane->triangles, m->areas);
}

static void add_sum(struct sum *sum, const struct sum *more)
{
    for (int c = 0; c < 3; c++)
        sum->values[c] += more->values[c];
    for (int b = 0; b < ORL_MAP_BATCHES; b++)
        sum->parts[b] += more->parts[b];
}

static void divide_by_area(struct sum *sum, float area)
{
    for (int c = 0; c < 3; c++)
        sum->values[c] = area > 0 ? sum->values[c] / area : 0;
    for (int b = 0; b < ORL_MAP_BATCHES; b++)
        sum->parts[b] = area > 0 ? sum->parts[b] / area : 0;
}

/* Rounds the shares such that their sum is exact. */
static void store_texel(const struct sum *sum, struct orl_texel *texel)
{
    float luma = 0, before = 0;
    long rounded = 0;
    memcpy(texel->irradiance, sum->values, sizeof texel->irradiance);
    for (int b = 0; b < ORL_MAP_BATCHES; b++)
        luma += sum->parts[b];
    for (int b = 0; b < ORL_MAP_BATCHES && luma > 0; b++) {
        before += sum->parts[b];
        texel->parts[b] = (uint8_t)(lrintf(UINT8_MAX * (before / luma)) - rounded);
        rounded += texel->parts[b];
    }
}

/*
 * Converts flux to irradiance for one side. The flux of a texel with hardly any surface is added to
 * its fullest neighbour, and the texel gets that neighbour's irradiance.
 */
static void finish_side(void *arg, size_t index, uint32_t member)
{
    const struct texel_builder *m = arg;
    const struct orl_facet_grid *side = &m->texels->sides[index];
    struct sum *sums = m->sums;
    const double enough = least_share * side->width * side->height;
    (void)member;
    for (int pass = 0; pass < 3; pass++)
        for (uint32_t y = 0; y < side->rows; y++)
            for (uint32_t x = 0; x < side->columns; x++) {
                const uint32_t here = side->first + y * side->columns + x;
                const bool small = (double)m->areas[here] < enough;
                const uint32_t there = small ? orl_facet_grid_fullest(side, m->areas, x, y) : here;
                if (pass == 0 && there != here && (double)m->areas[there] >= enough) {
                    add_sum(&sums[there], &sums[here]);
                    m->areas[there] += m->areas[here];
                } else if (pass == 1 &&
                           (!small || there == here || !((double)m->areas[there] >= enough))) {
                    divide_by_area(&sums[here], m->areas[here]);
                } else if (pass == 2 && there != here && (double)m->areas[there] >= enough) {
                    sums[here] = sums[there];
                }
            }
    for (uint32_t i = side->first; i < side->first + side->columns * side->rows; i++)
        store_texel(&sums[i], &m->texels->texels[i]);
}

/* Finds objects that stand on whole texels, by rays along both diagonals: no long wall passes
 * between these. */
static void find_cuts(void *arg, size_t index, uint32_t member)
{
    static const double corners[2][2] = {{0.001, 0.001}, {0.999, 0.001}};
    const struct texel_builder *m = arg;
    const struct orl_facet_grid *side = &m->texels->sides[index];
    const struct orl_plane *plane = &m->texels->planes.planes[index / 2];
    const struct orl_vec3 normal = index % 2 == 1 ? plane->frame.n : orl_neg(plane->frame.n);
    const double whole = 0.999 * side->width * side->height;
    (void)member;
    for (uint32_t i = 0; i < side->columns * side->rows; i++) {
        bool *cut = &m->texels->cut[side->first + i];
        const uint32_t column = i % side->columns, row = i / side->columns;
        const struct orl_vec3 corner =
            orl_madd(orl_madd(plane->origin, plane->frame.u, column * side->width), plane->frame.v,
                     row * side->height);
        for (int k = 0; k < 2 && (double)m->areas[side->first + i] >= whole && !*cut; k++) {
            const double x = corners[k][0] * side->width, y = corners[k][1] * side->height;
            const struct orl_surface_point surface_point = {
                m->texels->lit_scene,
                orl_madd(orl_madd(corner, plane->frame.u, x), plane->frame.v, y), normal,
                (uint32_t)(index / 2)};
            *cut = !orl_surface_point_unoccluded(
                &surface_point, orl_madd(orl_madd(corner, plane->frame.u, side->width - x),
                                         plane->frame.v, side->height - y));
        }
    }
}

/* Fills the texels. Returns false if the pool is cancelled. */
static bool fill_texels(struct texel_builder *m, struct orl_thread_pool *pool)
{
    const size_t facets = m->texels->lit_scene->geometry->n_facets;
    const uint64_t leaves = (m->map->header->count + ORL_MAP_LEAF - 1) / ORL_MAP_LEAF;
    return orl_parallel_try(pool, (leaves + LEAVES_A_CHUNK - 1) / LEAVES_A_CHUNK, find_texels, m) ==
               0 &&
           orl_parallel_try(pool, SLICES, add_flux, m) == 0 &&
           orl_parallel_try(pool, 2 * facets, add_areas, m) == 0 &&
           orl_parallel_try(pool, 2 * facets, finish_side, m) == 0 &&
           orl_parallel_try(pool, 2 * facets, find_cuts, m) == 0;
}

static bool build_texels(struct texel_builder *m, struct orl_thread_pool *pool)
{
    struct orl_texels *texels = m->texels;
    const struct orl_geometry *g = texels->lit_scene->geometry;
    const bool laid_out = orl_planes_init(&texels->planes, g);
    texels->sides = calloc(2 * g->n_facets + 1, sizeof *texels->sides);
    m->places = malloc((m->map->header->count + 1) * sizeof *m->places);
    m->coincident = calloc(g->n_facets + 1, sizeof *m->coincident);
    if (!laid_out || !texels->sides || !m->places || !m->coincident)
        return false;
    struct orl_photon_facets photon_facets = {m->map, &texels->planes, m->places, m->coincident};
    if (orl_photon_facets_find(&photon_facets, pool) < 0)
        return false;
    lay_out_texels(m);
    const size_t bytes = ((size_t)texels->count + 2) / 2 * LINE;
    texels->texels = aligned_alloc(LINE, bytes);
    texels->cut = calloc((size_t)texels->count + 1, sizeof *texels->cut);
    m->sums = calloc((size_t)texels->count + 1, sizeof *m->sums);
    m->areas = calloc((size_t)texels->count + 1, sizeof *m->areas);
    if (!texels->texels || !texels->cut || !m->sums || !m->areas)
        return false;
    memset(texels->texels, 0, bytes);
    return fill_texels(m, pool);
}

struct orl_texels *orl_texels_new(const struct orl_photon_map *map,
                                  const struct orl_lit_scene *lit_scene, double photons,
                                  struct orl_thread_pool *pool)
{
    struct orl_texels *texels = calloc(1, sizeof *texels);
    struct texel_builder m = {.texels = texels, .map = map};
    if (!texels)
        return NULL;
    texels->lit_scene = lit_scene;
    texels->photons = photons;
    const bool made = build_texels(&m, pool);
    free(m.places);
    free(m.coincident);
    free(m.sums);
    free(m.areas);
    if (made)
        return texels;
    orl_texels_free(texels);
    return NULL;
}

void orl_texels_free(struct orl_texels *texels)
{
    if (!texels)
        return;
    orl_planes_done(&texels->planes);
    free(texels->sides);
    free(texels->texels);
    free(texels->cut);
    free(texels);
}

void orl_texels_rebind(struct orl_texels *texels, const struct orl_lit_scene *lit_scene)
{
    texels->lit_scene = lit_scene;
    texels->planes.geometry = lit_scene->geometry;
}

uint64_t orl_texels_bytes(const struct orl_texels *texels)
{
    return sizeof *texels + texels->count * (sizeof *texels->texels + sizeof *texels->cut);
}

bool orl_texels_has(const struct orl_texels *texels, uint32_t facet)
{
    return orl_planes_has(&texels->planes, facet);
}

double orl_texels_width(const struct orl_texels *texels, uint32_t facet, bool front)
{
    const struct orl_facet_grid *side = &texels->sides[2 * facet + front];
    return fmax(side->width, side->height);
}

const struct orl_texel *orl_texels_at(const struct orl_texels *texels, uint32_t facet, bool front,
                                      struct orl_vec3 point, bool *ret_cut)
{
    const uint32_t side = 2 * facet + front;
    *ret_cut = false;
    if (texels->sides[side].columns == 0)
        return NULL;
    const uint32_t index = index_in(texels, side, point);
    *ret_cut = texels->cut[index];
    return &texels->texels[index];
}
