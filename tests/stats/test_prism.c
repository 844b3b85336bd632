/*
 * Prisms: ray directions against Snell's law at the two faces of a wedge, light against eye
 * transport by quadrature, samples against shares, rtrace's values, sunlight through a prism
 * window in closed form, and refusals.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/sampling/sampling.h"
#include "scene/material/function_brdf/function_brdf_check.h"
#include "scene/material/kinds.h"
#include "support/scene_text.h"
#include "support/subject.h"

/*
 * Glass of index A1 with a flat front (+z) and a back tilted by A2 (radians) about x; A3 of the
 * light gets through. Snell's law in vectors, for a face's normal q, outside direction d and
 * inside direction i: the tangent of d is d - (d.q) q, and that of i is n times shorter.
 */
static const char wedge[] =
    "qy = sin(A2); qz = cos(A2); sq(x) : x*x; root(x) = if(x, sqrt(x), 0);\n"
    "fall = if(-Dz, 1, 0);\n" /* enters through the flat front */
    "ix = Dx/A1; iy = Dy/A1; iz = -root(1 - sq(ix) - sq(iy));\n"
    "k = iy*qy + iz*qz; tx = ix; ty = iy - k*qy; tz = iz - k*qz;\n"
    "out = 1 - A1*A1*(tx*tx + ty*ty + tz*tz);\n"
    "ox = A1*tx; oy = A1*ty - root(out)*qy; oz = A1*tz - root(out)*qz;\n"
    "dq = Dy*qy + Dz*qz; ux = Dx/A1; uy = (Dy - dq*qy)/A1; uz = (Dz - dq*qz)/A1;\n"
    "ju = root(1 - ux*ux - uy*uy - uz*uz); jx = ux; jy = uy + ju*qy; jz = uz + ju*qz;\n"
    "up = 1 - A1*A1*(jx*jx + jy*jy);\n"
    "c = A3 * if(fall - .5, if(out, if(-oz, if(-k, 1, 0), 0), 0), if(dq, if(jz, if(up, 1, 0), 0), "
    "0));\n"
    "px = if(fall - .5, ox, A1*jx); py = if(fall - .5, oy, A1*jy);\n"
    "pz = if(fall - .5, oz, root(up));\n"
    "c2 = c*.25;\n";

#define WEDGE "void prism1 m 5 c px py pz w.cal 0 3 1.5 .2 .8\n"

static struct orl_vec3 lit_scene(const struct subject *s, struct orl_vec3 v)
{
    return orl_to_world(&s->frame, v);
}

/* Computes the wedge's outgoing direction in its own frame (front +z). Returns false if there is
 * none. */
static bool by_snell(struct orl_vec3 d, struct orl_vec3 *ret_out)
{
    const double n = 1.5;
    const struct orl_vec3 flat = orl_v3(0, 0, 1), lean = orl_v3(0, sin(.2), cos(.2));
    const struct orl_vec3 faces[2] = {d.z < 0 ? flat : lean, d.z < 0 ? lean : flat};
    for (int i = 0; i < 2; i++) {
        const double ratio = i ? n : 1 / n, across = orl_dot(d, faces[i]);
        const struct orl_vec3 t = orl_scale(orl_madd(d, faces[i], -across), ratio);
        const double left = 1 - orl_dot(t, t);
        if (!(left > 0) || !(across * (ret_out->z = d.z) > 0))
            return false;
        d = orl_madd(t, faces[i], copysign(sqrt(left), across));
    }
    const bool through = d.z * ret_out->z > 0;
    *ret_out = d;
    return through;
}

/* Returns the prism of a text, in its own axes. */
static struct subject prism_of(const char *text)
{
    struct subject s = subject_of(text, "w.cal", wedge);
    s.hit = (struct orl_hit){.normal = {0, 0, 1}, .front = true};
    s.frame = (struct orl_frame){orl_v3(1, 0, 0), orl_v3(0, 1, 0), orl_v3(0, 0, 1)};
    return s;
}

