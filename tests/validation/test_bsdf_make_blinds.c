/*
 * Venetian blinds on the virtual goniophotometer, compared with closed forms: flat slats, endless,
 * one above the other. Tolerances as in test_bsdf_make.c.
 */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "fixtures/bsdf_ask.h"
#include "support/panels.h"

enum { CELLS = 41, STEPS = 32, STRIPS = 100 };

/* Klems quarter: direction (i, k) of STEPS each in a cell, toward which light travels. */
static struct orl_vec3 place_in(int cell, int i, int k)
{
    static const double edges_deg[] = {0, 9, 27, 45, 63, 90};
    static const int cells[] = {1, 8, 12, 12, 8};
    int ring = 0, first = 0;
    while (cell >= first + cells[ring])
        first += cells[ring++];
    const double low = ring == 4 ? 0 : pow(cos(edges_deg[ring + 1] * ORL_DEG_TO_RAD), 2);
    const double high = pow(cos(edges_deg[ring] * ORL_DEG_TO_RAD), 2);
    const double c = sqrt(low + (high - low) * (i + 0.5) / STEPS), s = sqrt(1 - c * c);
    const double phi = 2 * ORL_PI * (cell - first + (k + 0.5) / STEPS - 0.5) / cells[ring];
    return orl_v3(s * cos(phi), s * sin(phi), c);
}

/* Returns the rounding error: the widths of steps at the horizon, where slopes are unbounded,
 * matter to 1e-3. */
static double rounding(int cell)
{
    return cell >= 33 ? 1e-3 : 2e-4;
}

/* ---- Mirrors --------------------------------------------------------------------------------- */

/*
 * Unfolded, a ray is a straight line through equal layers: the share `rest` of all entry points
 * hits one slat more than the others. Each slat absorbs a fifth of the light.
 */
static void mirrors_are_a_line_through_layers(void **state)
{
    static const double cell[4] = {0, 1, -0.2, 0.2}, depth = 1, spacing = 0.4, rho = 0.8;
    const struct panel panel = {.text = "void metal m 0 0 5 .8 .8 .8 1 0\n"
                                        "m polygon slat 0 0 12 0 0 -1 1 0 -1 1 0 0 0 0 0\n",
                                .basis = ORL_BSDF_KLEMS_QUARTER,
                                .cell = cell};
    struct orl_bsdf_make_result made = panel_make(&panel);
    (void)state;
    for (int in = 0; in < CELLS; in++) {
        double transmitted = 0;
        for (int i = 0; i < STEPS; i++)
            for (int k = 0; k < STEPS; k++) {
                const struct orl_vec3 d = place_in(in, i, k);
                const double layers = depth * fabs(d.y) / d.z / spacing, rest = fmod(layers, 1);
                transmitted += pow(rho, floor(layers)) * (1 - rest + rest * rho);
            }
        transmitted /= STEPS * STEPS;
        for (int front = 0; front < 2; front++) {
            const struct orl_bsdf_share *s = made.directions[in].shares[front];
            assert_close(s[1].value, transmitted, 6 * s[1].error + rounding(in));
            assert_true(s[0].value == 0); /* nothing is reflected */
        }
    }
    orl_bsdf_make_result_done(&made);
}

/* ---- Matt slats ------------------------------------------------------------------------------ */

/* A segment in the plane across the slats: coordinates along it (z) and across (y). */
struct segment {
    double z0, y0, z1, y1;
};

/* Returns the form factor between endless diffuse strips, by crossed strings. */
static double seen(struct segment a, struct segment b)
{
    const double crossed = hypot(a.z0 - b.z1, a.y0 - b.y1) + hypot(a.z1 - b.z0, a.y1 - b.y0);
    const double straight = hypot(a.z0 - b.z0, a.y0 - b.y0) + hypot(a.z1 - b.z1, a.y1 - b.y1);
    return fabs(crossed - straight) / (2 * hypot(a.z1 - a.z0, a.y1 - a.y0));
}

static struct segment strip(int i, double y)
{
    return (struct segment){(double)i / STRIPS - 1, y, (i + 1.0) / STRIPS - 1, y};
}

/* Computes the light that the strips of both slats finally emit toward the back and the front.
 * first: light incident on strips of the lower slat; the total is 1. */
static void radiosity(const double first[STRIPS], double spacing, double rho, double ret_out[2])
{
    static double between[STRIPS][STRIPS];
    double sent[2][STRIPS] = {{0}}, now[2][STRIPS];
    const struct segment ends[2] = {{-1, 0, -1, spacing}, {0, 0, 0, spacing}};
    for (int i = 0; i < STRIPS; i++)
        for (int k = 0; k < STRIPS; k++)
            between[i][k] = seen(strip(i, 0), strip(k, spacing));
    for (int round = 0; round < 60; round++) {
        for (int s = 0; s < 2; s++)
            for (int i = 0; i < STRIPS; i++) {
                now[s][i] = s == 0 ? rho * first[i] : 0;
                for (int k = 0; k < STRIPS; k++)
                    now[s][i] += rho * sent[1 - s][k] * between[k][i];
            }
        memcpy(sent, now, sizeof sent);
    }
    ret_out[0] = ret_out[1] = 0;
    for (int i = 0; i < STRIPS; i++)
        for (int end = 0; end < 2; end++)
            ret_out[end] += (sent[0][i] + sent[1][i]) * seen(strip(i, 0), ends[end]);
}

