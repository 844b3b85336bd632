#include "render/gather/photon_guiding.h"

#include <stdlib.h>

#include "photon/map/map_layout.h"
#include "photon/map/quantization.h"
#include "scene/material/scatter.h"

enum { RUN = 16, MOST_DEPTH = 18, ROOM = 8 * ORL_GUIDE_PATCHES };

static const double least_share = 1.0 / 256; /* cells with less light are not halved */
static const double contrast = 8;            /* ratio of a bright cell to the mean */
static const double tolerated = 0.005; /* error of even rays, as a share of the photons' light */
static const double generous = 1.25;   /* factor by which patches exceed their outermost photons */

/* Sums over the photons of a run; offsets are from its first one. */
struct run {
    struct orl_vec3 origin, offsets, normals;
    double squares, flux;
};

static struct orl_vec3 place_of(const struct orl_photon_map *map, uint64_t photon)
{
    const struct orl_map_header *h = map->header;
    const uint32_t *leaf =
        map->places + photon / ORL_MAP_LEAF * ORL_LEAF_WORDS + photon % ORL_MAP_LEAF;
    uint32_t cell[3];
    orl_position_unpack(leaf[0], leaf[ORL_MAP_LEAF], cell);
    return orl_v3((double)(float)(h->low[0] + (cell[0] + 0.5) * h->cell),
                  (double)(float)(h->low[1] + (cell[1] + 0.5) * h->cell),
                  (double)(float)(h->low[2] + (cell[2] + 0.5) * h->cell));
}

static double luma_of(const struct orl_photon_map *map, uint64_t photon)
{
    const struct orl_rgb flux =
        orl_rgb_scale(orl_flux_unpack(map->fluxes[photon]), map->header->flux_unit);
    return orl_luma(
        (struct orl_rgb){(double)(float)flux.r, (double)(float)flux.g, (double)(float)flux.b});
}

/* Sums up a run. Neighbours mostly have one normal, so that it is decoded only when it changes. */
static struct run sum_run(const struct orl_photon_map *map, uint64_t first, uint64_t n)
{
    struct run run = {.origin = place_of(map, first)};
    uint16_t code = map->normals[first];
    struct orl_vec3 normal = orl_normal_decode(code);
    for (uint64_t i = first; i < first + n; i++) {
        const struct orl_vec3 off = orl_sub(place_of(map, i), run.origin);
        run.offsets = orl_add(run.offsets, off);
        run.squares += orl_dot(off, off);
        if (map->normals[i] != code) {
            code = map->normals[i];
            normal = orl_normal_decode(code);
        }
        run.normals = orl_add(run.normals, normal);
        run.flux += luma_of(map, i);
    }
    return run;
}

/* Returns the spot of photons first .. first + n - 1 of the map's order. */
static struct orl_guide_patch patch_of(const struct orl_photon_map *map, uint64_t first, uint64_t n)
{
    const struct run run = sum_run(map, first, n);
    const struct orl_vec3 mean = orl_scale(run.offsets, 1.0 / (double)n);
    const struct orl_vec3 at = orl_add(run.origin, mean);
    const double spread2 = orl_larger(run.squares / (double)n - orl_dot(mean, mean), 0);
    const struct orl_vec3 normal =
        orl_length(run.normals) > 0 ? orl_normalize(run.normals) : run.normals;
    /* The mean squared distance from a square's centre is 2/3 of the square of half its side. */
    return (struct orl_guide_patch){.at = {(float)at.x, (float)at.y, (float)at.z},
                                    .normal = {(float)normal.x, (float)normal.y, (float)normal.z},
                                    .half = (float)(generous * sqrt(1.5 * spread2)),
                                    .flux = (float)run.flux};
}

struct making {
    const struct orl_photon_map *map;
    struct orl_guide_patch *patches;
    uint64_t run; /* photons in each run but the last */
};

static void make_patch(void *arg, size_t index, uint32_t member)
{
    const struct making *m = arg;
    const uint64_t first = index * m->run, left = m->map->header->count - first;
    (void)member;
    m->patches[index] = patch_of(m->map, first, left < m->run ? left : m->run);
}

