/* `oriel glare` from a script's view: a picture of one bright square on a darker ground. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>
#include <jansson.h>

#include "support/cli.h"

enum { SIDE = 100, FROM = 60, TO = 66 };

static struct cli_result result;
static char folder[64], picture[128];

/* RGBE of 4 or 64 W/sr/m2: 179 times that, plus half a step. */
static int set_up(void **state)
{
    static const unsigned char dark[4] = {128, 128, 128, 131}, bright[4] = {128, 128, 128, 135};
    (void)state;
    cli_make_folder(folder);
    snprintf(picture, sizeof picture, "%s/eye.hdr", folder);
    FILE *file = fopen(picture, "wb");
    assert_non_null(file);
    fprintf(file, "#?RADIANCE\nVIEW= -vta -vh 180 -vv 180\nFORMAT=32-bit_rle_rgbe\n\n-Y %d +X %d\n",
            SIDE, SIDE);
    for (int y = 0; y < SIDE; y++)
        for (int x = 0; x < SIDE; x++) {
            const bool inside = x >= FROM && x < TO && y >= FROM && y < TO;
            fwrite(inside ? bright : dark, 1, 4, file);
        }
    assert_int_equal(fclose(file), 0);
    return 0;
}

static int tear_down(void **state)
{
    (void)state;
    cli_remove_folder(folder);
    return 0;
}

static void run_glare(const char *a, const char *b, const char *c)
{
    const char *const args[] = {"glare", picture, a, b, c, NULL};
    cli_run(args, &result);
}

static double number(const json_t *json, const char *a, const char *b, const char *c)
{
    const json_t *value = json_object_get(json_object_get(json_object_get(json, a), b), c);
    assert_true(json_is_number(value));
    return json_number_value(value);
}

static void test_numbers(void **state)
{
    (void)state;
    run_glare("--json", NULL, NULL);
    assert_int_equal(result.exit_code, 0);
    assert_string_equal(result.err, "");
    json_t *json = json_loads(result.out, 0, NULL);
    assert_non_null(json);
    const json_t *sources = json_object_get(json, "sources"), *one = json_array_get(sources, 0);
    assert_int_equal(json_array_size(sources), 1);
    assert_int_equal(json_integer_value(json_object_get(one, "pixels")), 36);
    const double bright = 64 * 179 * 128.5 / 128, dark = 4 * 179 * 128.5 / 128;
    const double found = json_number_value(json_object_get(one, "luminance_cd_m2"));
    assert_true(fabs(found / bright - 1) < 1e-5);
    /* pi times the ground's luminance, plus the excess of the square. */
    const double sr = json_number_value(json_object_get(one, "solid_angle_sr"));
    const double off = json_number_value(json_object_get(one, "angle_deg")) * acos(-1) / 180;
    const double wanted = acos(-1) * dark + (bright - dark) * sr * cos(off);
    const double lx = number(json, "metrics", "vertical_illuminance_lx", "value");
    assert_true(fabs(lx / wanted - 1) < 2e-3);
    json_decref(json);
}

static void test_table_and_options(void **state)
{
    (void)state;
    run_glare("--detail", "-b", "20000");
    assert_int_equal(result.exit_code, 0);
    assert_non_null(strstr(result.out, "0 above 20000 cd/m2"));
    run_glare("--task", "50.5,20.5,0.5", NULL);
    assert_non_null(strstr(result.out, "1 above 3593.98"));
    run_glare("-A", picture, NULL);
    assert_non_null(strstr(result.out, "mask: "));
}

static void test_mistakes(void **state)
{
    const char *const missing[] = {"glare", "nowhere.hdr", NULL};
    (void)state;
    run_glare("--task", "1,2", NULL);
    assert_int_equal(result.exit_code, 2);
    run_glare("--radius", "9", NULL);
    assert_int_equal(result.exit_code, 1);
    assert_non_null(strstr(result.err, "radius_rad"));
    cli_run(missing, &result);
    assert_int_equal(result.exit_code, 1);
    run_glare("--view", "-vtl -vh 2 -vv 2", NULL);
    assert_int_equal(result.exit_code, 1);
    assert_non_null(strstr(result.err, "not a parallel one"));
}

/* Runs a job's view of that many pixels per side, with the picture as its mask. */
static void run_job(int side)
{
    char job[128], out[128], text[1024];
    const char *const args[] = {"run", job, "-o", out, NULL};
    snprintf(job, sizeof job, "%s/job.json", folder);
    snprintf(out, sizeof out, "%s/out", folder);
    snprintf(
        text, sizeof text,
        "{\"scene\":{\"files\":[\"sky.rad\"]},\"technique\":\"backward\",\"pixel_samples\":2,"
        "\"views\":"
        "[{\"name\":\"v\",\"view\":\"-vta -vd 0 1 0 -vh 180 -vv 180\",\"width\":%d,\"height\":%d,"
        "\"metrics\":[\"dgp\"],\"glare\":{\"mask\":\"eye.hdr\",\"band_rad\":0.2}}]}",
        side, side);
    cli_write_file(folder, "sky.rad", "void glow g 0 0 4 10 10 10 0\ng source s 0 0 4 0 0 1 360\n");
    cli_write_file(folder, "job.json", text);
    cli_run(args, &result);
}

/* A uniform sky is equally bright in a mask and in a band; the mask is above 0.1 everywhere. */
static void test_mask_of_a_job(void **state)
{
    static const char *const parts[] = {"mask", "band"};
    char path[128];
    (void)state;
    run_job(SIDE);
    if (result.exit_code != 0)
        fail_msg("%s", result.err);
    snprintf(path, sizeof path, "%s/out/result.json", folder);
    json_t *json = json_load_file(path, 0, NULL);
    const json_t *view = json_array_get(json_object_get(json, "views"), 0);
    for (int i = 0; i < 2; i++) {
        assert_true(fabs(number(view, "glare", parts[i], "mean_cd_m2") / 1790 - 1) < 1e-6);
        assert_true(number(view, "glare", parts[i], "least_cd_m2") > 1789);
    }
    const double all = number(view, "glare", "mask", "pixels");
    assert_true(all > 0.9 * SIDE * SIDE * 0.785 && all <= SIDE * SIDE);
    assert_true(number(view, "glare", "band", "pixels") < all / 2);
    json_decref(json);
    run_job(SIDE / 2); /* the mask does not fit */
    assert_int_equal(result.exit_code, 1);
    assert_non_null(strstr(result.err, "the mask has 100 x 100 pixels"));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_numbers), cmocka_unit_test(test_table_and_options),
        cmocka_unit_test(test_mistakes), cmocka_unit_test(test_mask_of_a_job)};
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
