/*
 * Lamps seen through a BSDF's lobes, by shadow rays and by BSDF samples with MIS. Compared with an
 * integral over panel and lamp of the values in the file, in a black room, so that no other light
 * reaches the sensors.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#include <cmocka.h>

#include "base/sampling/sampling.h"
#include "fixtures/bsdf_make.h"
#include "support/scene_text.h"

enum { SENSORS = 3, SEEDS = 4, POINTS = 1000000 };

/*
 * A panel of 1.3 m by 0.95 m in the plane y = 0, in a black wall, that faces y; and a lamp of 1.4 m
 * by 0.75 m in the plane y = at, which faces the panel. No sensor sees the lamp itself.
 */
static const char panel[] =
    "void BSDF panel_mat 6 0 pane.xml 0 0 1 . 0 0\n"
    "panel_mat polygon panel 0 0 12 1.35 0 2.2  0.05 0 2.2  0.05 0 3.15  1.35 0 3.15\n"
    "void plastic black 0 0 5 0 0 0 0 0\n"
    "black polygon below 0 0 12 9 0 -9  -9 0 -9  -9 0 2.2  9 0 2.2\n"
    "black polygon above 0 0 12 9 0 3.15  -9 0 3.15  -9 0 9  9 0 9\n"
    "black polygon left 0 0 12 0.05 0 2.2  -9 0 2.2  -9 0 3.15  0.05 0 3.15\n"
    "black polygon right 0 0 12 9 0 2.2  1.35 0 2.2  1.35 0 3.15  9 0 3.15\n"
    "void light shine 0 0 3 100 100 100\n";
static const char lamps[2][128] = {
    "shine polygon lamp 0 0 12 0 1 3.2  1.4 1 3.2  1.4 1 3.95  0 1 3.95\n",
    "shine polygon lamp 0 0 12 0 -1 3.2  0 -1 3.95  1.4 -1 3.95  1.4 -1 3.2\n"};

static const struct orl_sensor sensors[SENSORS] = {
    {{0.7, 0.9, 2}, {0, -1, 0}}, {{0.3, 0.5, 2.2}, {0, -1, 0}}, {{1.5, 0.5, 2.7}, {-0.3, -1, 0}}};

/* World to the panel's frame: z is its normal, y is up. */
static struct orl_vec3 local(struct orl_vec3 d)
{
    return orl_v3(-d.x, d.z, d.y);
}

struct integral {
    double value, standard_error; /* lx */
};

/* Integrates with random points on both. */
static struct integral integrate(const struct orl_bsdf *bsdf, const struct orl_sensor *sensor,
                                 double at)
{
    const double areas = 1.3 * 0.95 * 1.4 * 0.75, radiance = 100;
    struct orl_random random = orl_random_stream(7, ORL_PURPOSE_SENSOR, 1);
    double sum = 0, squares = 0;
    for (int i = 0; i < POINTS; i++) {
        const struct orl_vec3 p = orl_v3(0.05 + 1.3 * orl_random_uniform(&random), 0,
                                         2.2 + 0.95 * orl_random_uniform(&random));
        const struct orl_vec3 q =
            orl_v3(1.4 * orl_random_uniform(&random), at, 3.2 + 0.75 * orl_random_uniform(&random));
        const struct orl_vec3 to_eye = orl_sub(sensor->position, p), to_lamp = orl_sub(q, p);
        const struct orl_vec3 out = orl_normalize(to_eye), in = orl_normalize(to_lamp);
        const double cos_sensor = -orl_dot(out, orl_normalize(sensor->direction));
        if (!(cos_sensor > 0))
            continue;
        const double f = orl_luma(orl_bsdf_eval(bsdf, local(in), local(out)));
        const double value = f * radiance * cos_sensor * fabs(out.y) * in.y * in.y * areas /
                             (orl_dot(to_eye, to_eye) * orl_dot(to_lamp, to_lamp));
        sum += value;
        squares += value * value;
    }
    const double mean = sum / POINTS;
    return (struct integral){ORL_EFFICACY_LM_PER_W * mean,
                             ORL_EFFICACY_LM_PER_W *
                                 sqrt((squares / POINTS - mean * mean) / POINTS)};
}

static void check_lamp(int behind, double most_error)
{
    struct text xml = read_fixture("tests/fixtures/bsdf_lcp8.xml");
    char scene[2048];
    double sum[SENSORS] = {0}, squares[SENSORS] = {0};
    struct orl_bsdf *bsdf = NULL;
    assert_int_equal(orl_bsdf_load_xml("pane.xml", xml.data, xml.size, &bsdf, NULL), 0);
    snprintf(scene, sizeof scene, "%s%s", panel, lamps[behind]);
    for (uint64_t seed = 1; seed <= SEEDS; seed++) {
        struct orl_result r = scene_run(&(struct scene_run){.scene = scene,
                                                            .resource_name = "pane.xml",
                                                            .resource_text = xml.data,
                                                            .sensors = sensors,
                                                            .n_sensors = SENSORS,
                                                            .technique = ORL_TECHNIQUE_BACKWARD,
                                                            .samples = 65536,
                                                            .seed = seed});
        for (int i = 0; i < SENSORS; i++) {
            sum[i] += r.illuminance_lx[i] / SEEDS;
            squares[i] += r.standard_error_lx[i] * r.standard_error_lx[i] / (SEEDS * SEEDS);
        }
        orl_result_done(&r);
    }
    for (int i = 0; i < SENSORS; i++) {
        const struct integral wanted = integrate(bsdf, &sensors[i], behind ? -1 : 1);
        const double se = hypot(sqrt(squares[i]), wanted.standard_error);
        const double off = sum[i] - wanted.value;
        print_message("sensor %d: %.3f, expected %.3f, off by %+.2f standard errors of %.2f %%\n",
                      i, sum[i], wanted.value, off / se, 100 * se / wanted.value);
        assert_true(fabs(off) <= 4 * se && se <= most_error * wanted.value);
    }
    orl_bsdf_unref(bsdf);
    free(xml.data);
}

static void test_reflected(void **state)
{
    (void)state;
    check_lamp(0, 0.03);
}

static void test_transmitted(void **state)
{
    (void)state;
    check_lamp(1, 0.03);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_reflected),
                                       cmocka_unit_test(test_transmitted)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
