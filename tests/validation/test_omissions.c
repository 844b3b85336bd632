/*
 * Omissions and substitutions of the plan: clear windows change nothing, a mirror however small
 * gets its caustic photons and all of their light, and a skip has the stated effect.
 */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

#include "support/cli.h"
#include "support/oracles.h"
#include "support/room.h"

#define ROOM ROOM_GREY ROOM_CLEAR ROOM_SHELL ROOM_PANE
#define GROUND "w polygon ground 0 0 12 -20 -40 -.1 24 -40 -.1 24 0 -.1 -20 0 -.1\n"
/* A square centimetre and a half behind three square metres: a part in 20 000. */
#define COIN "void mirror m 0 0 3 .9 .9 .9\nm ring coin 0 0 8 2 1.5 .001 0 0 1 0 .007\n"

struct run {
    const char *text;
    enum orl_technique technique;
    enum orl_effect effect;
    enum orl_effect_override override;
    uint64_t caustic;
    const char *folder;
};

static struct orl_result run_job(const struct run *r)
{
    enum orl_effect_override overrides[ORL_EFFECT_COUNT] = {ORL_OVERRIDE_AUTO};
    overrides[r->effect] = r->override;
    return scene_run(&(struct scene_run){.scene = r->text,
                                         .sensors = room_sensors,
                                         .n_sensors = ROOM_SENSORS,
                                         .technique = r->technique,
                                         .overrides = overrides,
                                         .global = 50000,
                                         .caustic = r->caustic,
                                         .samples = 512,
                                         .folder = r->folder});
}

/*
 * With nothing outside, a ray that leaves needs no test: equal light to the bit, with fewer rays.
 */
static void test_clear_windows(void **state)
{
    static const enum orl_technique techniques[2] = {ORL_TECHNIQUE_GATHER, ORL_TECHNIQUE_BACKWARD};
    (void)state;
    for (int i = 0; i < 2; i++) {
        struct run r = {.text = ROOM_SKY ROOM_SUN ROOM,
                        .technique = techniques[i],
                        .effect = ORL_EFFECT_EXTERIOR};
        struct orl_result planned = run_job(&r);
        r.override = ORL_OVERRIDE_FORCE;
        struct orl_result forced = run_job(&r);
        assert_false(planned.plan.effects[ORL_EFFECT_EXTERIOR].simulated);
        assert_memory_equal(planned.illuminance_lx, forced.illuminance_lx,
                            ROOM_SENSORS * sizeof *forced.illuminance_lx);
        assert_true(planned.health.rays < forced.health.rays);
        print_message("%s: rays of a clear window, planned / forced: %.2f\n",
                      orl_technique_name(techniques[i]),
                      (double)planned.health.rays / (double)forced.health.rays);
        orl_result_done(&planned);
        orl_result_done(&forced);
    }
}

static double sun_w(void)
{
    const double half = 0.5 * 0.533 * ORL_DEG_TO_RAD;
    return 1e6 * 4 * ORL_PI * sin(0.5 * half) * sin(0.5 * half);
}

/*
 * All light that the coin mirrors lands: 45 degrees through a pane of 0.9 per pass, 0.9 mirrored.
 */
static void test_small_mirror(void **state)
{
    const double area = ORL_PI * .007 * .007;
    const double watts = sun_w() * sqrt(.5) * area * oracle_pane(sqrt(.5), 1.52, .9) * .9;
    char folder[64];
    double squares;
    (void)state;
    cli_make_folder(folder);
    struct orl_result result = run_job(&(struct run){.text = ROOM_SKY ROOM_SUN ROOM COIN,
                                                     .technique = ORL_TECHNIQUE_GATHER,
                                                     .caustic = 50000,
                                                     .folder = folder});
    const double flux = scene_map_flux(&result, folder, "caustic", &squares);
    assert_true(result.plan.effects[ORL_EFFECT_CAUSTICS_MIRROR].simulated);
    assert_int_equal(result.maps[1].stored >= 50000, 1);
    print_message("caustic photons emitted for each stored: %.1f\n",
                  (double)result.maps[1].emitted / (double)result.maps[1].stored);
    /* Fluxes differ between the window's cells, by a factor of ten at the rim. */
    if (!(fabs(flux - watts) <= 4 * sqrt(squares) + 0.002 * watts))
        fail_msg("%g W of caustics, not %g, standard error %g", flux, watts, sqrt(squares));
    orl_result_done(&result);
    cli_remove_folder(folder);
}

