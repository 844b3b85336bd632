/*
 * Mixtures of unlike materials in whole jobs, where the share is 1 on one side of a line and 0 on
 * the other: the light equals that of two polygons, for all techniques; and refusals.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "scene/built/scene.h"
#include "scene/material/scatter.h"
#include "scene/parse/parse.h"
#include "support/scene_text.h"

/* ---- Jobs -------------------------------------------------------------------------------------
 */

/* A closed room without its south wall; x and z of the wall are those of the room. */
#define ROOM                                                                                       \
    "void glow sky 0 0 4 100 90 80 0\nsky source s 0 0 4 0 0 1 360\n"                              \
    "void light sun 0 0 3 4e6 4e6 4e6\nsun source d 0 0 4 .2 -.7 .6 .533\n"                        \
    "void plastic wall 0 0 5 .6 .6 .6 0 0\nvoid glass pane 0 0 3 .8 .8 .8\n"                       \
    "void metal steel 0 0 5 .7 .7 .7 .8 .1\nvoid mirror m 0 0 3 .8 .8 .8\n"                        \
    "wall polygon w 0 0 12 0 0 0 0 0 3 0 5 3 0 5 0\nwall polygon e 0 0 12 4 0 0 4 5 0 4 5 3 4 0 "  \
    "3\n"                                                                                          \
    "wall polygon n 0 0 12 0 5 0 0 5 3 4 5 3 4 5 0\nwall polygon u 0 0 12 0 0 3 4 0 3 4 5 3 0 5 "  \
    "3\n"
#define FLOOR "polygon f 0 0 12 0 0 0 0 5 0 4 5 0 4 0 0\n"
#define SOUTH "polygon s 0 0 12 0 0 0 4 0 0 4 0 3 0 0 3\n"
#define LEFT "polygon l 0 0 12 0 0 0 2 0 0 2 0 3 0 0 3\n"
#define RIGHT "polygon r 0 0 12 2 0 0 4 0 0 4 0 3 2 0 3\n"

enum { SENSORS = 3 };

static void run_scene(const char *scene, enum orl_technique technique, double ret_lx[SENSORS])
{
    static const struct orl_sensor sensors[SENSORS] = {
        {{1, 2.5, .8}, {0, 0, 1}}, {{3, 1.5, .8}, {0, 0, 1}}, {{2, 4, 1.5}, {0, -1, 0}}};
    const struct scene_run job = {.scene = scene,
                                  .sensors = sensors,
                                  .n_sensors = SENSORS,
                                  .technique = technique,
                                  .overrides = scene_wish_maps,
                                  .samples = 1024,
                                  .global = 50000,
                                  .caustic = 20000,
                                  .threads = 2};
    scene_run_lx(&job, ret_lx);
}

/* Compares the first n sensors. Both runs have 1 024 rays: 2 % each if they were independent. */
static void compare_sensors(const char *mixed, const char *split, enum orl_technique technique,
                            int n)
{
    double a[SENSORS], b[SENSORS];
    run_scene(mixed, technique, a);
    run_scene(split, technique, b);
    for (int i = 0; i < n; i++)
        if (!(b[i] > 10 && fabs(a[i] / b[i] - 1) < .05))
            fail_msg("sensor %d: %g lx, not %g", i, a[i], b[i]);
}

/* A facade that is half glass and half wall: half of the photon port is closed. */
static void test_facade(void **state)
{
    static const char split[] = ROOM "wall " FLOOR "wall " LEFT "pane " RIGHT;
    static const char mixed[] =
        ROOM "wall " FLOOR "void mixfunc half 4 pane wall if(Px-2,1,0) . 0 0\nhalf " SOUTH;
    (void)state;
    compare_sensors(mixed, split, ORL_TECHNIQUE_BACKWARD, SENSORS);
    compare_sensors(mixed, split, ORL_TECHNIQUE_GATHER, SENSORS);
}

/* A screen with a hole: void also lets the sun through. */
static void test_screen(void **state)
{
    static const char split[] =
        ROOM "wall " FLOOR "wall " LEFT "void glass nothing 0 0 4 1 1 1 1\nnothing " RIGHT;
    static const char mixed[] =
        ROOM "wall " FLOOR "void mixfunc half 4 void wall if(Px-2,1,0) . 0 0\nhalf " SOUTH;
    (void)state;
    compare_sensors(mixed, split, ORL_TECHNIQUE_BACKWARD, SENSORS);
    compare_sensors(mixed, split, ORL_TECHNIQUE_GATHER, SENSORS);
}

