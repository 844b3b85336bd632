/*
 * Path steps, and the loop of paths towards the light, against closed forms: a pane under an even
 * sky, an absorbing slab, Russian roulette, and an endless series of mirrors.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#include <cmocka.h>

#include "light/eye_path.h"
#include "scene/material/kinds.h"
#include "support/room.h"

#define SKY "void glow g 0 0 4 3 2 1 0\ng source sky 0 0 4 0 0 1 360\n"
#define PANE(z) "p polygon pane 0 0 12 -9 -9 " z " 9 -9 " z " 9 9 " z " -9 9 " z "\n"

enum { DRAWS = 20000 };

static struct orl_thread_pool *pool;

static int start(void **state)
{
    (void)state;
    pool = orl_thread_pool_start(1);
    return pool ? 0 : -1;
}

static int stop(void **state)
{
    (void)state;
    orl_thread_pool_stop(pool);
    return 0;
}

static struct orl_path upwards(const struct orl_lit_scene *lit_scene, double z)
{
    return orl_path_from(orl_sub(orl_v3(0, 0, z), lit_scene->geometry->center), orl_v3(0, 0, 1));
}

/* ---- Steps ----------------------------------------------------------------------------------- */

static void panes_dim_what_is_seen_through_them(void **state)
{
    struct orl_lit_scene *lit_scene =
        build_lit_scene(SKY "void glass p 0 0 3 .8 .6 .4\n" PANE("1") PANE("2"), NULL, NULL, pool);
    struct orl_path path = upwards(lit_scene, 0);
    struct orl_rgb left = orl_gray(1);
    struct orl_hit hit;
    (void)state;
    for (int pane = 0; pane < 2; pane++) {
        assert_true(orl_path_intersect(lit_scene, &path, &hit));
        const struct orl_material *m = orl_lit_scene_material(lit_scene, &hit);
        assert_true(orl_path_transmit_straight(&path, m, &hit));
        orl_path_skip_surface(&path, lit_scene, &hit);
        left = orl_rgb_mul(left, orl_glass_transmittance(m, &hit, 1));
    }
    assert_false(orl_path_intersect(lit_scene, &path, &hit));
    assert_true(path.weight.r == left.r && path.weight.g == left.g && path.weight.b == left.b);
    orl_lit_scene_free(lit_scene);
}

/* Beer's law applies from the surface where a path enters a solid to the one where it leaves. */
static void solids_absorb_on_the_way(void **state)
{
    struct orl_lit_scene *lit_scene =
        build_lit_scene(SKY "void dielectric d 0 0 5 .5 .6 .7 1 0\n"
                            "d polygon below 0 0 12 -9 -9 0 -9 9 0 9 9 0 9 -9 0\n"
                            "d polygon above 0 0 12 -9 -9 2 9 -9 2 9 9 2 -9 9 2\n",
                        NULL, NULL, pool);
    const double offset = 1e-4;
    struct orl_path path = upwards(lit_scene, -1);
    struct orl_surface_sample through;
    struct orl_hit hit;
    (void)state;
    for (int side = 0; side < 2; side++) {
        assert_true(orl_path_intersect(lit_scene, &path, &hit));
        const struct orl_material *m = orl_lit_scene_material(lit_scene, &hit);
        orl_path_attenuate(&path, m, &hit);
        assert_true(
            orl_material_refract(m, &hit, orl_path_back(&path), ORL_TRANSPORT_EYE, &through));
        orl_path_spawn_ray(&path, lit_scene, &hit, &through);
    }
    assert_true(fabs(path.weight.r - .25) < offset);
    assert_true(fabs(path.weight.g - .36) < offset);
    assert_true(fabs(path.weight.b - .49) < offset);
    /* In air nothing is absorbed, over any distance. */
    const struct orl_rgb before = path.weight;
    orl_path_escape(&path);
    assert_true(path.weight.r == before.r && path.weight.b == before.b);
    orl_lit_scene_free(lit_scene);
}

/* Each survivor has weight 1 / survival: the mean stays, with a variance of (1 - survival) /
 * survival. */
static void roulette_keeps_the_mean(void **state)
{
    static const double chances[] = {.01, .3, .9, 1};
    (void)state;
    for (size_t i = 0; i < sizeof chances / sizeof *chances; i++) {
        struct orl_random random = orl_random_stream(i, ORL_PURPOSE_BENCH, 0);
        const double sigma = sqrt((1 - chances[i]) / chances[i] / DRAWS);
        double sum = 0;
        for (int n = 0; n < DRAWS; n++) {
            struct orl_path path = orl_path_from(orl_v3(0, 0, 0), orl_v3(0, 0, 1));
            if (orl_path_roulette(&path, chances[i], &random))
                sum += path.weight.g;
        }
        assert_true(fabs(sum / DRAWS - 1) <= 4 * sigma);
    }
}

/* A path changes sides through a port, outwards and inwards; reflection, or a surface without a
 * port, keeps the side. */