static void test_snell(void **state)
{
    struct subject s = prism_of(WEDGE);
    struct orl_random random = orl_random_stream(1, ORL_PURPOSE_PILOT, 0);
    int through = 0;
    (void)state;
    assert_int_equal(s.material->kind, ORL_MATERIAL_PRISM);
    for (int i = 0; i < 2000; i++) {
        const double z = 2 * orl_random_uniform(&random) - 1, r = sqrt(1 - z * z);
        const double phi = 2 * ORL_PI * orl_random_uniform(&random);
        const struct orl_vec3 ray = orl_v3(r * cos(phi), r * sin(phi), z);
        struct orl_vec3 out;
        struct orl_surface_sample prism_rays[ORL_PRISM_RAYS];
        const bool expected = by_snell(ray, &out);
        const int n = orl_prism_deviated_rays(s.material, &s.hit, orl_neg(ray), ORL_TRANSPORT_EYE,
                                              prism_rays);
        assert_int_equal(n, expected ? 1 : 0);
        if (!expected)
            continue;
        through++;
        assert_true(orl_length(orl_sub(out, prism_rays[0].direction)) < 1e-9);
        assert_true(fabs(prism_rays[0].weight.g - .8) < 1e-12 && prism_rays[0].transmitted);
    }
    assert_true(through > 1000);
    subject_done(&s);
}

/* An arbitrary smooth function of both directions. */
static double seen_by(struct orl_vec3 light, struct orl_vec3 eye)
{
    return (1 + light.x) * (1.5 + light.y * light.z) * (1 + .5 * eye.y) * (2 - eye.x);
}

/*
 * Eye rays and light rays give the same flux, for uniform radiance weighted by that function.
 * Quadrature: 160 000 midpoints a side over cells of equal projected solid angle; the ends are cut
 * within a cell, an error of 1e-3.
 */
static void test_both_ways(void **state)
{
    enum { SIDE = 400 };
    struct subject s = prism_of(WEDGE);
    (void)state;
    for (int side = 0; side < 2; side++) {
        double sums[2] = {0, 0};
        for (int transport = 0; transport < 2; transport++)
            for (int i = 0; i < SIDE * SIDE; i++) {
                const int row = i / SIDE, column = i % SIDE;
                const double r2 = (row + .5) / SIDE, phi = 2 * ORL_PI * (column + .5) / SIDE;
                const double r = sqrt(r2), z = sqrt(1 - r2);
                /* Light is in front when side is 0, and so the eye is behind. */
                const bool front = (side == 0) == (transport == ORL_TRANSPORT_LIGHT);
                const struct orl_vec3 from = orl_v3(r * cos(phi), r * sin(phi), front ? z : -z);
                struct orl_surface_sample prism_rays[ORL_PRISM_RAYS];
                const int n = orl_prism_deviated_rays(s.material, &s.hit, from,
                                                      (enum orl_transport)transport, prism_rays);
                if (n == 1)
                    sums[transport] +=
                        prism_rays[0].weight.r * (transport == ORL_TRANSPORT_LIGHT
                                                      ? seen_by(from, prism_rays[0].direction)
                                                      : seen_by(prism_rays[0].direction, from));
            }
        if (!(fabs(sums[0] / sums[1] - 1) < 2e-3))
            fail_msg("side %d: %g by light, %g by eyes", side, sums[0], sums[1]);
    }
    subject_done(&s);
}

/* A prism with two outgoing rays: samples choose by their shares, and have equal weights. */
static void test_two_ways(void **state)
{
    struct subject s = prism_of("void prism2 m 9 c2 px py pz .5 Dx Dy Dz w.cal 0 3 1.5 .2 .8\n");
    const struct orl_vec3 from = lit_scene(&s, orl_normalize(orl_v3(.1, -.2, 1)));
    struct orl_surface_sample prism_rays[ORL_PRISM_RAYS];
    int first = 0;
    (void)state;
    assert_int_equal(
        orl_prism_deviated_rays(s.material, &s.hit, from, ORL_TRANSPORT_EYE, prism_rays), 2);
    for (int i = 0; i < 10000; i++) {
        const double u[3] = {.5, .5, (i + .5) / 10000};
        const struct orl_surface_sample d =
            orl_material_sample_at(s.material, &s.hit, from, ORL_TRANSPORT_EYE, ORL_LOBE_ALL, u);
        assert_int_equal(d.event, ORL_EVENT_REFRACTED);
        assert_true(fabs(d.weight.b - .7) < 1e-12);
        first += orl_length(orl_sub(d.direction, prism_rays[0].direction)) < 1e-12;
    }
    assert_true(abs(first - 2857) <= 1); /* .2 of .7 */
    subject_done(&s);
}

