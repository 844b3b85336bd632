/*
 * Neighbour clamping (icache.h) as a nearest-neighbour search: a record's radius becomes the least
 * "radius of a neighbour + distance to it" among the neighbours within its reach. The neighbours
 * are sorted along the Morton curve. A binary tree over blocks of them stores the box of each node
 * and the least radius in it. Nodes which cannot lower a radius are skipped. For equal radii, such
 * as a thousand records in one place, the search ends at the root.
 */
#include <stdlib.h>

#include "photon/map/map_layout.h"
#include "render/gather/icache_iterator.h"

enum { BLOCK = 8 };

static const double cells_an_axis = (1 << 20) - 1;

/* Factor that keeps distances to boxes below those to the points in them, which are rounded as
 * well. */
static const double rounded_down = 1 - 1e-12;

struct node {
    double low[3], high[3];
    double least; /* least radius served in this node; INFINITY: the node is empty */
};

struct sorted {
    uint64_t code;
    uint32_t record;
};

struct clamping {
    struct orl_icache *cache;
    struct sorted *sorted;
    struct node *nodes; /* node i has the children 2 i and 2 i + 1; blocks begin at first_block */
    size_t first_block;
    double *radii;     /* new radius of each record */
    size_t *n_visited; /* nodes and records looked at for each record */
};

static void get_coordinates(struct orl_vec3 p, double ret[3])
{
    ret[0] = p.x;
    ret[1] = p.y;
    ret[2] = p.z;
}

static struct node empty_node(void)
{
    return (struct node){
        {INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}, INFINITY};
}

static void extend_node(struct node *node, const struct node *by)
{
    for (int k = 0; k < 3; k++) {
        node->low[k] = fmin(node->low[k], by->low[k]);
        node->high[k] = fmax(node->high[k], by->high[k]);
    }
    node->least = fmin(node->least, by->least);
}

static struct node node_of(const struct orl_irradiance_record *record)
{
    struct node node = {.least = orl_irradiance_record_radius(record)};
    get_coordinates(record->place.point, node.low);
    get_coordinates(record->place.point, node.high);
    return node;
}

static int by_code(const void *a, const void *b)
{
    const struct sorted *x = a, *y = b;
    return x->code != y->code ? (x->code > y->code) - (x->code < y->code)
                              : (x->record > y->record) - (x->record < y->record);
}

static void sort_records(struct clamping *h)
{
    const struct orl_icache *cache = h->cache;
    struct node all = empty_node();
    for (size_t i = 0; i < cache->count; i++) {
        const struct node one = node_of(&cache->records[i]);
        extend_node(&all, &one);
    }
    for (size_t i = 0; i < cache->count; i++) {
        double at[3];
        get_coordinates(cache->records[i].place.point, at);
        h->sorted[i] = (struct sorted){.record = (uint32_t)i};
        for (int k = 0; k < 3; k++) {
            const double extent = all.high[k] - all.low[k];
            const double share = extent > 0 ? (at[k] - all.low[k]) / extent : 0;
            h->sorted[i].code |= orl_zorder_spread((uint64_t)(share * cells_an_axis)) << k;
        }
    }
    qsort(h->sorted, cache->count, sizeof *h->sorted, by_code);
}

static void build_tree(struct clamping *h)
{
    const size_t count = h->cache->count;
    for (size_t i = 0; i < 2 * h->first_block; i++)
        h->nodes[i] = empty_node();
    for (size_t i = 0; i < count; i++) {
        const struct node one = node_of(&h->cache->records[h->sorted[i].record]);
        extend_node(&h->nodes[h->first_block + i / BLOCK], &one);
    }
    for (size_t i = h->first_block - 1; i > 0; i--) {
        extend_node(&h->nodes[i], &h->nodes[2 * i]);
        extend_node(&h->nodes[i], &h->nodes[2 * i + 1]);
    }
}

/* State of the search for one record, with the least radius so far. */
struct search {
    const struct clamping *h;
    size_t record;
    double at[3], reach, radius;
    size_t n_visited;
};

