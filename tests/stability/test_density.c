/*
 * Hard cases of density estimates, on maps made by hand: empty ones, few photons, photons on one
 * spot, thin walls, a table just above the floor, edges and corners. Photons of flux 1 are
 * distributed uniformly, so the expected estimate is their number over the area. Estimates are
 * taken both at the place and by leaves.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>
#include <sodium.h>

#include "base/sampling/sampling.h"
#include "photon/density/irradiance_tables.h"
#include "photon/map/quantization.h"
#include "support/cli.h"
#include "support/scene_text.h"
#include "support/stability.h"

#define GREY "void plastic w 0 0 5 .5 .5 .5 0 0\n"

struct bed {
    struct orl_lit_scene *lit_scene;
    struct orl_photon *photons;
    size_t count;
    struct orl_random random;
    struct orl_photon_map *map;
    struct orl_leaf_irradiance *leaf_irradiance;
    struct orl_search *search;
};

static struct bed bed_new(const char *scene, size_t most, uint64_t seed)
{
    struct bed bed = {.photons = malloc((most + 1) * sizeof *bed.photons),
                      .random = orl_random_stream(seed, ORL_PURPOSE_BENCH, 0),
                      .search = calloc(1, sizeof *bed.search)};
    assert_true(bed.photons && bed.search);
    bed.lit_scene = build_lit_scene(scene, NULL, NULL, NULL);
    return bed;
}

/* Distributes count photons over the parallelogram at corner, in scene coordinates. */
static void strew(struct bed *bed, size_t count, struct orl_vec3 corner, struct orl_vec3 a,
                  struct orl_vec3 b, struct orl_vec3 normal)
{
    const struct orl_vec3 low = orl_sub(corner, bed->lit_scene->geometry->center);
    for (size_t i = 0; i < count; i++) {
        const double u = orl_random_uniform(&bed->random), v = orl_random_uniform(&bed->random);
        const struct orl_vec3 p = orl_madd(orl_madd(low, a, u), b, v);
        bed->photons[bed->count++] =
            (struct orl_photon){.position = {(float)p.x, (float)p.y, (float)p.z},
                                .flux = {1, 1, 1},
                                .normal = orl_normal_encode(normal)};
    }
}

static void open_bed_map(struct bed *bed, double max_radius)
{
    const struct orl_map_build build = {.kind = "global", .emitted = 1, .seed = 1};
    struct orl_thread_pool *pool = orl_thread_pool_start(2);
    struct orl_error err;
    char folder[64], path[128];
    cli_make_folder(folder);
    snprintf(path, sizeof path, "%s/map", folder);
    assert_int_equal(orl_photon_map_write(path, bed->photons, bed->count, &build, pool, &err), 0);
    assert_int_equal(orl_photon_map_open(path, false, &bed->map, &err), 0);
    bed->leaf_irradiance = orl_leaf_irradiance_new(bed->map, bed->lit_scene, 64, max_radius, pool);
    assert_non_null(bed->leaf_irradiance);
    orl_thread_pool_stop(pool);
    cli_remove_folder(folder);
}

static void bed_done(struct bed *bed)
{
    orl_leaf_irradiance_free(bed->leaf_irradiance);
    orl_photon_map_free(bed->map);
    orl_lit_scene_free(bed->lit_scene);
    free(bed->photons);
    free(bed->search);
}

/* Returns the irradiance at a place of the scene by k neighbours; k = 0: by leaves. */
static double estimate_irradiance(struct bed *bed, struct orl_vec3 place, struct orl_vec3 normal,
                                  uint32_t k, double max_radius)
{
    struct orl_surface_point surface_point;
    const struct orl_vec3 point = orl_sub(place, bed->lit_scene->geometry->center);
    assert_true(orl_surface_point_find(bed->lit_scene, point, normal, 1e-5, &surface_point));
    if (k == 0)
        return orl_leaf_irradiance_estimate(bed->leaf_irradiance, point, normal, &surface_point,
                                            bed->search, NULL, NULL)
            .g;
    const struct orl_density_query query = {.point = point,
                                            .normal = normal,
                                            .k = k,
                                            .max_radius = max_radius,
                                            .surface_point = &surface_point};
    return orl_density_estimate(bed->map, &query, bed->search).irradiance.g;
}

static const struct orl_vec3 up = {0, 0, 1};

/* ---- Few photons ----------------------------------------------------------------------------- */

