/* The check of a BSDF: values against closed forms, and deliberate faults that it must find. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "bsdf_json/bsdf_json.h"
#include "fixtures/bsdf_ask.h"
#include "fixtures/bsdf_make.h"

/* Returns a tree file made of blocks: pairs of direction and data. */
static struct text tree_file(size_t n_blocks, const char *const (*blocks)[2])
{
    struct text t;
    text_open(&t);
    make_head(t.stream, "TensorTree4");
    for (size_t i = 0; i < n_blocks; i++) {
        make_block_head(t.stream, "Visible", blocks[i][0], NULL);
        fputs(blocks[i][1], t.stream);
        make_block_tail(t.stream);
    }
    make_tail(t.stream);
    text_close(&t);
    return t;
}

#define TREE_FILE(...)                                                                             \
    tree_file(sizeof((const char *const[][2]){__VA_ARGS__}) / sizeof(const char *[2]),             \
              (const char *const[][2]){__VA_ARGS__})

/* Checks the BSDF in the text, and frees the text. */
static struct orl_bsdf_check examine(struct text t)
{
    static struct orl_bsdf_check check;
    struct orl_bsdf *bsdf = load_text(t);
    assert_non_null(bsdf);
    orl_bsdf_examine(bsdf, &check);
    orl_bsdf_unref(bsdf);
    return check;
}

/* Returns the level of the first verdict that contains the words, or -1. */
static int level_of(const struct orl_bsdf_check *check, const char *words)
{
    for (size_t i = 0; i < check->n_verdicts; i++)
        if (strstr(check->verdicts[i].text, words))
            return (int)check->verdicts[i].level;
    return -1;
}

/* ---- Values ---------------------------------------------------------------------------------- */

static void a_uniform_surface_has_its_closed_forms(void **state)
{
    const struct orl_bsdf_check c =
        examine(TREE_FILE({"Reflection Front", "{0.1}"}, {"Reflection Back", "{0.05}"},
                          {"Transmission Front", "{0.08}"}, {"Transmission Back", "{0.08}"}));
    (void)state;
    for (int i = 0; i < ORL_BSDF_CHECK_DIRECTIONS; i++) {
        assert_close(c.directions[0][i].reflected, 0.1 * ORL_PI, 1e-7);
        assert_close(c.directions[1][i].reflected, 0.05 * ORL_PI, 1e-7);
        assert_close(c.directions[i % 2][i].transmitted, 0.08 * ORL_PI, 1e-7);
    }
    assert_close(c.directions[0][20].theta_deg, 75, 0);
    assert_close(c.directions[0][20].phi_deg, 270, 0);
    assert_close(c.extremes[0][0].mean, 0.1 * ORL_PI, 1e-7);
    assert_close(c.total[0].most, 0.18 * ORL_PI, 1e-7);
    assert_close(c.total[1].least, 0.13 * ORL_PI, 1e-7);
    assert_close(c.irreciprocal_reflection[0], 0, 1e-7);
    assert_close(c.irreciprocal_transmission, 0, 1e-7);
    assert_close(c.strongest.share, 0, 1e-6);
    assert_close(c.strongest.dgp_loss, 0, 0);
    for (int k = 0; k < 4; k++) {
        assert_close(c.redirection[k / 2][k % 2].transmitted, 0.08 * ORL_PI, 1e-7);
        assert_close(c.redirection[k / 2][k % 2].upward, 0.5, 0.02);
    }
    assert_int_equal(c.worst, ORL_BSDF_OK);
}

/* Extremes are over every cell of the data, with their direction; the mean weights cells by size.
 */
static void extremes_are_over_all_cells(void **state)
{
    /* By A: 4, 8, 12, 16 times the unit; every B alike. A.x is the high bit. */
    const struct orl_bsdf_check c = examine(
        TREE_FILE({"Reflection Back", "{.04 .04 .04 .04 .08 .08 .08 .08 .12 .12 .12 .12 .16 .16 "
                                      ".16 .16}"}));
    (void)state;
    assert_close(c.extremes[1][0].least, 0.04 * ORL_PI, 1e-7);
    assert_close(c.extremes[1][0].mean, 0.10 * ORL_PI, 1e-7);
    assert_close(c.extremes[1][0].most, 0.16 * ORL_PI, 1e-7);
    /* Light that travels to (+, +) comes from 225 degrees; the cell's middle is at sin = 1/2. */
    assert_close(c.extremes[1][0].most_phi_deg, 225, 1e-9);
    assert_close(c.extremes[1][0].most_theta_deg, 30, 1e-9);
    assert_close(c.extremes[0][0].most, 0, 0);
    /* f(in, out) depends on `in` alone, so reversing a pair of unequal cells changes the value by
     * their difference. The expected figure is the mean over pairs of max(0, a - b), over the mean
     * of a: (4+8+12+4+8+4)/16/10. */
    assert_close(c.irreciprocal_reflection[1], 0.25, 0.01);
    assert_close(c.irreciprocal_reflection[0], -1, 0);
    assert_close(c.irreciprocal_transmission, -1, 0);
    assert_int_equal(level_of(&c, "opaque"), ORL_BSDF_NOTE);
}

