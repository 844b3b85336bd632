#include "photon/density/nested_discs.h"

#include <string.h>

#include "base/multiversion.h"
#include "photon/map/quantization.h"
#include "photon/surface/footprint.h"

/* Factor on the area that a neighbouring estimate used. */
static const float first_beyond = 1.15F;

/* ---- Summation ------------------------------------------------------------------------------- */

/*
 * Shares of a patch within a radius: linear in the area, and for first moments linear in the third
 * power of the radius. So sums over even light equal those of the disc.
 */
struct share {
    float area, moment;
};

static float ramp_of(float off, float half)
{
    return off >= half ? 1 : off <= -half ? 0 : 0.5F + 0.5F * off / half;
}

static struct share share_within(float radius, float distance2, float ramp, bool cut)
{
    const float radius2 = radius * radius;
    struct share share = {ramp_of(radius2 - distance2, 2 * radius * ramp), 0};
    if (cut)
        share.moment = ramp_of(radius2 * radius - distance2 * sqrtf(distance2), 3 * radius2 * ramp);
    return share;
}

static void add_row(float *restrict sum, const float *restrict flux_sums, float share)
{
    for (int i = 0; i < ORL_FLUX_SUMS; i++)
        sum[i] += share * flux_sums[i];
}

static void project_offset(const struct orl_disc_search *disc_search, const struct orl_frame *frame,
                           const float at[3], float *ret_x, float *ret_y)
{
    const struct orl_vec3 chord =
        orl_v3(at[0] - disc_search->at[0], at[1] - disc_search->at[1], at[2] - disc_search->at[2]);
    *ret_x = (float)(orl_dot(chord, frame->u) * disc_search->cell);
    *ret_y = (float)(orl_dot(chord, frame->v) * disc_search->cell);
}

static void project_patch(const struct orl_disc_search *disc_search, const struct orl_frame *frame,
                          uint32_t patch, float *ret_x, float *ret_y)
{
    uint32_t lane;
    const struct orl_patch_group *group = orl_patch_find(disc_search->sums, patch, &lane);
    const float at[3] = {group->at[0][lane], group->at[1][lane], group->at[2][lane]};
    project_offset(disc_search, frame, at, ret_x, ret_y);
}

ORL_FOR_WIDE_VECTORS static void add_wholes(const struct orl_disc_search *disc_search,
                                            const struct orl_frame *frame, float radius,
                                            struct orl_nested_disc rings[ORL_NESTED_DISCS])
{
    static const float narrower = 0.70710678F;
    const struct orl_whole_patches *whole_patches = disc_search->whole_patches;
    for (uint32_t n = 0; n < disc_search->patches; n++) {
        const float distance2 = whole_patches->distance2[n], ramp = whole_patches->ramp[n];
        const float *flux_sums = disc_search->sums->patch_sums[whole_patches->patch[n]];
        float disc = radius, x = 0, y = 0;
        struct share share = share_within(disc, distance2, ramp, frame != NULL);
        if (frame && share.area > 0)
            project_patch(disc_search, frame, whole_patches->patch[n], &x, &y);
        for (int i = 0; i < ORL_NESTED_DISCS && share.area > 0; i++) {
            struct share inside = {0, 0};
            disc *= narrower;
            if (i + 1 < ORL_NESTED_DISCS)
                inside = share_within(disc, distance2, ramp, frame != NULL);
            if (share.area > inside.area)
                add_row(rings[i].flux_sums, flux_sums, share.area - inside.area);
            if (share.moment > inside.moment) {
                add_row(rings[i].by_x, flux_sums, (share.moment - inside.moment) * x);
                add_row(rings[i].by_y, flux_sums, (share.moment - inside.moment) * y);
            }
            share = inside;
        }
    }
}

/* Adds a photon's fluxes, their squares and its count to the sums, times a factor. */
static void add_photon(float sum[ORL_FLUX_SUMS], const struct orl_rgb *flux, uint32_t batch,
                       float factor)
{
    const float luma = (float)orl_luma(*flux);
    sum[batch] += factor * luma;
    sum[ORL_FLUX_SUMS_RGB] += factor * (float)flux->r;
    sum[ORL_FLUX_SUMS_RGB + 1] += factor * (float)flux->g;
    sum[ORL_FLUX_SUMS_RGB + 2] += factor * (float)flux->b;
    sum[ORL_FLUX_SUMS_SQUARES] += factor * luma * luma;
    sum[ORL_FLUX_SUMS_COUNT] += factor;
}

