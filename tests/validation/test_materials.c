/*
 * Whole jobs with less common materials and lights: a translucent skylight, a shade around a lamp,
 * a solid glass block, a mirror on the floor, spotlights, illums.
 *
 * Rooms reflect 0.1 %: enough for photons to be stored, negligible otherwise, so that illuminances
 * are form factors and the sum of photon fluxes is the incoming flux. Seeds are fixed.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

#include "support/cli.h"
#include "support/hdr.h"
#include "support/scene_text.h"

#define SKY "void glow g 0 0 4 1 1 1 0\ng source sky 0 0 4 0 0 1 360\n"
#define SUN(x, y, z)                                                                               \
    "void light l 0 0 3 1e6 1e6 1e6\nl source sun 0 0 4 " #x " " #y " " #z " .533\n"
#define DARK "void plastic w 0 0 5 .001 .001 .001 0 0\n"
/* 4 x 5 x 3 m, without its southern wall and its ceiling. */
#define WALLS                                                                                      \
    "w polygon floor 0 0 12 0 0 0 4 0 0 4 5 0 0 5 0\n"                                             \
    "w polygon west 0 0 12 0 0 0 0 5 0 0 5 3 0 0 3\n"                                              \
    "w polygon east 0 0 12 4 0 0 4 0 3 4 5 3 4 5 0\n"                                              \
    "w polygon north 0 0 12 0 5 0 4 5 0 4 5 3 0 5 3\n"
#define SOUTH "w polygon south 0 0 12 0 0 0 0 0 3 4 0 3 4 0 0\n"
#define CEILING "w polygon ceiling 0 0 12 0 0 3 0 5 3 4 5 3 4 0 3\n"

static void assert_within(const char *what, double value, double expected, double tolerance)
{
    if (!(fabs(value - expected) <= tolerance))
        fail_msg("%s: %.6g is not within %.2g of %.6g", what, value, tolerance, expected);
}

static double sun_normal_w(void)
{
    const double half = 0.5 * 0.533 * ORL_DEG_TO_RAD;
    return 1e6 * 4 * ORL_PI * sin(0.5 * half) * sin(0.5 * half);
}

enum { MOST_SENSORS = 12, SIDE = 16 };

struct outcome {
    double w[MOST_SENSORS]; /* irradiances, W/m2 */
    double global_w, global_sigma, caustic_w, caustic_sigma;
    double pixels[SIDE * SIDE][3];
    struct orl_health health;
};

static void run_job(struct scene_run job, struct outcome *o)
{
    char folder[64], path[128];
    double squares;
    cli_make_folder(folder);
    job.folder = folder;
    job.global = job.global ? job.global : 100000;
    job.samples = job.samples ? job.samples : 4096;
    job.width = job.height = SIDE;
    job.overrides = scene_wish_maps;
    struct orl_result result = scene_run(&job);
    for (size_t i = 0; i < job.n_sensors; i++)
        o->w[i] = result.illuminance_lx[i] / ORL_EFFICACY_LM_PER_W;
    o->global_w = scene_map_flux(&result, folder, "global", &squares);
    o->global_sigma = sqrt(squares);
    if (job.caustic) {
        o->caustic_w = scene_map_flux(&result, folder, "caustic", &squares);
        o->caustic_sigma = sqrt(squares);
    }
    if (job.view) {
        snprintf(path, sizeof path, "%s/view.hdr", folder);
        hdr_read(path, SIDE, SIDE, o->pixels);
    }
    o->health = result.health;
    orl_result_done(&result);
    cli_remove_folder(folder);
}

/* ---- A translucent skylight ------------------------------------------------------------------ */

/* 2 x 1 m in the middle of the ceiling. */
#define SKYLIGHT                                                                                   \
    DARK WALLS SOUTH                                                                               \
        "w polygon ceiling 0 0 30 0 0 3 0 5 3 4 5 3 4 0 3 0 0 3 "                                  \
        "1 2 3 3 2 3 3 3 3 1 3 3 1 2 3\np polygon pane 0 0 12 1 2 3 1 3 3 3 3 3 3 2 3\n"

enum { UNDER = 5 };
static const struct orl_sensor under[UNDER] = {{{2, 2.5, 0}, {0, 0, 1}},
                                               {{1, 2, 0}, {0, 0, 1}},
                                               {{3, 4, 0}, {0, 0, 1}},
                                               {{0, 2.5, 1}, {1, 0, 0}},
                                               {{2, 2.5, 1.2}, {0, 0, 1}}};

