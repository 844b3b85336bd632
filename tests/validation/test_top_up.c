/*
 * More photons for an existing map: only the missing ones are traced, and the map equals, bit for
 * bit, one made at once.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

#include "support/cli.h"
#include "support/room.h"

/* A mirror under the window reflects the sun to the ceiling. */
#define MIRROR                                                                                     \
    "void mirror m 0 0 3 .8 .8 .8\n"                                                               \
    "m polygon strip 0 0 12 1 .3 .05 3 .3 .05 3 2 .05 1 2 .05\n"
#define CLOSED ROOM_SKY ROOM_SUN ROOM_GREY ROOM_CLEAR ROOM_SHELL MIRROR ROOM_PANE
#define OPEN ROOM_SKY ROOM_SUN ROOM_GREY ROOM_SHELL MIRROR

struct step {
    uint64_t global, caustic;
    uint32_t threads;
};

enum { MOST_STEPS = 3 };

static struct orl_result run_step(const char *scene, const char *folder, struct step step)
{
    const struct scene_run run = {.scene = scene,
                                  .sensors = room_sensors,
                                  .n_sensors = ROOM_SENSORS,
                                  .overrides = scene_wish_maps,
                                  .global = step.global,
                                  .caustic = step.caustic,
                                  .threads = step.threads,
                                  .samples = 64,
                                  .folder = folder};
    return scene_run(&run);
}

static const struct orl_map_info *find_map(const struct orl_result *result, const char *kind)
{
    for (size_t i = 0; i < result->n_maps; i++)
        if (strcmp(result->maps[i].kind, kind) == 0)
            return &result->maps[i];
    fail_msg("no %s map", kind);
    return NULL;
}

static void assert_same_map(const struct orl_result *a, const char *folder_a,
                            const struct orl_result *b, const char *folder_b, const char *kind)
{
    char path[2][512];
    unsigned char *bytes[2];
    size_t size[2];
    scene_map_path(a, folder_a, kind, path[0]);
    scene_map_path(b, folder_b, kind, path[1]);
    for (int i = 0; i < 2; i++)
        bytes[i] = scene_read_bytes(path[i], &size[i]);
    assert_int_equal(size[0], size[1]);
    assert_memory_equal(bytes[0], bytes[1], size[0]);
    for (int i = 0; i < 2; i++)
        free(bytes[i]);
    assert_string_equal(find_map(a, kind)->key, find_map(b, kind)->key);
    assert_int_equal(find_map(a, kind)->emitted, find_map(b, kind)->emitted);
    assert_int_equal(find_map(a, kind)->stored, find_map(b, kind)->stored);
}

/* Runs the steps in one folder, and the last alone in another, and compares them. */
static void check_steps(const char *scene, const struct step *steps, size_t count)
{
    char folder[64], other[64];
    struct orl_result last = {0};
    cli_make_folder(folder);
    cli_make_folder(other);
    for (size_t i = 0; i < count; i++) {
        orl_result_done(&last);
        last = run_step(scene, folder, steps[i]);
        for (size_t k = 0; k < last.n_maps && i > 0; k++) {
            const bool is_caustic = strcmp(last.maps[k].kind, "caustic") == 0;
            const uint64_t before = is_caustic ? steps[i - 1].caustic : steps[i - 1].global;
            const uint64_t now = is_caustic ? steps[i].caustic : steps[i].global;
            /* With an equal count the map is found; with a smaller one or none it is built from
             * nothing. */
            assert_int_equal(last.maps[k].cached, before == now);
            assert_int_equal(last.maps[k].reused > 0, before > 0 && before < now);
            assert_true(last.maps[k].reused == 0 || last.maps[k].reused >= before);
        }
    }
    const struct step whole = {steps[count - 1].global, steps[count - 1].caustic, 2};
    struct orl_result at_once = run_step(scene, other, whole);
    assert_int_equal(last.n_maps, at_once.n_maps);
    for (size_t k = 0; k < at_once.n_maps; k++) {
        assert_same_map(&last, folder, &at_once, other, at_once.maps[k].kind);
        assert_true(at_once.maps[k].reused == 0);
    }
    for (size_t i = 0; i < ROOM_SENSORS; i++)
        assert_true(last.illuminance_lx[i] == at_once.illuminance_lx[i]);
    orl_result_done(&last);
    orl_result_done(&at_once);
    cli_remove_folder(folder);
    cli_remove_folder(other);
}

