/*
 * The virtual goniophotometer compared with closed forms. Unless stated otherwise a value must be
 * within six of its standard errors, which with 16 batches chance exceeds in 1 of 40 000 cases,
 * plus rounding.
 */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

#include "fixtures/bsdf_ask.h"
#include "support/panels.h"

enum { QUARTER_RINGS = 5, STEPS = 64 };

/* Klems quarter: edges of its rings, and their numbers of cells. */
static const double edges_deg[QUARTER_RINGS + 1] = {0, 9, 27, 45, 63, 90};
static const int ring_cells[QUARTER_RINGS] = {1, 8, 12, 12, 8};

static int ring_of(size_t cell)
{
    int ring = 0, first = 1;
    while ((int)cell >= first)
        first += ring_cells[++ring];
    return ring;
}

static double cos2_deg(double angle)
{
    return angle == 90 ? 0 : pow(cos(angle * ORL_DEG_TO_RAD), 2);
}

static double omega_of(size_t cell)
{
    const int r = ring_of(cell);
    return ORL_PI * (cos2_deg(edges_deg[r]) - cos2_deg(edges_deg[r + 1])) / ring_cells[r];
}

/* Returns the cosine at point i of STEPS, by projected solid angle in a ring. */
static double ring_cosine(int ring, int i)
{
    const double low = cos2_deg(edges_deg[ring + 1]), high = cos2_deg(edges_deg[ring]);
    return sqrt(low + (high - low) * (i + 0.5) / STEPS);
}

static void assert_share(struct orl_bsdf_share share, double expected, double rounding)
{
    assert_close(share.value, expected, 6 * share.error + rounding);
}

/* ---- Sheets and slabs ------------------------------------------------------------------------ */

static void a_lambertian_sheet_is_the_same_everywhere(void **state)
{
    const struct panel panel = {.text = "void trans s 0 0 7 .5 .5 .5 0 0 .6 0\n"
                                        "s polygon p 0 0 12 0 0 0 2 0 0 2 1 0 0 1 0\n",
                                .basis = ORL_BSDF_KLEMS_QUARTER};
    struct orl_bsdf_make_result made = panel_make(&panel);
    struct orl_bsdf *bsdf = panel_read(&made);
    (void)state;
    assert_int_equal(made.n_directions, 41);
    for (int front = 0; front < 2; front++) {
        const struct orl_vec3 in = direction(0.3, -0.4, front ? 1 : -1);
        assert_share(made.diffuse[front][0], 0.2, 0);
        assert_share(made.diffuse[front][1], 0.3, 0);
        /* Stratified points have less variance than random ones: 6 errors of a cell with 1/41 of
         * 1230 paths. */
        for (int i = 0; i < 16; i++) {
            const struct orl_vec3 out = direction(0.9 * cos(i), 0.9 * sin(i), 1);
            assert_close(eval(bsdf, in, out), (front ? 0.2 : 0.3) / ORL_PI, 0.08);
        }
    }
    assert_true(made.lost == 0);
    orl_bsdf_unref(bsdf);
    orl_bsdf_make_result_done(&made);
}

/* Returns a clear slab's mean reflectance and transmittance over a ring, for that transmissivity
 * per unit of length and that thickness. */
static void mean_slab(int ring, double thickness, double clarity, double *ret_r, double *ret_t)
{
    *ret_r = *ret_t = 0;
    for (int i = 0; i < STEPS; i++) {
        double r, t;
        const double c = ring_cosine(ring, i);
        const double inside = sqrt(1 - (1 - c * c) / (1.5 * 1.5));
        slab_shares(c, 1.5, pow(clarity, thickness / inside), &r, &t);
        *ret_r += r / STEPS;
        *ret_t += t / STEPS;
    }
}

/* A coloured glass slab in a box larger than the cell. Green dominates luma, so the luma shares are
 * the weighted sum over the three channels. */
