/* A job cancelled at any step of any technique returns the cancel error, and leaves no partial
 * files. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <dirent.h>
#include <math.h>
#include <stdatomic.h>
#include <stdio.h>
#include <string.h>

#include "support/cli.h"
#include "support/room.h"
#include "support/techniques.h"

/* The first progress report at or after this point sets the flag: a stage's number and its
 * fraction. */
struct trap {
    atomic_bool cancel;
    double at;
};

static void on_progress(void *ctx, enum orl_stage stage, double stage_fraction, double job_fraction,
                        double left_s)
{
    struct trap *trap = ctx;
    (void)job_fraction, (void)left_s;
    if ((int)stage + stage_fraction >= trap->at)
        atomic_store(&trap->cancel, true);
}

enum { POINTS = 18 };

static size_t count_files(const char *folder)
{
    size_t count = 0;
    DIR *dir = opendir(folder);
    assert_non_null(dir);
    for (const struct dirent *entry; (entry = readdir(dir));)
        count += entry->d_name[0] != '.';
    closedir(dir);
    return count;
}

/* Runs the room with maps and a view; the folder is the store. */
static int run_room(enum orl_technique technique, const char *folder, struct trap *trap)
{
    char xml[2048];
    struct orl_error err = {0};
    scene_uniform_bsdf(0.2, xml);
    const int code = scene_run_try(
        &(struct scene_run){.scene = ROOM_SKY ROOM_SUN ROOM_GREY ROOM_BSDF ROOM_SHELL ROOM_PANE,
                            .resource_name = "pane.xml",
                            .resource_text = xml,
                            .sensors = room_sensors,
                            .n_sensors = ROOM_SENSORS,
                            .view = "-vtv -vp 2 4.5 1.5 -vd 0 -1 0 -vh 70 -vv 55",
                            .width = 16,
                            .height = 12,
                            .technique = technique,
                            .overrides = scene_wish_maps,
                            .global = 4000,
                            .caustic = 2000,
                            .samples = 64,
                            .pixel_samples = 4,
                            .threads = 2,
                            .folder = folder,
                            .cancel = &trap->cancel,
                            .progress = on_progress,
                            .ctx = trap},
        &err);
    assert_int_equal(code, code < 0 ? (int)err.code : 0);
    return code;
}

/*
 * Cancels at POINTS points. After a stage's last report the next stage sees the flag; after the
 * last stage's none does, so the job may succeed. Maps finished before remain complete, and the
 * next run finds them.
 */
static void cancel_at_points(void **state)
{
    const enum orl_technique technique = of_technique(state);
    char folder[64];
    struct trap trap = {.at = INFINITY};
    int cancelled = 0;
    cli_make_folder(folder);
    atomic_init(&trap.cancel, false);
    assert_int_equal(run_room(technique, folder, &trap), 0);
    const size_t whole = count_files(folder);
    cli_remove_folder(folder);
    for (int i = 0; i < POINTS; i++) {
        cli_make_folder(folder);
        trap = (struct trap){.at = (double)i * ORL_STAGE_COUNT / POINTS};
        const int code = run_room(technique, folder, &trap);
        assert_true(code == 0 || code == ORL_ERR_CANCELLED);
        cancelled += code < 0;
        assert_in_range(count_files(folder), code < 0 ? 0 : whole, whole);
        if (i == POINTS / 2) {
            trap = (struct trap){.at = INFINITY};
            assert_int_equal(run_room(technique, folder, &trap), 0);
            assert_int_equal(count_files(folder), whole);
        }
        cli_remove_folder(folder);
    }
    if (cancelled < POINTS - 2)
        fail_msg("only %d of %d were cancelled", cancelled, POINTS);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        OF_TECHNIQUE(cancel_at_points, BACKWARD),
        OF_TECHNIQUE(cancel_at_points, GATHER),
        OF_TECHNIQUE(cancel_at_points, DIRECT),
        OF_TECHNIQUE(cancel_at_points, PRECOMPUTED),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
