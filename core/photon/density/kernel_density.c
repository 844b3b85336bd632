#include "photon/density/density_estimate.h"

#include <stdlib.h>

#include "base/multiversion.h"
#include "photon/density/leaf_photons.h"

enum { BESIDE = 2, NEIGHBOURS = 2 * BESIDE + 1 };

struct orl_kernel_density {
    const struct orl_photon_map *map;
    uint32_t k;
    float *
        /* squared cells: radius per leaf, then the maximum of each node, level by level */
        reach2[ORL_MAP_LEVELS + 1];
};

enum { CHUNK = 1 << 12 };

/*
 * If walls and edges leave less than this share of the k photons, a small patch counts as a whole,
 * and the estimate is the same anywhere on it. Then a photon at the query point counts, too. It
 * would be missing from its patch, and patches without a query at a photon have no surplus to
 * compensate. Otherwise small facets with few photons would be darker by one photon in a leaf of
 * sixteen.
 */
static const double whole_patch = 0.5;

/* Temporary data while radii are computed. */
struct radius_builder {
    struct orl_kernel_density *kernel_density;
    float *medians; /* per leaf: median of squared distances */
    uint64_t leaves;
    uint32_t k;
    double max_radius;
};

/* Returns the median of a few values, and sorts them. */
static float median_of(float *values, uint32_t n)
{
    for (uint32_t i = 1; i < n; i++) {
        const float value = values[i];
        uint32_t k = i;
        for (; k > 0 && values[k - 1] > value; k--)
            values[k] = values[k - 1];
        values[k] = value;
    }
    return values[n / 2];
}

/* Returns the median of a full leaf's values without branches: the value that half of them
 * precede. */
static float median_of_leaf(const float values[ORL_MAP_LEAF])
{
    float median = values[0];
    for (int i = 0; i < ORL_MAP_LEAF; i++) {
        int before = 0;
        for (int k = 0; k < ORL_MAP_LEAF; k++)
            before += (values[k] < values[i]) | ((values[k] == values[i]) & (k < i));
        median = before == ORL_MAP_LEAF / 2 ? values[i] : median;
    }
    return median;
}

/* Returns the median of squared distances from the centre, which is robust against a few
 * outliers. */
static inline float median2(const struct orl_photon_map *map, uint64_t leaf, uint32_t n)
{
    const uint32_t *a = map->places + leaf * ORL_LEAF_WORDS, *b = a + ORL_MAP_LEAF;
    float x[ORL_MAP_LEAF], y[ORL_MAP_LEAF], z[ORL_MAP_LEAF], d2[ORL_MAP_LEAF] = {0};
    float middle[3] = {0};
    for (uint32_t i = 0; i < n; i++) {
        x[i] = (float)(int32_t)(a[i] & 0xfffffU);
        y[i] = (float)(int32_t)(b[i] & 0xfffffU);
        z[i] = (float)(int32_t)((a[i] >> 24) << 12 | b[i] >> 20);
    }
    for (uint32_t i = 0; i < n; i++) {
        middle[0] += x[i] / (float)n;
        middle[1] += y[i] / (float)n;
        middle[2] += z[i] / (float)n;
    }
    for (uint32_t i = 0; i < n; i++) {
        const float dx = x[i] - middle[0], dy = y[i] - middle[1], dz = z[i] - middle[2];
        d2[i] = dx * dx + dy * dy + dz * dz;
    }
    return n == ORL_MAP_LEAF ? median_of_leaf(d2) : median_of(d2, n);
}

ORL_FOR_WIDE_VECTORS static void measure_medians(void *arg, size_t chunk, uint32_t member)
{
    const struct radius_builder *m = arg;
    const struct orl_photon_map *map = m->kernel_density->map;
    (void)member;
    for (uint64_t i = chunk * CHUNK; i < (chunk + 1) * CHUNK && i < m->leaves; i++) {
        const uint32_t n = orl_leaf_photons(map, i);
        m->medians[i] = n == ORL_MAP_LEAF ? median2(map, i, ORL_MAP_LEAF) : median2(map, i, n);
    }
}

/*
 * Computes the radii of leaves. A radius from 16 photons alone is noisy, and so is its kernel; the
 * median over a leaf and its neighbours in Morton order is less so. Half of a uniform disc lies
 * within the median of squared distances, and a leaf takes its share of the k photons' area.
 */
