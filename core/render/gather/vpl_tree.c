/* Trees of virtual lights, clustered by position and normal. */
#include <stdlib.h>

#include "render/gather/vpl.h"

enum { LAMPS_A_LEAF = 4 };
/* Angle, seen from a place, within which lamps are treated as one. */
static const double alike = 0.2;
static const double least_cosine = 1e-3; /* lower limit of the cosine of a visible lamp */

/* State while one tree is built. */
struct tree_builder {
    struct orl_vpls *vpls;
    uint32_t n_nodes; /* index past its last node so far */
    float normals_as; /* length that the difference of opposite normals counts as */
};

/* Bounds of some lamps: three coordinates of position, three of the normal. */
struct bounds {
    float low[6], high[6];
};

static struct bounds bounds_of(const struct orl_vpl *lamps, uint32_t count)
{
    struct bounds b;
    for (int axis = 0; axis < 6; axis++)
        b.low[axis] = b.high[axis] = lamps[0].place[axis];
    for (uint32_t i = 1; i < count; i++)
        for (int axis = 0; axis < 6; axis++) {
            const float x = lamps[i].place[axis];
            b.low[axis] = x < b.low[axis] ? x : b.low[axis];
            b.high[axis] = x > b.high[axis] ? x : b.high[axis];
        }
    return b;
}

/* Returns the axis of the largest extent; -1 if all lamps coincide. */
static int widest_axis(const struct tree_builder *g, const struct bounds *b)
{
    int best = -1;
    float most = 0;
    for (int axis = 0; axis < 6; axis++) {
        const float apart = (b->high[axis] - b->low[axis]) * (axis < 3 ? 1 : g->normals_as);
        if (apart > most) {
            most = apart;
            best = axis;
        }
    }
    return best;
}

static void describe_node(struct orl_vpl_node *node, const struct bounds *b,
                          const struct orl_vpl *lamps)
{
    double radius2 = 0, spread2 = 0, power = 0;
    for (int axis = 0; axis < 3; axis++) {
        const double half = 0.5 * ((double)b->high[axis] - b->low[axis]);
        const double turn = 0.5 * ((double)b->high[axis + 3] - b->low[axis + 3]);
        node->center[axis] = 0.5F * (b->high[axis] + b->low[axis]);
        node->normal[axis] = 0.5F * (b->high[axis + 3] + b->low[axis + 3]);
        node->half[axis] = (float)(half * (1 + 1e-5));
        radius2 += half * half;
        spread2 += turn * turn;
    }
    for (uint32_t i = 0; i < node->count; i++)
        power += orl_luma(
            (struct orl_rgb){lamps[i].intensity[0], lamps[i].intensity[1], lamps[i].intensity[2]});
    node->radius = (float)(sqrt(radius2) * (1 + 1e-5));
    node->spread = (float)(sqrt(spread2) * (1 + 1e-5));
    node->power = (float)power;
}

/* Moves the lamps below the middle to the front; returns their number. */
static uint32_t partition_lamps(struct orl_vpl *lamps, uint32_t count, int axis, float middle)
{
    uint32_t below = 0;
    for (uint32_t i = 0; i < count; i++)
        if (lamps[i].place[axis] < middle) {
            const struct orl_vpl lamp = lamps[i];
            lamps[i] = lamps[below];
            lamps[below++] = lamp;
        }
    return below;
}

/* Builds a node and its subtree; returns its index. The depth is limited by how often floats can be
 * halved. */
static uint32_t build_node(struct tree_builder *g, uint32_t first, uint32_t count)
{
    struct orl_vpl *lamps = &g->vpls->lamps[first];
    const uint32_t index = g->n_nodes++;
    struct orl_vpl_node *node = &g->vpls->nodes[index];
    const struct bounds b = bounds_of(lamps, count);
    const int axis = widest_axis(g, &b);
    *node = (struct orl_vpl_node){.first = first, .count = count};
    describe_node(node, &b, lamps);
    if (count <= LAMPS_A_LEAF || axis < 0)
        return index;
    const uint32_t below = partition_lamps(lamps, count, axis, 0.5F * (b.low[axis] + b.high[axis]));
    if (below == 0 || below == count)
        return index;
    build_node(g, first, below);
    node->right = build_node(g, first + below, count - below);
    return index;
}

/* Builds a group's tree. A tree of n lamps has fewer than 2 n nodes, so that each tree has its own
 * range. */
static void build_tree(void *arg, size_t group, uint32_t member)
{
    struct orl_vpls *vpls = arg;
    const uint32_t first = (uint32_t)vpls->first[group];
    const uint32_t count = (uint32_t)vpls->first[group + 1] - first;
    struct tree_builder g = {
        .vpls = vpls, .n_nodes = 2 * first, .normals_as = (float)vpls->lit_scene->geometry->radius};
    (void)member;
    if (count > 0)
        vpls->roots[group] = build_node(&g, first, count);
}

int orl_vpl_build_trees(struct orl_vpls *vpls, struct orl_thread_pool *pool)
{
    const size_t count = vpls->first[ORL_MAP_BATCHES];
    vpls->nodes = malloc((2 * count + 1) * sizeof *vpls->nodes);
    if (!vpls->nodes)
        return ORL_ERR_NOMEM;
    return orl_parallel_try(pool, ORL_MAP_BATCHES, build_tree, vpls);
}

