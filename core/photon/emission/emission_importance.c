#include "photon/emission/emit_sampling.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "light/path.h"
#include "scene/material/scatter.h"

double orl_parallel_beam_sample(const struct orl_geometry *g, struct orl_vec3 towards,
                                const double u[2], struct orl_vec3 *ret_point)
{
    const double pad = g->radius * 1e-4;
    const double low[3] = {g->low.x - pad, g->low.y - pad, g->low.z - pad};
    const double high[3] = {g->high.x + pad, g->high.y + pad, g->high.z + pad};
    const double d[3] = {towards.x, towards.y, towards.z};
    double area[3], total = 0, at[3];
    int face = 0;
    for (int k = 0; k < 3; k++) {
        const int i = (k + 1) % 3, j = (k + 2) % 3;
        area[k] = fabs(d[k]) * (high[i] - low[i]) * (high[j] - low[j]);
        total += area[k];
    }
    double left = u[0] * total;
    while (face < 2 && left >= area[face])
        left -= area[face++];
    const int i = (face + 1) % 3, j = (face + 2) % 3;
    at[face] = d[face] > 0 ? high[face] : low[face];
    at[i] = low[i] + fmin(area[face] > 0 ? left / area[face] : 0, 1) * (high[i] - low[i]);
    at[j] = low[j] + u[1] * (high[j] - low[j]);
    *ret_point = orl_v3(at[0], at[1], at[2]);
    return total;
}

/* Sky patches: an equal-area cylindrical projection with 16 x 16 cells. A sun's light is parallel,
 * so its maps are finer. */
enum {
    PATCHES_X = 16,
    PATCHES_Y = 16,
    PATCHES = PATCHES_X * PATCHES_Y,
    SUN_SIDE = 128,
    PATCH_SIDE = 32,
    PHOTONS_A_CELL = 4
};
enum { MOST_PANES = 16, SEGMENTS = 3 };
static const double importance_share = 0.9, beside_port = 0.2;
static const double beside_others = 0.25, dimmest_share = 1e-3;
/* Minimum importance of places whose photons all leave at once. These photons still light the
 * surface where they land, but make no caustic and no virtual point light. */
static const double least_importance = 0.002, least_importance_lamp = 1e-4,
                    least_importance_caustic = 5e-4;

struct pilot {
    const struct orl_emission *emission;
    const struct orl_stratum *stratum;
    uint64_t seed;
    uint32_t patch, side;
    bool caustic, lamps; /* purpose, if not photon maps */
    double *values;
};

static uint32_t patch_of(struct orl_vec3 towards)
{
    const double phi = atan2(towards.y, towards.x) / (2 * ORL_PI);
    const double x = (phi < 0 ? phi + 1 : phi) * PATCHES_X, y = 0.5 * (towards.z + 1) * PATCHES_Y;
    const uint32_t column = x < PATCHES_X - 1 ? (uint32_t)x : PATCHES_X - 1;
    return (y < PATCHES_Y - 1 ? (uint32_t)y : PATCHES_Y - 1) * PATCHES_X + column;
}

/* Returns a direction uniform over a patch. */
static struct orl_vec3 patch_direction(uint32_t patch, struct orl_random *random)
{
    const uint32_t row = patch / PATCHES_X, column = patch % PATCHES_X;
    const double z = 2 * (row + orl_random_uniform(random)) / PATCHES_Y - 1;
    const double phi = 2 * ORL_PI * (column + orl_random_uniform(random)) / PATCHES_X;
    const double s = sqrt(fmax(0, 1 - z * z));
    return orl_v3(s * cos(phi), s * sin(phi), z);
}

/*
 * Returns the share of light that surfaces on its way deflect, with panes that it passes straight.
 * It is computed, not sampled: a pane mirrors a tenth, so of four photons most often none, and the
 * cell would look empty.
 */