static void test_closed(void **state)
{
    static const struct step thrice[] = {{10000, 5000, 3}, {20000, 10000, 1}, {40000, 20000, 2}};
    static const struct step one_kind[] = {{10000, 10000, 1}, {10000, 20000, 3}};
    static const struct step other_kind[] = {{10000, 20000, 1}, {30000, 20000, 1}};
    static const struct step new_kind[] = {{10000, 0, 1}, {20000, 10000, 2}};
    static const struct step down[] = {{20000, 20000, 1}, {10000, 10000, 1}};
    (void)state;
    check_steps(CLOSED, thrice, 3);
    check_steps(CLOSED, one_kind, 2);
    check_steps(CLOSED, other_kind, 2);
    check_steps(CLOSED, new_kind, 2);
    check_steps(CLOSED, down, 2);
}

static void test_open(void **state)
{
    static const struct step both[] = {{10000, 2000, 1}, {40000, 10000, 3}};
    (void)state;
    check_steps(OPEN, both, 2);
}

/* Few photons, and many; or counts that differ by one batch at most. */
static void test_extremes(void **state)
{
    static const struct step few[] = {{1, 1, 1}, {3, 3, 1}, {30000, 300, 2}};
    static const struct step near[] = {{30000, 30000, 1}, {30001, 30001, 2}};
    (void)state;
    check_steps(CLOSED, few, 3);
    char folder[64];
    cli_make_folder(folder);
    struct orl_result first = run_step(CLOSED, folder, near[0]);
    struct orl_result second = run_step(CLOSED, folder, near[1]);
    /* The count is within the same batch: nothing is traced. */
    assert_true(first.maps[0].stored > near[1].global);
    assert_int_equal(second.maps[0].stored, first.maps[0].stored);
    assert_int_equal(second.maps[0].reused, first.maps[0].stored);
    assert_int_equal(second.health.photons, 0);
    orl_result_done(&first);
    orl_result_done(&second);
    cli_remove_folder(folder);
    check_steps(CLOSED, near, 2);
}

/* Only the missing photons are traced: photons started by the second job, compared with both at
 * once. */
static void test_only_the_rest_is_traced(void **state)
{
    char folder[64], other[64];
    (void)state;
    cli_make_folder(folder);
    cli_make_folder(other);
    struct orl_result first = run_step(CLOSED, folder, (struct step){10000, 10000, 1});
    struct orl_result second = run_step(CLOSED, folder, (struct step){40000, 40000, 1});
    struct orl_result whole = run_step(CLOSED, other, (struct step){40000, 40000, 1});
    assert_true(second.health.photons > 0);
    assert_int_equal(first.health.photons + second.health.photons, whole.health.photons);
    assert_int_equal(first.health.photons_capped + second.health.photons_capped,
                     whole.health.photons_capped);
    orl_result_done(&first);
    orl_result_done(&second);
    orl_result_done(&whole);
    cli_remove_folder(folder);
    cli_remove_folder(other);
}

/* Without caustics there is no map to extend, with or without an empty one. */
static void test_nothing_to_go_on_from(void **state)
{
    static const struct step empty[] = {{5000, 5000, 1}, {5000, 9000, 1}};
    char folder[64], other[64];
    (void)state;
    cli_make_folder(folder);
    cli_make_folder(other);
    static const char plain[] = ROOM_SKY ROOM_GREY ROOM_CLEAR ROOM_SHELL ROOM_PANE;
    struct orl_result first = run_step(plain, folder, empty[0]);
    struct orl_result second = run_step(plain, folder, empty[1]);
    struct orl_result whole = run_step(plain, other, empty[1]);
    for (size_t k = 0; k < second.n_maps; k++) {
        assert_same_map(&second, folder, &whole, other, second.maps[k].kind);
        assert_int_equal(second.maps[k].reused, 0);
    }
    orl_result_done(&first);
    orl_result_done(&second);
    orl_result_done(&whole);
    cli_remove_folder(folder);
    cli_remove_folder(other);
}

