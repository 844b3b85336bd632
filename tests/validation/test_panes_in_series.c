/*
 * Free panes a hand's breadth in front of other panes: both are ports, and light through both
 * enters by the outer one. The floor reflects the sum of each place's direct light, which a sensor
 * that sees only the floor must read.
 *
 * A black room of 4 x 5 x 3 m with a floor of 0.8; a window of glass in the south and a second pane
 * 10 cm outside it, under a uniform sky all around, or with the sun as well.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#include <cmocka.h>

#include "support/extent.h"
#include "support/scene_fixture.h"
#include "support/scene_text.h"

#define SKY "void glow g 0 0 4 30 30 30 0\ng source sky 0 0 4 0 0 1 360\n"
#define SUN "void light l 0 0 3 1e6 1e6 1e6\nl source sun 0 0 4 0 -1 1 .533\n"

enum { SIDE_X = 12, SIDE_Y = 15, PLACES = SIDE_X * SIDE_Y };

/* Faces the room from beside the window, and so sees black walls and the floor. */
static const struct orl_sensor watcher = {{2, 0.05, 2.7}, {0, 1, 0}};

/* Computes the illuminance at the middles of the floor's squares, and at the watcher, by each
 * technique. */
static double run_scene(const char *scene, uint64_t photons, enum orl_technique technique,
                        double ret_floor[PLACES], double *ret_error)
{
    static struct orl_sensor sensors[PLACES + 1];
    for (int i = 0; i < PLACES; i++)
        sensors[i] = (struct orl_sensor){
            {4 * (i % SIDE_X + 0.5) / SIDE_X, 5 * (i / SIDE_X + 0.5) / SIDE_Y, 0}, {0, 0, 1}};
    sensors[PLACES] = watcher;
    struct orl_result r = scene_run(&(struct scene_run){.scene = scene,
                                                        .sensors = sensors,
                                                        .n_sensors = PLACES + 1,
                                                        .technique = technique,
                                                        .samples = (uint32_t)extent(512, 2048),
                                                        .global = photons,
                                                        .caustic = photons / 2});
    for (int i = 0; i < PLACES; i++)
        ret_floor[i] = r.illuminance_lx[i];
    *ret_error = r.standard_error_lx[PLACES];
    const double seen = r.illuminance_lx[PLACES];
    orl_result_done(&r);
    return seen;
}

/* Returns the watcher's light from a floor of those illuminances: each square is a patch. */
static double seen_of_floor(const double floor[PLACES])
{
    enum { FINE = 8 };
    double sum = 0;
    for (int i = 0; i < PLACES; i++)
        for (int k = 0; k < FINE * FINE; k++) {
            const double x = 4 * (i % SIDE_X + (k % FINE + 0.5) / FINE) / SIDE_X;
            const double y = 5 * (i / SIDE_X + ((double)(k / FINE) + 0.5) / FINE) / SIDE_Y;
            const struct orl_vec3 way = orl_sub(orl_v3(x, y, 0), watcher.position);
            const double d2 = orl_dot(way, way);
            if (way.y > 0)
                sum += 0.8 / ORL_PI * floor[i] * way.y * -way.z / (d2 * d2) * 20 / PLACES /
                       (FINE * FINE);
        }
    return sum;
}

/*
 * Three standard errors, of a tenth at most (the former fault was four fifths), and 4 %: the
 * squares' middles represent light that is not uniform over them, an error of a per cent under the
 * sky and two at the sun's edges, as finer grids show.
 */
static void check_floor(const char *scene, uint64_t photons)
{
    static const enum orl_technique techniques[3] = {ORL_TECHNIQUE_BACKWARD, ORL_TECHNIQUE_GATHER,
                                                     ORL_TECHNIQUE_PRECOMPUTED};
    double floor[PLACES], error;
    for (int t = 0; t < 3; t++) {
        const double seen = run_scene(scene, photons, techniques[t], floor, &error);
        const double expected = seen_of_floor(floor);
        print_message("technique %d: %g +- %g lx, by the floor %g\n", (int)techniques[t], seen,
                      error, expected);
        if (!(error < 0.1 * expected) || !(fabs(seen - expected) <= 3 * error + 0.04 * expected))
            fail_msg("technique %d: %g +- %g lx, by the floor %g", (int)techniques[t], seen, error,
                     expected);
    }
}

static void under_the_sky(void **state)
{
    (void)state;
    check_floor(scene_join(SKY, scene_fixture("room_panes_in_series"), NULL), 100000);
}

static void in_the_sun(void **state)
{
    (void)state;
    check_floor(scene_join(SKY SUN, scene_fixture("room_panes_in_series"), NULL),
                extent(50000, 100000));
}

int main(void)
{
    static const struct CMUnitTest tests[] = {
        cmocka_unit_test(under_the_sky),
        cmocka_unit_test(in_the_sun),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