static double deflected_share(const struct orl_lit_scene *lit_scene, struct orl_vec3 origin,
                              struct orl_vec3 direction)
{
    struct orl_path path = orl_path_from(origin, direction);
    struct orl_hit hit;
    double sum = 0, share = 1;
    for (int pane = 0; pane < MOST_PANES && share > dimmest_share; pane++) {
        if (!orl_path_intersect(lit_scene, &path, &hit) ||
            orl_lit_scene_crossing(lit_scene, &hit) == ORL_CROSSING_INWARDS)
            return sum;
        const struct orl_material *m = orl_lit_scene_material(lit_scene, &hit);
        const struct orl_vec3 back = orl_path_back(&path);
        const enum orl_lobes lobes = (enum orl_lobes)(ORL_LOBE_REFLECTED | ORL_LOBE_TRANSMITTED);
        const double straight = orl_luma(orl_material_straight(m, &hit, back));
        const double all = orl_luma(orl_material_albedo(m, &hit, back, lobes));
        sum += share * fmax(all - straight, 0);
        share *= straight;
        orl_path_skip_surface(&path, lit_scene, &hit);
    }
    return sum;
}

/*
 * Returns 1 if light along that ray hits further surfaces, 0 if it leaves. For maps it must hit
 * several in a row, as light in a room does, and light on the ground outside does not. Then photons
 * in rooms have about the same flux, whether they come by an opening or by a port, and density
 * estimates do not depend on a few heavy ones.
 */
static double ray_importance(const struct orl_lit_scene *lit_scene, struct orl_vec3 origin,
                             struct orl_vec3 direction, bool lamps, struct orl_random *random)
{
    struct orl_path path = orl_path_from(origin, direction);
    struct orl_hit hit;
    if (!orl_path_intersect(lit_scene, &path, &hit))
        return 0;
    if (orl_lit_scene_crossing(lit_scene, &hit) == ORL_CROSSING_INWARDS)
        /* the port emits this light itself, but there may be a gap beside the pane */
        return beside_port;
    for (int segment = 0; segment < (lamps ? 1 : SEGMENTS); segment++) {
        const struct orl_surface_sample s =
            orl_material_sample(orl_lit_scene_material(lit_scene, &hit), &hit, orl_path_back(&path),
                                ORL_TRANSPORT_LIGHT, ORL_LOBE_ALL, random);
        if (s.event == ORL_EVENT_ABSORBED)
            return segment > 0;
        orl_path_spawn_ray(&path, lit_scene, &hit, &s);
        if (!orl_path_intersect(lit_scene, &path, &hit))
            return 0;
    }
    return 1;
}

static void probe_row(void *arg, size_t row, uint32_t member)
{
    const struct pilot *pilot = arg;
    const struct orl_lit_scene *lit_scene = pilot->emission->lit_scene;
    (void)member;
    for (uint32_t column = 0; column < pilot->side; column++) {
        const size_t cell = row * pilot->side + column;
        struct orl_random random = orl_random_stream(pilot->seed, ORL_PURPOSE_GUIDE,
                                                     (uint64_t)pilot->patch << 32 | (uint64_t)cell);
        double sum = 0;
        for (int i = 0; i < PHOTONS_A_CELL; i++) {
            const struct orl_vec3 towards = pilot->stratum->kind == ORL_STRATUM_OPEN_SUN
                                                ? lit_scene->suns[pilot->stratum->sun].frame.n
                                                : patch_direction(pilot->patch, &random);
            const double x = column + orl_random_uniform(&random);
            const double y = (double)row + orl_random_uniform(&random);
            const double u[2] = {x / pilot->side, y / pilot->side};
            struct orl_vec3 origin;
            orl_parallel_beam_sample(lit_scene->geometry, towards, u, &origin);
            sum += pilot->caustic
                       ? deflected_share(lit_scene, origin, orl_neg(towards))
                       : ray_importance(lit_scene, origin, orl_neg(towards), pilot->lamps, &random);
        }
        const double least = pilot->caustic ? least_importance_caustic
                             : pilot->lamps ? least_importance_lamp
                                            : least_importance;
        pilot->values[cell] = least + sum / PHOTONS_A_CELL;
    }
}

/*
 * Returns the largest value around a cell; the cell gets a share of it. The few photons of a cell
 * easily miss a narrow contribution inside it. Photons that carry it would be hundreds of times as
 * heavy as others.
 */
