/*
 * Hard cases of the sun: grazing a wall, in its plane, cut by the horizon, below it, overhead,
 * through one cell of a BSDF and across a cell border, in one picture with very dim light.
 *
 * The sun is a disc of uniform radiance L and angular radius R. Its centre is at angle d above a
 * plane. For small angles the plane's irradiance is L times the integral of (d + y) over the part
 * of the disc above the plane: L (d A + 2/3 (R^2 - d^2)^(3/2)), A = R^2 (pi - acos(d/R)) + d
 * sqrt(R^2 - d^2).
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

#include <cmocka.h>

#include "fixtures/bsdf_make.h"
#include "support/cli.h"
#include "support/hdr.h"
#include "support/scene_text.h"
#include "support/stability.h"

#define RADIUS_DEG (0.5 * ORL_SUN_DIAMETER_DEG)

static const double efficacy = ORL_EFFICACY_LM_PER_W;

static double sun_sr(void)
{
    const double s = sin(0.5 * RADIUS_DEG * ORL_DEG_TO_RAD);
    return 4 * ORL_PI * s * s;
}

/* Returns the irradiance of a plane over that of one facing the sun. The sun's centre is d radians
 * above the plane. */
static double grazing_share(double d)
{
    const double r = RADIUS_DEG * ORL_DEG_TO_RAD, h = fmin(fmax(d / r, -1), 1);
    const double side = sqrt(1 - h * h);
    const double area = ORL_PI - acos(h) + h * side;
    return (d * area + r * 2 / 3 * side * side * side) / ORL_PI;
}

/* ---- 1, 2: along a wall ---------------------------------------------------------------------- */

/*
 * Measures n sensors at one place in the open, with the sun d radians above their planes. The
 * planes are turned about the level line across the sun's azimuth. Returns lux over the lux of a
 * sensor that faces the sun. Each sensor has its own scrambling of the points on the disc, the
 * same in each run.
 */
static void read_grazing(double d, size_t n, double *ret_share)
{
    struct orl_sensor sensors[64];
    char scene[256];
    assert_true(n <= 64);
    for (size_t i = 0; i < n; i++)
        sensors[i] = (struct orl_sensor){{0, 0, 0}, {0.6 * sin(d), -0.8 * sin(d), cos(d)}};
    snprintf(scene, sizeof scene,
             "void light l 0 0 3 1e6 1e6 1e6\nl source sun 0 0 4 .6 -.8 0 %.3f\n",
             ORL_SUN_DIAMETER_DEG);
    scene_run_lx(
        &(struct scene_run){
            .scene = scene, .sensors = sensors, .n_sensors = n, .samples = 16, .global = 1},
        ret_share);
    for (size_t i = 0; i < n; i++)
        ret_share[i] /= efficacy * 1e6 * sun_sr();
}

/* At 0.1 degrees a third of the disc has set, and E rests on the remaining sample points. */
static void test_01_above_a_wall(void **state)
{
    enum { SENSORS = 64 };
    static const double degrees[] = {0.1, 0.15, 0.2, 0.26, 0.3, 0.5};
    double worst_mean = 0, worst = 0;
    (void)state;
    for (int i = 0; i < 6; i++) {
        const double d = degrees[i] * ORL_DEG_TO_RAD;
        double share[SENSORS], sum = 0;
        read_grazing(d, SENSORS, share);
        for (int k = 0; k < SENSORS; k++) {
            const double off = share[k] / grazing_share(d) - 1;
            sum += off;
            worst = fmax(worst, fabs(off));
        }
        worst_mean = fmax(worst_mean, fabs(sum / SENSORS));
    }
    stability_row(1, "sun 0.1 deg above a wall plane", "E / closed form - 1: mean of 64 sensors",
                  worst_mean, 0.001);
    stability_row(1, "sun 0.1 deg above a wall plane", "E / closed form - 1: worst of 64 sensors",
                  worst, 0.005);
}

/* Both sides of the plane, from 1e-9 to 1e-3 rad; R is 4.7e-3. Errors are shares of R, because E
 * is proportional to R. */