int orl_photon_guide_init(struct orl_photon_guide *guide, const struct orl_photon_map *map,
                          struct orl_thread_pool *pool)
{
    const uint64_t count = map->header->count;
    const uint64_t least = (count + ORL_GUIDE_PATCHES - 1) / ORL_GUIDE_PATCHES;
    const uint64_t run = least > RUN ? least : RUN;
    *guide = (struct orl_photon_guide){.count = (uint32_t)((count + run - 1) / run)};
    guide->patches = malloc((guide->count + 1) * sizeof *guide->patches);
    if (!guide->patches)
        return ORL_ERR_NOMEM;
    struct making making = {map, guide->patches, run};
    return orl_parallel_try(pool, guide->count, make_patch, &making);
}

void orl_photon_guide_done(struct orl_photon_guide *guide)
{
    free(guide->patches);
    *guide = (struct orl_photon_guide){.patches = NULL};
}

/* The area of the square that a spot covers, as a uniform density. */
struct projected_patch {
    float at[2], half, light;
};

/* State while a view is built. */
struct build {
    struct orl_guide_distribution *distribution;
    struct projected_patch projected[ORL_GUIDE_PATCHES];
    uint16_t room[ROOM]; /* lists of the splats in a cell, one after another */
    double light;        /* sum over all splats */
    double variance;     /* even rays' variance for one ray, in units of the squared light */
};

struct area {
    double low[2], high[2];
};

/* Projects a spot. Returns false if it lies behind the place or faces away. */
static bool project_patch(const struct orl_guide_patch *patch, struct orl_vec3 point,
                          const struct orl_frame *frame, struct projected_patch *ret)
{
    const struct orl_vec3 way =
        orl_sub(orl_v3((double)patch->at[0], (double)patch->at[1], (double)patch->at[2]), point);
    const struct orl_vec3 facing =
        orl_v3((double)patch->normal[0], (double)patch->normal[1], (double)patch->normal[2]);
    const double half = (double)patch->half;
    const double d2 = orl_larger(orl_dot(way, way), half * half), d = sqrt(d2);
    const double there = -orl_dot(way, facing) / d, here = orl_dot(way, frame->n) / d;
    if (!(d > 0) || !(there > 0) || !(here > 0))
        return false;
    const double wide = half / d;
    const struct orl_vec3 local = orl_to_local(frame, orl_scale(way, 1 / d));
    const struct orl_square at = orl_disk_to_square(local.x, local.y);
    ret->at[0] = (float)(0.5 * (at.x + 1));
    ret->at[1] = (float)(0.5 * (at.y + 1));
    ret->half = (float)orl_smaller(wide * sqrt(orl_larger(here, wide) / ORL_PI) + 1e-6, 0.5);
    ret->light = (float)((double)patch->flux * there * here / d2);
    return ret->light > 0;
}

static double overlap(const struct projected_patch *s, const struct area *a, int axis)
{
    const double low = orl_larger((double)s->at[axis] - (double)s->half, a->low[axis]);
    const double high = orl_smaller((double)s->at[axis] + (double)s->half, a->high[axis]);
    return orl_larger(high - low, 0) / (2 * (double)s->half);
}

/* Appends the splats of a list that overlap an area to the list at `to`; returns their number and
 * sets their light there. */
static uint32_t pick_projected(struct build *build, uint32_t first, uint32_t count, uint32_t to,
                               const struct area *area, double *ret_light)
{
    uint32_t n = 0;
    *ret_light = 0;
    for (uint32_t i = first; i < first + count; i++) {
        const struct projected_patch *s = &build->projected[build->room[i]];
        const double share = overlap(s, area, 0) * overlap(s, area, 1);
        if (!(share > 0))
            continue;
        *ret_light += share * (double)s->light;
        build->room[to + n++] = build->room[i];
    }
    return n;
}

/* Returns true if any splat of a list is smaller than the cell. */
static bool is_fine(const struct build *build, uint32_t first, uint32_t count, double size)
{
    for (uint32_t i = first; i < first + count; i++)
        if (2 * (double)build->projected[build->room[i]].half < size)
            return true;
    return false;
}