static double largest_beside(const double *scratch, size_t side, size_t x, size_t y)
{
    double most = 0;
    for (size_t row = y > 0 ? y - 1 : 0; row <= y + 1 && row < side; row++)
        for (size_t column = x > 0 ? x - 1 : 0; column <= x + 1 && column < side; column++)
            most = fmax(most, scratch[row * side + column]);
    return most;
}

static void spread_values(struct pilot *pilot, double *scratch)
{
    const size_t side = pilot->side;
    memcpy(scratch, pilot->values, side * side * sizeof *scratch);
    for (size_t y = 0; y < side; y++)
        for (size_t x = 0; x < side; x++)
            pilot->values[y * side + x] =
                fmax(scratch[y * side + x], beside_others * largest_beside(scratch, side, x, y));
}

/* Computes the summed-area table: sums of all cells above and left of a corner, (side + 1)
 * squared. */
static void sum_areas(const struct pilot *pilot, double *ret_sums)
{
    const size_t side = pilot->side, wide = side + 1;
    for (size_t i = 0; i < wide; i++)
        ret_sums[i] = ret_sums[i * wide] = 0;
    for (size_t y = 0; y < side; y++)
        for (size_t x = 0; x < side; x++)
            ret_sums[(y + 1) * wide + x + 1] =
                pilot->values[y * side + x] + ret_sums[y * wide + x + 1] +
                ret_sums[(y + 1) * wide + x] - ret_sums[y * wide + x];
}

/* Returns the mean of the cells up to `reach` around a cell. */
static double mean_around(const double *sums, size_t side, size_t x, size_t y, size_t reach)
{
    const size_t wide = side + 1;
    const size_t x0 = x > reach ? x - reach : 0, x1 = x + reach < side ? x + reach + 1 : side;
    const size_t y0 = y > reach ? y - reach : 0, y1 = y + reach < side ? y + reach + 1 : side;
    return (sums[y1 * wide + x1] - sums[y0 * wide + x1] - sums[y1 * wide + x0] +
            sums[y0 * wide + x0]) /
           (double)((x1 - x0) * (y1 - y0));
}

/*
 * Importance for virtual point lights. Such a light reaches a place with some probability or not at
 * all; the variance is least if photons are distributed by the square root of that probability. A
 * cell's few photons estimate a small probability badly, so the largest mean of several
 * neighbourhoods is used.
 */
static void weigh_cells(struct pilot *pilot, double *sums)
{
    static const size_t reaches[] = {1, 4, 13};
    const size_t side = pilot->side;
    sum_areas(pilot, sums);
    for (size_t y = 0; y < side; y++)
        for (size_t x = 0; x < side; x++) {
            double *value = &pilot->values[y * side + x];
            for (size_t i = 0; i < sizeof reaches / sizeof *reaches; i++)
                *value = fmax(*value, mean_around(sums, side, x, y, reaches[i]));
            *value = sqrt(*value);
        }
}

static int build_importance(struct pilot *pilot, struct orl_thread_pool *pool,
                            struct orl_distribution_2d *ret_table)
{
    const size_t side = pilot->side;
    double *scratch = malloc((side + 1) * (side + 1) * sizeof *scratch);
    pilot->values = malloc(side * side * sizeof *pilot->values);
    int code =
        scratch && pilot->values ? orl_parallel_try(pool, side, probe_row, pilot) : ORL_ERR_NOMEM;
    if (code == 0 && pilot->lamps && !pilot->caustic)
        weigh_cells(pilot, scratch);
    else if (code == 0)
        spread_values(pilot, scratch);
    if (code == 0)
        code = orl_distribution_2d_init(ret_table, pilot->side, pilot->side, pilot->values,
                                        1 - importance_share);
    free(scratch);
    free(pilot->values);
    return code;
}