#define ROOM                                                                                       \
    "void plastic b 0 0 5 0 0 0 0 0\n"                                                             \
    "b polygon f 0 0 12 0 0 0 0 4 0 4 4 0 4 0 0\nb polygon w 0 0 12 0 0 0 0 0 3 0 4 3 0 4 0\n"     \
    "b polygon e 0 0 12 4 0 0 4 4 0 4 4 3 4 0 3\nb polygon s 0 0 12 0 0 0 4 0 0 4 0 3 0 0 3\n"     \
    "b polygon n 0 0 12 0 4 0 0 4 3 4 4 3 4 4 0\n"

/*
 * Sun from above through a skylight made of the wedge. Across its deflected beam the irradiance is
 * that of the sun times the share and the stretch of solid angles, by differences of Snell's law;
 * on the floor also times the cosine. 300 000 photons, of which some 600 contribute to a sensor,
 * uniformly; the disc is 0.5 degrees.
 */
static void test_sun(void **state)
{
    static const struct orl_sensor sensors[] = {{{2, 2.2, 0}, {0, 0, 1}},
                                                {{3.6, 3.6, 0}, {0, 0, 1}}};
    static const char scene[] = ROOM WEDGE
        "m polygon skylight 0 0 12 1 1 3 3 1 3 3 3 3 1 3 3\n"
        "b polygon ceiling 0 0 30 0 0 3 4 0 3 4 4 3 0 4 3 0 0 3 1 1 3 1 3 3 3 3 3 3 1 3 1 1 3\n"
        "void light l 0 0 3 1e6 1e6 1e6\nl source sun 0 0 4 .1 .2 1 .533\n";
    const struct orl_vec3 ray = orl_normalize(orl_v3(-.1, -.2, -1));
    const struct orl_frame frame = orl_frame_about(ray);
    const double h = 1e-5, half = .533 / 2 * ORL_PI / 180;
    struct orl_vec3 out, slopes[2];
    double lx[2];
    (void)state;
    assert_true(by_snell(ray, &out));
    for (int axis = 0; axis < 2; axis++) {
        struct orl_vec3 ends[2];
        for (int k = 0; k < 2; k++)
            assert_true(by_snell(orl_normalize(orl_madd(ray, axis ? frame.v : frame.u, k ? h : -h)),
                                 &ends[k]));
        slopes[axis] = orl_scale(orl_sub(ends[1], ends[0]), .5 / h);
    }
    const double stretch = orl_length(orl_cross(slopes[0], slopes[1]));
    const double sun = 179 * 1e6 * 2 * ORL_PI * (1 - cos(half));
    const double expected = sun * .8 * stretch * -out.z;
    const struct scene_run run = {.scene = scene,
                                  .resource_name = "w.cal",
                                  .resource_text = wedge,
                                  .sensors = sensors,
                                  .n_sensors = 2,
                                  .caustic = 300000,
                                  .technique = ORL_TECHNIQUE_GATHER};
    scene_run_lx(&run, lx);
    if (!(fabs(lx[0] / expected - 1) < .02))
        fail_msg("%g lx, not %g", lx[0], expected);
    assert_true(lx[1] < .01 * expected); /* the beam does not reach this sensor */
}

static void test_refused(void **state)
{
    static const struct {
        const char *prism, *says;
    } cases[] = {
        {"void prism1 m 5 .5 Dx Dy Dz-.2 . 0 0\n", "not reversible"},
        {"void prism1 m 5 1.5 Dx Dy Dz . 0 0\n", "more than 1"},
        {"void prism1 m 5 .5 DxA Dy Dz . 0 0\n", "DxA"},
        {"void prism2 m 5 .5 Dx Dy Dz . 0 0\n", "8 expressions"},
    };
    static const struct orl_sensor sensor = {{2, 2, 1}, {0, 0, 1}};
    (void)state;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char text[4096];
        struct orl_error err = {0};
        snprintf(text, sizeof text, ROOM "%sm polygon p 0 0 12 1 1 3 3 1 3 3 3 3 1 3 3\n",
                 cases[i].prism);
        const struct scene_run run = {.scene = text, .sensors = &sensor, .n_sensors = 1};
        assert_int_not_equal(scene_run_fails(&run, &err), 0);
        if (!strstr(err.message, cases[i].says))
            fail_msg("case %zu: %s", i, err.message);
    }
}

int main(void)
{
    static const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_snell),    cmocka_unit_test(test_both_ways),
        cmocka_unit_test(test_two_ways), cmocka_unit_test(test_sun),
        cmocka_unit_test(test_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