/* Returns the irradiance from the pane at radiance 1, by midpoints. */
static double form(const struct orl_sensor *sensor)
{
    enum { STEPS = 200 };
    double sum = 0;
    for (int i = 0; i < STEPS * STEPS; i++) {
        const struct orl_vec3 at =
            orl_v3(1 + 2 * (i % STEPS + 0.5) / STEPS, 2 + (i / STEPS + 0.5) / STEPS, 3);
        const struct orl_vec3 way = orl_sub(at, sensor->position);
        const double d2 = orl_dot(way, way);
        sum += fmax(orl_dot(way, sensor->direction), 0) * way.z / (d2 * d2);
    }
    return sum * 2 / (STEPS * STEPS);
}

/*
 * Under a sky of radiance 1 the skylight shows tau = A1 (1 - A4) A6 in all directions, and
 * transmits tau pi A. 32768 stratified rays per sensor, of which 2000 or more hit the pane: 1 %.
 */
static void test_skylight_and_sky(void **state)
{
    static const char scene[] = SKY "void trans p 0 0 7 .9 .9 .9 .05 0 .5 0\n" SKYLIGHT;
    const double tau = .9 * .95 * .5, flux = tau * ORL_PI * 2;
    struct outcome o;
    (void)state;
    run_job((struct scene_run){.scene = scene,
                               .sensors = under,
                               .n_sensors = UNDER,
                               .samples = 32768,
                               .view = "-vtv -vp 2 2.5 1 -vd 0 0 1 -vu 0 1 0 -vh 10 -vv 10"},
            &o);
    for (int i = 0; i < UNDER; i++)
        assert_within("sensor", o.w[i], tau * form(&under[i]), 0.01 * tau * form(&under[i]));
    assert_within("flux", o.global_w, flux, 3 * o.global_sigma + 0.001 * flux);
    /* A view from below: all rays through the skylight reach the sky. The tolerance covers 8 bits
     * and a nearly black room. */
    for (int i = 0; i < SIDE * SIDE; i++)
        assert_within("pixel", o.pixels[i][1], tau, 0.01 * tau);
}

/* The sun's light through it is caustic light: a flux of tau E cos A, uniform in all directions. */
static void test_skylight_and_sun(void **state)
{
    const double tau = .45, arrives = sun_normal_w() * .8, flux = tau * arrives * 2;
    struct outcome o;
    double is = 0, should = 0;
    (void)state;
    run_job((struct scene_run){.scene = SUN(0, -.6,
                                            .8) "void trans p 0 0 7 .9 .9 .9 0 0 .5 0\n" SKYLIGHT,
                               .sensors = under,
                               .n_sensors = UNDER,
                               .caustic = 200000},
            &o);
    assert_within("flux", o.caustic_w, flux, 3 * o.caustic_sigma + 0.002 * flux);
    /* Density of some 300 photons, 6 % each; 3 sigma of the mean of five are 8 %. */
    for (int i = 0; i < UNDER; i++) {
        const double expected = tau * arrives / ORL_PI * form(&under[i]);
        assert_within("sensor", o.w[i], expected, 0.2 * expected);
        is += o.w[i];
        should += expected;
    }
    assert_within("sensors", is, should, 0.08 * should);
}

/* Specular transmission of a smooth pane casts a sharp patch: shadow rays pass the pane. */
static void test_skylight_patch(void **state)
{
    /* The sun is 0.6 in the south over 0.8: the patch is 2.25 further north. */
    static const struct orl_sensor sensors[2] = {{{2, 4.75, 0}, {0, 0, 1}}, {{2, 3, 0}, {0, 0, 1}}};
    const double expected = .9 * .5 * sun_normal_w() * .8;
    struct outcome o;
    (void)state;
    run_job((struct scene_run){.scene = SUN(0, -.6,
                                            .8) "void trans p 0 0 7 .9 .9 .9 0 0 .5 1\n" SKYLIGHT,
                               .sensors = sensors,
                               .n_sensors = 2,
                               .caustic = 20000},
            &o);
    assert_within("in the patch", o.w[0], expected, 0.01 * expected);
    assert_within("beside it", o.w[1], 0, 0.005 * expected);
    assert_within("no caustics", o.caustic_w, 0, 0.005 * expected);
}

