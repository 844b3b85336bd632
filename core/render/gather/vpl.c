/* Virtual lights: the trees of a group, the choice of a lamp, then the lamps themselves. */
#include "render/gather/vpl.h"

#include <stdlib.h>
#include <string.h>

#include "photon/map/quantization.h"

/* ---- Trees, clustered by position and normal ------------------------------------------------- */

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

/* Builds the trees and sorts the lamps by them. Returns the codes of orl_vpls_init. */
static int orl_vpl_build_trees(struct orl_vpls *vpls, struct orl_thread_pool *pool)
{
    const size_t count = vpls->first[ORL_MAP_BATCHES];
    vpls->nodes = malloc((2 * count + 1) * sizeof *vpls->nodes);
    if (!vpls->nodes)
        return ORL_ERR_NOMEM;
    return orl_parallel_try(pool, ORL_MAP_BATCHES, build_tree, vpls);
}

/* ---- Choice of a lamp ------------------------------------------------------------------------ */

/* The top of a group's tree for a place: nodes with the largest uncertainty are split first. */
enum { ORL_VPL_MOST_CUT = 32 };
struct orl_vpl_cut {
    uint32_t nodes[ORL_VPL_MOST_CUT];
    double light[ORL_VPL_MOST_CUT]; /* estimate of the node's light */
    /* Uncertain part of it; 0 if the node cannot be split usefully. */
    double uncertain[ORL_VPL_MOST_CUT];
    uint32_t count;
    double sum; /* sum of light; 0: no lamp lights the place */
};

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