/* Writes a clear pane as a tree of the given depth: light stays in its cell. */
static void write_pane(FILE *f, unsigned depth, double value)
{
    if (depth == 0) {
        fprintf(f, "{%.9g}\n", value);
        return;
    }
    fputs("{", f);
    for (int i = 0; i < 16; i++)
        if ((i & 3) == i >> 2)
            write_pane(f, depth - 1, value);
        else
            fputs("{0}", f);
    fputs("}\n", f);
}

static struct orl_bsdf_check examine_pane(unsigned depth, double transmittance)
{
    struct text t;
    text_open(&t);
    make_head(t.stream, "TensorTree4");
    make_block_head(t.stream, "Visible", "Transmission Front", NULL);
    write_pane(t.stream, depth, transmittance * (1 << 2 * depth) / ORL_PI);
    make_block_tail(t.stream);
    make_tail(t.stream);
    text_close(&t);
    return examine(t);
}

/* The check compares the solid angle of the sun's cell with its disc, and derives a bound on DGP.
 */
static void a_clear_pane_smears_the_sun(void **state)
{
    static const struct {
        unsigned depth;
        double smear, loss;
    } cases[] = {{5, 45.1, 0.152}, {6, 11.28, 0.0966}, {7, 2.82, 0.0413}};
    (void)state;
    for (int i = 0; i < 3; i++) {
        const struct orl_bsdf_check c = examine_pane(cases[i].depth, 0.9);
        assert_close(c.normal.smear / cases[i].smear, 1, 2e-3);
        assert_close(c.normal.dgp_loss, cases[i].loss, 1e-3);
        assert_close(c.normal.share, 1, 0.1);
        assert_close(c.strongest.share, 1, 0.1);
        assert_close(c.extremes[0][1].most, 0.9, 1e-6);
        assert_close(c.irreciprocal_transmission, -1,
                     0); /* filled in by reciprocity, so there is no evidence */
        assert_close(c.redirection[0][1].upward, 0, 0);
        assert_close(c.redirection[0][0].upward, 1, 0);
        assert_int_equal(level_of(&c, "aBSDF"), ORL_BSDF_NOTE);
        assert_int_equal(level_of(&c, "no Transmission Back"), ORL_BSDF_NOTE);
    }
}

static void a_klems_pane_smears_it_more(void **state)
{
    struct text t;
    struct orl_bsdf_check c;
    (void)state;
    text_open(&t);
    make_head(t.stream, "Columns");
    make_block_head(t.stream, "Visible", "Transmission Front", "LBNL/Klems Full");
    for (int i = 0; i < 145 * 145; i++)
        fprintf(t.stream, "%s\n", i % 146 == 0 ? "30" : "0");
    make_block_tail(t.stream);
    make_tail(t.stream);
    text_close(&t);
    c = examine(t);
    assert_close(c.normal.smear, 351, 1);
    assert_close(c.normal.dgp_loss, 0.234, 1e-3);
    assert_close(c.normal.share, 1, 0.1);
}

/* ---- Deliberate faults ----------------------------------------------------------------------- */

static void energy_out_of_nothing_is_found(void **state)
{
    const struct orl_bsdf_check c =
        examine(TREE_FILE({"Reflection Front", "{0.2}"}, {"Reflection Back", "{0.1}"},
                          {"Transmission Front", "{0.18197186}"}));
    (void)state;
    assert_close(c.total[0].most, 1.2, 1e-6);
    assert_int_equal(c.worst, ORL_BSDF_FAULT);
    assert_int_equal(level_of(&c, "R + T = 1.200"), ORL_BSDF_FAULT);
    assert_int_equal(level_of(&c, "rescaled"), ORL_BSDF_FAULT);
    assert_int_equal(level_of(&c, "look swapped"), -1);
}