/*
 * A lamp in a closed shade, which transmits tau of its incident light and reflects rho: (1 + tau) /
 * (1 - rho) of the lamp's flux lands on shade and room in all. The lamp itself, 2 cm in 60, blocks
 * 0.2 % of each of two more bounces.
 */
static void test_lampshade(void **state)
{
    const double flux = 1000 * ORL_PI * 4 * ORL_PI * .02 * .02, expected = flux * 1.45 / .55;
    struct outcome o;
    (void)state;
    run_job((struct scene_run){.scene = DARK WALLS SOUTH CEILING
                               "void light lamp 0 0 3 1000 1000 1000\n"
                               "lamp sphere bulb 0 0 4 2 2.5 1.5 .02\n"
                               "void trans shade 0 0 7 .9 .9 .9 0 0 .5 0\n"
                               "!genbox shade s .6 .6 .6 | xform -t 1.7 2.2 1.2\n",
                               .sensors = under,
                               .n_sensors = 1},
            &o);
    assert_within("flux", o.global_w, expected, 3 * o.global_sigma + 0.01 * expected);
}

/* ---- A solid glass block --------------------------------------------------------------------- */

/* Fills 2 x 1.5 m of the southern wall and extends 0.2 m into the room: its sides are free, and
 * light that entered by its outer face is totally reflected there. */
#define BLOCK                                                                                      \
    DARK WALLS CEILING                                                                             \
        "w polygon south 0 0 30 0 0 0 0 0 3 4 0 3 4 0 0 0 0 0 "                                    \
        "1 0 .5 3 0 .5 3 0 2 1 0 2 1 0 .5\n!genbox p block 2 .2 1.5 | xform -t 1 0 .5\n"

/* Returns the transmittance of a slab of index 1.5 at that cosine, all passes summed; unpolarised
 * at each face. */
static double slab(double cosine, double transmissivity)
{
    const double n = 1.5, inside = sqrt(1 - (1 - cosine * cosine) / (n * n));
    const double s = (cosine - n * inside) / (cosine + n * inside);
    const double p = (n * cosine - inside) / (n * cosine + inside);
    const double r = 0.5 * (s * s + p * p), d = pow(transmissivity, .2 / inside);
    return (1 - r) * (1 - r) * d / (1 - r * r * d * d);
}

static double slab_of_even_light(double transmissivity)
{
    enum { STEPS = 10000 };
    double sum = 0;
    for (int i = 0; i < STEPS; i++)
        sum += slab(sqrt((i + 0.5) / STEPS), transmissivity) / STEPS;
    return sum;
}

/* Returns the irradiance at a point that faces the inner face, whose radiance is the slab's. */
static double form_of_block(struct orl_vec3 at, double transmissivity)
{
    enum { STEPS = 200 };
    double sum = 0;
    for (int i = 0; i < STEPS * STEPS; i++) {
        const struct orl_vec3 from =
            orl_v3(1 + 2 * (i % STEPS + 0.5) / STEPS, .2, .5 + 1.5 * (i / STEPS + 0.5) / STEPS);
        const struct orl_vec3 way = orl_sub(from, at);
        const double d2 = orl_dot(way, way), c = fabs(way.y) / sqrt(d2);
        sum += c * c / d2 * slab(c, transmissivity);
    }
    return sum * 3 / (STEPS * STEPS);
}

/* Photons and eye paths both follow Fresnel, Beer, and n^2 for radiance at entry and exit. */
static void test_block_and_sky(void **state)
{
    static const char *const blocks[2] = {SKY "void dielectric p 0 0 5 1 1 1 1.5 0\n" BLOCK,
                                          SKY "void dielectric p 0 0 5 .1 .1 .1 1.5 0\n" BLOCK};
    static const struct orl_sensor sensors[2] = {{{2, 3, 1}, {0, -1, 0}}, {{1, 2, 2}, {0, -1, 0}}};
    (void)state;
    for (int k = 0; k < 2; k++) {
        const double t = k ? .1 : 1, flux = slab_of_even_light(t) * ORL_PI * 3;
        struct outcome o;
        run_job((struct scene_run){.scene = blocks[k],
                                   .sensors = sensors,
                                   .n_sensors = 2,
                                   .view = "-vtv -vp 2 2 1.25 -vd 0 -1 0 -vu 0 0 1 -vh 5 -vv 5"},
                &o);
        assert_within("flux", o.global_w, flux, 3 * o.global_sigma + 0.003 * flux);
        for (int i = 0; i < 2; i++) {
            const double expected = form_of_block(sensors[i].position, t);
            assert_within("sensor", o.w[i], expected, 0.02 * expected);
        }
        for (int i = 0; i < SIDE * SIDE; i++)
            assert_within("pixel", o.pixels[i][1], slab(1, t), 0.006 * slab(1, t));
    }
}

