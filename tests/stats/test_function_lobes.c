/*
 * Lobes by functions and data: samples against pdfs and values, shares against quadratures, values
 * against rtrace's, and the refusals and warnings.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <stdio.h>
#include <string.h>

#include "base/sampling/sampling.h"
#include "scene/material/kinds.h"
#include "scene/material/scatter.h"
#include "support/scene_text.h"
#include "support/subject.h"

/*
 * A power-cosine lobe about the mirrored or the straight direction, brighter towards the light's
 * x; not reciprocal. Its normalisation without that factor is (n + 1) / 2 pi, and it has no
 * cosine.
 */
static const char functions[] =
    "n = 8; pow(x,y) : if(x, x^y, 0);\n"
    "mx = Dx + 2*RdotP*NxP; my = Dy + 2*RdotP*NyP; mz = Dz + 2*RdotP*NzP;\n"
    "up(x,y,z) = x*NxP + y*NyP + z*NzP;\n"
    "lobe(x,y,z,o) = (n + 1)/(2*PI) * (1 + .3*x) *\n"
    "  if(up(x,y,z), pow(x*mx + y*my + z*mz, n), pow(x*Dx + y*Dy + z*Dz, n));\n"
    "lean(v,x,y,z,o) = v*(1 + .2*y); cosine(x,y,z,o) = abs(up(x,y,z)); side(x) = x;\n"
    "abs(x) : if(x, x, -x);\n"
    "red(x,y,z,o) = .3*lobe(x,y,z,o); green(x,y,z) = .1*(1 + .5*(x*Nx + y*Ny + z*Nz));\n";

#define METFUNC "void metfunc m 2 lobe l.cal 0 4 .8 .6 .4 .5\n"
#define TRANSFUNC "void transfunc m 2 lobe l.cal 0 6 .9 .8 .7 .2 .6 .7\n"
/* Each channel has its own function; green differs between the front and the back. */
#define BRTDFUNC                                                                                   \
    "void BRTDfunc m 10 0 0 0 0 0 0 red green 0 l.cal 0 9 .2 .15 .1 .3 .2 .05 .12 .1 .08\n"

static const double angles[] = {0, 40, 75, 130};
enum { ANGLES = sizeof angles / sizeof *angles };

static struct orl_vec3 above(struct orl_vec3 axis, int i, int side)
{
    const int row = i / side, column = i % side;
    return orl_hemisphere_about(axis, (column + .5) / side, (row + .5) / side);
}

/*
 * Checks samples against values. The mean weight is the integral of f by 64 x 64 midpoints a side,
 * with an error below 0.5 % where f has a crease. The pdf integrates to 1, exactly, because the
 * midpoints divide the cells. The variance of DRAWS samples is known. The albedo, used for Russian
 * roulette, is the sum over the midpoints of the cells that sampling uses.
 */
static void check_material(const char *text)
{
    enum { SIDE = 64, COARSE = 16, CELLS = 8, DRAWS = 4000 };
    struct subject s = subject_of(text, "l.cal", functions);
    for (int k = 0; k < 2 * ANGLES; k++) {
        const enum orl_transport transport = k & 1 ? ORL_TRANSPORT_EYE : ORL_TRANSPORT_LIGHT;
        const struct orl_vec3 from = subject_direction(&s, angles[k / 2], 20 + 37 * k);
        double f = 0, pdf = 0, sum = 0, squares = 0, drawn = 0, by_cells = 0;
        for (int side = 0; side < 2; side++) {
            const struct orl_vec3 axis = side ? orl_neg(s.hit.normal) : s.hit.normal;
            for (int i = 0; i < SIDE * SIDE; i++) {
                const struct orl_vec3 to = above(axis, i, SIDE);
                f += ORL_PI / (SIDE * SIDE) *
                     (k & 1 ? orl_material_eval_lobes(s.material, &s.hit, to, from)
                            : orl_material_eval_lobes(s.material, &s.hit, from, to))
                         .g;
            }
            for (int i = 0; i < CELLS * CELLS; i++)
                by_cells +=
                    ORL_PI / (CELLS * CELLS) *
                    orl_material_eval_lobes(s.material, &s.hit, from, above(axis, i, CELLS)).g;
            for (int i = 0; i < COARSE * COARSE; i++) {
                const struct orl_vec3 to = above(axis, i, COARSE);
                pdf += ORL_PI / (COARSE * COARSE) / fabs(orl_dot(to, axis)) *
                       orl_material_pdf(s.material, &s.hit, from, transport, ORL_LOBE_ALL, to);
            }
        }
        for (int i = 0; i < DRAWS; i++) {
            struct orl_random random =
                orl_random_stream((uint64_t)k, ORL_PURPOSE_BENCH, (uint64_t)i);
            const struct orl_surface_sample d =
                orl_material_sample(s.material, &s.hit, from, transport, ORL_LOBE_ALL, &random);
            const double w = d.event == ORL_EVENT_GLOSSY ? d.weight.g : 0;
            sum += w / DRAWS;
            squares += w * w / DRAWS;
            drawn += d.event != ORL_EVENT_ABSORBED;
        }
        const double noise = 4 * sqrt((squares - sum * sum) / DRAWS);
        if (!(fabs(sum - f) < noise + .005 * f))
            fail_msg("case %d: draws %g +- %g, integral %g", k, sum, noise / 4, f);
        assert_true(fabs(pdf - 1) < 1e-9 && drawn > .9 * DRAWS);
        const double all =
            orl_material_albedo(s.material, &s.hit, from,
                                (enum orl_lobes)(ORL_LOBE_REFLECTED | ORL_LOBE_TRANSMITTED))
                .g;
        assert_true(fabs(all - by_cells) < 1e-9);
    }
    subject_done(&s);
}