/* Matt slats follow ISO 15099, with as many strips as needed instead of five. */
static void matt_slats_are_a_cavity(void **state)
{
    static const double cell[4] = {0, 1, -0.4, 0.4}, spacing = 0.8, rho = 0.6;
    const struct panel panel = {.text = "void plastic w 0 0 5 .6 .6 .6 0 0\n"
                                        "w polygon slat 0 0 12 0 0 -1 1 0 -1 1 0 0 0 0 0\n",
                                .basis = ORL_BSDF_KLEMS_QUARTER,
                                .cell = cell};
    struct orl_bsdf_make_result made = panel_make(&panel);
    (void)state;
    for (int in = 0; in < CELLS; in++) {
        double first[STRIPS] = {0}, direct = 0, out[2];
        for (int i = 0; i < STEPS; i++)
            for (int k = 0; k < STEPS; k++) {
                const struct orl_vec3 d = place_in(in, i, k);
                const double slope = fabs(d.y) / d.z, reach = fmin(1, spacing / slope);
                direct += fmax(0, 1 - slope / spacing) / (STEPS * STEPS);
                /* Light is uniform over the part of the slat that it reaches. */
                for (int s = 0; s < STRIPS && reach > (double)s / STRIPS; s++)
                    first[s] +=
                        fmin(1, reach * STRIPS - s) / STRIPS * slope / spacing / (STEPS * STEPS);
            }
        radiosity(first, spacing, rho, out);
        for (int front = 0; front < 2; front++) {
            const struct orl_bsdf_share *s = made.directions[in].shares[front];
            assert_close(s[1].value, direct + out[1], 6 * s[1].error + rounding(in));
            assert_close(s[0].value, out[0], 6 * s[0].error + rounding(in));
        }
    }
    orl_bsdf_make_result_done(&made);
}

/* ---- Orientation ----------------------------------------------------------------------------- */

/* Transmission of light from that direction; z < 0 is outside. */
static double let_through(const struct orl_bsdf *bsdf, double x, double y, double side)
{
    return orl_bsdf_albedo(bsdf, direction(x, y, side), ORL_BSDF_TRANSMIT).g;
}

/*
 * Black slats whose outer edges are higher, at 45 degrees and edge above edge: only light from
 * outside and above, or from inside and below, passes between them. Then the same slats rotated,
 * whose outer edges are further to the right, at larger x.
 */
static void up_and_left_and_outside_are_where_they_are(void **state)
{
    static const double s = 0.70710678;
    static const struct panel tilted = {.text = "void plastic b 0 0 5 0 0 0 0 0\n"
                                                "b polygon slat 0 0 12 0 0 0 1 0 0 1 1 -1 0 1 -1\n",
                                        .paths = 1024};
    static const struct panel turned = {.text = "void plastic b 0 0 5 0 0 0 0 0\n"
                                                "b polygon slat 0 0 12 0 0 0 0 1 0 1 1 -1 1 0 -1\n",
                                        .paths = 1024};
    (void)state;
    for (int k = 0; k < 2; k++) {
        struct orl_bsdf_make_result made = panel_make(k ? &turned : &tilted);
        struct orl_bsdf *bsdf = panel_read(&made);
        const double x = k ? s : 0, y = k ? 0 : s;
        /* A cell of Klems full is 10 and 15 degrees wide: most of its light passes. */
        assert_true(let_through(bsdf, x, y, -1) > 0.8);
        assert_true(let_through(bsdf, -x, -y, 1) > 0.8);
        assert_true(let_through(bsdf, -x, -y, -1) == 0);
        assert_true(let_through(bsdf, x, y, 1) == 0);
        /* The light keeps its direction. */
        assert_true(eval(bsdf, direction(x, y, -1), direction(-x, -y, 1)) > 10);
        assert_true(eval(bsdf, direction(x, y, -1), direction(x, y, 1)) == 0);
        orl_bsdf_unref(bsdf);
        orl_bsdf_make_result_done(&made);
    }
}

int main(void)
{
    static const struct CMUnitTest tests[] = {
        cmocka_unit_test(mirrors_are_a_line_through_layers),
        cmocka_unit_test(matt_slats_are_a_cavity),
        cmocka_unit_test(up_and_left_and_outside_are_where_they_are),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