static void test_02_in_the_plane(void **state)
{
    double worst = 0, before = 0;
    bool rising = true;
    (void)state;
    for (int i = 0; i < 50; i++) {
        const double d = i < 25 ? -pow(10, -3 - i / 4.0) : pow(10, -9 + (i - 25) / 4.0);
        double share;
        read_grazing(d, 1, &share);
        worst = fmax(worst, isfinite(share) ? fabs(share - grazing_share(d)) : INFINITY);
        rising = rising && share >= before;
        before = share;
    }
    worst /= RADIUS_DEG * ORL_DEG_TO_RAD;
    stability_row(2, "sun exactly in the plane",
                  "|E - closed form| / (E facing, times R), +-1e-3 rad", worst, 0.005);
    stability_holds(2, "sun exactly in the plane", "E is finite and rises with the sun", rising);
}

/* ---- 3, 4, 5: horizon and zenith ------------------------------------------------------------- */

static struct orl_sky_request sky_at(double altitude_deg, double direct_lx, double diffuse_lx)
{
    return (struct orl_sky_request){.model = ORL_SKY_BY_PEREZ,
                                    .sun_given = true,
                                    .sun_altitude_deg = altitude_deg,
                                    .sun_azimuth_deg = 30,
                                    .input = ORL_SKY_NORMAL_LX,
                                    .first = direct_lx,
                                    .second = diffuse_lx,
                                    .turbidity = 2.45,
                                    .direct_normal_lx = -1};
}

/* Measures level ground and a wall that faces the sun under that sky. */
static struct orl_result read_sky(const struct orl_sky_request *sky, uint32_t samples)
{
    const double azimuth = 30 * ORL_DEG_TO_RAD;
    const struct orl_sensor sensors[2] = {{{0, 0, 1}, {0, 0, 1}},
                                          {{0, 0, 1}, {-sin(azimuth), -cos(azimuth), 0}}};
    return scene_run(&(struct scene_run){.scene = "# nothing\n",
                                         .sky = sky,
                                         .sensors = sensors,
                                         .n_sensors = 2,
                                         .samples = samples,
                                         .global = 1});
}

/* Returns the share of the disc that is above the horizon. */
static double visible_share(double altitude_deg)
{
    const double h = fmin(fmax(altitude_deg / RADIUS_DEG, -1), 1);
    return 1 - (acos(h) - h * sqrt(1 - h * h)) / ORL_PI;
}

/* A black sky with a sun of 1000 lx, from 0.3 degrees above the horizon to below it. */
static void test_03_half_below_the_horizon(void **state)
{
    double before[2] = {INFINITY, INFINITY}, wall = 0, level = 0, last = -1;
    long rises = 0;
    (void)state;
    for (int i = 0; i <= 30; i++) {
        const double altitude = 0.3 - 0.02 * i;
        const struct orl_sky_request sky = sky_at(altitude, 1000, 0);
        struct orl_result result = read_sky(&sky, 16);
        double *lx = result.illuminance_lx;
        /* Under a whole disc, the wall's E rises as the sun goes down by the cosine alone. */
        lx[1] /= cos(altitude * ORL_DEG_TO_RAD);
        rises += lx[0] > before[0] || lx[1] > before[1] * (1 + 1e-6);
        wall = fmax(wall, fabs(lx[1] / 1000 - visible_share(altitude)));
        level = fmax(level, fabs(lx[0] / 1000 - grazing_share(altitude * ORL_DEG_TO_RAD)));
        memcpy(before, lx, sizeof before);
        last = fmax(lx[0], lx[1]);
        orl_result_done(&result);
    }
    level /= RADIUS_DEG * ORL_DEG_TO_RAD;
    stability_row(3, "sun disc half below the horizon",
                  "steps of 0.02 deg at which E rises, 0.3 to -0.3", (double)rises, 0);
    stability_row(3, "sun disc half below the horizon", "wall: |E / E facing - share of the disc|",
                  wall, 0.005);
    stability_row(3, "sun disc half below the horizon",
                  "ground: |E - closed form| / (E facing, times R)", level, 0.02);
    stability_row(3, "sun disc half below the horizon", "E at -0.3 degrees, lx", last, 0);
}

