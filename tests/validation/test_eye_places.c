/*
 * Views from unsuitable places: in the plane of a wall, of the floor, in a corner; views that begin
 * in such a plane; views so narrow that pixels show less than the geometry's precision. The plan
 * warns before rendering, and the picture takes as many paths as any other.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <stdio.h>
#include <string.h>

#include "support/cli.h"
#include "support/room.h"

#define ROOM ROOM_SKY ROOM_GREY ROOM_CLEAR ROOM_SHELL ROOM_PANE

enum { SIDE = 96 };

static struct orl_result run_view(const char *view)
{
    char folder[64];
    cli_make_folder(folder);
    struct orl_result result = scene_run(&(struct scene_run){.scene = ROOM,
                                                             .view = view,
                                                             .seed = 1,
                                                             .width = SIDE,
                                                             .height = SIDE,
                                                             .global = 5000,
                                                             .folder = folder});
    cli_remove_folder(folder);
    return result;
}

static const char *warning_of(const struct orl_result *result, const char *words)
{
    for (size_t i = 0; i < result->n_warnings; i++)
        if (strstr(result->warnings[i], words))
            return result->warnings[i];
    return NULL;
}

/* The first is an ordinary view, the baseline for the others. */
static const struct {
    const char *name, *view;
    const char *surface; /* surface that holds the eye point, or NULL */
} cases[] = {
    {"in the room", "-vtv -vp 2 1.5 1.2 -vd 0 1 0 -vh 90 -vv 90", NULL},
    {"in a wall, towards the room", "-vtv -vp 4 2 1.2 -vd -1 0 0 -vh 90 -vv 90", "'"},
    {"in a wall, along it", "-vtv -vp 4 2 1.2 -vd 0 1 0 -vh 90 -vv 90", "'"},
    {"in a wall, all round", "-vta -vp 4 2 1.2 -vd -1 0 0 -vh 360 -vv 360", "'"},
    {"in the floor", "-vth -vp 2 2 0 -vd 0 1 0 -vh 180 -vv 180", "'"},
    {"in a corner", "-vth -vp 4 5 0 -vd -1 -1 .5 -vh 180 -vv 180", "'"},
    {"begins in a wall", "-vtv -vp 5 2 1.2 -vd -1 0 0 -vh 60 -vv 60 -vo 1", NULL},
    {"parallel, begins in a wall", "-vtl -vp 4 2 1.2 -vd -1 0 0 -vh 2 -vv 2", NULL},
    {"narrow", "-vtv -vp 2 1.5 1.2 -vd .1 1 0 -vh 1e-6 -vv 1e-6", NULL},
};

/* Pictures of different content differ in paths by at most a factor of three; a separate hemisphere
 * for every pixel would take ten times as many. */
static const double most_times = 3;

static void test_paths(void **state)
{
    double usual = 0;
    (void)state;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        struct orl_result result = run_view(cases[i].view);
        const double paths = (double)result.health.paths;
        const char *const warning = warning_of(&result, "lies on a surface");
        print_message("# %-28s %9.0f paths%s%s\n", cases[i].name, paths, warning ? "; " : "",
                      warning ? warning : "");
        usual = i == 0 ? paths : usual;
        assert_true(paths <= most_times * usual);
        assert_true((warning != NULL) == (cases[i].surface != NULL));
        assert_int_equal(result.n_views, 1);
        orl_result_done(&result);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_paths)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
