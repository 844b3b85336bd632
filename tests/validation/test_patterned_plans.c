/*
 * Plans of scenes with patterns: an effect's light is at most the plan's bound for it, which uses
 * the maxima of patterns over their surfaces and skies; and the bytes are equal for any number of
 * threads. A room with a tiled floor and a rough wall, under a patterned sky.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "support/cli.h"
#include "support/scene_text.h"

/* A sky brighter toward the south and at the horizon; tiles, the bright ones of which exceed the
 * plastic's reflectance; waves in the normals of a wall. */
static const char functions[] = "sky = if(Dz, 2 - Dy + 4*exp(-8*Dz), .2);\n"
                                "tile = if((frac(Px) - .5)*(frac(Py) - .5), 1.5, .25);\n"
                                "wave_x = 0; wave_y = .2*sin(9*Py); wave_z = .2*sin(9*Pz);\n";
static const char scene[] =
    "void brightfunc dome 2 sky f.cal 0 0\ndome glow g 0 0 4 8 9 10 0\n"
    "g source s 0 0 4 0 0 1 360\n"
    "void light sun 0 0 3 2e6 2e6 2e6\nsun source d 0 0 4 .2 -.7 .6 .533\n"
    "void brightfunc tiles 2 tile f.cal 0 0\ntiles plastic floor 0 0 5 .6 .5 .4 0 0\n"
    "void texfunc waves 4 wave_x wave_y wave_z f.cal 0 0\nwaves plastic rough 0 0 5 .6 .6 .6 0 0\n"
    "void plastic wall 0 0 5 .6 .6 .6 0 0\nvoid glass pane 0 0 3 .9 .9 .9\n"
    "floor polygon f 0 0 12 0 0 0 4 0 0 4 5 0 0 5 0\n"
    "wall polygon u 0 0 12 0 0 3 0 5 3 4 5 3 4 0 3\n"
    "rough polygon w 0 0 12 0 0 0 0 5 0 0 5 3 0 0 3\n"
    "wall polygon e 0 0 12 4 0 0 4 0 3 4 5 3 4 5 0\n"
    "wall polygon n 0 0 12 0 5 0 4 5 0 4 5 3 0 5 3\n"
    "pane polygon p 0 0 12 0 0 0 0 0 3 4 0 3 4 0 0\n";

enum { SENSORS = 4 };
static const struct orl_sensor sensors[SENSORS] = {{{2, 1, .8}, {0, 0, 1}},
                                                   {{2, 4, .8}, {0, 0, 1}},
                                                   {{1, 2, 2.9}, {0, 0, -1}},
                                                   {{3.9, 2, 1.5}, {-1, 0, 0}}};

static struct orl_result run_room(enum orl_technique technique, enum orl_effect effect,
                                  enum orl_effect_override override, uint32_t threads,
                                  const char *folder)
{
    enum orl_effect_override overrides[ORL_EFFECT_COUNT] = {ORL_OVERRIDE_AUTO};
    overrides[effect] = override;
    return scene_run(&(struct scene_run){.scene = scene,
                                         .resource_name = "f.cal",
                                         .resource_text = functions,
                                         .sensors = sensors,
                                         .n_sensors = SENSORS,
                                         .technique = technique,
                                         .overrides = overrides,
                                         .global = 50000,
                                         .samples = 1024,
                                         .view = folder ? "-vp 2 4.5 1.5 -vd 0 -1 -.2" : NULL,
                                         .width = 24,
                                         .height = 24,
                                         .pixel_samples = 4,
                                         .threads = threads,
                                         .folder = folder});
}

/* The sun, the sky, and light reflected by surfaces: most of it arrives at some sensor. */
static void test_bounds(void **state)
{
    static const enum orl_effect effects[] = {ORL_EFFECT_SUN, ORL_EFFECT_SKY,
                                              ORL_EFFECT_INTERREFLECTION};
    (void)state;
    struct orl_result whole =
        run_room(ORL_TECHNIQUE_BACKWARD, ORL_EFFECT_SUN, ORL_OVERRIDE_AUTO, 2, NULL);
    for (size_t e = 0; e < sizeof effects / sizeof *effects; e++) {
        struct orl_result without =
            run_room(ORL_TECHNIQUE_BACKWARD, effects[e], ORL_OVERRIDE_SKIP, 2, NULL);
        const double bound = whole.plan.effects[effects[e]].bound;
        double most = 0;
        for (int i = 0; i < SENSORS; i++)
            most = fmax(most, whole.illuminance_lx[i] - without.illuminance_lx[i]);
        print_message("effect %d: at most %.0f lx of it, bound %.0f\n", (int)effects[e], most,
                      bound);
        assert_true(whole.plan.effects[effects[e]].simulated);
        assert_true(most > 100);
        assert_true(most <= bound);
        orl_result_done(&without);
    }
    orl_result_done(&whole);
}

static void test_threads(void **state)
{
    static const uint32_t threads[3] = {1, 2, 7};
    static const enum orl_technique techniques[2] = {ORL_TECHNIQUE_BACKWARD, ORL_TECHNIQUE_GATHER};
    (void)state;
    for (size_t t = 0; t < 2; t++) {
        double lx[SENSORS] = {0};
        unsigned char *first = NULL;
        size_t first_size = 0;
        for (int i = 0; i < 3; i++) {
            char folder[64], path[128];
            size_t size = 0;
            cli_make_folder(folder);
            struct orl_result r =
                run_room(techniques[t], ORL_EFFECT_SUN, ORL_OVERRIDE_AUTO, threads[i], folder);
            snprintf(path, sizeof path, "%s/view.hdr", folder);
            unsigned char *const picture = scene_read_bytes(path, &size);
            if (first) {
                assert_memory_equal(lx, r.illuminance_lx, sizeof lx);
                assert_int_equal(size, first_size);
                assert_memory_equal(picture, first, size);
                free(picture);
            } else {
                memcpy(lx, r.illuminance_lx, sizeof lx);
                first = picture;
                first_size = size;
            }
            orl_result_done(&r);
            cli_remove_folder(folder);
        }
        free(first);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_bounds),
        cmocka_unit_test(test_threads),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
