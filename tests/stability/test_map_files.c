/*
 * Hard case of photon map files: a file that is cut short or changed anywhere is refused, and a
 * job that finds such a file in its cache rebuilds the map.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "base/sampling/sampling.h"
#include "photon/map/map.h"
#include "support/cli.h"
#include "support/room.h"
#include "support/stability.h"

static void write_bytes(const char *path, const unsigned char *bytes, size_t size)
{
    FILE *file = fopen(path, "wb");
    assert_non_null(file);
    assert_int_equal(fwrite(bytes, 1, size, file), size);
    assert_int_equal(fclose(file), 0);
}

/* Returns true if these bytes are accepted as a map, with the whole file verified as for a cached
 * map. */
static bool accepted(const char *path, const unsigned char *bytes, size_t size)
{
    struct orl_photon_map *map = NULL;
    write_bytes(path, bytes, size);
    const int code = orl_photon_map_open(path, true, &map, NULL);
    if (code == 0)
        orl_photon_map_free(map);
    else
        assert_true(code == ORL_ERR_CORRUPT || code == ORL_ERR_VERSION);
    return code == 0;
}

static struct scene_run run_in(const char *folder)
{
    return (struct scene_run){.scene = ROOM_SKY ROOM_SUN ROOM_GREY ROOM_CLEAR ROOM_SHELL ROOM_PANE,
                              .sensors = room_sensors,
                              .n_sensors = ROOM_SENSORS,
                              .samples = 64,
                              .global = 10000,
                              .folder = folder};
}

static void test_damaged(void **state)
{
    const uint64_t flips = stability_full() ? 20000 : 400;
    struct orl_random random = orl_random_stream(45, ORL_PURPOSE_BENCH, 0);
    char folder[64], map_path[512], path[512];
    size_t size;
    double cut = 0, flipped = 0;
    (void)state;
    cli_make_folder(folder);
    const struct scene_run run = run_in(folder);
    struct orl_result result = scene_run(&run);
    scene_map_path(&result, folder, "global", map_path);
    orl_result_done(&result);
    unsigned char *bytes = scene_read_bytes(map_path, &size);
    snprintf(path, sizeof path, "%s/damaged", folder);
    assert_true(accepted(path, bytes, size));
    for (size_t i = 0; i < 50; i++)
        cut += accepted(path, bytes, size * i / 50);
    cut += accepted(path, bytes, size - 1);
    /* Some of the flips go to the header, because it is small. */
    for (uint64_t i = 0; i < flips; i++) {
        const size_t room = i % 4 ? size : sizeof(struct orl_map_header);
        const size_t at = (size_t)(orl_random_uniform(&random) * (double)room);
        const unsigned char bit = (unsigned char)(1U << (orl_random_bits(&random) & 7U));
        bytes[at] ^= bit;
        flipped += accepted(path, bytes, size);
        bytes[at] ^= bit;
    }
    stability_row(45, "truncated or corrupt photon map",
                  "files cut at every 1/50 that are accepted", cut, 0);
    stability_row(45, "truncated or corrupt photon map",
                  "files with a flipped bit that are accepted", flipped, 0);
    free(bytes);
    cli_remove_folder(folder);
}

static void test_rebuilt(void **state)
{
    char folder[64], path[512];
    double first[ROOM_SENSORS], second[ROOM_SENSORS];
    size_t size;
    bool told = false;
    (void)state;
    cli_make_folder(folder);
    const struct scene_run run = run_in(folder);
    struct orl_result result = scene_run(&run);
    memcpy(first, result.illuminance_lx, sizeof first);
    scene_map_path(&result, folder, "global", path);
    orl_result_done(&result);
    unsigned char *bytes = scene_read_bytes(path, &size);
    bytes[size / 2] ^= 1;
    write_bytes(path, bytes, size);
    free(bytes);
    result = scene_run(&run);
    memcpy(second, result.illuminance_lx, sizeof second);
    for (size_t i = 0; i < result.n_warnings; i++)
        told = told || strstr(result.warnings[i], "damaged");
    stability_holds(45, "truncated or corrupt photon map",
                    "a cached one is built again, and said so",
                    told && !result.maps[0].cached && memcmp(first, second, sizeof first) == 0);
    orl_result_done(&result);
    cli_remove_folder(folder);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_damaged),
        cmocka_unit_test(test_rebuilt),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