/* Returns a lower bound of the radius by a node's records; INFINITY if the node is out of reach. */
static double bound_of(const struct search *s, const struct node *node)
{
    double square = 0;
    for (int k = 0; k < 3; k++) {
        const double off = fmax(0, fmax(node->low[k] - s->at[k], s->at[k] - node->high[k]));
        square += off * off;
    }
    const double away = rounded_down * sqrt(square);
    return away < s->reach ? node->least + away : INFINITY;
}

static void search_block(struct search *s, size_t block)
{
    const struct orl_icache *cache = s->h->cache;
    const struct orl_irradiance_record *far = &cache->records[s->record];
    const size_t first = block * BLOCK, end = first + BLOCK;
    for (size_t i = first; i < end && i < cache->count; i++) {
        const size_t index = s->h->sorted[i].record;
        const struct orl_irradiance_record *near = &cache->records[index];
        s->n_visited++;
        if (index == s->record || !orl_irradiance_record_covers(far, &near->place))
            continue;
        const double apart = orl_length(orl_sub(far->place.point, near->place.point));
        s->radius = fmin(s->radius, orl_irradiance_record_radius(near) + apart);
    }
}

/* Searches the half with the lower bound first, so that the other one may be skipped. */
static void search_part(struct search *s, size_t index)
{
    if (index >= s->h->first_block) {
        search_block(s, index - s->h->first_block);
        return;
    }
    const struct node *children = &s->h->nodes[2 * index];
    const double bounds[2] = {bound_of(s, &children[0]), bound_of(s, &children[1])};
    const size_t better = bounds[1] < bounds[0];
    s->n_visited += 2;
    if (bounds[better] < s->radius)
        search_part(s, 2 * index + better);
    if (bounds[1 - better] < s->radius)
        search_part(s, 2 * index + 1 - better);
}

static void clamp_record(void *arg, size_t index, uint32_t member)
{
    const struct clamping *h = arg;
    const struct orl_irradiance_record *record = &h->cache->records[index];
    struct search s = {.h = h,
                       .record = index,
                       .reach = ORL_ICACHE_ACCURACY * orl_irradiance_record_radius(record),
                       .radius = record->radius,
                       .n_visited = 1};
    (void)member;
    get_coordinates(record->place.point, s.at);
    if (bound_of(&s, &h->nodes[1]) < s.radius)
        search_part(&s, 1);
    h->radii[index] = s.radius;
    h->n_visited[index] = s.n_visited;
}

static int clamping_init(struct clamping *h, struct orl_icache *cache)
{
    *h = (struct clamping){.cache = cache, .first_block = 1};
    while (h->first_block * BLOCK < cache->count)
        h->first_block *= 2;
    h->sorted = malloc((cache->count + 1) * sizeof *h->sorted);
    h->nodes = malloc(2 * h->first_block * sizeof *h->nodes);
    h->radii = malloc((cache->count + 1) * sizeof *h->radii);
    h->n_visited = malloc((cache->count + 1) * sizeof *h->n_visited);
    return h->sorted && h->nodes && h->radii && h->n_visited ? 0 : ORL_ERR_NOMEM;
}

static void clamping_done(struct clamping *h)
{
    free(h->sorted);
    free(h->nodes);
    free(h->radii);
    free(h->n_visited);
}

int orl_icache_clamp_neighbours(struct orl_icache *cache, struct orl_thread_pool *pool)
{
    struct clamping h;
    int code = clamping_init(&h, cache);
    if (code == 0) {
        sort_records(&h);
        build_tree(&h);
        /* All records use the original radii, so that order does not matter. */
        code = orl_parallel_try(pool, cache->count, clamp_record, &h);
    }
    for (size_t i = 0; i < cache->count && code == 0; i++) {
        cache->records[i].radius = h.radii[i];
        cache->n_visited += h.n_visited[i];
    }
    clamping_done(&h);
    return code < 0 ? code : orl_icache_index(cache);
}
