#include "photon/density/nested_discs.h"

#include <string.h>

#include "base/vectors.h"
#include "photon/density/disc_search.h"
#include "photon/map/flux.h"
#include "photon/surface/sides.h"

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

static void add_row(float *restrict sum, const float *restrict mass, float share)
{
    for (int i = 0; i < ORL_MASS; i++)
        sum[i] += share * mass[i];
}

static void project_offset(const struct orl_disc_search *hunt, const struct orl_frame *frame,
                           const float at[3], float *ret_x, float *ret_y)
{
    const struct orl_vec3 chord =
        orl_v3(at[0] - hunt->at[0], at[1] - hunt->at[1], at[2] - hunt->at[2]);
    *ret_x = (float)(orl_dot(chord, frame->u) * hunt->cell);
    *ret_y = (float)(orl_dot(chord, frame->v) * hunt->cell);
}

static void project_patch(const struct orl_disc_search *hunt, const struct orl_frame *frame,
                          uint32_t patch, float *ret_x, float *ret_y)
{
    uint32_t lane;
    const struct orl_patch_group *group = orl_patch_find(hunt->sums, patch, &lane);
    const float at[3] = {group->at[0][lane], group->at[1][lane], group->at[2][lane]};
    project_offset(hunt, frame, at, ret_x, ret_y);
}

ORL_FOR_WIDE_VECTORS static void add_wholes(const struct orl_disc_search *hunt,
                                            const struct orl_frame *frame, float radius,
                                            struct orl_nested_disc rings[ORL_NESTED_DISCS])
{
    static const float narrower = 0.70710678F;
    const struct orl_search_wholes *wholes = hunt->wholes;
    for (uint32_t n = 0; n < hunt->patches; n++) {
        const float distance2 = wholes->distance2[n], ramp = wholes->ramp[n];
        const float *mass = hunt->sums->masses[wholes->patch[n]];
        float disc = radius, x = 0, y = 0;
        struct share share = share_within(disc, distance2, ramp, frame != NULL);
        if (frame && share.area > 0)
            project_patch(hunt, frame, wholes->patch[n], &x, &y);
        for (int i = 0; i < ORL_NESTED_DISCS && share.area > 0; i++) {
            struct share inside = {0, 0};
            disc *= narrower;
            if (i + 1 < ORL_NESTED_DISCS)
                inside = share_within(disc, distance2, ramp, frame != NULL);
            if (share.area > inside.area)
                add_row(rings[i].mass, mass, share.area - inside.area);
            if (share.moment > inside.moment) {
                add_row(rings[i].by_x, mass, (share.moment - inside.moment) * x);
                add_row(rings[i].by_y, mass, (share.moment - inside.moment) * y);
            }
            share = inside;
        }
    }
}

/* Adds a photon's fluxes, their squares and its count to the sums, times a factor. */
static void add_photon(float sum[ORL_MASS], const struct orl_rgb *flux, uint32_t batch,
                       float factor)
{
    const float luma = (float)orl_luma(*flux);
    sum[batch] += factor * luma;
    sum[ORL_MASS_FLUX] += factor * (float)flux->r;
    sum[ORL_MASS_FLUX + 1] += factor * (float)flux->g;
    sum[ORL_MASS_FLUX + 2] += factor * (float)flux->b;
    sum[ORL_MASS_SQUARES] += factor * luma * luma;
    sum[ORL_MASS_COUNT] += factor;
}

static void add_photons(const struct orl_disc_search *hunt, const struct orl_frame *frame,
                        float radius2, struct orl_nested_disc rings[ORL_NESTED_DISCS])
{
    const struct orl_photon_map *map = hunt->sums->map;
    for (uint32_t n = 0; n < hunt->photons; n++) {
        const struct orl_search_candidate c = hunt->single[n];
        if (!(c.distance2 < radius2))
            continue;
        const struct orl_rgb flux = orl_flux_unpack(map->fluxes[c.index]);
        const uint32_t batch = orl_photon_batch(map, c.index);
        struct orl_nested_disc *ring = &rings[c.distance2 >= radius2 / 2   ? 0
                                              : c.distance2 >= radius2 / 4 ? 1
                                                                           : 2];
        add_photon(ring->mass, &flux, batch, 1);
        if (!frame)
            continue;
        const uint32_t *leaf = map->places + (size_t)(c.index / ORL_MAP_LEAF) * ORL_LEAF_WORDS +
                               c.index % ORL_MAP_LEAF;
        uint32_t cell[3];
        float x, y;
        orl_place_unpack(leaf[0], leaf[ORL_MAP_LEAF], cell);
        project_offset(hunt, frame,
                       (const float[3]){(float)cell[0], (float)cell[1], (float)cell[2]}, &x, &y);
        add_photon(ring->by_x, &flux, batch, x);
        add_photon(ring->by_y, &flux, batch, y);
    }
}