static void orl_vpl_cut_init(struct orl_vpl_cut *cut, const struct orl_vpls *vpls, uint32_t group,
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

/* Draws a lamp by a cut made for the same place, and sets its probability. Returns false if no lamp
 * lights the place. */
static bool orl_vpl_sample(const struct orl_vpls *vpls, const struct orl_vpl_cut *cut, double u,
                           struct orl_vec3 point, struct orl_vec3 normal, uint32_t *ret_lamp,
                           double *ret_probability)
{
    uint32_t i = 0;
    if (!(cut->sum > 0))
        return false;
    for (u *= cut->sum; i + 1 < cut->count && u >= cut->light[i]; i++)
        u -= cut->light[i];
    if (i >= cut->count || !(cut->light[i] > 0)) /* possible only by rounding */
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

/* ---- Lamps ----------------------------------------------------------------------------------- */

/* Length that determines the cap, as a share of the typical distance between lamps; the cap is its
 * inverse square. */
static const double near_share = 0.12;
enum { PAIRS = 1024, CUT_A_LAMP = 4, LEAST_CUT = 16, STRIP = 1024 };

static struct orl_vec3 from_floats(const float v[3])
{
    return orl_v3(v[0], v[1], v[2]);
}

static void to_floats(struct orl_vec3 v, float ret[3])
{
    ret[0] = (float)v.x;
    ret[1] = (float)v.y;
    ret[2] = (float)v.z;
}

/* Makes a lamp of a photon. The surface is intersected again, because the map's coded normal is
 * exact to a degree only. */
static void make_lamp(const struct orl_lit_scene *lit_scene, const struct orl_photon *photon,
                      struct orl_vpl *ret_lamp)
{
    const struct orl_geometry *g = lit_scene->geometry;
    const struct orl_vec3 at = from_floats(photon->position);
    const struct orl_vec3 coded = orl_normal_decode(photon->normal);
    const double lift = 64 * g->radius * 0x1p-24 + 4 * orl_facet_offset(g, photon->facet);
    struct orl_hit hit;
    if (!orl_geometry_intersect(g, orl_madd(at, coded, lift), orl_neg(coded), 2 * lift, &hit) ||
        hit.facet != photon->facet)
        hit = (struct orl_hit){.point = at, .normal = coded, .facet = photon->facet, .front = true};
    const struct orl_vec3 lit = orl_dot(hit.normal, coded) > 0 ? hit.normal : orl_neg(hit.normal);
    const struct orl_rgb albedo =
        orl_material_diffuse(orl_lit_scene_material(lit_scene, &hit), &hit);
    to_floats(orl_madd(hit.point, lit, orl_facet_offset(g, photon->facet)), ret_lamp->place);
    to_floats(lit, ret_lamp->place + 3);
    ret_lamp->intensity[0] = (float)(photon->flux[0] * albedo.r / ORL_PI);
    ret_lamp->intensity[1] = (float)(photon->flux[1] * albedo.g / ORL_PI);
    ret_lamp->intensity[2] = (float)(photon->flux[2] * albedo.b / ORL_PI);
}

static int compare_doubles(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* Returns the median distance over pairs of lamps. */
static double typical_distance(const struct orl_vpls *vpls, size_t count)
{
    double apart[PAIRS];
    for (size_t i = 0; i < PAIRS; i++) {
        const struct orl_vpl *a = &vpls->lamps[orl_mix64(2 * i + 1) % count];
        const struct orl_vpl *b = &vpls->lamps[orl_mix64(2 * i + 2) % count];
        apart[i] = orl_length(orl_sub(from_floats(a->place), from_floats(b->place)));
    }
    qsort(apart, PAIRS, sizeof *apart, compare_doubles);
    return apart[PAIRS / 2];
}

/* Photons, and the index of the lamp that each becomes. */
struct making {
    struct orl_vpls *vpls;
    const struct orl_photon *photons;
    size_t count;
    uint32_t *places;
};

static void make_strip(void *arg, size_t strip, uint32_t member)
{
    const struct making *m = arg;
    const size_t end = m->count - strip * STRIP < STRIP ? m->count : (strip + 1) * STRIP;
    (void)member;
    for (size_t i = strip * STRIP; i < end; i++)
        make_lamp(m->vpls->lit_scene, &m->photons[i], &m->vpls->lamps[m->places[i]]);
}

/* Sorts lamps by group, and within a group in the order of photons. */
static void find_places(const struct making *making)
{
    struct orl_vpls *vpls = making->vpls;
    size_t next[ORL_MAP_BATCHES];
    for (size_t i = 0; i < making->count; i++)
        vpls->first[making->photons[i].batch + 1]++;
    for (size_t b = 0; b < ORL_MAP_BATCHES; b++) {
        vpls->first[b + 1] += vpls->first[b];
        next[b] = vpls->first[b];
    }
    for (size_t i = 0; i < making->count; i++)
        making->places[i] = (uint32_t)next[making->photons[i].batch]++;
}

int orl_vpls_init(struct orl_vpls *vpls, const struct orl_lit_scene *lit_scene,
                  struct orl_thread_pool *pool, const struct orl_photon *photons, size_t count,
                  uint64_t emitted)
{
    struct making making = {.vpls = vpls, .photons = photons, .count = count};
    *vpls = (struct orl_vpls){.lit_scene = lit_scene, .emitted = (double)emitted / ORL_MAP_BATCHES};
    vpls->lamps = malloc((count + 1) * sizeof *vpls->lamps);
    making.places = malloc((count + 1) * sizeof *making.places);
    int code = vpls->lamps && making.places ? 0 : ORL_ERR_NOMEM;
    if (code == 0) {
        find_places(&making);
        code = orl_parallel_try(pool, (count + STRIP - 1) / STRIP, make_strip, &making);
    }
    free(making.places);
    if (code)
        return code;
    const double near = count > 0 ? near_share * typical_distance(vpls, count) : 1;
    /* Without lamps the paths carry all light. */
    vpls->max_factor_sr_m2 = count == 0 ? 0 : near > 0 ? 1 / (near * near) : INFINITY;
    return orl_vpl_build_trees(vpls, pool);
}

void orl_vpls_done(struct orl_vpls *vpls)
{
    free(vpls->lamps);
    free(vpls->nodes);
    memset(vpls, 0, sizeof *vpls);
}

/* Returns the irradiance at a place by one lamp. */
static struct orl_rgb light_of(const struct orl_vpls *vpls, const struct orl_vpl *lamp,
                               struct orl_vec3 point, struct orl_vec3 normal)
{
    const struct orl_vec3 way = orl_sub(from_floats(lamp->place), point);
    const double d2 = orl_dot(way, way), d = sqrt(d2);
    const double here = orl_dot(way, normal);
    const double there = -orl_dot(way, from_floats(lamp->place + 3));
    if (!(d > 0) || !(here > 0) || !(there > 0))
        return orl_gray(0);
    const double factor = fmin(here * there / (d2 * d2), vpls->max_factor_sr_m2);
    /* In a sealed scene no path leaves through a port and comes in again (light/lit_scene.h). */
    const struct orl_rgb share = orl_transmittance_to_surface(
        vpls->lit_scene, point, orl_scale(way, 1 / d), d * (1 - 1e-6), vpls->lit_scene->open);
    const struct orl_rgb intensity = {lamp->intensity[0], lamp->intensity[1], lamp->intensity[2]};
    return orl_rgb_scale(orl_rgb_mul(intensity, share), factor);
}

struct orl_rgb orl_vpl_irradiance(const struct orl_vpls *vpls, uint32_t group, double u,
                                  uint32_t lamps, struct orl_vec3 point, struct orl_vec3 normal)
{
    const uint32_t size = CUT_A_LAMP * lamps;
    struct orl_vpl_cut cut;
    struct orl_rgb sum = orl_gray(0);
    orl_vpl_cut_init(&cut, vpls, group, size > LEAST_CUT ? size : LEAST_CUT, point, normal);
    for (uint32_t k = 0; k < lamps; k++) {
        uint32_t lamp;
        double probability;
        if (orl_vpl_sample(vpls, &cut, (u + k) / lamps, point, normal, &lamp, &probability))
            sum = orl_rgb_add(sum, orl_rgb_scale(light_of(vpls, &vpls->lamps[lamp], point, normal),
                                                 1 / (probability * lamps * vpls->emitted)));
    }
    return sum;
}