static void test_metfunc(void **state)
{
    (void)state;
    check_material(METFUNC);
}

static void test_transfunc(void **state)
{
    (void)state;
    check_material(TRANSFUNC);
}

static void test_brtdfunc(void **state)
{
    (void)state;
    check_material(BRTDFUNC);
}

/* All parts of BRTDfunc: mirrored, straight, lobes, and diffuse under a pattern. */
static void test_parts(void **state)
{
    struct subject s = subject_of("void colorfunc p 4 .9 .8 .7 . 0 0\np BRTDfunc m 10 .1 .1 .05 .1 "
                                  ".2 .1 red green 0 l.cal 0 9 .2 .1 .1 .1 .1 .1 .05 .05 .05\n",
                                  "l.cal", functions);
    const struct orl_vec3 n = s.hit.normal, back = orl_neg(n);
    (void)state;
    assert_int_equal(s.material->kind, ORL_MATERIAL_MIXTURE);
    assert_true(fabs(orl_material_diffuse(s.material, &s.hit).r - .9 * .2) < 1e-12);
    assert_true(fabs(orl_material_mirrored(s.material, &s.hit, n).b - .05) < 1e-12);
    assert_true(fabs(orl_material_straight(s.material, &s.hit, n).g - .2) < 1e-12);
    assert_true(fabs(orl_material_eval_lobes(s.material, &s.hit, n, n).g - .15) < 1e-12);
    assert_true(fabs(orl_material_eval_lobes(s.material, &s.hit, back, n).g -
                     (.05 + .8 * .05 / ORL_PI)) < 1e-12);
    subject_done(&s);
}

/* Shares are those of trans: the diffuse share on each side, and tints. */
static void test_shares(void **state)
{
    struct subject s = subject_of(TRANSFUNC, "l.cal", functions);
    const struct orl_vec3 n = s.hit.normal, back = orl_neg(n);
    (void)state;
    assert_true(fabs(orl_material_diffuse(s.material, &s.hit).r - .9 * .8 * .4) < 1e-12);
    const double lobe = 9 / (2 * ORL_PI); /* at the lobe's middle, without the factor 1 + .3 x */
    const double mirrored = orl_material_eval_lobes(s.material, &s.hit, n, n).g;
    assert_true(fabs(mirrored - .2 * lobe * (1 + .3 * n.x)) < 1e-9);
    const double through = orl_material_eval_lobes(s.material, &s.hit, back, n).g;
    assert_true(fabs(through - (.8 * .8 * .6 * .3 / ORL_PI +
                                .8 * .8 * .6 * .7 * lobe * (1 + .3 * back.x))) < 1e-9);
    subject_done(&s);
}

/*
 * Values of rtrace from 200 directions over a plane, lit by a sun of .05 degrees from five: sums
 * by channel, and by cos(i), to the printed digits.
 */