static double value_of(const struct orl_bsdf *bsdf, struct orl_vec3 in, struct orl_vec3 out)
{
    return orl_luma(orl_bsdf_eval(bsdf, in, out));
}

/*
 * In use, that file's values for light from outside are divided by 1.2, in both transport
 * directions and for either given direction. Light from inside, 0.886, is not scaled.
 */
static void energy_out_of_nothing_is_divided_out(void **state)
{
    struct orl_bsdf *bsdf =
        load_text(TREE_FILE({"Reflection Front", "{0.2}"}, {"Reflection Back", "{0.1}"},
                            {"Transmission Front", "{0.18197186}"}));
    const struct orl_vec3 outside = {0.6, 0, -0.8}, inside = {0, 0.8, 0.6}, up = {0, 0, 1};
    const double u[3] = {0.3, 0.6, 0.9}, through = 0.18197186;
    struct orl_vec3 other;
    struct orl_rgb weight;
    double pdf;
    (void)state;
    assert_non_null(bsdf);
    assert_close(value_of(bsdf, outside, orl_neg(up)), 0.2 / 1.2, 1e-7);
    assert_close(value_of(bsdf, outside, inside), through / 1.2, 1e-7);
    assert_close(value_of(bsdf, inside, outside), through, 1e-7);
    assert_close(value_of(bsdf, inside, up), 0.1, 1e-7);
    assert_close(orl_luma(orl_bsdf_albedo(bsdf, outside, ORL_BSDF_BOTH)), 1, 1e-14);
    assert_close(orl_luma(orl_bsdf_albedo(bsdf, inside, ORL_BSDF_BOTH)), (0.1 + through) * ORL_PI,
                 1e-6);
    assert_true(orl_bsdf_sample(bsdf, outside, ORL_BSDF_TRANSMIT, u, &other, &weight, &pdf));
    assert_close(orl_luma(weight) * pdf, value_of(bsdf, outside, other) * other.z, 1e-12);
    assert_true(orl_bsdf_sample_adjoint(bsdf, inside, ORL_BSDF_TRANSMIT, u, &other, &weight, &pdf));
    assert_close(orl_luma(weight) * pdf, value_of(bsdf, other, inside) * -other.z, 1e-12);
    orl_bsdf_unref(bsdf);
}

/* A little noise in one direction is not a fault. */
static void noise_is_only_a_warning(void **state)
{
    const struct orl_bsdf_check c =
        examine(TREE_FILE({"Reflection Back", "{.3 .3 .3 .3 .3 .3 .3 .3 .3 .3 .3 .3 .325 .325 "
                                              ".325 .325}"}));
    (void)state;
    assert_close(c.total[1].most, 1.021, 1e-3);
    assert_int_equal(level_of(&c, "Energy is gained"), ORL_BSDF_WARNING);
    assert_int_equal(c.worst, ORL_BSDF_WARNING);
}

/*
 * Slats. From outside, rising light passes and falling light is reflected; from inside it is the
 * other way round, by reciprocity. Transmission Front in the grid's order A.x, A.y, B.x, B.y:
 * rising light (A.y = 1) leaves rising (B.y = 1).
 */
#define SLATS_PASS "{0 .01 0 .01 0 .5 0 .5 0 .01 0 .01 0 .5 0 .5}"
#define OUTSIDE_BACK "{.3 0 .3 0 .02 0 .02 0 .3 0 .3 0 .02 0 .02 0}"
#define INSIDE_BACK "{0 .02 0 .02 0 .3 0 .3 0 .02 0 .02 0 .3 0 .3}"

static void slats_the_right_way_round_are_fine(void **state)
{
    const struct orl_bsdf_check c =
        examine(TREE_FILE({"Transmission Front", SLATS_PASS}, {"Reflection Front", OUTSIDE_BACK},
                          {"Reflection Back", INSIDE_BACK}));
    (void)state;
    assert_true(c.total[0].most < 1 && c.total[1].most < 1);
    assert_int_equal(level_of(&c, "it shades"), ORL_BSDF_OK);
    assert_int_equal(level_of(&c, "swapped"), -1);
}

static void a_transmission_filed_under_the_wrong_side_is_found(void **state)
{
    const struct orl_bsdf_check c = examine(TREE_FILE({"Transmission Back", SLATS_PASS}));
    (void)state;
    assert_close(c.redirection[0][1].transmitted, 0.5 * ORL_PI / 2 + 0.01 * ORL_PI / 2, 0.05);
    assert_int_equal(level_of(&c, "front and back are swapped"), ORL_BSDF_WARNING);
}

