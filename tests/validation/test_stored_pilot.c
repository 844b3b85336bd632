/*
 * A photon pilot in the store: later runs without a memory cache plan by it, and results stay the
 * same. A damaged file costs another pilot, and is replaced.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>
#include <glob.h>
#include <sys/stat.h>

#include "support/cli.h"
#include "support/room.h"

/* A lens gathers the sun onto the floor: a pilot decides the number of caustic photons. */
#define SCENE                                                                                      \
    ROOM_SKY ROOM_SUN ROOM_GREY ROOM_CLEAR ROOM_SHELL ROOM_PANE                                    \
        "void dielectric d 0 0 5 1 1 1 1.5 0\nd sphere lens 0 0 4 2 1.6 .06 .05\n"

static struct orl_result run_job(const char *folder, uint32_t threads)
{
    return scene_run(&(struct scene_run){.scene = SCENE,
                                         .sensors = room_sensors,
                                         .n_sensors = ROOM_SENSORS,
                                         .samples = 64,
                                         .global = 20000,
                                         .caustic = ORL_PHOTONS_BY_PLAN,
                                         .folder = folder,
                                         .threads = threads});
}

static char *find_pilot(const char *folder)
{
    char pattern[128];
    glob_t found;
    snprintf(pattern, sizeof pattern, "%s/pilot-*.opm", folder);
    assert_int_equal(glob(pattern, 0, NULL, &found), 0);
    assert_int_equal(found.gl_pathc, 1);
    char *path = strdup(found.gl_pathv[0]);
    globfree(&found);
    return path;
}

static void assert_same(const struct orl_result *a, const struct orl_result *b)
{
    assert_int_equal(a->plan.photons_caustic, b->plan.photons_caustic);
    assert_memory_equal(a->plan.forecast.emitted, b->plan.forecast.emitted,
                        sizeof a->plan.forecast.emitted);
    assert_memory_equal(a->illuminance_lx, b->illuminance_lx,
                        ROOM_SENSORS * sizeof *a->illuminance_lx);
}

static void test_a_later_run_plans_by_the_stored_pilot(void **state)
{
    char folder[64];
    (void)state;
    cli_make_folder(folder);
    struct orl_result first = run_job(folder, 1);
    struct stat before, after;
    char *path = find_pilot(folder);
    assert_int_equal(stat(path, &before), 0);
    struct orl_result again = run_job(folder, 2);
    assert_int_equal(stat(path, &after), 0);
    assert_true(after.st_ino == before.st_ino && after.st_mtim.tv_nsec == before.st_mtim.tv_nsec);
    assert_same(&first, &again);
    free(path);
    orl_result_done(&first);
    orl_result_done(&again);
    cli_remove_folder(folder);
}

static void test_a_damaged_pilot_is_run_again(void **state)
{
    char folder[64];
    size_t size, size_after;
    (void)state;
    cli_make_folder(folder);
    struct orl_result first = run_job(folder, 1);
    char *path = find_pilot(folder);
    unsigned char *bytes = scene_read_bytes(path, &size);
    bytes[size - 1] ^= 1;
    FILE *file = fopen(path, "wb");
    assert_non_null(file);
    assert_int_equal(fwrite(bytes, 1, size, file), size);
    assert_int_equal(fclose(file), 0);
    free(bytes);
    /* The first run drops the file, and the second one writes it again. */
    for (int i = 0; i < 2; i++) {
        struct orl_result again = run_job(folder, 1);
        assert_same(&first, &again);
        orl_result_done(&again);
    }
    bytes = scene_read_bytes(path, &size_after);
    assert_int_equal(size_after, size);
    free(bytes);
    free(path);
    orl_result_done(&first);
    cli_remove_folder(folder);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_a_later_run_plans_by_the_stored_pilot),
                                       cmocka_unit_test(test_a_damaged_pilot_is_run_again)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