/* Divides a cell while it contains finer splats. Its mass is the light of its bright parts. */
static void divide_cell(struct build *build, uint32_t cell, uint32_t first, uint32_t count,
                        const struct area *area, double light, int depth)
{
    struct orl_guide_distribution *distribution = build->distribution;
    struct orl_guide_cell *here = &distribution->cells[cell];
    const double size = (area->high[0] - area->low[0]) * (area->high[1] - area->low[1]);
    const double share = light / build->light;
    *here = (struct orl_guide_cell){.mass = 0};
    if (share < least_share || depth == MOST_DEPTH || distribution->count + 2 > ORL_GUIDE_CELLS ||
        first + 2 * count > ROOM || !is_fine(build, first, count, sqrt(size))) {
        if (share > contrast * size) {
            here->mass = (float)share;
            build->variance += share * share / size;
        }
        return;
    }
    const uint32_t low = distribution->count;
    distribution->count += 2;
    for (uint32_t half = 0; half < 2; half++) {
        const int axis = depth % 2;
        struct area part = *area;
        double within;
        (half ? part.low : part.high)[axis] = 0.5 * (area->low[axis] + area->high[axis]);
        const uint32_t n = pick_projected(build, first, count, first + count, &part, &within);
        divide_cell(build, low + half, first + count, n, &part, within, depth + 1);
    }
    here->low = low;
    here->mass = distribution->cells[low].mass + distribution->cells[low + 1].mass;
}

void orl_guide_distribution_build(const struct orl_photon_guide *guide, struct orl_vec3 point,
                                  struct orl_vec3 normal, uint32_t rays,
                                  struct orl_guide_distribution *ret_distribution)
{
    const struct orl_frame frame = orl_frame_about(normal);
    const struct area all = {{0, 0}, {1, 1}};
    struct build build; /* its splats stay uninitialised, because they are many */
    uint32_t n = 0;
    build.distribution = ret_distribution;
    build.light = build.variance = 0;
    for (uint32_t i = 0; i < guide->count; i++)
        if (project_patch(&guide->patches[i], point, &frame, &build.projected[n])) {
            build.light += (double)build.projected[n].light;
            build.room[n] = (uint16_t)n;
            n++;
        }
    ret_distribution->useful = false;
    ret_distribution->count = 1;
    if (!(build.light > 0))
        return;
    divide_cell(&build, 0, 0, n, &all, build.light, 0);
    ret_distribution->useful =
        ret_distribution->cells[0].mass > 0 && build.variance > tolerated * tolerated * rays;
}

void orl_guide_distribution_sample(const struct orl_guide_distribution *distribution, double u[2])
{
    double low[2] = {0, 0}, size[2] = {1, 1};
    uint32_t cell = 0;
    for (int axis = 0; distribution->cells[cell].low; axis = 1 - axis) {
        const struct orl_guide_cell *halves = &distribution->cells[distribution->cells[cell].low];
        const double p = (double)halves[0].mass / ((double)halves[0].mass + (double)halves[1].mass);
        const bool second = !(u[axis] < p);
        u[axis] = orl_smaller(second ? (u[axis] - p) / (1 - p) : u[axis] / p, 1 - 0x1p-53);
        size[axis] *= 0.5;
        low[axis] += second ? size[axis] : 0;
        cell = distribution->cells[cell].low + second;
    }
    for (int axis = 0; axis < 2; axis++)
        u[axis] = low[axis] + size[axis] * u[axis];
}

double orl_guide_distribution_pdf(const struct orl_guide_distribution *distribution,
                                  const double u[2])
{
    double at[2] = {u[0], u[1]}, size = 1;
    uint32_t cell = 0;
    for (int axis = 0; distribution->cells[cell].low && distribution->cells[cell].mass > 0;
         axis = 1 - axis) {
        const bool second = at[axis] >= 0.5;
        at[axis] = 2 * at[axis] - second;
        size *= 0.5;
        cell = distribution->cells[cell].low + second;
    }
    return (double)distribution->cells[cell].mass / (double)distribution->cells[0].mass / size;
}
