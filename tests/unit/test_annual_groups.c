/*
 * Light of window groups in many combinations of states (annual/year/annual_scene.h). The work for
 * four rooms with one group each is that of one run per state, not per group, and the sum over
 * groups equals the light of each room alone.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "support/year.h"

enum { ROOMS = 4, ROWS = 48, TEXT = 8192 };

static const char materials[] =
    "void plastic w 0 0 5 .5 .5 .5 0 0\nvoid plastic e 0 0 5 .2 .2 .2 0 0\n"
    "void glass clear 0 0 3 .9 .9 .9\nvoid glass tinted 0 0 3 .3 .3 .3\n"
    "e polygon ground 0 0 12 -90 -90 -.3 90 -90 -.3 90 90 -.3 -90 90 -.3\n";

/* Writes a box with a window in the south; boxes stand a metre apart. */
static size_t write_room(char *text, size_t size, int n)
{
    const double x = 5.0 * n, e = x + 4, a = x + 1, b = x + 3;
    return (size_t)snprintf(text, size,
                            "w polygon floor%d 0 0 12 %g 0 0 %g 0 0 %g 5 0 %g 5 0\n"
                            "w polygon ceiling%d 0 0 12 %g 0 3 %g 5 3 %g 5 3 %g 0 3\n"
                            "w polygon east%d 0 0 12 %g 0 0 %g 0 3 %g 5 3 %g 5 0\n"
                            "w polygon west%d 0 0 12 %g 0 0 %g 5 0 %g 5 3 %g 0 3\n"
                            "w polygon north%d 0 0 12 %g 5 0 %g 5 0 %g 5 3 %g 5 3\n"
                            "w polygon south%d 0 0 30 %g 0 0 %g 0 3 %g 0 3 %g 0 0 %g 0 0 "
                            "%g 0 1 %g 0 1 %g 0 2.5 %g 0 2.5 %g 0 1\n"
                            "clear polygon front%d 0 0 12 %g 0 1 %g 0 2.5 %g 0 2.5 %g 0 1\n",
                            n, x, e, e, x, n, x, x, e, e, n, e, e, e, e, n, x, x, x, x, n, x, e, e,
                            x, n, x, x, e, e, x, a, b, b, a, a, n, a, a, b, b);
}

struct street {
    char text[TEXT], names[ROOMS][16], windows[ROOMS][16], *lists[ROOMS][1];
    unsigned char series[ROOMS][ROWS];
    struct orl_shade_state states[ROOMS][2];
    struct orl_window_group groups[ROOMS];
    struct orl_sensor sensors[ROOMS];
};

/* Each row has another combination of states. */
static void build_street(struct street *s)
{
    static char clear[] = "clear", tinted[] = "tinted";
    size_t used = (size_t)snprintf(s->text, TEXT, "%s", materials);
    for (int n = 0; n < ROOMS; n++) {
        used += write_room(s->text + used, TEXT - used, n);
        assert_true(used < TEXT);
        snprintf(s->names[n], sizeof s->names[n], "group%d", n);
        snprintf(s->windows[n], sizeof s->windows[n], "front%d", n);
        s->lists[n][0] = s->windows[n];
        s->states[n][0] = (struct orl_shade_state){.name = clear};
        s->states[n][1] = (struct orl_shade_state){.name = tinted, .material = tinted};
        for (int i = 0; i < ROWS; i++)
            s->series[n][i] = (unsigned char)(i >> n & 1);
        s->groups[n] = (struct orl_window_group){.name = s->names[n],
                                                 .windows = s->lists[n],
                                                 .n_windows = 1,
                                                 .states = s->states[n],
                                                 .n_states = 2,
                                                 .series = s->series[n],
                                                 .n_series = ROWS};
        s->sensors[n] = (struct orl_sensor){{5.0 * n + 2, 2, .8}, {0, 0, 1}};
    }
}

static struct year_run run_of(const struct street *s)
{
    return (struct year_run){.scene = s->text,
                             .site = {38.42, 27.14, 2},
                             .sensors = s->sensors,
                             .n_sensors = ROOMS,
                             .samples = 512,
                             .seed = 4};
}

/* Each sensor has paths of all light in both states. */
static void test_work(void **state)
{
    static struct street s;
    (void)state;
    build_street(&s);
    struct year_run run = run_of(&s);
    struct orl_annual_result open = year_run(&run);
    run.groups = s.groups;
    run.n_groups = ROOMS;
    struct orl_annual_result all = year_run(&run);
    assert_true(all.summed);
    print_message("# rays of paths: %.0f with all open, %.0f by groups\n", (double)open.health.rays,
                  (double)all.health.rays);
    assert_int_equal(all.n_runs, 2);
    assert_true((double)all.health.rays < 2.1 * (double)open.health.rays);
    orl_annual_done(&open);
    orl_annual_done(&all);
}

/* A room with only its own group has few combinations of states, so no sum is needed. */
static void test_light(void **state)
{
    static struct street s;
    double squares = 0, worst = 0;
    size_t n = 0;
    (void)state;
    build_street(&s);
    struct year_run run = run_of(&s);
    run.groups = s.groups;
    run.n_groups = ROOMS;
    struct orl_annual_result all = year_run(&run);
    for (int room = 0; room < ROOMS; room++) {
        run.groups = &s.groups[room];
        run.n_groups = 1;
        run.seed = 50;
        struct orl_annual_result alone = year_run(&run);
        assert_false(alone.summed);
        for (size_t c = 0; c < all.n_columns; c++) {
            const size_t at = (size_t)room * all.n_columns + c;
            const double off = (double)all.total[at] - (double)alone.total[at];
            const double z = off / hypot((double)all.se[at], (double)alone.se[at]);
            assert_true(all.direct[at] == alone.direct[at]);
            squares += z * z;
            worst = fmax(worst, fabs(z));
            n++;
        }
        orl_annual_done(&alone);
    }
    print_message("# %zu sensor-hours: z rms %.2f, worst %.2f\n", n, sqrt(squares / (double)n),
                  worst);
    assert_true(sqrt(squares / (double)n) < 1.6 && worst < 4.5);
    orl_annual_done(&all);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_work), cmocka_unit_test(test_light)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