static void measure_leaves(void *arg, size_t chunk, uint32_t member)
{
    const struct radius_builder *m = arg;
    const float most = (float)(m->max_radius / m->kernel_density->map->header->cell);
    (void)member;
    for (uint64_t i = chunk * CHUNK; i < (chunk + 1) * CHUNK && i < m->leaves; i++) {
        float near[NEIGHBOURS] = {0};
        uint32_t n = 0;
        for (uint64_t j = i < BESIDE ? 0 : i - BESIDE; j <= i + BESIDE && j < m->leaves; j++)
            near[n++] = m->medians[j] / (float)orl_leaf_photons(m->kernel_density->map, j);
        const float even = 2 * (float)m->k * median_of(near, n);
        m->kernel_density->reach2[0][i] = even < 1 ? 1 : even > most * most ? most * most : even;
    }
}

static void measure_nodes(struct orl_kernel_density *kernel_density,
                          const struct orl_map_layout *layout)
{
    uint64_t children = layout->leaves;
    for (uint32_t level = 0; level < layout->levels; level++) {
        for (uint64_t node = 0; node < layout->groups[level]; node++) {
            float most = 0;
            for (uint64_t c = node * ORL_MAP_FANOUT;
                 c < (node + 1) * ORL_MAP_FANOUT && c < children; c++)
                most = kernel_density->reach2[level][c] > most ? kernel_density->reach2[level][c]
                                                               : most;
            kernel_density->reach2[level + 1][node] = most;
        }
        children = layout->groups[level];
    }
}

struct orl_kernel_density *orl_kernel_density_new(const struct orl_photon_map *map, uint32_t k,
                                                  double max_radius, struct orl_thread_pool *pool)
{
    const struct orl_map_layout layout = orl_map_layout_of(map->header->count);
    struct orl_kernel_density *kernel_density = calloc(1, sizeof *kernel_density);
    if (!kernel_density)
        return NULL;
    kernel_density->map = map;
    kernel_density->k = k;
    for (uint32_t level = 0; level <= layout.levels && layout.levels > 0; level++) {
        const uint64_t nodes = level == 0 ? layout.leaves : layout.groups[level - 1];
        kernel_density->reach2[level] = calloc(nodes + 1, sizeof(float));
        if (!kernel_density->reach2[level]) {
            orl_kernel_density_free(kernel_density);
            return NULL;
        }
    }
    struct radius_builder m = {kernel_density, malloc((layout.leaves + 1) * sizeof *m.medians),
                               layout.leaves, k, max_radius};
    if (!m.medians) {
        orl_kernel_density_free(kernel_density);
        return NULL;
    }
    const size_t chunks = (layout.leaves + CHUNK - 1) / CHUNK;
    int code = orl_parallel_try(pool, chunks, measure_medians, &m);
    if (code == 0)
        code = orl_parallel_try(pool, chunks, measure_leaves, &m);
    free(m.medians);
    if (code < 0) {
        orl_kernel_density_free(kernel_density);
        return NULL;
    }
    measure_nodes(kernel_density, &layout);
    return kernel_density;
}

void orl_kernel_density_free(struct orl_kernel_density *kernel_density)
{
    if (!kernel_density)
        return;
    for (uint32_t level = 0; level <= ORL_MAP_LEVELS; level++)
        free(kernel_density->reach2[level]);
    free(kernel_density);
}

void orl_kernel_density_rebind(struct orl_kernel_density *kernel_density,
                               const struct orl_photon_map *map)
{
    kernel_density->map = map;
}

uint64_t orl_kernel_density_bytes(const struct orl_kernel_density *kernel_density)
{
    const struct orl_map_layout layout = orl_map_layout_of(kernel_density->map->header->count);
    uint64_t nodes = layout.leaves;
    for (uint32_t level = 0; level < layout.levels; level++)
        nodes += layout.groups[level];
    return nodes * sizeof(float);
}

double orl_kernel_density_radius(const struct orl_kernel_density *kernel_density, uint32_t photon)
{
    const struct orl_map_header *h = kernel_density->map->header;
    return h->levels > 0 ? sqrt((double)kernel_density->reach2[0][photon / ORL_MAP_LEAF]) * h->cell
                         : INFINITY;
}

/* State of one query: sums so far. */
struct kernel_query {
    const struct orl_kernel_density *kernel_density;
    struct orl_photon_filter filter;
    uint32_t found;
    float widest2;      /* squared cells: largest radius of the discs that count */
    struct orl_rgb sum; /* flux over area */
    struct orl_batches parts;
};