/* Precomputed irradiance is rebuilt from the extended global map. */
static void test_precomputed(void **state)
{
    char folder[64], other[64];
    struct scene_run run = {.scene = CLOSED,
                            .sensors = room_sensors,
                            .n_sensors = ROOM_SENSORS,
                            .overrides = scene_wish_maps,
                            .technique = ORL_TECHNIQUE_PRECOMPUTED,
                            .global = 10000,
                            .caustic = 10000};
    (void)state;
    cli_make_folder(folder);
    cli_make_folder(other);
    run.folder = folder;
    struct orl_result first = scene_run(&run);
    run.global = 40000;
    struct orl_result second = scene_run(&run);
    run.folder = other;
    struct orl_result whole = scene_run(&run);
    assert_true(find_map(&second, "global")->reused >= 10000);
    assert_int_equal(find_map(&second, "precomputed")->reused, 0);
    assert_same_map(&second, folder, &whole, other, "global");
    assert_same_map(&second, folder, &whole, other, "precomputed");
    orl_result_done(&first);
    orl_result_done(&second);
    orl_result_done(&whole);
    cli_remove_folder(folder);
    cli_remove_folder(other);
}

static void damage(const struct orl_result *result, const char *folder, const char *kind)
{
    char path[512];
    scene_map_path(result, folder, kind, path);
    FILE *file = fopen(path, "r+b");
    assert_non_null(file);
    assert_int_equal(fseek(file, 5000, SEEK_SET), 0);
    const int byte = fgetc(file);
    assert_int_equal(fseek(file, 5000, SEEK_SET), 0);
    assert_int_equal(fputc(byte ^ 4, file), byte ^ 4);
    assert_int_equal(fclose(file), 0);
}

static bool warned(const struct orl_result *result, const char *words)
{
    for (size_t i = 0; i < result->n_warnings; i++)
        if (strstr(result->warnings[i], words))
            return true;
    return false;
}

/* A smaller map that is damaged is skipped, for the next smaller or for none, with a warning. */
static void test_damaged(void **state)
{
    char folder[64], other[64];
    (void)state;
    cli_make_folder(folder);
    cli_make_folder(other);
    struct orl_result least = run_step(CLOSED, folder, (struct step){5000, 0, 1});
    struct orl_result first = run_step(CLOSED, folder, (struct step){10000, 10000, 1});
    damage(&first, folder, "global");
    damage(&first, folder, "caustic");
    struct orl_result second = run_step(CLOSED, folder, (struct step){40000, 40000, 1});
    struct orl_result whole = run_step(CLOSED, other, (struct step){40000, 40000, 1});
    assert_true(warned(&second, "a smaller global photon map is damaged"));
    assert_true(warned(&second, "a smaller caustic photon map is damaged"));
    assert_false(warned(&whole, "damaged"));
    assert_int_equal(find_map(&second, "global")->reused, find_map(&least, "global")->stored);
    assert_int_equal(find_map(&second, "caustic")->reused, 0);
    assert_same_map(&second, folder, &whole, other, "global");
    assert_same_map(&second, folder, &whole, other, "caustic");
    orl_result_done(&least);
    orl_result_done(&first);
    orl_result_done(&second);
    orl_result_done(&whole);
    cli_remove_folder(folder);
    cli_remove_folder(other);
}

/* Another seed does not extend the map. */
static void test_families(void **state)
{
    char folder[64];
    struct scene_run run = {.scene = CLOSED,
                            .sensors = room_sensors,
                            .n_sensors = 1,
                            .overrides = scene_wish_maps,
                            .global = 5000,
                            .samples = 64};
    (void)state;
    cli_make_folder(folder);
    run.folder = folder;
    struct orl_result first = scene_run(&run);
    run.seed = 2;
    run.global = 9000;
    struct orl_result second = scene_run(&run);
    run.scene = OPEN;
    run.seed = 1;
    struct orl_result third = scene_run(&run);
    assert_int_equal(second.maps[0].reused, 0);
    assert_int_equal(third.maps[0].reused, 0);
    assert_string_not_equal(first.maps[0].family, second.maps[0].family);
    assert_string_not_equal(first.maps[0].family, third.maps[0].family);
    orl_result_done(&first);
    orl_result_done(&second);
    orl_result_done(&third);
    cli_remove_folder(folder);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_closed),
        cmocka_unit_test(test_open),
        cmocka_unit_test(test_extremes),
        cmocka_unit_test(test_only_the_rest_is_traced),
        cmocka_unit_test(test_nothing_to_go_on_from),
        cmocka_unit_test(test_precomputed),
        cmocka_unit_test(test_damaged),
        cmocka_unit_test(test_families),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