/* The two reflections exchanged: each is plausible alone, but with the transmission they exceed 1.
 */
static void swapped_reflections_are_found(void **state)
{
    const struct orl_bsdf_check c =
        examine(TREE_FILE({"Transmission Front", SLATS_PASS}, {"Reflection Front", INSIDE_BACK},
                          {"Reflection Back", OUTSIDE_BACK}));
    (void)state;
    assert_true(c.total[0].most > 1.2);
    assert_int_equal(level_of(&c, "look swapped"), ORL_BSDF_FAULT);
}

/* An incomplete colour is not used, and a warning says so. */
static void incomplete_colour_is_told(void **state)
{
    struct text t;
    struct orl_bsdf_check c;
    (void)state;
    text_open(&t);
    make_head(t.stream, "TensorTree4");
    make_block_head(t.stream, "Visible", "Reflection Front", NULL);
    fputs("{0.1}", t.stream);
    make_block_tail(t.stream);
    make_block_head(t.stream, "CIE-u", "Reflection Front", NULL);
    fputs("{0.3}", t.stream);
    make_block_tail(t.stream);
    make_tail(t.stream);
    text_close(&t);
    c = examine(t);
    assert_false(c.info.colored);
    assert_true(c.info.color_left_out);
    assert_int_equal(level_of(&c, "Colour is incomplete"), ORL_BSDF_WARNING);
    assert_close(c.directions[0][0].reflected, 0.1 * ORL_PI, 1e-7);
    c = examine(TREE_FILE({"Reflection Front", "{0.1}"}));
    assert_int_equal(level_of(&c, "olour"), -1);
}

static void negative_values_are_told(void **state)
{
    const struct orl_bsdf_check c = examine(
        TREE_FILE({"Reflection Front", "{-1 .1 .1 .1 .1 .1 .1 .1 .1 .1 .1 .1 .1 .1 .1 .1}"}));
    (void)state;
    assert_int_equal(c.info.clamped, 1);
    assert_int_equal(level_of(&c, "1 of 16 values are negative"), ORL_BSDF_WARNING);
}

static void a_black_surface_is_told(void **state)
{
    const struct orl_bsdf_check c = examine(TREE_FILE({"Transmission Front", "{0}"}));
    (void)state;
    assert_int_equal(level_of(&c, "All values are zero"), ORL_BSDF_WARNING);
    assert_close(c.normal.share, 0, 0);
}

/* ---- Placeholder transmissions --------------------------------------------------------------- */

/* For any placeholder of the missing transmission, the check gives the same as without it. */
static void a_dummy_transmission_is_as_good_as_none(void **state)
{
    static const struct {
        const char *front, *back;
        enum orl_bsdf_placeholder dummy[2];
    } cases[] = {{SLATS_PASS, "{0}", {ORL_BSDF_NO_PLACEHOLDER, ORL_BSDF_PLACEHOLDER_ZERO}},
                 {SLATS_PASS, SLATS_PASS, {ORL_BSDF_NO_PLACEHOLDER, ORL_BSDF_PLACEHOLDER_COPY}},
                 {"{0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0}",
                  SLATS_PASS,
                  {ORL_BSDF_PLACEHOLDER_ZERO, ORL_BSDF_NO_PLACEHOLDER}}};
    (void)state;
    for (int i = 0; i < 3; i++) {
        const struct orl_bsdf_check with = examine(TREE_FILE({"Transmission Front", cases[i].front},
                                                             {"Transmission Back", cases[i].back}));
        const struct orl_bsdf_check without =
            i == 2 ? examine(TREE_FILE({"Transmission Back", cases[i].back}))
                   : examine(TREE_FILE({"Transmission Front", cases[i].front}));
        assert_int_equal(with.info.dummy[0], cases[i].dummy[0]);
        assert_int_equal(with.info.dummy[1], cases[i].dummy[1]);
        assert_int_equal(with.info.has[0][1], i != 2);
        assert_int_equal(with.info.has[1][1], i == 2);
        assert_memory_equal(with.directions, without.directions, sizeof with.directions);
        assert_memory_equal(with.extremes, without.extremes, sizeof with.extremes);
        assert_int_equal(level_of(&with, i == 1 ? "a copy of the other" : "all zeros"),
                         ORL_BSDF_NOTE);
    }
}