static const char plate[] = GREY "w polygon floor 0 0 12 0 0 0 2 0 0 2 2 0 0 2 0\n";

static void case_22_empty_map(void **state)
{
    struct bed bed = bed_new(plate, 0, 1);
    (void)state;
    open_bed_map(&bed, 0.5);
    stability_row(22, "empty map", "irradiance by k neighbours",
                  fabs(estimate_irradiance(&bed, orl_v3(1, 1, 0), up, 64, 0.5)), 0);
    stability_row(22, "empty map", "irradiance by leaves",
                  fabs(estimate_irradiance(&bed, orl_v3(1, 1, 0), up, 0, 0.5)), 0);
    bed_done(&bed);
    static const struct orl_sensor sensor = {{1, 1, 1}, {0, 0, 1}};
    struct orl_result result =
        scene_run(&(struct scene_run){.scene = plate, .sensors = &sensor, .n_sensors = 1});
    bool told = false;
    for (size_t i = 0; i < result.n_warnings; i++)
        told = told || strstr(result.warnings[i], "no light");
    stability_holds(22, "empty map", "a job without photons says so, and is dark",
                    told && !(result.illuminance_lx[0] != 0));
    orl_result_done(&result);
}

static void case_23_more_neighbours_than_photons(void **state)
{
    static const uint32_t ks[] = {0, 1, 2, 3, 64, 4096};
    double undefined = 0, off = 0;
    (void)state;
    for (size_t n = 0; n <= 3; n++) {
        struct bed bed = bed_new(plate, n, n);
        strew(&bed, n, orl_v3(0.9, 0.9, 0), orl_v3(0.2, 0, 0), orl_v3(0, 0.2, 0), up);
        open_bed_map(&bed, 0.5);
        for (size_t i = 0; i < sizeof ks / sizeof *ks; i++) {
            const double e = estimate_irradiance(&bed, orl_v3(1, 1, 0), up, ks[i], 0.5);
            undefined += !isfinite(e) || e < 0;
            /* All photons, over the whole disc; fluxes are stored to 1/256. */
            if (ks[i] >= 64)
                off = fmax(off, fabs(e * ORL_PI * 0.25 - (double)n) / fmax((double)n, 1));
        }
        bed_done(&bed);
    }
    stability_row(23, "k > N; N = 0, 1, 2, 3", "answers that are no finite number", undefined, 0);
    stability_row(23, "k > N; N = 0, 1, 2, 3", "relative error of all flux over the disc", off,
                  1.0 / 256);
}

static void case_24_coincident_photons(void **state)
{
    struct bed bed = bed_new(plate, 1000, 3);
    (void)state;
    strew(&bed, 1000, orl_v3(1, 1, 0), orl_v3(0, 0, 0), orl_v3(0, 0, 0), up);
    open_bed_map(&bed, 0.5);
    double undefined = 0;
    for (uint32_t k = 0; k <= 4096; k = 2 * k + 1) {
        const double e = estimate_irradiance(&bed, orl_v3(1, 1, 0), up, k, 0.5);
        undefined += !isfinite(e) || !(e > 0);
    }
    stability_row(24, "1000 photons on one spot", "answers that are no finite number above 0",
                  undefined, 0);
    bed_done(&bed);
}

/* ---- Walls ----------------------------------------------------------------------------------- */

