#include "render/gather/vpl.h"

#include <stdlib.h>
#include <string.h>

#include "photon/map/normal_code.h"

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
