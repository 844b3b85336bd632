/* Results of traced photons: deposits on surfaces, and crossings through discs in free space, found
 * by a hierarchy of discs. */
#include "photon/tracing/trace.h"

#include <math.h>
#include <stdlib.h>

#include "base/memory/memory.h"
#include "photon/map/quantization.h"

enum { LEAF = 4, DEEPEST = 64 };

/* Bounding box of some discs, in depth-first order: an inner node is followed by its children. */
struct node {
    double low[3], high[3];
    uint32_t first, count; /* leaf: its discs; count 0: inner node */
    uint32_t second;       /* inner node: index of the second child; the first one is next */
};

struct orl_counting_discs {
    const struct orl_counting_disc *discs;
    uint32_t *order;
    struct node *nodes;
    uint32_t n_nodes;
    size_t count;
};

/* Returns the disc's half extent along an axis, from the circle's normal. */
static double half_extent(const struct orl_counting_disc *disc, int axis)
{
    const double n = orl_component(disc->frame.n, axis);
    return disc->radius * sqrt(fmax(0, 1 - n * n));
}

static void bound_discs(const struct orl_counting_discs *tree, struct node *node, uint32_t first,
                        uint32_t count)
{
    for (int axis = 0; axis < 3; axis++) {
        node->low[axis] = INFINITY;
        node->high[axis] = -INFINITY;
        for (uint32_t i = first; i < first + count; i++) {
            const struct orl_counting_disc *disc = &tree->discs[tree->order[i]];
            const double at = orl_component(disc->center, axis);
            const double half = half_extent(disc, axis) + 1e-9 * (disc->radius + fabs(at));
            node->low[axis] = fmin(node->low[axis], at - half);
            node->high[axis] = fmax(node->high[axis], at + half);
        }
    }
}

static int longest_axis(const struct node *node)
{
    int longest = 0;
    for (int axis = 1; axis < 3; axis++)
        if (node->high[axis] - node->low[axis] > node->high[longest] - node->low[longest])
            longest = axis;
    return longest;
}

struct rank {
    double at;
    uint32_t disc;
};

static int compare_ranks(const void *a, const void *b)
{
    const struct rank *x = a, *y = b;
    return x->at != y->at ? (x->at > y->at) - (x->at < y->at)
                          : (x->disc > y->disc) - (x->disc < y->disc);
}

/* Splits the discs in halves by their centers along the box's longest axis. */
static void split_discs(struct orl_counting_discs *tree, struct rank *ranks, uint32_t first,
                        uint32_t count)
{
    struct node *node = &tree->nodes[tree->n_nodes++];
    bound_discs(tree, node, first, count);
    if (count <= LEAF) {
        node->first = first;
        node->count = count;
        return;
    }
    const int axis = longest_axis(node);
    for (uint32_t i = 0; i < count; i++) {
        const uint32_t disc = tree->order[first + i];
        ranks[i] = (struct rank){orl_component(tree->discs[disc].center, axis), disc};
    }
    qsort(ranks, count, sizeof *ranks, compare_ranks);
    for (uint32_t i = 0; i < count; i++)
        tree->order[first + i] = ranks[i].disc;
    node->count = 0;
    split_discs(tree, ranks, first, count / 2);
    node->second = tree->n_nodes;
    split_discs(tree, ranks, first + count / 2, count - count / 2);
}

int orl_counting_discs_new(const struct orl_counting_disc *discs, size_t count,
                           struct orl_counting_discs **ret_discs)
{
    struct orl_counting_discs *tree = calloc(1, sizeof *tree);
    struct rank *ranks = malloc((count + 1) * sizeof *ranks);
    if (tree) {
        tree->discs = discs;
        tree->count = count;
        tree->order = malloc((count + 1) * sizeof *tree->order);
        tree->nodes = malloc((count + 1) * sizeof *tree->nodes);
    }
    if (!tree || !ranks || !tree->order || !tree->nodes) {
        free(ranks);
        orl_counting_discs_free(tree);
        return ORL_ERR_NOMEM;
    }
    for (uint32_t i = 0; i < count; i++)
        tree->order[i] = i;
    if (count > 0)
        split_discs(tree, ranks, 0, (uint32_t)count);
    free(ranks);
    *ret_discs = tree;
    return 0;
}

void orl_counting_discs_free(struct orl_counting_discs *discs)
{
    if (!discs)
        return;
    free(discs->order);
    free(discs->nodes);
    free(discs);
}

static void add_crossing(struct orl_disc_crossings *crossings, struct orl_disc_crossing crossing)
{
    if (orl_array_reserve(&crossings->crossings, &crossings->capacity, crossings->count,
                          sizeof crossing))
        crossings->crossings[crossings->count++] = crossing;
    else
        crossings->out_of_memory = true;
}