enum { SUNS = 5, EYES = 200 };
struct values {
    const char *text, *resource, *content;
    double side; /* side of the eyes: 1 in front, -1 behind */
    double sums[SUNS][6];
};
static const struct values traced[] = {
    {METFUNC,
     "l.cal",
     functions,
     1,
     {{63.9274301, 47.9455738, 31.9637157, 1.03738489, 0.778038617, 0.51869267},
      {50.047686, 37.5357666, 25.0238432, -1.04868183, -0.786510881, -0.524340792},
      {40.5406203, 30.405467, 20.2703097, -1.23843527, -0.928826351, -0.619217333},
      {0},
      {0}}},
    {TRANSFUNC,
     "l.cal",
     functions,
     1,
     {{37.5659685, 35.5287869, 33.491601, 0.503486138, 0.509015812, 0.514545419},
      {30.6260961, 28.5889146, 26.55173, -0.539547458, -0.534017553, -0.528487458},
      {25.8725639, 23.8353817, 21.798196, -0.634424304, -0.628894086, -0.62336489},
      {36.2182391, 32.1939918, 28.169741, 0.637358015, 0.566540698, 0.495723023},
      {25.5216888, 22.6859474, 19.8502023, 0.255786278, 0.227365772, 0.198944857}}},
    {"void transdata m 5 noop l.dat . Ldz Ldx 0 9 .8 .6 .4 .25 .5 .6 0 1 0\n",
     "l.dat",
     "2 -1 1 5 -1 1 5 .1 .12 .14 .16 .18 .2 .22 .24 .26 .28 .3 .32 .34 .36 .38 .4 .42 .44 .46 .48 "
     ".5 .52 .54 .56 .58",
     1,
     {{45.8820928, 41.1074439, 36.3327949, -0.124540937, -0.111580777, -0.0986206171},
      {44.742167, 39.967503, 35.1928629, -0.121446757, -0.108486557, -0.0955264209},
      {40.8119197, 36.0372679, 31.2626161, -0.110778615, -0.0978184478, -0.0848582803},
      {13.4264039, 10.0698012, 6.71320195, -0.0364442164, -0.0273331575, -0.0182221082},
      {13.721742, 10.2913055, 6.86086893, -0.0372458731, -0.027934402, -0.0186229309}}},
    {BRTDFUNC,
     "l.cal",
     functions,
     1,
     {{41.5793744, 38.9565147, 6.36619863, 0.795318297, -0.105742361, -0.0172802131},
      {31.1695664, 37.9820429, 6.36619874, -0.769230695, -0.103097285, -0.0172802134},
      {24.0392668, 35.75104, 6.36619701, -0.911545688, -0.0970415195, -0.0172802087},
      {35.385119, 16.8315722, 5.09295977, 0.633780971, -0.0456871002, -0.0138241728},
      {24.7734636, 18.3483614, 5.09295639, 0.255237368, -0.049804226, -0.0138241636}}},
    {BRTDFUNC,
     "l.cal",
     functions,
     -1,
     {{47.9455728, 23.3251866, 3.18309896, 0.778038834, -0.0633131667, -0.00864010558},
      {37.5357662, 24.2996534, 3.18309937, -0.786510923, -0.0659582292, -0.00864010669},
      {30.4054667, 26.5306618, 3.18309905, -0.92882598, -0.0720140096, -0.00864010581},
      {35.385119, 35.9008095, 5.09295977, 0.633780971, -0.0974480493, -0.0138241728},
      {24.7734636, 34.3840387, 5.09295639, 0.255237368, -0.0933309736, -0.0138241636}}}};

static void test_rtrace(void **state)
{
    static const double suns[SUNS][3] = {
        {.3, .2, 1}, {-.5, .1, .8}, {.2, -.6, .5}, {.1, .3, -1}, {-.4, -.2, -.6}};
    static const double step[] = {0.8191725133961645, 0.6710436067037893};
    (void)state;
    for (size_t k = 0; k < sizeof traced / sizeof *traced; k++) {
        struct subject s = subject_of(traced[k].text, traced[k].resource, traced[k].content);
        const struct orl_hit hit = {.normal = {0, 0, traced[k].side}, .front = traced[k].side > 0};
        for (int sun = 0; sun < SUNS; sun++) {
            const struct orl_vec3 light =
                orl_normalize(orl_v3(suns[sun][0], suns[sun][1], suns[sun][2]));
            double sums[6] = {0};
            for (int i = 0; i < EYES; i++) {
                const double x = (fmod(i * step[0], 1) - .5) * 1.6,
                             y = (fmod(i * step[1], 1) - .5) * 1.6;
                const struct orl_vec3 eye = orl_normalize(orl_v3(-x, -y, 1));
                struct orl_rgb f = orl_material_eval_lobes(s.material, &hit, light, eye);
                if (light.z > 0)
                    f = orl_rgb_add(
                        f, orl_rgb_scale(orl_material_diffuse(s.material, &hit), 1 / ORL_PI));
                const double channels[] = {f.r, f.g, f.b};
                for (int c = 0; c < 3; c++) {
                    sums[c] += channels[c];
                    sums[3 + c] += channels[c] * cos(i);
                }
            }
            for (int c = 0; c < 6; c++)
                if (!(fabs(sums[c] - traced[k].sums[sun][c]) <
                      2e-6 * (10 + fabs(traced[k].sums[sun][c]))))
                    fail_msg("%zu, sun %d, sum %d: %.9g, not %.9g", k, sun, c, sums[c],
                             traced[k].sums[sun][c]);
        }
        subject_done(&s);
    }
}