/* The screen with a texture on its wall part, not on the hole. */
static void test_rough_screen(void **state)
{
#define BUMPS                                                                                      \
    "void texfunc bumps 4 .3*sin(9*Px) 0 .3*cos(9*Pz) . 0 0\n"                                     \
    "bumps plastic bumpy 0 0 5 .5 .5 .5 .1 .1\n"
    static const char split[] =
        ROOM BUMPS "wall " FLOOR "bumpy " LEFT "void glass nothing 0 0 4 1 1 1 1\nnothing " RIGHT;
    static const char mixed[] =
        ROOM BUMPS "wall " FLOOR "void mixfunc half 4 void bumpy if(Px-2,1,0) . 0 0\nhalf " SOUTH;
    (void)state;
    compare_sensors(mixed, split, ORL_TECHNIQUE_BACKWARD, SENSORS);
    compare_sensors(mixed, split, ORL_TECHNIQUE_GATHER, SENSORS);
}

/* A floor that is half steel and half paint: glossy reflections of the sun. With a gather the
 * sensor opposite finds the sun by random rays only, in both scenes. */
static void test_floor(void **state)
{
#define WINDOW "pane " SOUTH
    static const char split[] = ROOM WINDOW "wall polygon a 0 0 12 0 0 0 0 5 0 2 5 0 2 0 0\n"
                                            "steel polygon b 0 0 12 2 0 0 2 5 0 4 5 0 4 0 0\n";
    static const char mixed[] =
        ROOM WINDOW "void mixfunc half 4 steel wall if(Px-2,1,0) . 0 0\nhalf " FLOOR;
    (void)state;
    compare_sensors(mixed, split, ORL_TECHNIQUE_BACKWARD, SENSORS);
    compare_sensors(mixed, split, ORL_TECHNIQUE_GATHER, 2);
}

/* A wall, half of which glows: found by random rays and by photons. */
static void test_glow(void **state)
{
#define DARK                                                                                       \
    "void plastic wall 0 0 5 .6 .6 .6 0 0\nvoid glow lit 0 0 4 20 15 10 0\n"                       \
    "wall polygon w 0 0 12 0 0 0 0 0 3 0 5 3 0 5 0\nwall polygon e 0 0 12 4 0 0 4 5 0 4 5 3 4 0 "  \
    "3\nwall polygon n 0 0 12 0 5 0 0 5 3 4 5 3 4 5 0\nwall polygon u 0 0 12 0 0 3 4 0 3 4 5 3 "   \
    "0 5 3\nwall " FLOOR
#define SOUTH_IN "polygon s 0 0 12 0 0 0 0 0 3 4 0 3 4 0 0\n"
    static const char split[] = DARK "wall polygon l 0 0 12 0 0 0 0 0 3 2 0 3 2 0 0\n"
                                     "lit polygon r 0 0 12 2 0 0 2 0 3 4 0 3 4 0 0\n";
    static const char mixed[] =
        DARK "void mixfunc half 4 lit wall if(Px-2,1,0) . 0 0\nhalf " SOUTH_IN;
    (void)state;
    compare_sensors(mixed, split, ORL_TECHNIQUE_BACKWARD, SENSORS);
    compare_sensors(mixed, split, ORL_TECHNIQUE_GATHER, SENSORS);
    compare_sensors(mixed, split, ORL_TECHNIQUE_DIRECT, SENSORS);
}

/* Shares that depend on the eye in form only give the light of those that do not. */
static void test_directed(void **state)
{
    static const char same[] = ROOM WINDOW "void mixfunc half 4 steel wall .4 . 0 0\nhalf " FLOOR;
    static const char directed[] =
        ROOM WINDOW "void mixfunc half 4 steel wall if(-Rdot,.4,.9) . 0 0\nhalf " FLOOR;
    (void)state;
    compare_sensors(directed, same, ORL_TECHNIQUE_BACKWARD, SENSORS);
    compare_sensors(directed, same, ORL_TECHNIQUE_GATHER, 2);
}

/* ---- Files ------------------------------------------------------------------------------------
 */

static int parse(const char *text, struct orl_parsed_scene *ret, struct orl_error *err)
{
    static const char *const names[] = {"a.rad"};
    const struct orl_file contents[] = {{text, strlen(text), NULL}};
    struct orl_memory_files memory = {names, contents, 1};
    const struct orl_files files = orl_files_from_memory(&memory);
    return orl_scene_parse(names, 1, &files, ret, err);
}

#define MATERIALS                                                                                  \
    "void plastic p 0 0 5 .5 .5 .5 0 0\nvoid metal b 0 0 5 .5 .5 .5 .5 .1\n"                       \
    "void glow g 0 0 4 1 1 1 0\nvoid dielectric d 0 0 5 1 1 1 1.5 0\n"                             \
    "void texfunc t 4 Nx Ny Nz . 0 0\nt plastic rough 0 0 5 .5 .5 .5 0 0\n"