static void sum_rings(const struct orl_disc_search *hunt, float radius2,
                      struct orl_nested_discs *rings)
{
    const struct orl_frame *frame = hunt->footprint ? &hunt->footprint->frame : NULL;
    rings->radius = orl_larger(sqrt((double)radius2), 1) * hunt->cell;
    rings->cut = hunt->footprint != NULL;
    memset(rings->rings, 0, sizeof rings->rings);
    add_wholes(hunt, frame, sqrtf(radius2), rings->rings);
    add_photons(hunt, frame, radius2, rings->rings);
    for (int i = 0; i < ORL_NESTED_DISCS; i++) {
        const double radius = rings->radius * exp2(-0.5 * i);
        rings->discs[i] = hunt->footprint ? orl_footprint_moments(hunt->footprint, radius)
                                          : orl_disc_moments(radius);
        rings->found += (double)rings->rings[i].mass[ORL_MASS_COUNT];
    }
}

/* ---- Footprint ------------------------------------------------------------------------------- */

/* Searches the footprint: out to twice the radius of the disc that holds k, or to the maximum
 * radius. Returns the squared radius in cells. */
static float find_in_footprint(struct orl_disc_search *hunt, double disc, double least,
                               struct orl_footprint *footprint)
{
    const double most = hunt->query->max_radius;
    double reach = orl_smaller(2 * disc, most);
    for (;;) {
        orl_footprint_make(hunt->query->footing, reach, footprint);
        orl_disc_search_keep_to(hunt, footprint);
        const float hint = (float)(1.05 * orl_footprint_even(footprint, disc) / hunt->cell);
        const float most2 = (float)(reach / hunt->cell * (reach / hunt->cell));
        const float radius2 = orl_disc_search_enough(hunt, hint * hint, most2);
        if (!(reach < most) || orl_disc_search_count(hunt) >= least)
            return radius2;
        reach = most;
    }
}

/* Returns the squared radius, in cells, of the disc that holds k, without regard to
 * obstructions. */
static float find_in_disc(struct orl_disc_search *hunt, const struct orl_zorder *order)
{
    const double reach = hunt->query->max_radius / hunt->cell;
    const float hint = (float)(hunt->query->hint / hunt->cell);
    return orl_disc_search_enough(
        hunt, hint > 0 ? first_beyond * hint * hint : orl_disc_search_first_radius2(hunt, order),
        (float)(reach * reach));
}

void orl_nested_discs_gather(const struct orl_leaf_sums *sums, const struct orl_zorder *order,
                             const struct orl_density_query *query, double least,
                             struct orl_search *search, struct orl_nested_discs *ret_rings)
{
    struct orl_disc_search hunt = orl_disc_search_of(sums, query, search);
    struct orl_footprint footprint;
    /* If the neighbour's disc was cut and this one is, too, the neighbour's size is used. */
    bool cut = query->hint > 0 && query->hint_cut && query->footing &&
               !orl_footing_is_free(query->footing, query->hint);
    double disc = query->hint;
    float radius2 = 0;
    *ret_rings = (struct orl_nested_discs){.radius = query->max_radius};
    if (sums->count == 0)
        return;
    if (!cut) {
        radius2 = find_in_disc(&hunt, order);
        disc = orl_larger(sqrt((double)radius2), 1) * hunt.cell;
        cut = query->footing && hunt.patches + hunt.photons > 0 &&
              !orl_footing_is_free(query->footing, disc);
    }
    ret_rings->clear = disc;
    if (cut) {
        radius2 = find_in_footprint(&hunt, disc, least, &footprint);
        ret_rings->clear = footprint.clear;
    }
    sum_rings(&hunt, radius2, ret_rings);
    ret_rings->clear = orl_smaller(ret_rings->clear, ret_rings->radius);
    ret_rings->disc = sqrt(ret_rings->discs[0].area / ORL_PI);
}
