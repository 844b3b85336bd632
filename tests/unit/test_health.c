/*
 * Numerical health: non-finite numbers stop at photon, gather and pixel and are counted; leaks are
 * detected; each run has its own counts and reports them in words.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "photon/tracing/trace.h"
#include "render/film/film.h"
#include "render/technique/photon_maps.h"
#include "support/cli.h"
#include "support/room.h"

static void test_add(void **state)
{
    struct orl_health sum = {0}, parts[2] = {{0}, {0}};
    (void)state;
    parts[0] = (struct orl_health){1,  2,  3,  4,  5,  6,   7,    8,         9,        10,
                                   11, 12, 13, 14, 15, 0.5, 0.25, {0, 0, 0}, {0, 0, 0}};
    parts[1].rays_leaked = 2;
    parts[1].leak_from = orl_v3(1, 2, 3);
    parts[1].leak_towards = orl_v3(0, 0, 1);
    for (int i = 0; i < 2; i++)
        orl_health_add(&sum, &parts[i]);
    assert_true(sum.leak_from.y == 2 && sum.leak_towards.z == 1);
    parts[1].leak_from = orl_v3(9, 9, 9);
    orl_health_add(&sum, &parts[1]);
    assert_int_equal(sum.rays_leaked, 7 + 2 + 2);
    assert_true(sum.leak_from.y == 2);
    parts[1] = sum;
    sum.rays_leaked = 7;
    sum.leak_from = sum.leak_towards = orl_v3(0, 0, 0);
    assert_memory_equal(&sum, &parts[0], sizeof sum);
}

static void test_film(void **state)
{
    struct orl_film film;
    struct orl_health health = {0};
    (void)state;
    assert_int_equal(orl_film_init(&film, 2, 2, NULL), 0);
    orl_film_set(&film, 0, 1, &(struct orl_pixel){{1, 2, 3}, 0}, &health);
    assert_int_equal(health.non_finite, 0);
    orl_film_set(&film, 0, 0, &(struct orl_pixel){{1, NAN, 3}, 0}, &health);
    orl_film_set(&film, 1, 0, &(struct orl_pixel){{1, 2, INFINITY}, 0}, &health);
    /* The value exceeds a float's range. */
    orl_film_set(&film, 1, 1, &(struct orl_pixel){{1e39, 2, 3}, 0}, &health);
    assert_int_equal(health.non_finite, 3);
    assert_true(film.pixels[2][1] == 2);
    for (int i = 0; i < 4; i++)
        for (int k = 0; k < 3; k++)
            assert_true(isfinite(film.pixels[i][k]) && (i == 2 || film.pixels[i][k] == 0));
    orl_film_done(&film);
}

/* ---- Photons -----------------------------------------------------------------------------------
 */

static struct orl_lit_scene *make_lit_scene(const char *text)
{
    struct orl_thread_pool *pool = orl_thread_pool_start(1);
    struct orl_lit_scene *lit_scene = build_lit_scene(text, NULL, NULL, pool);
    orl_thread_pool_stop(pool);
    return lit_scene;
}

/* Traces one photon straight down onto the floor from the middle of the room. */
static void trace_down(const struct orl_lit_scene *lit_scene, struct orl_rgb flux,
                       struct orl_deposits *deposits)
{
    struct orl_random random = orl_random_stream(1, ORL_PURPOSE_BENCH, 0);
    const struct orl_photon_ray photon_ray = {.origin = {0, 0, -0.3},
                                              .direction = {0, 0, -1},
                                              .flux = flux,
                                              .medium_transmissivity = {1, 1, 1},
                                              .from_port = true};
    orl_trace_photon(lit_scene, &photon_ray, false, 0, &random, deposits);
}

static void expect_finite(const struct orl_deposits *deposits)
{
    for (size_t i = 0; i < deposits->count; i++)
        for (int k = 0; k < 3; k++)
            assert_true(isfinite(deposits->photons[i].flux[k]) &&
                        isfinite(deposits->photons[i].position[k]));
}