/* A matrix whose back transmission repeats the front. The true reverse is different, unless the
 * matrix is diagonal. */
static struct text klems_twice(bool diagonal)
{
    static const char *const names[] = {"Transmission Front", "Transmission Back"};
    struct text t;
    text_open(&t);
    make_head(t.stream, "Columns");
    for (int k = 0; k < 2; k++) {
        make_block_head(t.stream, "Visible", names[k], "LBNL/Klems Quarter");
        for (int i = 0; i < 41 * 41; i++)
            fprintf(t.stream, "%s\n", i % 41 == (diagonal ? i / 41 : i / 82) ? "1" : "0");
        make_block_tail(t.stream);
    }
    make_tail(t.stream);
    text_close(&t);
    return t;
}

/* If the true reverse is the same data, the copy is right and kept. Different data are never
 * placeholders. */
static void true_transmissions_are_kept(void **state)
{
    struct orl_bsdf_check c =
        examine(TREE_FILE({"Transmission Front", "{0.2}"}, {"Transmission Back", "{0.2}"}));
    (void)state;
    assert_true(c.info.has[0][1] && c.info.has[1][1]);
    c = examine(TREE_FILE({"Transmission Front", SLATS_PASS}, {"Transmission Back", "{0.1}"}));
    assert_true(c.info.has[0][1] && c.info.has[1][1]);
    assert_int_equal(level_of(&c, "Transmission is not reciprocal"), ORL_BSDF_WARNING);
    c = examine(TREE_FILE({"Transmission Front", "{0}"}, {"Transmission Back", "{0}"}));
    assert_int_equal(c.info.dummy[0] + c.info.dummy[1], 0);
    c = examine(klems_twice(true));
    assert_true(c.info.has[0][1] && c.info.has[1][1]);
    c = examine(klems_twice(false));
    assert_int_equal(c.info.dummy[1], ORL_BSDF_PLACEHOLDER_COPY);
}

/* ---- JSON --------------------------------------------------------------------------------------
 */

static void the_check_is_told_as_json(void **state)
{
    const struct orl_bsdf_check c = examine_pane(6, 0.9);
    json_t *json = orl_bsdf_check_to_json(&c);
    const char *kind = NULL, *verdict = NULL;
    double transmitted = 0, smear = 0;
    json_t *list = NULL, *verdicts = NULL, *none = NULL;
    (void)state;
    assert_non_null(json);
    assert_int_equal(json_unpack(json, "{s:s, s:{s:s, s:o, s:{s:o}, s:{s:o}, s:{s:{s:f}}}}", "kind",
                                 &kind, "check", "verdict", &verdict, "verdicts", &verdicts,
                                 "hemispherical", "back", &list, "irreciprocal", "transmission",
                                 &none, "straight_through", "normal", "smear", &smear),
                     0);
    assert_string_equal(kind, "TensorTree4");
    assert_string_equal(verdict, orl_bsdf_level_name(c.worst));
    assert_int_equal(json_array_size(verdicts), c.n_verdicts);
    assert_int_equal(json_array_size(list), ORL_BSDF_CHECK_DIRECTIONS);
    assert_int_equal(json_unpack(json_array_get(list, 7), "{s:f}", "transmitted", &transmitted), 0);
    assert_close(transmitted, 0.9, 1e-6);
    assert_close(smear, 11.28, 0.02);
    assert_true(json_is_null(none));
    json_decref(json);
}

int main(void)
{
    static const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_uniform_surface_has_its_closed_forms),
        cmocka_unit_test(extremes_are_over_all_cells),
        cmocka_unit_test(a_clear_pane_smears_the_sun),
        cmocka_unit_test(a_klems_pane_smears_it_more),
        cmocka_unit_test(energy_out_of_nothing_is_found),
        cmocka_unit_test(energy_out_of_nothing_is_divided_out),
        cmocka_unit_test(noise_is_only_a_warning),
        cmocka_unit_test(slats_the_right_way_round_are_fine),
        cmocka_unit_test(a_transmission_filed_under_the_wrong_side_is_found),
        cmocka_unit_test(swapped_reflections_are_found),
        cmocka_unit_test(incomplete_colour_is_told),
        cmocka_unit_test(negative_values_are_told),
        cmocka_unit_test(a_black_surface_is_told),
        cmocka_unit_test(a_dummy_transmission_is_as_good_as_none),
        cmocka_unit_test(true_transmissions_are_kept),
        cmocka_unit_test(the_check_is_told_as_json),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
