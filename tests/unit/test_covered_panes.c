/* Panes that lie on a wall without a hole give a warning; those in holes, in front of blinds and
 * on glass do not. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "support/scene_text.h"

#define ROOM                                                                                       \
    "void plastic w 0 0 5 .5 .5 .5 0 0\nvoid glass p 0 0 3 .9 .9 .9\n"                             \
    "void glow g 0 0 4 1 1 1 0\ng source sky 0 0 4 0 0 1 360\n"                                    \
    "w polygon floor 0 0 12 -2 0 0 -2 4 0 2 4 0 2 0 0\n"                                           \
    "w polygon roof 0 0 12 -2 0 3 2 0 3 2 4 3 -2 4 3\n"                                            \
    "w polygon back 0 0 12 -2 4 0 -2 4 3 2 4 3 2 4 0\n"                                            \
    "w polygon left 0 0 12 -2 0 0 -2 0 3 -2 4 3 -2 4 0\n"                                          \
    "w polygon right 0 0 12 2 0 0 2 4 0 2 4 3 2 0 3\n"
#define WHOLE "w polygon front 0 0 12 -2 0 0 2 0 0 2 0 3 -2 0 3\n"
#define HOLE                                                                                       \
    "w polygon front 0 0 30 -2 0 0 2 0 0 2 0 3 -2 0 3 -2 0 0 -1 0 1 -1 0 2 1 0 2 1 0 1 -1 0 1\n"
#define PANE "p polygon pane 0 0 12 -1 0 1 1 0 1 1 0 2 -1 0 2\n"
#define OUTER "p polygon outer 0 0 12 -1 -1e-4 1 1 -1e-4 1 1 -1e-4 2 -1 -1e-4 2\n"
#define INNER "p polygon inner 0 0 12 -1 1e-4 1 1 1e-4 1 1 1e-4 2 -1 1e-4 2\n"
/* A blind of half the pane's width. */
#define BLIND "w polygon blind 0 0 12 -1 1e-4 1 0 1e-4 1 0 1e-4 2 -1 1e-4 2\n"
#define SHUTTER "w polygon shutter 0 0 12 -1 .01 1 1 .01 1 1 .01 2 -1 .01 2\n"

static void test_covered(void **state)
{
    static const char from_all[] =
        "covers the whole pane '%s' (scene.rad:%d) at a distance of 0.0001";
    static const struct {
        const char *scene, *pane;
    } cases[] = {
        {ROOM HOLE PANE, NULL},       {ROOM HOLE PANE OUTER INNER, NULL},
        {ROOM HOLE PANE BLIND, NULL}, {ROOM HOLE PANE SHUTTER, NULL},
        {ROOM WHOLE OUTER, "outer"},  {ROOM WHOLE INNER, "inner"},
    };
    static const struct orl_sensor sensor = {{0, 2, 0.8}, {0, 0, 1}};
    (void)state;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        struct orl_result result =
            scene_run(&(struct scene_run){.scene = cases[i].scene,
                                          .sensors = &sensor,
                                          .n_sensors = 1,
                                          .technique = ORL_TECHNIQUE_BACKWARD,
                                          .samples = 16});
        char wanted[160];
        size_t said = 0, right = 0;
        snprintf(wanted, sizeof wanted, from_all, cases[i].pane ? cases[i].pane : "", 11);
        for (size_t k = 0; k < result.n_warnings; k++) {
            said += strstr(result.warnings[k], "covers the whole pane") != NULL;
            right += strstr(result.warnings[k], wanted) != NULL;
        }
        if (said != (cases[i].pane != NULL) || right != said)
            fail_msg("case %zu: %zu warnings, %zu as expected, first: %s", i, said, right,
                     result.n_warnings ? result.warnings[0] : "none");
        orl_result_done(&result);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_covered)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
