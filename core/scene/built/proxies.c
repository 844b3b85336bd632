#include "scene/built/scene.h"

#include <stdlib.h>
#include <string.h>

#include "base/sampling/sampling.h"

enum { POINTS = 32, FIRST_POINTS = 6, LOOKS = 5, MOST_WAYS = 256, MOST_PANES = 64 };
static const double hidden_share = 0.75;
/* multiple of the summed reach within which two proxies may be meant as a pair */
static const double near_pair = 1.5;
/* lateral offset of the extra rays, as a share of the largest thickness */
static const double aside_of_thickness = 0.01;

/* Directions across proxies: the distinct ones from the hidden geometry towards its proxy. */
struct ways {
    struct orl_vec3 way[MOST_WAYS];
    size_t count;
    double reach; /* the largest thickness */
};

static bool is_proxy(const struct orl_scene *scene, uint32_t facet)
{
    struct orl_facet own;
    const struct orl_facet *f = orl_facet_get_own(scene->geometry, facet, &own);
    return orl_facet_proxy_offset(scene->geometry, facet) != 0 && f->area > 0 &&
           orl_surface_kind_is_flat(f->kind);
}

static struct orl_vec3 way_across(const struct orl_geometry *geometry, uint32_t facet)
{
    const struct orl_vec3 normal = orl_facet_normal(geometry, facet);
    return orl_facet_proxy_offset(geometry, facet) > 0 ? normal : orl_neg(normal);
}

/* Returns false if there are too many. */
static bool add_way(struct ways *ways, const struct orl_geometry *geometry, uint32_t facet)
{
    const struct orl_vec3 way = way_across(geometry, facet);
    size_t k = 0;
    ways->reach = fmax(ways->reach, fabs(orl_facet_proxy_offset(geometry, facet)));
    while (k < ways->count && orl_dot(way, ways->way[k]) < 1 - 1e-5)
        k++;
    if (k == MOST_WAYS)
        return false;
    if (k == ways->count)
        ways->way[ways->count++] = way;
    return true;
}

/* Returns how far a proxy reaches towards `self`: its thickness. If `self` is a proxy that faces it
 * and represents the same geometry, adds the thickness of `self`. */
static double reach_to(const struct orl_scene *scene, uint32_t proxy, uint32_t self)
{
    const struct orl_geometry *const g = scene->geometry;
    const bool faces =
        is_proxy(scene, self) && orl_dot(way_across(g, proxy), way_across(g, self)) < -1 + 1e-3;
    return fabs(orl_facet_proxy_offset(g, proxy)) +
           (faces ? fabs(orl_facet_proxy_offset(g, self)) : 0);
}

/* Returns true if a ray from a point along a direction hits a proxy that represents the surface at
 * the point. */
static bool is_covered(const struct orl_scene *scene, const struct orl_geometry *proxies,
                       struct orl_vec3 point, struct orl_vec3 way, double reach, uint32_t self)
{
    double at = 0;
    for (int i = 0; i < MOST_PANES; i++) {
        struct orl_hit hit;
        if (!orl_geometry_intersect(proxies, orl_madd(point, way, at), way, reach - at, &hit))
            return false;
        struct orl_facet own;
        const struct orl_facet *f = orl_facet_get_own(proxies, hit.facet, &own);
        at += hit.distance;
        /* If proxies represent each other, only the first stays. */
        if (orl_dot(way_across(proxies, hit.facet), way) > 1 - 1e-3 &&
            at <= reach_to(scene, hit.facet, self) + 4 * f->offset && hit.facet != self &&
            (!is_proxy(scene, self) || (hit.facet < self && !scene->hidden[hit.facet])))
            return true;
        at += f->offset;
    }
    return false;
}

/* Returns true if is_covered holds at the point and at small offsets to all sides. Rays start
 * just behind the point, because it may lie in the proxy's plane. */
static bool is_well_covered(const struct orl_scene *scene, const struct orl_geometry *proxies,
                            const struct ways *ways, struct orl_vec3 way, struct orl_vec3 point,
                            uint32_t self)
{
    const struct orl_frame frame = orl_frame_about(way);
    const double back = 2 * orl_facet_offset(scene->geometry, self);
    const double aside = fmax(8 * back, aside_of_thickness * ways->reach);
    for (int i = 0; i < LOOKS; i++) {
        const double x = i == 1 ? aside : i == 2 ? -aside : 0;
        const double y = i == 3 ? aside : i == 4 ? -aside : 0;
        const struct orl_vec3 from =
            orl_madd(orl_madd(orl_madd(point, frame.u, x), frame.v, y), way, -back);
        if (!is_covered(scene, proxies, from, way, 2 * ways->reach + back, self))
            return false;
    }
    return true;
}

static bool is_hidden(const struct orl_scene *scene, const struct orl_geometry *proxies,
                      const struct ways *ways, uint32_t facet)
{
    struct orl_random random = orl_random_stream(2, ORL_PURPOSE_PILOT, facet);
    int covered = 0;
    for (int i = 0; i < POINTS; i++) {
        const double u[2] = {orl_random_uniform(&random), orl_random_uniform(&random)};
        struct orl_vec3 point, normal;
        bool found = false;
        orl_facet_sample(scene->geometry, facet, u, &point, &normal);
        for (size_t w = 0; w < ways->count && !found; w++)
            found = is_well_covered(scene, proxies, ways, ways->way[w], point, facet);
        covered += found;
        if (i + 1 == FIRST_POINTS && covered == 0)
            return false;
    }
    return covered >= hidden_share * POINTS;
}