/* One floor under two rooms, with a wall 1 mm thick between them that starts at `gap`. */
static void two_rooms(const char *name, double gap)
{
    static const double away[] = {1e-4, 1e-3, 0.01, 0.05, 0.2};
    const double lit = 1e5 / 4;
    double worst = 0, worst_leaf = 0, dimmest = INFINITY;
    char scene[2048];
    snprintf(scene, sizeof scene,
             GREY "w polygon floor 0 0 12 0 0 0 4 0 0 4 2 0 0 2 0\n"
                  "w polygon wall1 0 0 12 2 0 %g 2 2 %g 2 2 3 2 0 3\n"
                  "w polygon wall2 0 0 12 2.001 0 %g 2.001 0 3 2.001 2 3 2.001 2 %g\n"
                  "w polygon under 0 0 12 2 0 %g 2.001 0 %g 2.001 2 %g 2 2 %g\n",
             gap, gap, gap, gap, gap > 0 ? gap : 3, gap > 0 ? gap : 3, gap > 0 ? gap : 3,
             gap > 0 ? gap : 3);
    struct bed bed = bed_new(scene, 100000, 28);
    strew(&bed, 100000, orl_v3(0, 0, 0), orl_v3(2, 0, 0), orl_v3(0, 2, 0), up);
    open_bed_map(&bed, 1);
    for (size_t i = 0; i < sizeof away / sizeof *away; i++) {
        for (int k = 0; k < 40; k++) {
            const double y = 0.01 + 0.0495 * k;
            const struct orl_vec3 dark = orl_v3(2.001 + away[i], y, 0),
                                  bright = orl_v3(2 - away[i], y, 0);
            worst = fmax(worst, estimate_irradiance(&bed, dark, up, 300, 1) / lit);
            worst_leaf = fmax(worst_leaf, estimate_irradiance(&bed, dark, up, 0, 1) / lit);
            dimmest = fmin(dimmest, estimate_irradiance(&bed, bright, up, 300, 1) / lit);
        }
    }
    stability_row(28, name, "dark side over lit side, by k neighbours", worst, 1e-3);
    stability_row(28, name, "dark side over lit side, by leaves", worst_leaf, 1e-3);
    /* The standard error of one estimate is 1/sqrt(298); this is the minimum of 200. */
    stability_row(28, name, "lit side: what the dimmest estimate lacks", 1 - dimmest, 0.25);
    bed_done(&bed);
}

static void case_28_thin_wall(void **state)
{
    (void)state;
    two_rooms("wall of 1 mm on one floor", 0);
    two_rooms("wall of 1 mm, 1 mm above the floor", 1e-3);
}

/* ---- A table just above the floor ------------------------------------------------------------ */

static void case_29_table(void **state)
{
    static const char scene[] = GREY "w polygon floor 0 0 12 0 0 0 4 0 0 4 3 0 0 3 0\n"
                                     "w polygon top 0 0 12 1 1 .005 3 1 .005 3 2 .005 1 2 .005\n";
    double on_table = 0, under = 0, beside = 0;
    (void)state;
    for (int lit_table = 0; lit_table < 2; lit_table++) {
        struct bed bed = bed_new(scene, 200000, 29);
        if (lit_table) {
            strew(&bed, 100000, orl_v3(1, 1, .005), orl_v3(2, 0, 0), orl_v3(0, 1, 0), up);
        } else {
            /* The floor, without the shadow of the table. */
            strew(&bed, 60000, orl_v3(0, 0, 0), orl_v3(1, 0, 0), orl_v3(0, 3, 0), up);
            strew(&bed, 60000, orl_v3(3, 0, 0), orl_v3(1, 0, 0), orl_v3(0, 3, 0), up);
            strew(&bed, 40000, orl_v3(1, 0, 0), orl_v3(2, 0, 0), orl_v3(0, 1, 0), up);
            strew(&bed, 40000, orl_v3(1, 2, 0), orl_v3(2, 0, 0), orl_v3(0, 1, 0), up);
        }
        open_bed_map(&bed, 0.4);
        for (int i = 0; i < 40; i++) {
            const double x = 1.0005 + 0.02 * i * i / 39 * 2.45;
            for (uint32_t k = 0; k <= 64; k += 64) {
                if (!lit_table)
                    on_table =
                        fmax(on_table, estimate_irradiance(&bed, orl_v3(x, 1.5, .005), up, k, 0.4));
                else
                    under = fmax(under, estimate_irradiance(&bed, orl_v3(x, 1.5, 0), up, k, 0.4));
                if (lit_table)
                    beside = fmax(beside, estimate_irradiance(&bed, orl_v3(1.5 - 0.5 * x, 1.5, 0),
                                                              up, k, 0.4));
            }
        }
        if (!lit_table)
            under = fmax(under, estimate_irradiance(&bed, orl_v3(2, 1.5, 0), up, 64, 0.4));
        bed_done(&bed);
    }
    stability_row(29, "table 5 mm above the floor", "dark table beside a lit floor: E over lit",
                  on_table / 20000, 1e-3);
    stability_row(29, "table 5 mm above the floor", "floor under a lit table: E over lit",
                  under / 50000, 1e-3);
    stability_row(29, "table 5 mm above the floor", "floor beside a lit table: E over lit",
                  beside / 50000, 1e-3);
}

/* ---- Edges and corners ----------------------------------------------------------------------- */

struct face {
    struct orl_vec3 corner, a, b, normal; /* a and b are unit vectors */
    double side[2];
};