ORL_ALWAYS_INLINE void add_leaf(struct kernel_query *kernel_query, uint32_t leaf)
{
    const struct orl_photon_map *map = kernel_query->filter.map;
    const uint32_t first = leaf * ORL_MAP_LEAF;
    const uint32_t *a = map->places + (size_t)leaf * ORL_LEAF_WORDS;
    const float reach2 = kernel_query->kernel_density->reach2[0][leaf];
    struct orl_leaf_matches photons;
    struct orl_rgb sum = orl_gray(0);
    struct orl_batches parts = {{0}};
    uint32_t found = 0;
    orl_leaf_find_near(&kernel_query->filter, leaf, reach2, &photons);
    for (uint32_t near = photons.near; near != 0; near &= near - 1) {
        const uint32_t i = (uint32_t)__builtin_ctz(near);
        if ((photons.to_be_tested >> i & 1) &&
            !orl_photon_counts(&kernel_query->filter, &photons, i, first + i))
            continue;
        const struct orl_rgb flux = orl_flux_unpack(map->fluxes[first + i]);
        sum = orl_rgb_add(sum, flux);
        parts.luma[a[i] >> 20 & (ORL_MAP_BATCHES - 1)] += orl_luma(flux);
        found++;
    }
    if (found == 0)
        return;
    const double cell = map->header->cell;
    const double area =
        kernel_query->filter.footprint
            ? orl_footprint_area(kernel_query->filter.footprint, sqrt((double)reach2) * cell)
            : ORL_PI * (double)reach2 * cell * cell;
    const double share = map->header->flux_unit / orl_larger(area, ORL_PI * cell * cell);
    kernel_query->sum = orl_rgb_add(kernel_query->sum, orl_rgb_scale(sum, share));
    orl_batches_add(&kernel_query->parts, &parts, share);
    kernel_query->found += found;
    kernel_query->widest2 = reach2 > kernel_query->widest2 ? reach2 : kernel_query->widest2;
}

/* Adds every leaf whose discs reach the point. */
ORL_FOR_WIDE_VECTORS static void add_leaves(struct kernel_query *kernel_query)
{
    const struct orl_photon_map *map = kernel_query->kernel_density->map;
    struct orl_box_visit stack[ORL_BOX_STACK];
    uint32_t depth = 0;
    if (map->header->levels > 0)
        stack[depth++] = (struct orl_box_visit){0, map->header->levels, 0};
    while (depth > 0) {
        const struct orl_box_visit at = stack[--depth];
        const float reach2 = kernel_query->kernel_density->reach2[at.level][at.node];
        if (!(at.distance2 < reach2))
            continue;
        if (at.level == 0)
            add_leaf(kernel_query, at.node);
        else
            depth = orl_box_push(map, at, kernel_query->filter.at, kernel_query->filter.normal_bins,
                                 reach2, stack, depth);
    }
}

struct orl_density orl_kernel_density_estimate(const struct orl_kernel_density *kernel_density,
                                               const struct orl_density_query *query,
                                               struct orl_search *search)
{
    const struct orl_map_header *h = kernel_density->map->header;
    struct kernel_query kernel_query = {.kernel_density = kernel_density,
                                        .filter =
                                            orl_photon_filter_make(kernel_density->map, query)};
    struct orl_footprint footprint;
    double clearance = INFINITY;
    bool patch = false;
    struct orl_density_query all;
    struct kernel_query whole = kernel_query;
    add_leaves(&whole);
    const double widest = sqrt((double)whole.widest2) * h->cell;
    if (query->surface_point && whole.found > 0 &&
        !orl_surface_point_is_clear(query->surface_point, widest)) {
        orl_footprint_make(query->surface_point, widest, &footprint);
        kernel_query.filter.footprint = &footprint;
        clearance = footprint.clearance;
        whole = kernel_query;
        add_leaves(&whole);
        patch = whole.found < whole_patch * kernel_density->k;
        if (query->at_photon && patch) {
            all = *query;
            all.at_photon = false;
            whole = kernel_query;
            whole.filter.query = &all;
            add_leaves(&whole);
        }
    }
    search->health.estimates += whole.found > 0;
    if (whole.found > 0 && whole.found < ORL_SEARCH_SPARSE && whole.found < h->count)
        search->health.sparse++;
    return (struct orl_density){.irradiance = whole.sum,
                                .radius = widest,
                                .clearance = orl_smaller(clearance, widest),
                                .found = whole.found,
                                .patch = patch,
                                .standard_error = sqrt(orl_batches_variance(&whole.parts)),
                                .parts = whole.parts};
}