/* Returns the nearest proxy in a direction from a point, if that is its own direction across;
 * UINT32_MAX: none. */
static uint32_t find_partner(const struct orl_geometry *proxies, struct orl_vec3 point,
                             struct orl_vec3 way, double reach, double *ret_apart)
{
    double at = 0;
    for (int i = 0; i < MOST_PANES; i++) {
        struct orl_hit hit;
        if (!orl_geometry_intersect(proxies, orl_madd(point, way, at), way, reach - at, &hit))
            return UINT32_MAX;
        at += hit.distance;
        *ret_apart = at;
        if (orl_dot(way_across(proxies, hit.facet), way) > 1 - 1e-3)
            return hit.facet;
        at += orl_facet_offset(proxies, hit.facet);
    }
    return UINT32_MAX;
}

/* Records pairs of proxies for which the decision is uncertain: taken as a pair although neither
 * reaches the other, or as two although they nearly are a pair. */
static void record_uncertain_pair(struct orl_scene *scene, const struct ways *ways, uint32_t self)
{
    struct orl_facet own;
    const struct orl_facet *f = orl_facet_get_own(scene->geometry, self, &own);
    const struct orl_vec3 way = orl_neg(way_across(scene->geometry, self));
    struct orl_random random = orl_random_stream(3, ORL_PURPOSE_PILOT, self);
    uint32_t partner = UINT32_MAX;
    double apart = 0;
    for (int i = 0; i < FIRST_POINTS && partner == UINT32_MAX; i++) {
        const double u[2] = {orl_random_uniform(&random), orl_random_uniform(&random)};
        struct orl_vec3 point, normal;
        orl_facet_sample(scene->geometry, self, u, &point, &normal);
        point = orl_madd(point, way, f->offset);
        partner = find_partner(scene->proxies, point, way, 2 * near_pair * ways->reach, &apart);
    }
    if (partner == UINT32_MAX || partner > self)
        return;
    const double mine = fabs(orl_facet_proxy_offset(scene->geometry, self));
    const double its = fabs(orl_facet_proxy_offset(scene->geometry, partner));
    const bool one = scene->hidden[self] || scene->hidden[partner];
    struct orl_proxy_pairing *pairing = one ? &scene->paired : &scene->not_paired;
    if (one ? apart > fmax(mine, its) + 4 * f->offset : apart <= near_pair * (mine + its))
        if (pairing->count++ == 0)
            *pairing = (struct orl_proxy_pairing){1, {partner, self}, apart, fmax(mine, its)};
}

int orl_proxies_split(struct orl_scene *scene, struct orl_error *err)
{
    struct orl_geometry *whole = scene->geometry, *light = NULL;
    const size_t n = whole->n_facets;
    struct ways ways = {.count = 0};
    bool *keep = NULL;
    int code = 0;
    for (uint32_t i = 0; i < n; i++)
        if (is_proxy(scene, i) && !add_way(&ways, whole, i))
            return orl_error_refuse(
                err, ORL_ERR_LIMIT,
                "give curved ones thickness 0 and remove the geometry that they stand for",
                "BSDFs with a thickness face more than %d different ways", MOST_WAYS);
    if (ways.count == 0)
        return 0;
    keep = calloc(n, sizeof *keep);
    scene->hidden = calloc(n, sizeof *scene->hidden);
    if (!keep || !scene->hidden) {
        code = ORL_ERR_NOMEM;
        goto done;
    }
    for (uint32_t i = 0; i < n; i++)
        keep[i] = is_proxy(scene, i);
    code = orl_geometry_subset(whole, keep, &scene->proxies, err);
    for (uint32_t i = 0; i < n && code == 0; i++) {
        scene->hidden[i] =
            orl_facet_area(whole, i) > 0 && is_hidden(scene, scene->proxies, &ways, i);
        scene->n_hidden += scene->hidden[i];
    }
    for (uint32_t i = 0; i < n && code == 0; i++)
        if (is_proxy(scene, i))
            record_uncertain_pair(scene, &ways, i);
    for (uint32_t i = 0; i < n && code == 0; i++)
        keep[i] = !scene->hidden[i];
    if (code == 0)
        code = orl_geometry_subset(whole, keep, &light, err);
    for (uint32_t i = 0; i < n && code == 0; i++) /* views see no proxy, hidden or not */
        keep[i] = !is_proxy(scene, i);
    if (code == 0)
        code = orl_geometry_subset(whole, keep, &scene->seen, err);
    if (code < 0)
        goto done;
    scene->geometry = light;
    light = NULL;
    orl_geometry_free(whole);
done:
    orl_geometry_free(light);
    free(keep);
    return code;
}

enum orl_port_crossing orl_proxies_last_crossing(const struct orl_scene *scene,
                                                 struct orl_vec3 origin, struct orl_vec3 direction,
                                                 double distance)
{
    enum orl_port_crossing last = ORL_CROSSING_NONE;
    for (int i = 0; i < MOST_PANES && scene->proxies; i++) {
        struct orl_hit hit;
        if (!orl_geometry_intersect(scene->proxies, origin, direction, distance, &hit))
            break;
        const enum orl_port_crossing crossing = orl_scene_crossing(scene, &hit);
        const double step = hit.distance + orl_facet_offset(scene->proxies, hit.facet);
        last = crossing == ORL_CROSSING_NONE ? last : crossing;
        origin = orl_madd(origin, direction, step);
        distance -= step;
    }
    return last;
}