static void test_refused(void **state)
{
    static const struct {
        const char *text, *says;
    } cases[] = {
        {"void plasfunc m 2 4 . 0 4 .5 .5 .5 .5\n", "more than 1"},
        {"void BRTDfunc m 10 0 0 0 0 0 0 .2 .2 .2 . 0 9 .4 .4 .4 .4 .4 .4 0 0 0\n", "more than 1"},
        {"void plasfunc p 2 4 . 0 4 .5 .5 .5 .5\nvoid mixfunc m 4 p void .5 . 0 0\n",
         "more than 1"},
        {"void WGMDfunc m 13 void .5 0 0 void .2 0 0 void 0 0 1 . 0 9 .5 .5 .5 .5 .5 .5 0 0 0\n",
         "more than 1"},
        {"void plasfunc m 2 .1 . 0 3 .5 .5 .5\n", "takes at least 4 numbers"},
        {"void transfunc m 2 .1 . 0 5 .5 .5 .5 0 0\n", "takes at least 6 numbers"},
        {"void metfunc m 2 T . 0 4 .5 .5 .5 .5\n", "uses T"},
        {"void metdata m 3 cosine gone.dat . 0 4 .5 .5 .5 .5\n", "gone.dat"},
    };
    static const struct orl_sensor sensor = {{2, 2, 1}, {0, 0, 1}};
    (void)state;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char text[1024];
        struct orl_error err = {0};
        snprintf(text, sizeof text, "%sm sphere s 0 0 4 0 0 0 1\n", cases[i].text);
        const struct scene_run run = {.scene = text, .sensors = &sensor, .n_sensors = 1};
        assert_int_not_equal(scene_run_fails(&run, &err), 0);
        if (!strstr(err.message, cases[i].says))
            fail_msg("case %zu: %s", i, err.message);
    }
}

/* A job with an accuracy goal is refused if a lobe is only one degree wide. */
static void test_narrow(void **state)
{
    static const struct orl_sensor sensor = {{0, 0, 2}, {0, 0, -1}};
    const struct scene_run run = {
        .scene = "void metfunc m 2 lobe l.cal 0 4 .8 .6 .4 .5\nm polygon p 0 0 12 -9 -9 0 9 -9 0 "
                 "9 9 0 -9 9 0\nvoid glow g 0 0 4 1 1 1 0\ng source s 0 0 4 0 0 1 360\n",
        .resource_name = "l.cal",
        .resource_text =
            "m(x,y,z) = x*(Dx + 2*RdotP*NxP) + y*(Dy + 2*RdotP*NyP) + z*(Dz + 2*RdotP*NzP);\n"
            "lobe(x,y,z,o) = if(m(x,y,z) - .9995, 100, 0);",
        .sensors = &sensor,
        .n_sensors = 1,
        .goal = {.relative_error = .1, .at = .95}};
    struct orl_error err = {0};
    (void)state;
    if (scene_run_fails(&run, &err) != ORL_ERR_UNSUPPORTED || !strstr(err.message, "accuracy goal"))
        fail_msg("%s", err.message);
}

int main(void)
{
    static const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_metfunc),  cmocka_unit_test(test_transfunc),
        cmocka_unit_test(test_brtdfunc), cmocka_unit_test(test_parts),
        cmocka_unit_test(test_shares),   cmocka_unit_test(test_rtrace),
        cmocka_unit_test(test_refused),  cmocka_unit_test(test_narrow),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