/* Caustics of one kind, without those of the other. */
static void test_kinds_of_caustics(void **state)
{
    static const char both[] = ROOM_SKY ROOM_SUN ROOM
        "void mirror m 0 0 3 .9 .9 .9\nm polygon q 0 0 12 1.5 1 .01 2.5 1 .01 2.5 1.2 .01 1.5 1.2 "
        ".01\n"
        "void metal s 0 0 5 .8 .8 .8 1 .1\n"
        "s polygon r 0 0 12 1.5 1.3 .01 2.5 1.3 .01 2.5 1.5 .01 1.5 1.5 .01\n";
    static const enum orl_effect skipped[2] = {ORL_EFFECT_CAUSTICS_MIRROR,
                                               ORL_EFFECT_CAUSTICS_BSDF};
    double flux[3], squares;
    (void)state;
    for (int i = 0; i < 3; i++) {
        char folder[64];
        cli_make_folder(folder);
        struct orl_result result =
            run_job(&(struct run){.text = both,
                                  .technique = ORL_TECHNIQUE_GATHER,
                                  .caustic = 50000,
                                  .effect = skipped[i % 2],
                                  .override = i < 2 ? ORL_OVERRIDE_SKIP : ORL_OVERRIDE_AUTO,
                                  .folder = folder});
        flux[i] = scene_map_flux(&result, folder, "caustic", &squares);
        orl_result_done(&result);
        cli_remove_folder(folder);
    }
    /* Light by way of both, from one to the other over the ceiling, is not counted: photons end
     * there. */
    assert_true(flux[0] > 0 && flux[1] > 0);
    assert_true(fabs(flux[0] + flux[1] - flux[2]) < 0.03 * flux[2]);
}

/*
 * A skip against the plan's advice: less light, but no less than the plan's bound; and a warning.
 */
static void test_skips(void **state)
{
    static const struct {
        const char *text;
        enum orl_effect effect;
    } cases[] = {
        {ROOM_SKY ROOM_SUN ROOM, ORL_EFFECT_SUN},
        {ROOM_SKY ROOM_SUN ROOM, ORL_EFFECT_SUNS},
        {ROOM_SKY ROOM_SUN ROOM, ORL_EFFECT_SKY},
        {ROOM_SKY ROOM_SUN ROOM GROUND, ORL_EFFECT_EXTERIOR},
        {ROOM_SKY ROOM_SUN ROOM, ORL_EFFECT_INTERREFLECTION},
        {ROOM_SKY ROOM "void light led 0 0 3 500 500 500\nled sphere s 0 0 4 2 2.6 2.6 .05\n",
         ORL_EFFECT_LAMPS},
    };
    (void)state;
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        struct run r = {.text = cases[k].text,
                        .technique = ORL_TECHNIQUE_BACKWARD,
                        .effect = cases[k].effect,
                        .override = ORL_OVERRIDE_SKIP};
        const char *name = orl_effect_name(cases[k].effect);
        struct orl_result skipped = run_job(&r);
        bool told = false;
        r.override = ORL_OVERRIDE_FORCE;
        struct orl_result forced = run_job(&r);
        const double bound = skipped.plan.effects[cases[k].effect].bound;
        for (size_t i = 0; i < skipped.n_warnings; i++)
            told = told ||
                   (strstr(skipped.warnings[i], "skipping") && strstr(skipped.warnings[i], name));
        if (!told)
            fail_msg("%s: no warning", name);
        for (int i = 0; i < ROOM_SENSORS; i++) {
            const double less = forced.illuminance_lx[i] - skipped.illuminance_lx[i];
            const double se = hypot(forced.standard_error_lx[i], skipped.standard_error_lx[i]);
            if (!(less > -4 * se && less < bound + 4 * se))
                fail_msg("%s, sensor %d: %g lx less, standard error %g, bound %g", name, i, less,
                         se, bound);
        }
        assert_true(forced.illuminance_lx[1] > skipped.illuminance_lx[1]);
        orl_result_done(&skipped);
        orl_result_done(&forced);
    }
}