static void a_clear_slab_is_fresnels_with_all_passes(void **state)
{
    static const double cell[4] = {-0.5, 0.5, 0, 0.7}, clarity[3] = {0.5, 0.8, 0.3};
    static const double luma[3] = {ORL_LUMA_R, ORL_LUMA_G, ORL_LUMA_B};
    const struct panel panel = {.text = "void dielectric d 0 0 5 .5 .8 .3 1.5 0\n"
                                        "!genbox d slab 4 4 .5 | xform -t -2 -2 -.5\n",
                                .basis = ORL_BSDF_KLEMS_QUARTER,
                                .cell = cell,
                                .color = true};
    struct orl_bsdf_make_result made = panel_make(&panel);
    struct orl_bsdf *bsdf = panel_read(&made);
    (void)state;
    assert_close(made.depth[0], -0.5, 1e-12);
    for (size_t i = 0; i < made.n_directions; i++) {
        double reflected = 0, transmitted = 0, r, t;
        for (int c = 0; c < 3; c++) {
            mean_slab(ring_of(i), 0.5, clarity[c], &r, &t);
            reflected += luma[c] * r;
            transmitted += luma[c] * t;
        }
        for (int front = 0; front < 2; front++) {
            /* Means of 64 steps are off by 1e-5 near the horizon. */
            assert_share(made.directions[i].shares[front][0], reflected, 3e-5);
            assert_share(made.directions[i].shares[front][1], transmitted, 3e-5);
        }
    }
    /*
     * All of the transmitted light is straight, in the glass's colours: 16-bit shares of luminance.
     */
    const struct orl_rgb f = orl_bsdf_eval(bsdf, direction(0, 0, -1), direction(0, 0, 1));
    for (int c = 0; c < 3; c++) {
        double r, t;
        mean_slab(0, 0.5, clarity[c], &r, &t);
        assert_close(c == 0 ? f.r : c == 1 ? f.g : f.b, t / omega_of(0), 1e-3 * t / omega_of(0));
    }
    orl_bsdf_unref(bsdf);
    orl_bsdf_make_result_done(&made);
}

/* Returns the reflectance of a pane that absorbs nothing, all passes summed, averaged over
 * projected solid angle. Glass is thin, and treats the polarisations separately. */
static double pane_reflectance(double c)
{
    const double inside = sqrt(1 - (1 - c * c) / (1.52 * 1.52));
    const double s = pow((c - 1.52 * inside) / (c + 1.52 * inside), 2);
    const double p = pow((1.52 * c - inside) / (1.52 * c + inside), 2);
    return s / (1 + s) + p / (1 + p);
}

static void mean_pane(double low_deg, double high_deg, double *ret_r, double *ret_t)
{
    const double low = cos2_deg(high_deg), high = cos2_deg(low_deg);
    *ret_r = 0;
    for (int i = 0; i < 16 * STEPS; i++)
        *ret_r +=
            pane_reflectance(sqrt(low + (high - low) * (i + 0.5) / (16 * STEPS))) / (16 * STEPS);
    *ret_t = 1 - *ret_r;
}

/* A frosted pane: clear outside, ideally diffuse behind, with interreflection between both. */
static void a_frosted_pane_is_a_pane_and_a_sheet(void **state)
{
    const double rho = 0.3, tau = 0.5;
    /* Transmissivity 1: no absorption. */
    const struct panel panel = {.text = "void glass g 0 0 3 1 1 1\n"
                                        "void trans s 0 0 7 .8 .8 .8 0 0 .625 0\n"
                                        "g polygon pane 0 0 12 0 0 -.1 1 0 -.1 1 1 -.1 0 1 -.1\n"
                                        "s polygon sheet 0 0 12 0 0 0 1 0 0 1 1 0 0 1 0\n",
                                .basis = ORL_BSDF_KLEMS_QUARTER,
                                .paths = 1 << 14};
    struct orl_bsdf_make_result made = panel_make(&panel);
    double rd, td, r, t;
    (void)state;
    mean_pane(0, 90, &rd, &td);
    const double gain = 1 / (1 - rho * rd);
    for (size_t i = 0; i < made.n_directions; i++) {
        struct orl_bsdf_share(*s)[2] = made.directions[i].shares;
        mean_pane(edges_deg[ring_of(i)], edges_deg[ring_of(i) + 1], &r, &t);
        assert_share(s[0][1], t * tau * gain, 2e-5);
        assert_share(s[0][0], r + t * rho * td * gain, 2e-5);
        /* From the inside light hits the sheet first, whatever its direction. */
        assert_share(s[1][1], tau * td * gain, 2e-5);
        assert_share(s[1][0], rho + tau * tau * rd * gain, 2e-5);
    }
    orl_bsdf_make_result_done(&made);
}