static bool says(const struct orl_result *result, const char *words)
{
    for (size_t i = 0; i < result->n_warnings; i++)
        if (strstr(result->warnings[i], words))
            return true;
    return false;
}

/* A sun below the horizon gives walls that face it no light, from the job's sky and from a command
 * in the scene. */
static void test_04_below_the_horizon(void **state)
{
    static const double altitudes[] = {-0.3, -1, -5, -30, -90};
    static const struct orl_sensor down = {{0, 0, 1}, {-.5, -.8, -.3}};
    double most = 0;
    int silent = 0;
    (void)state;
    for (int i = 0; i < 5; i++) {
        const struct orl_sky_request sky = sky_at(altitudes[i], 50000, 0);
        char scene[128];
        struct orl_result result = read_sky(&sky, 16);
        most = fmax(most, fmax(result.illuminance_lx[0], result.illuminance_lx[1]));
        silent += !says(&result, "below the horizon");
        orl_result_done(&result);
        snprintf(scene, sizeof scene, "!gendaylit -ang %g 30 -W 500 0\n", altitudes[i]);
        result = scene_run(&(struct scene_run){
            .scene = scene, .sensors = &down, .n_sensors = 1, .samples = 16, .global = 1});
        most = fmax(most, result.illuminance_lx[0]);
        silent += !says(&result, "below the horizon");
        orl_result_done(&result);
    }
    stability_row(4, "sun below the horizon, DNI > 0", "E by the sun, lx", most, 0);
    stability_row(4, "sun below the horizon, DNI > 0", "results without a warning", silent, 0);
}

/*
 * The sky models require a sun no higher than 87 degrees, and get it clamped; the sun itself may
 * not jump there. E of level ground is DNI sin(altitude) + diffuse, and d sin is at most 3e-5 per
 * step.
 */
static void test_05_overhead(void **state)
{
    const double step = stability_full() ? 0.01 : 0.1, direct = 80000, diffuse = 15000;
    double before = -1, jump = 0, off = 0;
    (void)state;
    for (int i = 0; i * step <= 4 + 1e-9; i++) {
        const double altitude = 86 + i * step;
        const struct orl_sky_request sky = sky_at(altitude, direct, diffuse);
        struct orl_result result = read_sky(&sky, 4096);
        const double lx = result.illuminance_lx[0];
        const double wanted = direct * sin(altitude * ORL_DEG_TO_RAD) + diffuse;
        off = fmax(off, fabs(lx / wanted - 1));
        if (before > 0)
            jump = fmax(jump, fabs(lx / before - 1) / step);
        before = lx;
        orl_result_done(&result);
    }
    stability_row(5, "sun above 87 deg", "|step of E| / E a degree, 86 to 90", jump, 0.002);
    stability_row(5, "sun above 87 deg", "|E / (DNI sin + diffuse) - 1|", off, 0.002);
}

/* ---- 11, 12: through the cells of a BSDF ----------------------------------------------------- */

/* A room that absorbs 99.9 %, with a southern wall of that BSDF, lit by the sun alone. */
static const char room[] =
    "void light l 0 0 3 1e6 1e6 1e6\nl source sun 0 0 4 %.12g %.12g %.12g .533\n"
    "void plastic w 0 0 5 .001 .001 .001 0 0\n"
    "w polygon floor 0 0 12 0 0 0 4 0 0 4 5 0 0 5 0\n"
    "w polygon ceiling 0 0 12 0 0 3 0 5 3 4 5 3 4 0 3\n"
    "w polygon west 0 0 12 0 0 0 0 5 0 0 5 3 0 0 3\n"
    "w polygon east 0 0 12 4 0 0 4 0 3 4 5 3 4 5 0\n"
    "w polygon north 0 0 12 0 5 0 4 5 0 4 5 3 0 5 3\n"
    "void BSDF p 6 0 pane.xml 0 0 1 . 0 0\n"
    "p polygon pane 0 0 12 0 0 0 0 0 3 4 0 3 4 0 0\n";
static const double pane_area = 12;

/* Returns the flux landed on the walls over DNI A cos, with the sun at that altitude in the south.
 */