/* The sun through the block: caustic light of the slab's transmittance, in a separate patch. */
static void test_block_and_sun(void **state)
{
    static const struct orl_sensor sensors[4] = {{{2, 1.3, 0}, {0, 0, 1}},
                                                 {{1.5, 1.4, 0}, {0, 0, 1}},
                                                 {{2, 3.5, 0}, {0, 0, 1}},
                                                 {{2, 1.1, 0.2}, {0, 0, 1}}};
    const double c = sqrt(.5), arrives = slab(c, 1) * sun_normal_w() * c;
    struct outcome o;
    (void)state;
    run_job((struct scene_run){.scene = SUN(0, -1, 1) "void dielectric p 0 0 5 1 1 1 1.5 0\n" BLOCK,
                               .sensors = sensors,
                               .n_sensors = 4,
                               .caustic = 100000},
            &o);
    assert_within("flux", o.caustic_w, arrives * 3, 3 * o.caustic_sigma + 0.003 * arrives * 3);
    assert_within("in the patch", o.w[0], arrives, 0.2 * arrives);
    assert_within("in the patch", o.w[1], arrives, 0.2 * arrives);
    assert_within("beyond it", o.w[2], 0, 0.005 * arrives);
    assert_within("in mid-air", o.w[3], arrives,
                  0.05 * arrives); /* by photons that pass the sensor */
}

/*
 * A lamp inside a clear cube: light outside the critical angle of every face stays for ever; it
 * ends by the bounce limit, counted, or on the lamp. The six cones do not overlap: 3 (1 -
 * cos(asin(1 / n))) gets out, less half a per cent that hits the lamp on its way.
 */
static void test_trapped_light(void **state)
{
    static const struct orl_sensor sensor = {{2, 4.5, 0}, {0, 0, 1}};
    const double flux = 1000 * ORL_PI * 4 * ORL_PI * .02 * .02;
    const double free = 3 * (1 - sqrt(1 - 1 / 2.25));
    struct outcome o;
    (void)state;
    run_job((struct scene_run){.scene = DARK WALLS SOUTH CEILING
                               "void light lamp 0 0 3 1000 1000 1000\n"
                               "lamp sphere bulb 0 0 4 2 2.5 1.5 .02\n"
                               "void dielectric cube 0 0 5 1 1 1 1.5 0\n"
                               "!genbox cube c 1 1 1 | xform -t 1.4 1.9 .9\n",
                               .sensors = &sensor,
                               .n_sensors = 1,
                               .global = 5000},
            &o);
    assert_within("flux", o.global_w, free * flux, 3 * o.global_sigma + 0.01 * flux);
    assert_within("all of it", o.health.flux_w, flux, 0.01 * flux);
    assert_true(o.health.photons_capped > 0 && o.health.flux_capped_w > 0.05 * flux);
    assert_true(o.health.flux_capped_w < (1 - free) * flux * 1.02);
}

/* ---- A mirror -------------------------------------------------------------------------------- */

/* A square metre on the floor reflects the sun to a ceiling beside it. */
static void test_mirror_patch(void **state)
{
    static const struct orl_sensor sensors[6] = {
        {{-1.5, 0, 2}, {0, 0, -1}},  {{-1.2, .3, 2}, {0, 0, -1}}, {{-1.8, -.3, 2}, {0, 0, -1}},
        {{-1.5, .7, 2}, {0, 0, -1}}, {{-.8, 0, 2}, {0, 0, -1}},   {{-2.2, 0, 2}, {0, 0, -1}}};
    const double expected = .9 * sun_normal_w() * .8;
    struct outcome o;
    double mean = 0;
    (void)state;
    run_job((struct scene_run){.scene = SUN(.6, 0, .8) DARK
                               "void mirror m 0 0 3 .9 .9 .9\n"
                               "m polygon floor 0 0 12 -.5 -.5 0 .5 -.5 0 .5 .5 0 -.5 .5 0\n"
                               "w polygon up 0 0 12 -2.5 -1 2 -2.5 1 2 -.5 1 2 -.5 -1 2\n",
                               .sensors = sensors,
                               .n_sensors = 6,
                               .caustic = 100000},
            &o);
    assert_within("flux", o.caustic_w, expected, 3 * o.caustic_sigma + 0.01 * expected);
    for (int i = 0; i < 6; i++)
        assert_within("sensor", o.w[i], i < 3 ? expected : 0, 0.2 * expected);
    for (int i = 0; i < 3; i++)
        mean += o.w[i] / 3;
    assert_within("mean", mean, expected, 0.08 * expected);
}

