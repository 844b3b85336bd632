/*
 * Jobs that reuse results of earlier jobs in the memory cache: by every photon map technique their
 * results equal, bit for bit, those of jobs with an empty cache.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "support/cli.h"
#include "support/room.h"
#include "support/techniques.h"

#define SCENE ROOM_SKY ROOM_SUN ROOM_GREY ROOM_CLEAR ROOM_SHELL ROOM_PANE
#define PANEL_SCENE ROOM_SKY ROOM_SUN ROOM_GREY ROOM_BSDF ROOM_SHELL ROOM_PANE
#define SHELF_BYTES (64UL << 20)

static const char near_wall[] = "-vtv -vp 1 1 1.2 -vd 1 0.6 -0.2 -vh 70 -vv 60";
static const char near_pane[] = "-vtv -vp 3 2 1.5 -vd -1 -0.7 -0.3 -vh 70 -vv 60";

/* A job's two kinds of results: sensors, and the picture's file. */
struct outcome {
    double lx[ROOM_SENSORS], error[ROOM_SENSORS];
    unsigned char *picture;
    size_t size;
};

/* Runs a job in the room with the glass pane, or with the panel if its text is given. */
static struct outcome run_job(enum orl_technique technique, const char *panel, const char *view,
                              uint32_t threads, const char *folder,
                              struct orl_memory_cache *memory_cache)
{
    const struct scene_run job = {.scene = panel ? PANEL_SCENE : SCENE,
                                  .resource_name = panel ? "pane.xml" : NULL,
                                  .resource_text = panel,
                                  .sensors = room_sensors,
                                  .n_sensors = ROOM_SENSORS,
                                  .view = view,
                                  .width = 24,
                                  .height = 20,
                                  .technique = technique,
                                  .overrides = scene_wish_maps,
                                  .global = 40000,
                                  .caustic = 10000,
                                  .samples = 64,
                                  .threads = threads,
                                  .folder = folder,
                                  .memory_cache = memory_cache};
    struct orl_result result = scene_run(&job);
    struct outcome outcome;
    char path[128];
    memcpy(outcome.lx, result.illuminance_lx, sizeof outcome.lx);
    memcpy(outcome.error, result.standard_error_lx, sizeof outcome.error);
    orl_result_done(&result);
    snprintf(path, sizeof path, "%s/view.hdr", folder);
    outcome.picture = scene_read_bytes(path, &outcome.size);
    return outcome;
}

static void assert_same(struct outcome *a, struct outcome *b)
{
    assert_memory_equal(a->lx, b->lx, sizeof a->lx);
    assert_memory_equal(a->error, b->error, sizeof a->error);
    assert_int_equal(a->size, b->size);
    assert_memory_equal(a->picture, b->picture, a->size);
    free(a->picture);
    free(b->picture);
}

static void compare_with_memory_cache(void **state)
{
    const enum orl_technique technique = of_technique(state);
    struct orl_memory_cache *memory_cache = orl_memory_cache_new(SHELF_BYTES);
    char folder[64], other[64];
    assert_non_null(memory_cache);
    cli_make_folder(folder);
    cli_make_folder(other);
    struct outcome first = run_job(technique, NULL, near_wall, 2, folder, memory_cache);
    struct outcome alone = run_job(technique, NULL, near_wall, 1, other, NULL);
    assert_same(&first, &alone);
    assert_true(orl_memory_cache_totals(memory_cache).bytes > 0);
    /* Another view, then the first one, both from the cache. */
    for (int i = 0; i < 2; i++) {
        const char *view = i == 0 ? near_pane : near_wall;
        struct outcome again =
            run_job(technique, NULL, view, 1 + (uint32_t)i, folder, memory_cache);
        alone = run_job(technique, NULL, view, 1, other, NULL);
        assert_same(&again, &alone);
    }
    orl_memory_cache_free(memory_cache);
    cli_remove_folder(folder);
    cli_remove_folder(other);
}

/* The second job finds no maps, and shoots photons from the first one's emission. */
static void compare_photons(const char *panel)
{
    struct orl_memory_cache *memory_cache = orl_memory_cache_new(SHELF_BYTES);
    struct outcome outcomes[2];
    assert_non_null(memory_cache);
    for (uint32_t i = 0; i < 2; i++) {
        char folder[64];
        const uint64_t hits = orl_memory_cache_totals(memory_cache).hits;
        cli_make_folder(folder);
        outcomes[i] = run_job(ORL_TECHNIQUE_GATHER, panel, near_wall, 1 + i, folder, memory_cache);
        cli_remove_folder(folder);
        /* Hits: the emission, and the data that are derived from the maps. */
        assert_int_equal(orl_memory_cache_totals(memory_cache).hits - hits, i == 0 ? 0 : 2);
    }
    assert_same(&outcomes[0], &outcomes[1]);
    orl_memory_cache_free(memory_cache);
}

static void test_photons_from_the_cached_emission_of_a_pane_are_the_same(void **state)
{
    (void)state;
    compare_photons(NULL);
}

static void test_photons_from_the_cached_emission_of_a_panel_are_the_same(void **state)
{
    (void)state;
    size_t size;
    unsigned char *panel = scene_read_bytes("tests/fixtures/bsdf_lcp8.xml", &size);
    compare_photons((const char *)panel);
    free(panel);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        OF_TECHNIQUE(compare_with_memory_cache, GATHER),
        OF_TECHNIQUE(compare_with_memory_cache, DIRECT),
        OF_TECHNIQUE(compare_with_memory_cache, PRECOMPUTED),
        cmocka_unit_test(test_photons_from_the_cached_emission_of_a_pane_are_the_same),
        cmocka_unit_test(test_photons_from_the_cached_emission_of_a_panel_are_the_same),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