static double landed(const char *xml, double altitude_deg, uint64_t photons, double *ret_sigma)
{
    static const struct orl_sensor sensor = {{2, 2, 0}, {0, 0, 1}};
    const double a = altitude_deg * ORL_DEG_TO_RAD;
    char scene[1024], folder[64];
    double squares;
    snprintf(scene, sizeof scene, room, 0.0, -cos(a), sin(a));
    cli_make_folder(folder);
    struct orl_result result = scene_run(&(struct scene_run){.scene = scene,
                                                             .resource_name = "pane.xml",
                                                             .resource_text = xml,
                                                             .sensors = &sensor,
                                                             .n_sensors = 1,
                                                             .samples = 16,
                                                             .global = photons,
                                                             .folder = folder});
    const double flux = scene_map_flux(&result, folder, "global", &squares);
    const double arrives = 1e6 * sun_sr() * pane_area * cos(a);
    orl_result_done(&result);
    cli_remove_folder(folder);
    *ret_sigma = sqrt(squares) / arrives;
    return flux / arrives;
}

/* Light that the room reflects and that lands again adds 0.1 %. */
static void test_11_one_cell(void **state)
{
    static const double altitudes[] = {0, 10, 36, 54, 75};
    struct text xml = read_fixture("tests/fixtures/bsdf_klems41.xml");
    struct orl_bsdf *bsdf = NULL;
    double worst = 0, off = 0;
    (void)state;
    assert_int_equal(orl_bsdf_load_xml("x", xml.data, xml.size, &bsdf, NULL), 0);
    for (int i = 0; i < 5; i++) {
        const double a = altitudes[i] * ORL_DEG_TO_RAD;
        const double tau = orl_bsdf_albedo(bsdf, orl_v3(0, sin(a), -cos(a)), ORL_BSDF_TRANSMIT).g;
        double sigma;
        const double share =
            landed(xml.data, altitudes[i], stability_full() ? 1000000 : 50000, &sigma);
        worst = fmax(worst, fabs(share - tau) / sigma);
        off = fmax(off, fabs(share / tau - 1));
    }
    stability_row(11, "0.5 deg sun through one BSDF cell",
                  "|flux - tau DNI A cos|, standard errors of the photons", worst, 3);
    stability_row(11, "0.5 deg sun through one BSDF cell", "|flux / (tau DNI A cos) - 1|", off,
                  0.003);
    orl_bsdf_unref(bsdf);
    free(xml.data);
}

/*
 * Two rings transmit 0.2 and 0.6: across 45 degrees the disc moves from one to the other. In a
 * step of s the share of the disc beyond a line changes by at most 2 R s / (pi R^2), at its widest
 * part; the bound adds a tenth for noise.
 */
static struct text two_rings(void)
{
    struct text t;
    text_open(&t);
    fputs(
        "<?xml version=\"1.0\"?>\n<WindowElement><Optical><Layer><Material><Name>two</Name>"
        "</Material><DataDefinition>\n<IncidentDataStructure>Columns</IncidentDataStructure>\n"
        "<AngleBasis><AngleBasisName>own</AngleBasisName>\n"
        "<AngleBasisBlock><Theta>22</Theta><nPhis>1</nPhis><ThetaBounds><LowerTheta>0</LowerTheta>"
        "<UpperTheta>45</UpperTheta></ThetaBounds></AngleBasisBlock>\n"
        "<AngleBasisBlock><Theta>67</Theta><nPhis>1</nPhis><ThetaBounds><LowerTheta>45</LowerTheta>"
        "<UpperTheta>90</UpperTheta></ThetaBounds></AngleBasisBlock>\n"
        "</AngleBasis></DataDefinition>\n",
        t.stream);
    make_block_head(t.stream, "Visible", "Transmission Front", "own");
    fprintf(t.stream, "%.15g %.15g %.15g %.15g", 0.2 / ORL_PI, 0.6 / ORL_PI, 0.2 / ORL_PI,
            0.6 / ORL_PI);
    make_block_tail(t.stream);
    make_tail(t.stream);
    text_close(&t);
    return t;
}