/* ---- Spotlights ------------------------------------------------------------------------------ */

#define LAMP(type) DARK WALLS SOUTH CEILING type "lamp ring disc 0 0 8 2 2.5 2.9 0 0 -1 0 .02\n"

/*
 * L A cos / (d + f)^2 within the cone, zero beyond it; f is the length of the direction vector.
 * Photons carry the sensors' light: their sum over the floor agrees.
 */
static void test_spotlight(void **state)
{
    static const char *const lamps[2] = {
        LAMP("void spotlight lamp 0 0 7 1e4 1e4 1e4 60 0 0 -1e-6\n"),
        LAMP("void spotlight lamp 0 0 7 1e4 1e4 1e4 60 0 0 -1\n")};
    static const double off[3] = {0, 1.35, 2};
    const double area = ORL_PI * .02 * .02, height = 2.9;
    struct orl_sensor sensors[3];
    (void)state;
    for (int i = 0; i < 3; i++)
        sensors[i] = (struct orl_sensor){{2, 2.5 + off[i], 0}, {0, 0, 1}};
    for (int k = 0; k < 2; k++) {
        const double focus = k ? 1 : 1e-6;
        double flux = 0;
        struct outcome o;
        run_job((struct scene_run){.scene = lamps[k], .sensors = sensors, .n_sensors = 3}, &o);
        for (int i = 0; i < 3; i++) {
            const double d = hypot(off[i], height), c = height / d;
            const double expected = 1e4 * area * c * c / pow(d + focus, 2);
            assert_within("sensor", o.w[i], i < 2 ? expected : 0, 0.005 * expected);
        }
        for (int i = 0; i < 1000; i++) {
            const double c2 = 1 - .25 * (i + 0.5) / 1000; /* uniform in sin^2, up to 30 degrees */
            const double d = height / sqrt(c2);
            flux += ORL_PI * .25 / 1000 * 1e4 * area * pow(d / (d + focus), 2);
        }
        assert_within("flux", o.global_w, flux, 3 * o.global_sigma + 0.002 * flux);
    }
}

/* A view sees the lamp only from within its cone. */
static void test_spotlight_seen(void **state)
{
    static const char scene[] = "void spotlight lamp 0 0 7 7 7 7 60 0 0 -1\n"
                                "lamp polygon p 0 0 12 -1 -1 2 -1 1 2 1 1 2 1 -1 2\n" DARK
                                "w polygon floor 0 0 12 -9 -9 -1 9 -9 -1 9 9 -1 -9 9 -1\n";
    struct outcome o;
    (void)state;
    run_job((struct scene_run){.scene = scene,
                               .view = "-vtv -vp 0 0 0 -vd 0 0 1 -vu 0 1 0 -vh 5 -vv 5"},
            &o);
    assert_within("from below", o.pixels[0][0], 7, 0.03);
    run_job((struct scene_run){.scene = scene,
                               .view = "-vtv -vp 3 0 0 -vd -3 0 2 -vu 0 1 0 -vh 5 -vv 5"},
            &o);
    assert_within("from the side", o.pixels[0][0], 0, 0);
}

/* ---- Illums ---------------------------------------------------------------------------------- */

/* An illum lights like a light: equal photons and sensors, to the last bit. */
static void test_illum_is_light(void **state)
{
    static const char *const lamps[3] = {LAMP("void light lamp 0 0 3 1e4 1e4 1e4\n"),
                                         LAMP("void illum lamp 0 0 3 1e4 1e4 1e4\n"),
                                         LAMP("void glass pane 0 0 3 1 1 1\n"
                                              "void illum lamp 1 pane 0 3 1e4 1e4 1e4\n")};
    struct outcome o[3];
    (void)state;
    for (int k = 0; k < 3; k++)
        run_job((struct scene_run){.scene = lamps[k], .sensors = under, .n_sensors = UNDER}, &o[k]);
    for (int k = 1; k < 3; k++) {
        assert_true(o[k].global_w == o[0].global_w);
        for (int i = 0; i < UNDER; i++)
            assert_true(o[k].w[i] == o[0].w[i]);
    }
    assert_true(o[0].w[0] > 0);
}