static void test_photons(void **state)
{
    static const struct orl_rgb broken[3] = {{NAN, 1, 1}, {1, INFINITY, 1}, {1, 1, 1e300}};
    struct orl_lit_scene *lit_scene = make_lit_scene(ROOM_GREY "!genbox w room 4 5 3 -i\n");
    (void)state;
    for (int i = 0; i < 3; i++) {
        struct orl_deposits deposits = {0};
        trace_down(lit_scene, broken[i], &deposits);
        assert_true(deposits.health.non_finite > 0);
        assert_int_equal(deposits.health.photons, 1);
        expect_finite(&deposits);
        free(deposits.photons);
    }
    /* A finite photon on a material with non-finite values lands, and its path ends. */
    for (size_t i = 0; i < lit_scene->n_materials; i++)
        lit_scene->materials[i].color.g = INFINITY;
    struct orl_deposits deposits = {0};
    trace_down(lit_scene, orl_gray(1), &deposits);
    assert_int_equal(deposits.health.non_finite, 1);
    assert_int_equal(deposits.health.rays, 1);
    expect_finite(&deposits);
    free(deposits.photons);
    orl_lit_scene_free(lit_scene);
}

/* A photon in a room without a ceiling that is assumed sealed: it counts as a leak, with its last
 * place. */
static void test_leak(void **state)
{
    struct orl_lit_scene *lit_scene =
        make_lit_scene(ROOM_GREY "w polygon floor 0 0 12 0 0 0 4 0 0 4 5 0 0 5 0\n"
                                 "w polygon high 0 0 9 0 0 3 .1 0 3 0 .1 3\n");
    struct orl_deposits deposits = {0};
    (void)state;
    lit_scene->open = false;
    trace_down(lit_scene, orl_gray(1), &deposits);
    const struct orl_health health = orl_deposits_health(&deposits);
    assert_int_equal(deposits.count, 1);
    assert_int_equal(health.rays_leaked, 1);
    assert_int_equal(health.rays, 2);
    assert_true(health.flux_w == 1 && health.flux_capped_w == 0);
    assert_true(fabs(health.leak_from.z - deposits.photons[0].position[2]) < 1e-4);
    assert_true(health.leak_towards.z > 0);
    free(deposits.photons);
    orl_lit_scene_free(lit_scene);
}

/* ---- Gathering ---------------------------------------------------------------------------------
 */

/* One wall of the room has a broken material: its radiance counts as black. */
static void test_gather(void **state)
{
    struct orl_lit_scene *lit_scene =
        make_lit_scene(ROOM_SKY ROOM_GREY "void plastic x 0 0 5 .3 .3 .3 0 0\n"
                                          "w polygon floor 0 0 12 0 0 0 4 0 0 4 5 0 0 5 0\n"
                                          "x polygon west 0 0 12 0 0 0 0 5 0 0 5 3 0 0 3\n");
    const struct orl_photon_map *const maps[ORL_MAP_KINDS] = {NULL};
    struct orl_search *search = calloc(1, sizeof *search);
    struct orl_gather gather;
    struct orl_surface_point surface_point;
    (void)state;
    assert_non_null(search);
    assert_int_equal(
        orl_gather_init(&gather, lit_scene, &orl_indirect_gathered, maps, NULL, 1, NULL, search),
        0);
    gather.near = INFINITY; /* forces new lighting of all hits, so that albedo is used */
    struct orl_shading_point place =
        orl_gather_sensor_point(&gather, orl_sub(orl_v3(2, 2, 0.5), lit_scene->geometry->center),
                                orl_v3(0, 0, 1), &surface_point);
    const double whole =
        orl_luma(orl_gather_sensor(&gather, &place, &surface_point, 1024, 0, search).value);
    assert_int_equal(search->health.non_finite, 0);
    for (size_t i = 0; i < lit_scene->n_materials; i++)
        if (strcmp(lit_scene->materials[i].name, "x") == 0)
            lit_scene->materials[i].color.b = NAN;
    const double broken =
        orl_luma(orl_gather_sensor(&gather, &place, &surface_point, 1024, 0, search).value);
    assert_true(search->health.non_finite > 20);
    assert_true(isfinite(broken) && broken > 0.5 * whole && broken <= whole);
    orl_gather_done(&gather);
    orl_lit_scene_free(lit_scene);
    free(search);
}

/* ---- A whole run ----------------------------------------------------------------------------- */

