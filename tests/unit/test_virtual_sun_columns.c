/*
 * Regions from which mirror images of suns may be visible, against rays: every place of a ray hit
 * is inside a region, and places without a mirror are outside.
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
#include "light/virtual_suns.h"
#include "support/scene_text.h"

enum { MIRRORS = 12, PLACES = 4000, LOOKS = 8 };

static double between(struct orl_random *random, double low, double high)
{
    return low + (high - low) * orl_random_uniform(random);
}

static struct orl_vec3 direction_of(struct orl_random *random)
{
    const double z = between(random, -1, 1), turn = between(random, 0, 2 * ORL_PI);
    const double r = sqrt(1 - z * z);
    return orl_v3(r * cos(turn), r * sin(turn), z);
}

/* Returns random triangles and rings, some of them near others. */
static struct orl_geometry *random_mirrors(struct orl_random *random)
{
    char text[8192] = "void mirror m 0 0 3 1 1 1\n";
    for (int i = 0; i < MIRRORS; i++) {
        const struct orl_vec3 at =
            orl_v3(between(random, -20, 20), between(random, -20, 20), between(random, -5, 5));
        const size_t used = strlen(text);
        double v[9];
        for (int k = 0; k < 9; k++)
            v[k] = (k % 3 == 0 ? at.x : k % 3 == 1 ? at.y : at.z) + between(random, -6, 6);
        if (i % 3 == 0)
            snprintf(text + used, sizeof text - used,
                     "m ring r%d 0 0 8 %.6f %.6f %.6f %.6f %.6f %.6f 0.4 3.1\n", i, v[0], v[1],
                     v[2], v[3] - at.x, v[4] - at.y, v[5] - at.z);
        else
            snprintf(text + used, sizeof text - used,
                     "m polygon p%d 0 0 9 %.6f %.6f %.6f %.6f %.6f %.6f %.6f %.6f %.6f\n", i, v[0],
                     v[1], v[2], v[3], v[4], v[5], v[6], v[7], v[8]);
    }
    return scene_geometry(text);
}

/* Returns a point in the disc, its rim included. */
static struct orl_vec3 near(const struct orl_frame *frame, double half, struct orl_random *random)
{
    const double turn = between(random, 0, 2 * ORL_PI);
    const double r = tan(half) * sqrt(orl_random_uniform(random));
    return orl_normalize(
        orl_madd(orl_madd(frame->n, frame->u, r * cos(turn)), frame->v, r * sin(turn)));
}

static void test_what_rays_meet_is_not_denied(void **state)
{
    static struct orl_virtual_sun_columns columns;
    size_t met = 0, denied = 0;
    (void)state;
    for (uint32_t scene = 0; scene < 20; scene++) {
        struct orl_random random = orl_random_stream(7, ORL_PURPOSE_PILOT, scene);
        struct orl_geometry *geometry = random_mirrors(&random);
        const struct orl_frame frame = orl_frame_about(direction_of(&random));
        const double half = scene % 2 == 0 ? 0.00465 : 0.05;
        bool shows[MIRRORS];
        for (int i = 0; i < MIRRORS; i++)
            shows[i] = orl_random_uniform(&random) < 0.7;
        orl_virtual_sun_columns_build(&columns, geometry, &frame, half, shows);
        for (int i = 0; i < PLACES; i++) {
            const double r = geometry->radius;
            const struct orl_vec3 place =
                orl_v3(between(&random, -r, r), between(&random, -r, r), between(&random, -r, r));
            const bool may = orl_virtual_sun_columns_show(&columns, &frame, place);
            denied += !may;
            for (int k = 0; k < LOOKS && orl_dot(place, place) < r * r; k++) {
                struct orl_hit hit;
                if (!orl_geometry_intersect(geometry, place, near(&frame, half, &random), INFINITY,
                                            &hit) ||
                    !shows[hit.facet])
                    continue;
                met++;
                assert_true(may);
            }
        }
        orl_geometry_free(geometry);
    }
    /* Both cases happen often enough for a meaningful test. */
    assert_true(met > 2000);
    assert_true(denied > 20 * PLACES / 2);
}

static void test_no_mirror_no_image(void **state)
{
    static struct orl_virtual_sun_columns columns;
    struct orl_random random = orl_random_stream(8, ORL_PURPOSE_PILOT, 0);
    struct orl_geometry *geometry = random_mirrors(&random);
    const struct orl_frame frame = orl_frame_about(orl_v3(0, 0, 1));
    const bool shows[MIRRORS] = {false};
    (void)state;
    orl_virtual_sun_columns_build(&columns, geometry, &frame, 0.005, shows);
    assert_false(orl_virtual_sun_columns_show(&columns, &frame, orl_v3(0, 0, 0)));
    orl_geometry_free(geometry);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_what_rays_meet_is_not_denied),
                                       cmocka_unit_test(test_no_mirror_no_image)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