/* A view shows the surface that an illum represents: here a glow of radiance 5 is behind it. */
static void test_illum_seen(void **state)
{
    static const struct {
        const char *lamp;
        double seen;
    } cases[4] = {
        {"void light lamp 0 0 3 9 9 9\n", 9},
        {"void illum lamp 0 0 3 9 9 9\n", 5},
        {"void illum lamp 1 void 0 3 9 9 9\n", 5},
        /* 0.918318 is 1.52's (1 - r) / (1 + r) */
        {"void glass pane 0 0 4 1 1 1 1.52\nvoid illum lamp 1 pane 0 3 9 9 9\n", 5 * .918318}};
    (void)state;
    for (int k = 0; k < 4; k++) {
        char scene[512];
        struct outcome o;
        snprintf(scene, sizeof scene,
                 "%svoid glow back 0 0 4 5 5 5 0\n" DARK
                 "lamp polygon p 0 0 12 -1 1 -1 1 1 -1 1 1 1 -1 1 1\n"
                 "back polygon q 0 0 12 -9 2 -9 9 2 -9 9 2 9 -9 2 9\n",
                 cases[k].lamp);
        run_job((struct scene_run){.scene = scene, .view = "-vtv -vp 0 0 0 -vh 5 -vv 5"}, &o);
        for (int i = 0; i < SIDE * SIDE; i++)
            assert_within("pixel", o.pixels[i][2], cases[k].seen, 0.005 * cases[k].seen);
    }
}

/* A glow of negative radius is visible and lights nothing. Of 32768 rays in four batches 950 hit
 * it, with a scatter of less than 1 / sqrt 950 = 3 %, a third of it by stratification. */
static void test_glow_radius(void **state)
{
    static const double radius[3] = {0, 1, -1};
    (void)state;
    for (int k = 0; k < 3; k++) {
        char scene[1024];
        struct outcome o;
        snprintf(scene, sizeof scene,
                 DARK WALLS SOUTH CEILING "void glow lamp 0 0 4 100 100 100 %g\n"
                                          "lamp ring disc 0 0 8 2 2.5 2.9 0 0 -1 0 .5\n",
                 radius[k]);
        run_job((struct scene_run){.scene = scene,
                                   .sensors = under,
                                   .n_sensors = 1,
                                   .samples = 32768,
                                   .view = "-vtv -vp 2 2.5 1 -vd 0 0 1 -vu 0 1 0 -vh 5 -vv 5"},
                &o);
        const double expected = k < 2 ? 100 * ORL_PI * .25 / (2.9 * 2.9 + .25) : 0;
        assert_within("sensor", o.w[0], expected, 0.03 * expected);
        assert_within("pixel", o.pixels[9][0], 100, 0.5);
    }
}

/*
 * A glow ball of 2 cm, which one ray of 40 000 hits, is sampled as a light, because its radius is
 * above 0. Rays and shadow rays agree with the closed form, 1e-3 for the shadow rays' scatter over
 * it; a view of rough metal, whose lobe rays never hit it, is as bright as with a light.
 */
static void test_small_glow(void **state)
{
    static const char *const lamps[2] = {"void glow lamp 0 0 4 1e4 1e4 1e4 100\n",
                                         "void light lamp 0 0 3 1e4 1e4 1e4\n"};
    const double expected = 1e4 * ORL_PI * .0004 / (4 + .25) * 2 / sqrt(4.25);
    struct outcome o[2];
    (void)state;
    for (int k = 0; k < 2; k++) {
        char scene[1024];
        snprintf(scene, sizeof scene,
                 DARK WALLS SOUTH CEILING
                 "void metal rough 0 0 5 .5 .5 .5 .9 .2\n"
                 "rough polygon p 0 0 12 0 1 .01 4 1 .01 4 2.4 .01 0 2.4 .01\n"
                 "%slamp sphere ball 0 0 4 2.5 2.5 2 .02\n",
                 lamps[k]);
        run_job((struct scene_run){.scene = scene,
                                   .sensors = under,
                                   .n_sensors = 1,
                                   .view = "-vtv -vp 2 .5 1 -vd 0 1 -.6 -vh 5 -vv 5"},
                &o[k]);
        assert_within("sensor", o[k].w[0], expected, 1e-3 * expected);
    }
    for (int i = 0; i < SIDE * SIDE; i++)
        assert_within("pixel", o[0].pixels[i][1], o[1].pixels[i][1], 0.005 * o[1].pixels[i][1]);
}