/*
 * Returns an upper estimate of the lamps' height along a normal, given that of the node's centre,
 * because the nearest lamps are brightest. It is small for lamps in the place's own plane, which
 * contribute little.
 */
static double height_bound(const struct orl_vpl_node *node, const double normal[3], double middle,
                           double turned, double near)
{
    const double most = middle + turned + fabs(normal[0]) * node->half[0] +
                        fabs(normal[1]) * node->half[1] + fabs(normal[2]) * node->half[2];
    const double least = least_cosine * near;
    if (!(most > 0))
        return 0;
    return most > least ? orl_smaller(middle + turned + node->radius, 2 * near) : least;
}

/* Estimates the light of a node's lamps at a place; zero only if none can light it. */
static double likely_light(const struct orl_vpl_node *node, struct orl_vec3 point,
                           struct orl_vec3 normal, double max_factor_sr_m2)
{
    const double up[3] = {normal.x, normal.y, normal.z};
    const double down[3] = {node->normal[0], node->normal[1], node->normal[2]};
    const double x = node->center[0] - point.x, y = node->center[1] - point.y,
                 z = node->center[2] - point.z, r = node->radius;
    const double d2 = x * x + y * y + z * z, near2 = d2 > r * r ? d2 : r * r, near = sqrt(near2);
    const double here = height_bound(node, up, x * up[0] + y * up[1] + z * up[2], 0, near);
    if (!(here > 0))
        return 0;
    const double there = height_bound(node, down, -(x * down[0] + y * down[1] + z * down[2]),
                                      (sqrt(d2) + r) * node->spread, near);
    const double factor = here * there;
    const double most =
        max_factor_sr_m2 * near2 * near2; /* not divided yet: lamps may share a point */
    return node->power * (factor < most ? factor / (near2 * near2) : max_factor_sr_m2);
}

/* Returns true if all lamps of the node light the place alike, seen from far away. */
static bool is_far(const struct orl_vpl_node *node, struct orl_vec3 point)
{
    const double x = node->center[0] - point.x, y = node->center[1] - point.y,
                 z = node->center[2] - point.z;
    const double near = node->radius / alike;
    return x * x + y * y + z * z > near * near && node->spread < alike;
}

static bool is_end(const struct orl_vpl_node *node, struct orl_vec3 point)
{
    return node->right == 0 || is_far(node, point);
}

static void set_node(struct orl_vpl_cut *cut, uint32_t i, const struct orl_vpls *vpls,
                     uint32_t node, struct orl_vec3 point, struct orl_vec3 normal)
{
    const struct orl_vpl_node *n = &vpls->nodes[node];
    cut->nodes[i] = node;
    cut->light[i] = likely_light(n, point, normal, vpls->max_factor_sr_m2);
    cut->uncertain[i] = cut->light[i] > 0 && !is_end(n, point) ? cut->light[i] : 0;
}

void orl_vpl_cut_init(struct orl_vpl_cut *cut, const struct orl_vpls *vpls, uint32_t group,
                      uint32_t size, struct orl_vec3 point, struct orl_vec3 normal)
{
    cut->count = 0;
    cut->sum = 0;
    if (vpls->first[group + 1] == vpls->first[group])
        return;
    set_node(cut, 0, vpls, vpls->roots[group], point, normal);
    for (cut->count = 1; cut->count < size && cut->count < ORL_VPL_MOST_CUT; cut->count++) {
        uint32_t most = 0;
        for (uint32_t i = 1; i < cut->count; i++)
            most = cut->uncertain[i] > cut->uncertain[most] ? i : most;
        if (!(cut->uncertain[most] > 0))
            break;
        const uint32_t node = cut->nodes[most];
        set_node(cut, most, vpls, node + 1, point, normal);
        set_node(cut, cut->count, vpls, vpls->nodes[node].right, point, normal);
    }
    for (uint32_t i = 0; i < cut->count; i++)
        cut->sum += cut->light[i];
}

bool orl_vpl_sample(const struct orl_vpls *vpls, const struct orl_vpl_cut *cut, double u,
                    struct orl_vec3 point, struct orl_vec3 normal, uint32_t *ret_lamp,
                    double *ret_probability)
{
    uint32_t i = 0;
    if (!(cut->sum > 0))
        return false;
    for (u *= cut->sum; i + 1 < cut->count && u >= cut->light[i]; i++)
        u -= cut->light[i];
    if (!(cut->light[i] > 0)) /* possible only by rounding */
        return false;
    double probability = cut->light[i] / cut->sum;
    u /= cut->light[i];
    const struct orl_vpl_node *node = &vpls->nodes[cut->nodes[i]];
    while (!is_end(node, point)) {
        const struct orl_vpl_node *left = node + 1, *right = &vpls->nodes[node->right];
        const double l = likely_light(left, point, normal, vpls->max_factor_sr_m2);
        const double r = likely_light(right, point, normal, vpls->max_factor_sr_m2);
        if (!(l + r > 0))
            return false;
        const double share = l / (l + r);
        const bool go_left = u < share;
        u = go_left ? u / share : (u - share) / (1 - share);
        probability *= go_left ? share : 1 - share;
        node = go_left ? left : right;
    }
    *ret_lamp = node->first + (uint32_t)(orl_smaller(orl_larger(u, 0), 1 - 0x1p-53) * node->count);
    *ret_probability = probability / node->count;
    return true;
}