static void ports_tell_sides(void **state)
{
    struct orl_lit_scene *lit_scene =
        build_lit_scene(ROOM_SKY ROOM_GREY ROOM_SHELL ROOM_CLEAR ROOM_PANE, NULL, NULL, pool);
    struct orl_path path =
        orl_path_from(orl_sub(orl_v3(2, 2, 1.5), lit_scene->geometry->center), orl_v3(0, -1, 0));
    struct orl_hit hit;
    (void)state;
    assert_false(lit_scene->open);
    assert_true(orl_path_intersect(lit_scene, &path, &hit));
    assert_true(orl_lit_scene_outside_after(lit_scene, &hit, true, false));
    assert_false(orl_lit_scene_outside_after(lit_scene, &hit, false, false));
    hit.front = !hit.front;
    assert_false(orl_lit_scene_outside_after(lit_scene, &hit, true, true));
    assert_true(orl_lit_scene_outside_after(lit_scene, &hit, false, true));
    path.direction = orl_v3(0, 1, 0);
    assert_true(orl_path_intersect(lit_scene, &path, &hit));
    assert_true(orl_lit_scene_outside_after(lit_scene, &hit, true, true));
    orl_lit_scene_free(lit_scene);
}

/* ---- Paths towards the light ----------------------------------------------------------------- */

static enum orl_lobes meet_anything(struct orl_eye_path *p, const struct orl_material *material)
{
    (void)p, (void)material;
    return ORL_LOBE_ALL;
}

static enum orl_lobes end_there(struct orl_eye_path *p, const struct orl_material *material)
{
    (void)p, (void)material;
    return ORL_LOBE_NONE;
}

static bool go_on(struct orl_eye_path *p, const struct orl_surface_sample *sample)
{
    (void)p, (void)sample;
    return true;
}

static const struct orl_path_visitor follows = {.met = meet_anything, .on_sampled = go_on};
static const struct orl_path_visitor ends = {.met = end_there, .on_sampled = go_on};

/* Both reflection and transmission lead to the sky, chosen at random by their shares. One pane has
 * no variance, because the weight is the sum of both. */
static void a_pane_shows_the_sky_both_ways(void **state)
{
    struct orl_lit_scene *lit_scene =
        build_lit_scene(SKY "void glass p 0 0 3 .5 .5 .5\n" PANE("1"), NULL, NULL, pool);
    struct orl_random random = orl_random_stream(1, ORL_PURPOSE_BENCH, 0);
    struct orl_health health = {0};
    (void)state;
    for (int n = 0; n < 100; n++) {
        struct orl_eye_path p = {
            .lit_scene = lit_scene, .random = &random, .path = upwards(lit_scene, 0)};
        orl_eye_path_trace(&p, &follows, &health);
        const struct orl_hit hit = p.hit;
        const struct orl_material *m = orl_lit_scene_material(lit_scene, &hit);
        const double all =
            orl_glass_transmittance(m, &hit, 1).g + orl_glass_reflectance(m, &hit, 1).g;
        assert_int_equal(p.bounce, 1);
        assert_true(fabs(p.seen.r - 3 * all) < 1e-12 && fabs(p.seen.b - all) < 1e-12);
    }
    assert_int_equal(health.paths_capped, 0);
    orl_lit_scene_free(lit_scene);
}

static void what_lies_ahead_may_be_known(void **state)
{
    struct orl_lit_scene *lit_scene =
        build_lit_scene(SKY "void glass p 0 0 3 .5 .5 .5\n" PANE("1"), NULL, NULL, pool);
    struct orl_random random = orl_random_stream(1, ORL_PURPOSE_BENCH, 0);
    struct orl_health health = {0};
    struct orl_eye_path p = {
        .lit_scene = lit_scene, .random = &random, .path = upwards(lit_scene, 0)};
    (void)state;
    orl_eye_path_set_next_hit(&p, NULL);
    orl_eye_path_trace(&p, &ends, &health);
    assert_true(p.seen.r == 3 && p.bounce == 0);
    /* With the pane unknown again, the path hits it and ends. */
    p = (struct orl_eye_path){
        .lit_scene = lit_scene, .random = &random, .path = upwards(lit_scene, 0)};
    orl_eye_path_trace(&p, &ends, &health);
    assert_true(p.seen.r == 0 && p.met);
    orl_lit_scene_free(lit_scene);
}

static void endless_paths_are_cut_and_counted(void **state)
{
    struct orl_lit_scene *lit_scene =
        build_lit_scene(SKY "void mirror m 0 0 3 1 1 1\n"
                            "m polygon above 0 0 12 -9 -9 1 -9 9 1 9 9 1 9 -9 1\n"
                            "m polygon below 0 0 12 -9 -9 -1 9 -9 -1 9 9 -1 -9 9 -1\n",
                        NULL, NULL, pool);
    struct orl_random random = orl_random_stream(1, ORL_PURPOSE_BENCH, 0);
    struct orl_health health = {0};
    struct orl_eye_path p = {
        .lit_scene = lit_scene, .random = &random, .path = upwards(lit_scene, 0)};
    (void)state;
    orl_eye_path_trace(&p, &follows, &health);
    assert_int_equal(p.bounce, ORL_EYE_PATH_MOST_HITS);
    assert_int_equal(health.paths_capped, 1);
    assert_true(p.seen.g == 0);
    orl_lit_scene_free(lit_scene);
}

int main(void)
{
    static const struct CMUnitTest tests[] = {
        cmocka_unit_test(panes_dim_what_is_seen_through_them),
        cmocka_unit_test(solids_absorb_on_the_way),
        cmocka_unit_test(roulette_keeps_the_mean),
        cmocka_unit_test(ports_tell_sides),
        cmocka_unit_test(a_pane_shows_the_sky_both_ways),
        cmocka_unit_test(what_lies_ahead_may_be_known),
        cmocka_unit_test(endless_paths_are_cut_and_counted),
    };
    return cmocka_run_group_tests(tests, start, stop);
}