static bool warned(const struct orl_result *result, const char *words)
{
    for (size_t i = 0; i < result->n_warnings; i++)
        if (strstr(result->warnings[i], words))
            return true;
    return false;
}

static void test_counts_of_a_run(void **state)
{
    char xml[2048], whole[4352], folder[64] = "", *value;
    struct scene_run run = {.scene = ROOM_SKY ROOM_SUN ROOM_GREY ROOM_BSDF ROOM_SHELL ROOM_PANE
                            "w polygon nothing 0 0 9 1 1 1 1 1 1 2 2 2\n",
                            .resource_name = "pane.xml",
                            .resource_text = whole,
                            .sensors = room_sensors,
                            .n_sensors = ROOM_SENSORS,
                            .samples = 64,
                            .global = 5000};
    (void)state;
    scene_uniform_bsdf(0.2, xml);
    value = strstr(xml, "{ 0.2 }");
    assert_non_null(value);
    *value = '\0';
    snprintf(whole, sizeof whole, "%s{ .2 .1 .2 .1 .2 .1 .2 .1 .2 .1 .2 .1 .2 .1 .2 -.1 }%s", xml,
             value + 7);
    cli_make_folder(folder);
    run.folder = folder;
    struct orl_result result = scene_run(&run);
    const struct orl_health *h = &result.health;
    assert_int_equal(h->degenerate, 1);
    assert_int_equal(h->surfaces, 9);
    assert_int_equal(h->bsdf_clamped, 1);
    assert_int_equal(h->bsdf_values, 16);
    assert_int_equal(h->bsdf_rescaled, 0);
    assert_true(warned(&result, "negative"));
    assert_true(h->photons >= 1000 && h->rays > h->photons && h->paths >= 5 * 64);
    assert_true(h->estimates > 0 && h->flux_w > 0);
    assert_int_equal(h->non_finite + h->photons_capped + h->rays_leaked, 0);
    const uint64_t photons = h->photons, paths = h->paths;
    orl_result_done(&result);
    /* If the map is found in the cache, no photon is traced. */
    result = scene_run(&run);
    assert_int_equal(result.health.photons, 0);
    assert_true(result.health.paths > 0 && result.health.paths < paths);
    assert_true(photons > 0);
    orl_result_done(&result);
    cli_remove_folder(folder);
}

/*
 * A slit of 0.1 mm along the floor, 5e-6 of the room's surface, is too small for the room to count
 * as open. The result reports the leaked light and its place.
 */
static void test_leaky_room(void **state)
{
    (void)state;
    struct orl_result result = scene_run(&(struct scene_run){
        .scene = ROOM_SKY ROOM_SUN ROOM_GREY ROOM_CLEAR ROOM_PANE
        "w polygon floor1 0 0 12 0 0 0 4 0 0 4 2.5 0 0 2.5 0\n"
        "w polygon floor2 0 0 12 0 2.5001 0 4 2.5001 0 4 5 0 0 5 0\n"
        "w polygon ceiling 0 0 12 0 0 3 0 5 3 4 5 3 4 0 3\n"
        "w polygon west 0 0 12 0 0 0 0 5 0 0 5 3 0 0 3\n"
        "w polygon east 0 0 12 4 0 0 4 0 3 4 5 3 4 5 0\n"
        "w polygon north 0 0 12 0 5 0 4 5 0 4 5 3 0 5 3\n"
        "w polygon south 0 0 30 0 0 0 0 0 3 4 0 3 4 0 0 0 0 0 1 0 1 3 0 1 3 0 2.5 1 0 2.5 1 0 1\n",
        .sensors = room_sensors,
        .n_sensors = ROOM_SENSORS,
        .samples = 256,
        .global = 1000000});
    assert_true(result.health.rays_leaked > 0);
    assert_true(warned(&result, "the building is not closed; one left from"));
    assert_true(warned(&result, "the results are good: about"));
    assert_true(result.health.leak_from.x >= 0 && result.health.leak_from.x <= 4);
    orl_result_done(&result);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_add),        cmocka_unit_test(test_film),
        cmocka_unit_test(test_photons),    cmocka_unit_test(test_leak),
        cmocka_unit_test(test_gather),     cmocka_unit_test(test_counts_of_a_run),
        cmocka_unit_test(test_leaky_room),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