/* Gloss merged into the diffuse part keeps the light in the room. */
static void test_gloss_keeps_energy(void **state)
{
    static const char glossy[] =
        ROOM_SKY "void plastic w 0 0 5 .5 .5 .5 .1 .2\n" ROOM_CLEAR ROOM_SHELL ROOM_PANE;
    double mean[2] = {0, 0};
    (void)state;
    for (int i = 0; i < 2; i++) {
        struct orl_result result =
            run_job(&(struct run){.text = glossy,
                                  .technique = ORL_TECHNIQUE_BACKWARD,
                                  .effect = ORL_EFFECT_GLOSSY,
                                  .override = i ? ORL_OVERRIDE_FORCE : ORL_OVERRIDE_SKIP});
        for (int k = 0; k < ROOM_SENSORS; k++)
            mean[i] += result.illuminance_lx[k] / ROOM_SENSORS;
        orl_result_done(&result);
    }
    /*
     * A tenth of the reflected tenth goes elsewhere: some per cent at a sensor, less in the mean.
     */
    assert_true(fabs(mean[0] - mean[1]) < 0.05 * mean[1]);
}

/* Red walls made gray: as bright by one reflection, and gray all over. */
static void test_bleached(void **state)
{
    static const char red[] =
        ROOM_SKY "void plastic w 0 0 5 .6 .2 .2 0 0\n" ROOM_CLEAR ROOM_SHELL ROOM_PANE;
    struct orl_result result[2];
    (void)state;
    for (int i = 0; i < 2; i++)
        result[i] = run_job(&(struct run){.text = red,
                                          .technique = ORL_TECHNIQUE_BACKWARD,
                                          .effect = ORL_EFFECT_COLOR,
                                          .override = i ? ORL_OVERRIDE_FORCE : ORL_OVERRIDE_SKIP});
    for (int k = 0; k < ROOM_SENSORS; k++) {
        const double off = fabs(result[0].illuminance_lx[k] - result[1].illuminance_lx[k]);
        assert_true(off <=
                    result[0].plan.effects[ORL_EFFECT_COLOR].bound * result[1].illuminance_lx[k]);
    }
    assert_int_equal(result[0].plan.channels, 1);
    assert_int_equal(result[1].plan.channels, 3);
    orl_result_done(&result[0]);
    orl_result_done(&result[1]);
}

/* A sensor list changes no key; an omitted sun does, and an omitted but absent sun does not. */
static void test_keys(void **state)
{
    char folder[64];
    (void)state;
    cli_make_folder(folder);
    struct run r = {.text = ROOM_SKY ROOM_SUN ROOM,
                    .technique = ORL_TECHNIQUE_GATHER,
                    .effect = ORL_EFFECT_GLOSSY,
                    .folder = folder};
    struct orl_result first = run_job(&r);
    r.override = ORL_OVERRIDE_FORCE; /* an effect that the scene lacks */
    struct orl_result second = run_job(&r);
    r.effect = ORL_EFFECT_SUN;
    r.override = ORL_OVERRIDE_SKIP;
    struct orl_result third = run_job(&r);
    assert_true(!first.maps[0].cached && second.maps[0].cached && !third.maps[0].cached);
    assert_string_equal(first.maps[0].key, second.maps[0].key);
    assert_string_not_equal(first.maps[0].key, third.maps[0].key);
    orl_result_done(&first);
    orl_result_done(&second);
    orl_result_done(&third);
    cli_remove_folder(folder);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_clear_windows),
        cmocka_unit_test(test_small_mirror),
        cmocka_unit_test(test_kinds_of_caustics),
        cmocka_unit_test(test_skips),
        cmocka_unit_test(test_gloss_keeps_energy),
        cmocka_unit_test(test_bleached),
        cmocka_unit_test(test_keys),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