static void add_photons(const struct orl_disc_search *disc_search, const struct orl_frame *frame,
                        float radius2, struct orl_nested_disc rings[ORL_NESTED_DISCS])
{
    const struct orl_photon_map *map = disc_search->sums->map;
    for (uint32_t n = 0; n < disc_search->photons; n++) {
        const struct orl_search_candidate c = disc_search->single[n];
        if (!(c.distance2 < radius2))
            continue;
        const struct orl_rgb flux = orl_flux_unpack(map->fluxes[c.index]);
        const uint32_t batch = orl_photon_batch(map, c.index);
        struct orl_nested_disc *ring = &rings[c.distance2 >= radius2 / 2   ? 0
                                              : c.distance2 >= radius2 / 4 ? 1
                                                                           : 2];
        add_photon(ring->flux_sums, &flux, batch, 1);
        if (!frame)
            continue;
        const uint32_t *leaf = map->places + (size_t)(c.index / ORL_MAP_LEAF) * ORL_LEAF_WORDS +
                               c.index % ORL_MAP_LEAF;
        uint32_t cell[3];
        float x, y;
        orl_position_unpack(leaf[0], leaf[ORL_MAP_LEAF], cell);
        project_offset(disc_search, frame,
                       (const float[3]){(float)cell[0], (float)cell[1], (float)cell[2]}, &x, &y);
        add_photon(ring->by_x, &flux, batch, x);
        add_photon(ring->by_y, &flux, batch, y);
    }
}

static void sum_rings(const struct orl_disc_search *disc_search, float radius2,
                      struct orl_nested_discs *rings)
{
    const struct orl_frame *frame = disc_search->footprint ? &disc_search->footprint->frame : NULL;
    rings->radius = orl_larger(sqrt((double)radius2), 1) * disc_search->cell;
    rings->cut = disc_search->footprint != NULL;
    memset(rings->rings, 0, sizeof rings->rings);
    add_wholes(disc_search, frame, sqrtf(radius2), rings->rings);
    add_photons(disc_search, frame, radius2, rings->rings);
    for (int i = 0; i < ORL_NESTED_DISCS; i++) {
        const double radius = rings->radius * exp2(-0.5 * i);
        rings->discs[i] = disc_search->footprint
                              ? orl_footprint_moments(disc_search->footprint, radius)
                              : orl_disc_moments(radius);
        rings->found += (double)rings->rings[i].flux_sums[ORL_FLUX_SUMS_COUNT];
    }
}

/* ---- Footprint ------------------------------------------------------------------------------- */

/* Searches the footprint: out to twice the radius of the disc that holds k, or to the maximum
 * radius. Returns the squared radius in cells. */
static float find_in_footprint(struct orl_disc_search *disc_search, double disc, double least,
                               struct orl_footprint *footprint)
{
    const double most = disc_search->query->max_radius;
    double reach = orl_smaller(2 * disc, most);
    for (;;) {
        orl_footprint_make(disc_search->query->surface_point, reach, footprint);
        orl_disc_search_restrict(disc_search, footprint);
        const float hint =
            (float)(1.05 * orl_footprint_equal_radius(footprint, disc) / disc_search->cell);
        const float most2 = (float)(reach / disc_search->cell * (reach / disc_search->cell));
        const float radius2 = orl_disc_search_find(disc_search, hint * hint, most2);
        if (!(reach < most) || orl_disc_search_count(disc_search) >= least)
            return radius2;
        reach = most;
    }
}

/* Returns the squared radius, in cells, of the disc that holds k, without regard to
 * obstructions. */
static float find_in_disc(struct orl_disc_search *disc_search, const struct orl_zorder *order)
{
    const double reach = disc_search->query->max_radius / disc_search->cell;
    const float hint = (float)(disc_search->query->hint / disc_search->cell);
    return orl_disc_search_find(disc_search,
                                hint > 0 ? first_beyond * hint * hint
                                         : orl_disc_search_first_radius2(disc_search, order),
                                (float)(reach * reach));
}

void orl_nested_discs_gather(const struct orl_leaf_sums *sums, const struct orl_zorder *order,
                             const struct orl_density_query *query, double least,
                             struct orl_search *search, struct orl_nested_discs *ret_rings)
{
    struct orl_disc_search disc_search = orl_disc_search_of(sums, query, search);
    struct orl_footprint footprint;
    /* If the neighbour's disc was cut and this one is, too, the neighbour's size is used. */
    bool cut = query->hint > 0 && query->hint_cut && query->surface_point &&
               !orl_surface_point_is_clear(query->surface_point, query->hint);
    double disc = query->hint;
    float radius2 = 0;
    *ret_rings = (struct orl_nested_discs){.radius = query->max_radius};
    if (sums->count == 0)
        return;
    if (!cut) {
        radius2 = find_in_disc(&disc_search, order);
        disc = orl_larger(sqrt((double)radius2), 1) * disc_search.cell;
        cut = query->surface_point && disc_search.patches + disc_search.photons > 0 &&
              !orl_surface_point_is_clear(query->surface_point, disc);
    }
    ret_rings->clearance = disc;
    if (cut) {
        radius2 = find_in_footprint(&disc_search, disc, least, &footprint);
        ret_rings->clearance = footprint.clearance;
    }
    sum_rings(&disc_search, radius2, ret_rings);
    ret_rings->clearance = orl_smaller(ret_rings->clearance, ret_rings->radius);
    ret_rings->disc = sqrt(ret_rings->discs[0].area / ORL_PI);
}