static void test_12_across_an_edge(void **state)
{
    const uint64_t photons = stability_full() ? 400000 : 10000;
    const double step = 0.01, widest = 2 * step / (ORL_PI * RADIUS_DEG);
    struct text xml = two_rings();
    double before = -1, jump = 0, off = 0, sigma = 0;
    (void)state;
    for (int i = -30; i <= 30; i++) {
        const double share = landed(xml.data, 45 + step * i, photons, &sigma);
        off = fmax(off, fabs(share - (0.2 + 0.4 * visible_share(step * i))) / 0.4);
        if (before > 0)
            jump = fmax(jump, fabs(share - before) / 0.4);
        before = share;
    }
    stability_row(12, "sun across cell edges",
                  "|flux step| per 0.01 deg, of that between the cells", jump, 1.1 * widest);
    stability_row(12, "sun across cell edges", "|flux - the disc's shares of both|, of the same",
                  off, 0.005);
    free(xml.data);
}

/* ---- 37: 1.47e9 beside 1 cd/m2 --------------------------------------------------------------- */

enum { SIDE = 64 };

/* Reads the luminances of the image, cd/m2. */
static void read_image(const char *folder, double ret_cd_m2[SIDE * SIDE])
{
    static double rgb[SIDE * SIDE][3];
    char path[128];
    snprintf(path, sizeof path, "%s/view.hdr", folder);
    hdr_read(path, SIDE, SIDE, rgb);
    for (int i = 0; i < SIDE * SIDE; i++)
        ret_cd_m2[i] = efficacy * orl_luma((struct orl_rgb){rgb[i][0], rgb[i][1], rgb[i][2]});
}

/* The view is two degrees across: the disc fills the middle fourth, pixels are 0.03 degrees. 8
 * bits give 0.4 %. */
static void test_37_bright_beside_dark(void **state)
{
    static double cd_m2[SIDE * SIDE];
    const double bright = 1.47e9;
    char scene[256], folder[64];
    double sun = 0, dark = 0;
    (void)state;
    snprintf(scene, sizeof scene,
             "void light l 0 0 3 %.9g %.9g %.9g\nl source sun 0 0 4 0 1 .5 .533\n"
             "void glow g 0 0 4 %.9g %.9g %.9g 0\ng source sky 0 0 4 0 0 1 360\n",
             bright / efficacy, bright / efficacy, bright / efficacy, 1 / efficacy, 1 / efficacy,
             1 / efficacy);
    cli_make_folder(folder);
    struct orl_result result =
        scene_run(&(struct scene_run){.scene = scene,
                                      .view = "-vtv -vp 0 0 0 -vd 0 1 .5 -vu 0 0 1 -vh 2 -vv 2",
                                      .width = SIDE,
                                      .height = SIDE,
                                      .global = 1,
                                      .folder = folder});
    orl_result_done(&result);
    read_image(folder, cd_m2);
    cli_remove_folder(folder);
    for (int i = 0; i < SIDE * SIDE; i++) {
        const double x = (i % SIDE + 0.5) * 2.0 / SIDE - 1, y = (i / SIDE + 0.5) * 2.0 / SIDE - 1;
        const double away = sqrt(x * x + y * y), pixel = 1.5 * 2.0 / SIDE;
        if (away < RADIUS_DEG - pixel)
            sun = fmax(sun, fabs(cd_m2[i] / bright - 1));
        else if (away > RADIUS_DEG + pixel)
            dark = fmax(dark, fabs(cd_m2[i] - 1));
    }
    stability_row(37, "1.47e9 cd/m2 sun beside 1 cd/m2", "|L / L given - 1| within the disc", sun,
                  0.01);
    stability_row(37, "1.47e9 cd/m2 sun beside 1 cd/m2", "|L / L given - 1| beside the disc", dark,
                  0.01);
}

int main(void)
{
    static const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_01_above_a_wall),
        cmocka_unit_test(test_02_in_the_plane),
        cmocka_unit_test(test_03_half_below_the_horizon),
        cmocka_unit_test(test_04_below_the_horizon),
        cmocka_unit_test(test_05_overhead),
        cmocka_unit_test(test_11_one_cell),
        cmocka_unit_test(test_12_across_an_edge),
        cmocka_unit_test(test_37_bright_beside_dark),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