static int build_dome_importance(struct orl_emission *e, struct pilot *pilot,
                                 struct orl_thread_pool *pool)
{
    int code = 0;
    e->dome_importance = calloc(PATCHES, sizeof *e->dome_importance);
    if (!e->dome_importance)
        return ORL_ERR_NOMEM;
    pilot->side = PATCH_SIDE;
    for (pilot->patch = 0; pilot->patch < PATCHES && code == 0; pilot->patch++)
        code = build_importance(pilot, pool, &e->dome_importance[pilot->patch]);
    return code;
}

static int build_sun_importance(struct orl_emission *e, struct pilot *pilot,
                                struct orl_thread_pool *pool)
{
    const uint32_t sun = pilot->stratum->sun;
    pilot->side = SUN_SIDE;
    pilot->patch = PATCHES + sun;
    int code = build_importance(pilot, pool, &e->sun_importance[sun]);
    pilot->caustic = true;
    if (code == 0)
        code = build_importance(pilot, pool, &e->sun_caustic_importance[sun]);
    pilot->caustic = false;
    return code;
}

int orl_emission_importance_build(struct orl_emission *emission, uint64_t seed,
                                  struct orl_thread_pool *pool)
{
    struct pilot pilot = {
        .emission = emission, .seed = seed, .lamps = emission->use == ORL_PHOTONS_FOR_VPLS};
    int code = 0;
    const size_t n_suns = emission->lit_scene->n_suns;
    emission->sun_importance = calloc(n_suns + 1, sizeof *emission->sun_importance);
    emission->sun_caustic_importance = calloc(n_suns + 1, sizeof *emission->sun_caustic_importance);
    if (!emission->sun_importance || !emission->sun_caustic_importance)
        return ORL_ERR_NOMEM;
    for (size_t i = 0; i < emission->n_strata && code == 0; i++) {
        pilot.stratum = &emission->strata[i];
        if (pilot.stratum->kind == ORL_STRATUM_OPEN_DOME)
            code = build_dome_importance(emission, &pilot, pool);
        if (pilot.stratum->kind == ORL_STRATUM_OPEN_SUN)
            code = build_sun_importance(emission, &pilot, pool);
    }
    return code;
}

void orl_emission_importance_done(struct orl_emission *emission)
{
    for (size_t i = 0; emission->sun_caustic_importance && i < emission->n_suns; i++) {
        orl_distribution_2d_done(&emission->sun_importance[i]);
        orl_distribution_2d_done(&emission->sun_caustic_importance[i]);
    }
    for (size_t i = 0; emission->dome_importance && i < PATCHES; i++)
        orl_distribution_2d_done(&emission->dome_importance[i]);
    free(emission->sun_importance);
    free(emission->sun_caustic_importance);
    free(emission->dome_importance);
}

uint64_t orl_emission_importance_bytes(const struct orl_emission *emission)
{
    uint64_t bytes = 0;
    for (size_t i = 0; emission->sun_caustic_importance && i < emission->n_suns; i++)
        bytes += orl_distribution_2d_bytes(&emission->sun_importance[i]) +
                 orl_distribution_2d_bytes(&emission->sun_caustic_importance[i]);
    for (size_t i = 0; emission->dome_importance && i < PATCHES; i++)
        bytes += orl_distribution_2d_bytes(&emission->dome_importance[i]);
    return bytes;
}

double orl_emission_importance_mean(const struct orl_emission *emission, struct orl_vec3 towards)
{
    const struct orl_distribution_2d *distribution = &emission->dome_importance[patch_of(towards)];
    return distribution->weight ? distribution->mean : 1;
}

const struct orl_distribution_2d *orl_emission_importance_find(const struct orl_emission *emission,
                                                               const struct orl_stratum *stratum,
                                                               bool caustic,
                                                               struct orl_vec3 towards)
{
    const struct orl_distribution_2d *distribution = NULL;
    if (stratum->kind == ORL_STRATUM_OPEN_SUN && emission->sun_importance)
        distribution =
            &(caustic ? emission->sun_caustic_importance : emission->sun_importance)[stratum->sun];
    else if (stratum->kind == ORL_STRATUM_OPEN_DOME && emission->dome_importance)
        distribution = &emission->dome_importance[patch_of(towards)];
    return distribution && distribution->weight ? distribution : NULL;
}