/* ---- A laser cut panel ----------------------------------------------------------------------- */

/*
 * Acrylic with cuts at right angles: every ray inside hits them beyond the critical angle, so that
 * cuts only reverse y. A ray is then a straight line through equal layers, and the parity of the
 * number crossed determines the exit direction. For light in the plane across the cuts.
 */
static double deflected_share(double sine, double aspect, double n)
{
    const double inside = asin(sine / n), crossed = aspect * tan(inside);
    const double whole = floor(crossed), rest = crossed - whole;
    /* For positions between two cuts, that share crosses one more. */
    return fmod(whole, 2) == 1 ? 1 - rest : rest;
}

static void a_laser_cut_panel_follows_snell(void **state)
{
    enum { PARTS = 48 };
    static const double cell[4] = {-1, 1, 0, 4};
    const double n = 1.491, aspect = 1.5;
    const struct panel panel = {.text = "void dielectric pmma 0 0 5 1 1 1 1.491 0\n"
                                        "!genbox pmma part 12 4 6 | xform -t -6 0 -6\n",
                                .basis = ORL_BSDF_KLEMS_FULL,
                                .cell = cell,
                                .paths = 1 << 12,
                                .symmetry = ORL_BSDF_LEFT_RIGHT};
    struct orl_bsdf_make_result made = panel_make(&panel);
    struct orl_bsdf *bsdf = panel_read(&made);
    (void)state;
    /*
     * Light from outside and above, at 40 degrees: a cell from 35 to 45, 15 degrees to either side.
     * Computes its mean by the first pass only; later passes (odd numbers) change its share by r^2.
     */
    double up = 0, down = 0;
    const double low = cos2_deg(45), high = cos2_deg(35);
    for (int i = 0; i < PARTS; i++)
        for (int k = 0; k < PARTS; k++) {
            const double c = sqrt(low + (high - low) * (i + 0.5) / PARTS);
            const double sine = sqrt(1 - c * c);
            const double side = (15 * ORL_DEG_TO_RAD) * ((k + 0.5) / PARTS - 0.5);
            const double z = sqrt(1 - sine * sine / (n * n)); /* inside */
            /* Slope across the cuts of a ray with a sideways component. */
            const double slope = sine * cos(side) / n / z;
            const double r = fresnel(c, n), t = (1 - r) * (1 - r) / (1 - r * r);
            const double share = deflected_share(n * sin(atan(slope)), aspect, n);
            up += t * share / (PARTS * PARTS);
            down += t * (1 - share) / (PARTS * PARTS);
        }
    const double omega = ORL_PI * (high - low) / 24;
    const struct orl_vec3 in = direction(0, sin(40 * ORL_DEG_TO_RAD), -1);
    const double to_up = eval(bsdf, in, direction(0, sin(40 * ORL_DEG_TO_RAD), 1)) * omega;
    const double to_down = eval(bsdf, in, direction(0, -sin(40 * ORL_DEG_TO_RAD), 1)) * omega;
    /* r is 0.05: passes beyond the first carry 0.25 % of the light, in either direction. */
    assert_close(to_up, up, 0.003);
    assert_close(to_down, down, 0.003);
    assert_close(to_up + to_down, up + down, 2e-4);
    assert_true(up > 0.3 && down > 0.05); /* the cell has both directions */
    orl_bsdf_unref(bsdf);
    orl_bsdf_make_result_done(&made);
}

int main(void)
{
    static const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_lambertian_sheet_is_the_same_everywhere),
        cmocka_unit_test(a_clear_slab_is_fresnels_with_all_passes),
        cmocka_unit_test(a_frosted_pane_is_a_pane_and_a_sheet),
        cmocka_unit_test(a_laser_cut_panel_follows_snell),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