/* Records the crossing if the segment crosses the disc from its lit side, within its unobstructed
 * part. */
static void record_crossing(const struct orl_counting_disc *disc, uint32_t index,
                            const struct orl_ray_segment *s, struct orl_disc_crossings *crossings)
{
    const double against = -orl_dot(s->direction, disc->frame.n);
    const double height = orl_dot(orl_sub(s->origin, disc->center), disc->frame.n);
    if (!(against > 0) || !(height > 0) || height >= s->distance * against)
        return;
    const double way = height / against;
    const struct orl_vec3 off = orl_sub(orl_madd(s->origin, s->direction, way), disc->center);
    const double u = orl_dot(off, disc->frame.u), v = orl_dot(off, disc->frame.v);
    const double distance2 = u * u + v * v;
    if (distance2 >= disc->radius * disc->radius)
        return;
    const double turn = atan2(v, u) / (2 * ORL_PI),
                 sector = (turn - floor(turn)) * ORL_COUNTING_DISC_SECTORS;
    if (distance2 >= (double)disc->reach2[(int)sector % ORL_COUNTING_DISC_SECTORS])
        return;
    const struct orl_rgb flux =
        s->focus > 0
            ? orl_rgb_scale(s->flux,
                            orl_spotlight_falloff(s->focus, s->lamp_distance + way) / s->spread)
            : s->flux;
    add_crossing(crossings,
                 (struct orl_disc_crossing){.disc = index,
                                            .distance2 = (float)distance2,
                                            .flux = {(float)flux.r, (float)flux.g, (float)flux.b},
                                            .batch = s->batch,
                                            .lamp = s->lamp});
}

static bool crosses_box(const struct node *node, const struct orl_ray_segment *s)
{
    double near = 0, far = s->distance;
    for (int axis = 0; axis < 3; axis++) {
        const double d = orl_component(s->direction, axis), o = orl_component(s->origin, axis);
        if (d == 0) {
            if (o < node->low[axis] || o > node->high[axis])
                return false;
            continue;
        }
        const double a = (node->low[axis] - o) / d, b = (node->high[axis] - o) / d;
        near = fmax(near, fmin(a, b));
        far = fmin(far, fmax(a, b));
    }
    return near <= far;
}

void orl_counting_discs_record(const struct orl_counting_discs *discs,
                               const struct orl_ray_segment *ray_segment,
                               struct orl_disc_crossings *crossings)
{
    uint32_t stack[DEEPEST], depth = 0;
    if (discs->count == 0)
        return;
    stack[depth++] = 0;
    while (depth > 0) {
        const uint32_t at = stack[--depth];
        const struct node *node = &discs->nodes[at];
        if (!crosses_box(node, ray_segment))
            continue;
        for (uint32_t i = 0; i < node->count; i++) {
            const uint32_t disc = discs->order[node->first + i];
            record_crossing(&discs->discs[disc], disc, ray_segment, crossings);
        }
        if (node->count == 0) {
            stack[depth++] = node->second;
            stack[depth++] = at + 1;
        }
    }
}

/* ---- Deposits -------------------------------------------------------------------------------- */

bool orl_deposits_reserve(struct orl_deposits *deposits, size_t more)
{
    const bool reserved = orl_array_reserve_more(&deposits->photons, &deposits->capacity,
                                                 deposits->count, more, sizeof *deposits->photons);
    deposits->out_of_memory |= !reserved;
    return reserved;
}

void orl_deposit(struct orl_deposits *deposits, const struct orl_hit *hit, struct orl_rgb flux,
                 uint8_t batch, enum orl_photon_class class)
{
    const struct orl_vec3 p = hit->point;
    const float sum = (float)flux.r + (float)flux.g + (float)flux.b + (float)(p.x + p.y + p.z);
    if (!isfinite(sum)) {
        deposits->health.non_finite++;
        return;
    }
    if (!orl_deposits_reserve(deposits, 1))
        return;
    const struct orl_vec3 lit = orl_hit_facing(hit);
    deposits->photons[deposits->count++] =
        (struct orl_photon){.position = {(float)p.x, (float)p.y, (float)p.z},
                            .flux = {(float)flux.r, (float)flux.g, (float)flux.b},
                            .normal = orl_normal_encode(lit),
                            .batch = batch,
                            .tag = (uint8_t) class,
                            .facet = hit->facet};
}

void orl_deposits_count_capped(struct orl_deposits *deposits, struct orl_rgb flux)
{
    deposits->health.photons_capped++;
    orl_sum_add(&deposits->flux_capped, orl_luma(flux));
}

struct orl_health orl_deposits_health(const struct orl_deposits *deposits)
{
    struct orl_health health = deposits->health;
    health.flux_w = orl_sum_value(&deposits->flux);
    health.flux_capped_w = orl_sum_value(&deposits->flux_capped);
    return health;
}