/*
 * A lamp outside, a square metre at four metres, seen through an invisible pane (index 1): counted
 * by shadow rays or by rays that hit it, not by both. Parallel rectangle over a point on its axis;
 * 4096 rays and 128 shadow rays have an error of 1 % for so smooth a lamp.
 */
static void test_lamp_outside(void **state)
{
    static const struct orl_sensor sensors[2] = {{{2, 2, 1.5}, {0, -1, 0}},
                                                 {{2, -0.5, 1.5}, {0, -1, 0}}};
    static const double distances[2] = {4, 1.5};
    struct outcome o;
    (void)state;
    run_job(
        (struct scene_run){
            .scene = DARK WALLS CEILING
            "void glass p 0 0 4 1 1 1 1\np polygon pane 0 0 12 0 0 0 0 0 3 4 0 3 4 0 0\n"
            "void light lamp 0 0 3 100 100 100\nlamp polygon l 0 0 12 1.5 -2 1 1.5 -2 "
            "2 2.5 -2 2 2.5 -2 1\n",
            .sensors = sensors,
            .n_sensors = 2},
        &o);
    for (int i = 0; i < 2; i++) {
        const double a = 0.5 / distances[i], root = sqrt(1 + a * a);
        const double factor = 4 / (2 * ORL_PI) * 2 * a / root * atan(a / root);
        assert_within("lamp outside", o.w[i], 100 * ORL_PI * factor, 0.01 * 100 * ORL_PI * factor);
    }
}

/*
 * A closed sphere of an exporter's white: 0.999 of its light is reflected, E = E0 / (1 - 0.999),
 * and the job ends. The lamp absorbs 1e-6 per reflection. Each of some 2000 emitted photons is
 * stored a thousand times, a geometric number: 2.2 %. For 8192 paths, 1.1 %.
 */
static void test_white_sphere(void **state)
{
    static const enum orl_technique techniques[] = {ORL_TECHNIQUE_GATHER, ORL_TECHNIQUE_BACKWARD};
    static const struct orl_sensor sensor = {{.6, -.8, 0}, {-.6, .8, 0}};
    const double expected = ORL_EFFICACY_LM_PER_W * ORL_PI * 1e5 * 1e-6 / (1 - 0.999 + 1e-6);
    (void)state;
    for (int t = 0; t < 2; t++) {
        bool told = false;
        struct orl_result result =
            scene_run(&(struct scene_run){.scene = "void plastic paint 0 0 5 1 1 1 0 0\n"
                                                   "paint bubble sphere 0 0 4 0 0 0 1\n"
                                                   "void light lamp 0 0 3 1e5 1e5 1e5\n"
                                                   "lamp sphere bulb 0 0 4 0 0 0 1e-3\n",
                                          .technique = techniques[t],
                                          .sensors = &sensor,
                                          .n_sensors = 1,
                                          .global = 2000000});
        assert_within("white sphere", result.illuminance_lx[0], expected, 0.08 * expected);
        for (size_t i = 0; i < result.n_warnings; i++)
            told |= strstr(result.warnings[i], "plastic paint at ") &&
                    strstr(result.warnings[i], "all incident light");
        assert_true(told);
        orl_result_done(&result);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_skylight_and_sky), cmocka_unit_test(test_skylight_and_sun),
        cmocka_unit_test(test_skylight_patch),   cmocka_unit_test(test_lampshade),
        cmocka_unit_test(test_block_and_sky),    cmocka_unit_test(test_block_and_sun),
        cmocka_unit_test(test_trapped_light),    cmocka_unit_test(test_mirror_patch),
        cmocka_unit_test(test_spotlight),        cmocka_unit_test(test_spotlight_seen),
        cmocka_unit_test(test_illum_is_light),   cmocka_unit_test(test_illum_seen),
        cmocka_unit_test(test_glow_radius),      cmocka_unit_test(test_small_glow),
        cmocka_unit_test(test_lamp_outside),     cmocka_unit_test(test_white_sphere),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