/* A furnace, 4 x 3 x 2.5 m: every wall has the same irradiance. */
static const struct face faces[6] = {
    {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {4, 3}},
    {{0, 0, 2.5}, {1, 0, 0}, {0, 1, 0}, {0, 0, -1}, {4, 3}},
    {{0, 0, 0}, {1, 0, 0}, {0, 0, 1}, {0, 1, 0}, {4, 2.5}},
    {{0, 3, 0}, {1, 0, 0}, {0, 0, 1}, {0, -1, 0}, {4, 2.5}},
    {{0, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 0}, {3, 2.5}},
    {{4, 0, 0}, {0, 1, 0}, {0, 0, 1}, {-1, 0, 0}, {3, 2.5}},
};

static struct orl_vec3 place_on(const struct face *f, double u, double v)
{
    return orl_madd(orl_madd(f->corner, f->a, u), f->b, v);
}

/* Returns the mean along all edges at that distance: 500 neighbours, half a disc of 15 cm, some
 * 250 of them that do not overlap; 0.3 % standard error. */
static double mean_along_edges(struct bed *bed, double away, uint32_t k)
{
    enum { STEPS = 60 };
    double sum = 0;
    for (int f = 0; f < 6; f++) {
        for (int i = 0; i < STEPS; i++) {
            const double *side = faces[f].side, u = 0.2 + (side[0] - 0.4) * (i + 0.5) / STEPS,
                         v = 0.2 + (side[1] - 0.4) * (i + 0.5) / STEPS;
            const double at[4][2] = {
                {u, away}, {u, side[1] - away}, {away, v}, {side[0] - away, v}};
            for (int e = 0; e < 4; e++)
                sum += estimate_irradiance(bed, place_on(&faces[f], at[e][0], at[e][1]),
                                           faces[f].normal, k, 1);
        }
    }
    return sum / (6 * STEPS * 4);
}

/* Returns the mean of the 24 corners, 2000 neighbours each: 0.5 % standard error. */
static double mean_in_corners(struct bed *bed, double away)
{
    double sum = 0;
    for (int f = 0; f < 6; f++)
        for (int c = 0; c < 4; c++) {
            const double u = c & 1 ? faces[f].side[0] - away : away;
            const double v = c & 2 ? faces[f].side[1] - away : away;
            sum += estimate_irradiance(bed, place_on(&faces[f], u, v), faces[f].normal, 2000, 1);
        }
    return sum / 24;
}

static void case_30_corner_of_a_furnace(void **state)
{
    static const double away[] = {0, 1e-4, 0.001, 0.01, 0.03, 0.1, 0.3};
    const double density = 17000;
    struct bed bed = bed_new(GREY "!genbox w room 4 3 2.5 -i\n", 1100000, 30);
    double edge = 0, corner = 0, leaf = 0;
    (void)state;
    for (int f = 0; f < 6; f++)
        strew(&bed, (size_t)(density * faces[f].side[0] * faces[f].side[1]), faces[f].corner,
              orl_scale(faces[f].a, faces[f].side[0]), orl_scale(faces[f].b, faces[f].side[1]),
              faces[f].normal);
    open_bed_map(&bed, 1);
    for (size_t i = 0; i < sizeof away / sizeof *away; i++) {
        edge = fmax(edge, fabs(mean_along_edges(&bed, away[i], 500) / density - 1));
        corner = fmax(corner, fabs(mean_in_corners(&bed, away[i]) / density - 1));
        leaf = fmax(leaf, fabs(mean_along_edges(&bed, away[i], 0) / density - 1));
    }
    stability_row(30, "white furnace", "error of E along edges, 0 to 30 cm away", edge, 0.02);
    stability_row(30, "white furnace", "error of E in corners, 0 to 30 cm away", corner, 0.02);
    stability_row(30, "white furnace", "error of E along edges, by leaves", leaf, 0.02);
    bed_done(&bed);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(case_22_empty_map),
        cmocka_unit_test(case_23_more_neighbours_than_photons),
        cmocka_unit_test(case_24_coincident_photons),
        cmocka_unit_test(case_28_thin_wall),
        cmocka_unit_test(case_29_table),
        cmocka_unit_test(case_30_corner_of_a_furnace),
    };
    return sodium_init() < 0 ? 1 : cmocka_run_group_tests(tests, NULL, NULL);
}
