/* Results without any light are an error, unless the job expects them or it is night; some dark
 * places are a warning. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <string.h>

#include "support/room.h"
#include "support/techniques.h"

/* A box without a window in daylight, with a hull around it. */
#define BOX "!genbox w box 2 2 2 -i\n!genbox w hull 2.2 2.2 2.2 | xform -t -.1 -.1 -.1\n"

static const struct orl_sensor inside_and_out[2] = {{{1, 1, 1}, {0, 0, 1}}, {{1, 1, 9}, {0, 0, 1}}};

static struct scene_run box(const char *scene, enum orl_technique technique, size_t n_sensors)
{
    return (struct scene_run){.scene = scene,
                              .sensors = inside_and_out,
                              .n_sensors = n_sensors,
                              .technique = technique,
                              .dark_is_error = true,
                              .samples = 64,
                              .global = 2000};
}

static bool warned(const struct orl_result *result, const char *words)
{
    for (size_t i = 0; i < result->n_warnings; i++)
        if (strstr(result->warnings[i], words))
            return true;
    return false;
}

static void all_dark(void **state)
{
    static const struct {
        const char *scene, *why;
    } cases[] = {{ROOM_SKY ROOM_SUN ROOM_GREY BOX, "none of the scene's light reaches them"},
                 {ROOM_GREY BOX, "the scene has no simulated light"}};
    for (size_t i = 0; i < 2; i++) {
        struct scene_run run = box(cases[i].scene, of_technique(state), 1);
        struct orl_error err = {0};
        assert_int_equal(scene_run_fails(&run, &err), ORL_ERR_UNLIT);
        assert_non_null(strstr(err.message, "the only sensor is at 0 lx"));
        assert_non_null(strstr(err.message, cases[i].why));
        assert_non_null(strstr(err.hint, "\"dark\": \"expected\""));
        run.dark_is_error = false;
        struct orl_result result = scene_run(&run);
        assert_true(result.illuminance_lx[0] == 0);
        orl_result_done(&result);
    }
}

/* One dark sensor of two: the values are kept, with a warning that names the dark one. */
static void some_dark(void **state)
{
    const struct scene_run run = box(ROOM_SKY ROOM_SUN ROOM_GREY BOX, of_technique(state), 2);
    struct orl_result result = scene_run(&run);
    assert_true(result.illuminance_lx[0] == 0 && result.illuminance_lx[1] > 0);
    assert_true(warned(&result, "1 of 2 sensors is at 0 lx, the first is sensors[0]"));
    orl_result_done(&result);
}

/* Black views without sensors are an error, with rounds or without. */
static void black_views(void **state)
{
    for (int in_rounds = 0; in_rounds < 2; in_rounds++) {
        struct scene_run run = box(ROOM_SKY ROOM_GREY BOX, of_technique(state), 0);
        struct orl_error err = {0};
        run.view = "-vtv -vp 1 1 1 -vd 0 1 0";
        run.width = run.height = 8;
        run.pixel_samples = 4;
        if (in_rounds) {
            run.samples = run.pixel_samples = 0;
            run.global = 0;
            run.goal = (struct orl_goal){.deadline_s = 0.2, .at = 0.95};
        }
        if (scene_run_fails(&run, &err) != ORL_ERR_UNLIT)
            fail_msg("%s", err.message);
        assert_non_null(strstr(err.message, "the only view is black"));
    }
}

static void night(void **state)
{
    const struct orl_sky_request sky = {.model = ORL_SKY_BY_PEREZ,
                                        .input = ORL_SKY_NORMAL_W,
                                        .sun_given = true,
                                        .sun_altitude_deg = -20,
                                        .ground_reflectance = 0.2,
                                        .turbidity = 2.45,
                                        .direct_normal_lx = -1};
    struct scene_run run = box(ROOM_GREY BOX, of_technique(state), 2);
    run.sky = &sky;
    struct orl_result result = scene_run(&run);
    assert_true(result.sky_dark);
    assert_true(result.illuminance_lx[0] == 0 && result.illuminance_lx[1] == 0);
    orl_result_done(&result);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        OF_TECHNIQUE(all_dark, GATHER),      OF_TECHNIQUE(all_dark, BACKWARD),
        OF_TECHNIQUE(all_dark, DIRECT),      OF_TECHNIQUE(some_dark, GATHER),
        OF_TECHNIQUE(some_dark, BACKWARD),   OF_TECHNIQUE(black_views, GATHER),
        OF_TECHNIQUE(black_views, BACKWARD), OF_TECHNIQUE(night, GATHER),
        OF_TECHNIQUE(night, BACKWARD),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