static void test_refused(void **state)
{
    static const struct {
        const char *text, *message;
    } cases[] = {
        {MATERIALS "void light l 0 0 3 1 1 1\nvoid mixfunc m 4 p l .5 . 0 0\nm " FLOOR,
         "mixtures of unlike materials"},
        {MATERIALS "void mixfunc m 4 d p .5 . 0 0\nm " FLOOR, "mixtures of unlike materials"},
        {MATERIALS "void mixfunc m 4 rough b .5 . 0 0\nm " FLOOR, "the same texture"},
        {MATERIALS "void mixfunc m 4 p b Dx . 0 0\nm " FLOOR, "uses the ray's direction"},
        {MATERIALS "void mixfunc m 4 p void Rdot . 0 0\nm " FLOOR, "uses the ray's direction"},
        {MATERIALS "void mixfunc m 4 p b .5 . 0 0\nm colorfunc x 4 1 1 1 . 0 0\nx " FLOOR,
         "is a mixture of unlike materials"},
        {MATERIALS "void mixfunc m 4 p b .5 . 0 0\nt alias x m\nx " FLOOR,
         "can have only the patterns"},
        {"void WGMDfunc m 12 void .2 0 0 void 0 0 0 void 0 0 1 0 9 0 0 0 0 0 0 0 0 0\nm " FLOOR,
         "WGMDfunc takes"},
        {"void WGMDfunc m 13 gone .2 0 0 void 0 0 0 void 0 0 1 . 0 9 0 0 0 0 0 0 0 0 0\nm " FLOOR,
         "'gone', which modifies a part of it, is not defined"},
        {"void texfunc t 4 Nx 0 0 . 0 0\n"
         "void WGMDfunc m 13 t .2 0 0 void 0 0 0 void 0 0 1 . 0 9 .1 .1 .1 0 0 0 0 0 0\nm " FLOOR,
         "different textures"},
        {"void WGMDfunc m 13 void 1.2 0 0 void 0 0 0 void 0 0 1 . 0 9 0 0 0 0 0 0 0 0 0\nm " FLOOR,
         "1.2"},
        {"void WGMDfunc m 13 void .2 2 2 void 0 0 0 void 0 0 1 . 0 9 0 0 0 0 0 0 0 0 0\nm " FLOOR,
         "roughness 2"},
    };
    (void)state;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        struct orl_parsed_scene parsed_scene = {0};
        struct orl_error err = {0};
        const int code = parse(cases[i].text, &parsed_scene, &err);
        if (code == 0 || !strstr(err.message, cases[i].message))
            fail_msg("case %zu: %d %s", i, code, err.message);
        orl_parsed_scene_done(&parsed_scene);
    }
}

/* A texture between a mixture and a surface applies to all components. */
static void test_texture(void **state)
{
    struct orl_parsed_scene parsed_scene = {0};
    struct orl_error err = {0};
    (void)state;
    assert_int_equal(parse(MATERIALS
                           "void mixfunc m 4 b g .5 . 0 0\nvoid mixfunc n 4 m p .5 . 0 0\n"
                           "n texfunc x 4 0 0 .1 . 0 0\nx " FLOOR,
                           &parsed_scene, &err),
                     0);
    const struct orl_material *const x = &parsed_scene.materials[parsed_scene.surfaces[0].material];
    assert_non_null(x->texture);
    const struct orl_material *const mixed = orl_mixture_of(x)->mixed;
    assert_ptr_equal(mixed[0].texture, x->texture);
    assert_ptr_equal(orl_mixture_of(&mixed[0])->mixed[0].texture, x->texture);
    assert_null(orl_mixture_of(&mixed[0])->mixed[1].texture);
    assert_ptr_equal(mixed[1].texture, x->texture);
    orl_parsed_scene_done(&parsed_scene);
}

/* Nine nested mixtures are too many; eight are accepted. A mixture in an array is stored once. */
static void test_bounds(void **state)
{
    char text[4096] = MATERIALS "void mixfunc m0 4 p b .5 . 0 0\n", more[128];
    (void)state;
    for (int i = 1; i < 9; i++) {
        struct orl_parsed_scene parsed_scene = {0};
        struct orl_error err = {0};
        char whole[4400];
        snprintf(more, sizeof more, "void mixfunc m%d 4 m%d p Px . 0 0\n", i, i - 1);
        strcat(text, more);
        snprintf(whole, sizeof whole, "%s%sm%d " FLOOR, text, more, i);
        const int code = parse(whole, &parsed_scene, &err);
        assert_int_equal(code, i < 7 ? 0 : ORL_ERR_UNSUPPORTED);
        if (code == 0)
            assert_int_equal(parsed_scene.n_patterns, i + 2);
        orl_parsed_scene_done(&parsed_scene);
        if (code < 0)
            break;
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_facade),       cmocka_unit_test(test_screen),
        cmocka_unit_test(test_rough_screen), cmocka_unit_test(test_floor),
        cmocka_unit_test(test_glow),         cmocka_unit_test(test_directed),
        cmocka_unit_test(test_refused),      cmocka_unit_test(test_bounds),
        cmocka_unit_test(test_texture),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
