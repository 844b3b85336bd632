/*
 * Hard cases of BSDF data in use: energy gain, all zero, sharp peaks, tiny values, uniform data.
 * The test writes the files and the loader reads them; light is simulated by whole jobs. Seeds are
 * fixed.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

#include <cmocka.h>

#include "base/sampling/sampling.h"
#include "bsdf/matrix/matrix.h"
#include "bsdf/tree/shirley.h"
#include "fixtures/bsdf_make.h"
#include "support/cli.h"
#include "support/scene_text.h"
#include "support/stability.h"

static const double efficacy = ORL_EFFICACY_LM_PER_W;

static double uniform(struct orl_random *random)
{
    return orl_random_uniform(random);
}

/* Returns a direction uniform in projected solid angle, on either side. */
static struct orl_vec3 any_direction(struct orl_random *random)
{
    const double s = uniform(random), phi = 2 * ORL_PI * uniform(random), r = sqrt(s);
    const double z = sqrt(1 - s);
    return orl_v3(r * cos(phi), r * sin(phi), uniform(random) < 0.5 ? z : -z);
}

static struct orl_bsdf *load_or_fail(struct text t)
{
    struct orl_bsdf *bsdf = load_text(t);
    assert_non_null(bsdf);
    return bsdf;
}

/* Returns a file with all four components of a structure, each with the same data. */
static struct text four_components(const char *structure, const char *basis, const char *data)
{
    static const char *const directions[] = {"Transmission Front", "Transmission Back",
                                             "Reflection Front", "Reflection Back"};
    struct text t;
    text_open(&t);
    make_head(t.stream, structure);
    for (int i = 0; i < 4; i++) {
        make_block_head(t.stream, "Visible", directions[i], basis);
        fputs(data, t.stream);
        make_block_tail(t.stream);
    }
    make_tail(t.stream);
    text_close(&t);
    return t;
}

/* Returns 41 x 41 values; some rows sum to far more than 1. */
static struct text lively_matrix(void)
{
    struct orl_random random = orl_random_stream(13, ORL_PURPOSE_BENCH, 1);
    struct text data, file;
    text_open(&data);
    for (int i = 0; i < 41 * 41; i++)
        fprintf(data.stream, "%.4g ", 0.7 * pow(uniform(&random), 3));
    text_close(&data);
    file = four_components("Columns", "LBNL/Klems Quarter", data.data);
    free(data.data);
    return file;
}

/* Returns a file of luma 0.75 everywhere, all of it red: 2.8 in that channel. */
static struct text red_file(void)
{
    static const char *const directions[] = {"Transmission Front", "Transmission Back",
                                             "Reflection Front", "Reflection Back"};
    static const char *const channels[][2] = {
        {"Visible", "{ 0.12 }"}, {"CIE-u", "{ 0.45 }"}, {"CIE-v", "{ 0.523 }"}};
    struct text t;
    text_open(&t);
    make_head(t.stream, "TensorTree4");
    for (int i = 0; i < 12; i++) {
        make_block_head(t.stream, channels[i % 3][0], directions[i / 3], NULL);
        fputs(channels[i % 3][1], t.stream);
        make_block_tail(t.stream);
    }
    make_tail(t.stream);
    text_close(&t);
    return t;
}

/* ---- 13: R + T above 1 ----------------------------------------------------------------------- */

enum { GAINERS = 4 };

static void load_gainers(struct orl_bsdf *ret_bsdfs[GAINERS])
{
    ret_bsdfs[0] = load_or_fail(four_components("TensorTree4", NULL, "{ 0.190985932 }"));
    ret_bsdfs[1] = load_or_fail(make_tree_file(4));
    ret_bsdfs[2] = load_or_fail(make_iso_file(4));
    ret_bsdfs[3] = load_or_fail(lively_matrix());
}

/*
 * For any file, no incident direction gains energy; where the file itself does not gain, its own
 * value stays. Tolerance: quotients of doubles, a few 1e-16.
 */
static void test_13_no_direction_gains(void **state)
{
    struct orl_bsdf *bsdfs[GAINERS];
    struct orl_random random = orl_random_stream(1, ORL_PURPOSE_BENCH, 13);
    double most = 0, weight_most = 0, filed = 0;
    (void)state;
    load_gainers(bsdfs);
    for (int b = 0; b < GAINERS; b++) {
        struct orl_bsdf_info info;
        orl_bsdf_describe(bsdfs[b], &info);
        assert_true(fmax(info.max_albedo[0], info.max_albedo[1]) > 1.1);
        filed = fmax(filed, fmax(info.max_albedo[0], info.max_albedo[1]));
        for (int i = 0; i < 50000; i++) {
            const struct orl_vec3 in = any_direction(&random);
            const double u[3] = {uniform(&random), uniform(&random), uniform(&random)};
            struct orl_vec3 out;
            struct orl_rgb weight;
            double pdf;
            most = fmax(most, orl_bsdf_albedo(bsdfs[b], in, ORL_BSDF_BOTH).g);
            if (orl_bsdf_sample(bsdfs[b], in, ORL_BSDF_BOTH, u, &out, &weight, &pdf))
                weight_most = fmax(weight_most, weight.g);
        }
        orl_bsdf_unref(bsdfs[b]);
    }
    struct orl_bsdf *red = load_or_fail(red_file());
    for (int i = 0; i < 1000; i++) {
        const struct orl_rgb sum = orl_bsdf_albedo(red, any_direction(&random), ORL_BSDF_BOTH);
        assert_true(sum.r > 0.9 && sum.g < 0.3);
        most = fmax(most, orl_rgb_max(sum));
    }
    orl_bsdf_unref(red);
    stability_row(13, "R + T > 1", "R + T in use in any channel, less 1", most - 1, 1e-14);
    stability_row(13, "R + T > 1", "weight of a draw, less 1", weight_most - 1, 1e-14);
    assert_true(filed > 1.5);
}

/* The pane is lossless after rescaling: half is reflected, half transmitted. */
#define PANE_1_2 0.190985932 /* 0.6 / pi */

static char *pane_of_1_2(void)
{
    char data[64];
    snprintf(data, sizeof data, "{ %.9f }", PANE_1_2);
    return four_components("TensorTree4", NULL, data).data;
}

static bool warns_of_rescaling(const struct orl_result *result)
{
    for (size_t i = 0; i < result->n_warnings; i++)
        if (strstr(result->warnings[i], "rescaled"))
            return true;
    return false;
}

/*
 * A box of such panes under an even sky all around: a furnace. If R + T is 1, every direction
 * inside sees the outside radiance. Sensors gather cosine-distributed rays, each of which scatters
 * several times.
 */
static void test_13_furnace(void **state)
{
    static const char scene[] =
        "void glow g 0 0 4 1 1 1 0\ng source sky 0 0 4 0 0 1 360\n"
        "void BSDF p 6 0 pane.xml 0.3 0.4 1 . 0 0\n!genbox p box 2 2 2 -i\n";
    static const struct orl_sensor sensors[3] = {
        {{1, 1, 1}, {0, 0, 1}}, {{.3, .4, .2}, {0, 0, -1}}, {{1.9, 1.9, 1.9}, {1, 1, 1}}};
    const uint32_t samples = stability_full() ? 65536 : 16384;
    char *xml = pane_of_1_2();
    double worst = -1;
    (void)state;
    struct orl_result result = scene_run(&(struct scene_run){.scene = scene,
                                                             .resource_name = "pane.xml",
                                                             .resource_text = xml,
                                                             .sensors = sensors,
                                                             .n_sensors = 3,
                                                             .samples = samples,
                                                             .global = 1000});
    for (int i = 0; i < 3; i++)
        worst = fmax(worst, fabs(result.illuminance_lx[i] / (efficacy * ORL_PI) - 1));
    stability_holds(13, "R + T > 1", "the result warns that it was rescaled",
                    warns_of_rescaling(&result));
    stability_row(13, "R + T > 1", "furnace of such panes: |E / E outside - 1|", worst, 0.01);
    orl_result_done(&result);
    free(xml);
}

/*
 * A lamp in a closed box that reflects half, with such a pane in the middle. Each photon lands
 * twice on the walls in the mean, for any pane that conserves energy. The lamp itself absorbs
 * 1e-3. The number of landings of a path has variance 2: n paths leave a standard error of
 * sqrt(1/2 / n) of the sum.
 */
static void test_13_photon_balance(void **state)
{
    static const char scene[] =
        "void plastic w 0 0 5 .5 .5 .5 0 0\n!genbox w box 2 2 2 -i\n"
        "void light l 0 0 3 1000 1000 1000\n"
        "l polygon lamp 0 0 12 .9 .9 1.99 .9 1.1 1.99 1.1 1.1 1.99 1.1 .9 1.99\n"
        "void BSDF p 6 0 pane.xml 0 1 0 . 0 0\n"
        "p polygon pane 0 0 12 .1 .1 1 1.9 .1 1 1.9 1.9 1 .1 1.9 1\n";
    static const struct orl_sensor sensor = {{.5, .5, 0}, {0, 0, 1}};
    char *xml = pane_of_1_2(), folder[64];
    double squares;
    (void)state;
    cli_make_folder(folder);
    struct orl_result result =
        scene_run(&(struct scene_run){.scene = scene,
                                      .resource_name = "pane.xml",
                                      .resource_text = xml,
                                      .sensors = &sensor,
                                      .n_sensors = 1,
                                      .samples = 64,
                                      .global = stability_full() ? 4000000 : 400000,
                                      .folder = folder});
    const double flux = scene_map_flux(&result, folder, "global", &squares);
    const double lossless = ORL_PI * 1000 * 0.04 / (1 - 0.5);
    stability_row(13, "R + T > 1", "closed box: |flux landed / that without a pane - 1|",
                  fabs(flux / lossless - 1), 0.01);
    orl_result_done(&result);
    cli_remove_folder(folder);
    free(xml);
}

/* ---- 15: all zero ---------------------------------------------------------------------------- */

static void test_15_black(void **state)
{
    static const char scene[] = "void glow g 0 0 4 1 1 1 0\ng source sky 0 0 4 0 0 1 360\n"
                                "void light l 0 0 3 1e6 1e6 1e6\nl source sun 0 0 4 0 -1 1 .533\n"
                                "void plastic w 0 0 5 .5 .5 .5 0 0\n"
                                "w polygon floor 0 0 12 0 0 0 4 0 0 4 5 0 0 5 0\n"
                                "w polygon ceiling 0 0 12 0 0 3 0 5 3 4 5 3 4 0 3\n"
                                "w polygon west 0 0 12 0 0 0 0 5 0 0 5 3 0 0 3\n"
                                "w polygon east 0 0 12 4 0 0 4 0 3 4 5 3 4 5 0\n"
                                "w polygon north 0 0 12 0 5 0 4 5 0 4 5 3 0 5 3\n"
                                "void BSDF p 6 0 pane.xml 0 0 1 . 0 0\n"
                                "p polygon pane 0 0 12 0 0 0 0 0 3 4 0 3 4 0 0\n";
    static const struct orl_sensor sensors[2] = {{{2, 1, 1}, {0, -1, 0}}, {{2, 2, 0}, {0, 0, 1}}};
    struct orl_bsdf *bsdf;
    struct orl_bsdf_check check;
    char xml[2048];
    double lx[2];
    (void)state;
    scene_uniform_bsdf(0, xml);
    scene_run_lx(&(struct scene_run){.scene = scene,
                                     .resource_name = "pane.xml",
                                     .resource_text = xml,
                                     .sensors = sensors,
                                     .n_sensors = 2,
                                     .caustic = 20000},
                 lx);
    stability_row(15, "all-zero BSDF", "E behind such a pane, lx", fmax(lx[0], lx[1]), 0);
    assert_int_equal(orl_bsdf_load_xml("zero.xml", xml, strlen(xml), &bsdf, NULL), 0);
    orl_bsdf_examine(bsdf, &check);
    stability_holds(15, "all-zero BSDF", "the check of BSDFs warns",
                    check.worst == ORL_BSDF_WARNING);
    orl_bsdf_unref(bsdf);
}

/* ---- 16: a peak of 1e5 1/sr ------------------------------------------------------------------ */

static const double peak_rings_deg[] = {0, 0.1, 30, 60, 90};

/* Returns a matrix whose first cell is 0.1 degrees in radius: 1e5 1/sr there integrate to 0.957. */
static struct text peaked_matrix(double peak, double elsewhere)
{
    enum { CELLS = 1 + 1 + 4 + 4 };
    struct text t;
    text_open(&t);
    fputs("<?xml version=\"1.0\"?>\n<WindowElement><Optical><Layer><Material><Name>peak</Name>"
          "</Material><DataDefinition>\n<IncidentDataStructure>Columns</IncidentDataStructure>\n"
          "<AngleBasis><AngleBasisName>own</AngleBasisName>\n",
          t.stream);
    for (int i = 0; i < 4; i++)
        fprintf(t.stream,
                "<AngleBasisBlock><Theta>%g</Theta><nPhis>%d</nPhis><ThetaBounds>"
                "<LowerTheta>%g</LowerTheta><UpperTheta>%g</UpperTheta></ThetaBounds>"
                "</AngleBasisBlock>\n",
                0.5 * (peak_rings_deg[i] + peak_rings_deg[i + 1]), i < 2 ? 1 : 4, peak_rings_deg[i],
                peak_rings_deg[i + 1]);
    fputs("</AngleBasis></DataDefinition>\n", t.stream);
    make_block_head(t.stream, "Visible", "Transmission Front", "own");
    for (int i = 0; i < CELLS * CELLS; i++)
        fprintf(t.stream, "%.9g ", i == 0 ? peak : elsewhere);
    make_block_tail(t.stream);
    make_tail(t.stream);
    text_close(&t);
    return t;
}

/* Integrates f over projected solid angle, by midpoints ring by ring: f is constant within cells.
 */
static double integrate_rings(const struct orl_bsdf *bsdf, struct orl_vec3 in)
{
    double sum = 0;
    for (int ring = 0; ring < 4; ring++) {
        const double low = pow(sin(peak_rings_deg[ring] * ORL_DEG_TO_RAD), 2);
        const double high = pow(sin(peak_rings_deg[ring + 1] * ORL_DEG_TO_RAD), 2);
        for (int k = 0; k < 64; k++) {
            const double s = low + (high - low) * (k / 16 + 0.5) / 4;
            const double phi = 2 * ORL_PI * (k % 16 + 0.5) / 16, r = sqrt(s);
            const struct orl_vec3 out = orl_v3(r * cos(phi), r * sin(phi), sqrt(1 - s));
            sum += orl_bsdf_eval(bsdf, in, out).g * ORL_PI * (high - low) / 64;
        }
    }
    return sum;
}

/* In a tree of 2^8 a leaf of 1e5 1/sr integrates to 4.79 over its cell, which is rescaled to 1. */
static double integrate_leaf(double *ret_filed)
{
    struct text t;
    struct orl_bsdf *bsdf;
    struct orl_bsdf_info info;
    double sum = 0;
    const int side = 256;
    text_open(&t);
    make_head(t.stream, "TensorTree4");
    make_block_head(t.stream, "Visible", "Reflection Front", NULL);
    for (int level = 0; level < 8; level++)
        fputs("{", t.stream);
    fputs("{100000}", t.stream);
    for (int level = 0; level < 8; level++)
        fputs("{0}{0}{0}{0}{0}{0}{0}{0}{0}{0}{0}{0}{0}{0}{0}}", t.stream);
    make_block_tail(t.stream);
    make_tail(t.stream);
    text_close(&t);
    bsdf = load_or_fail(t);
    orl_bsdf_describe(bsdf, &info);
    *ret_filed = fmax(info.max_albedo[0], info.max_albedo[1]);
    const double r = 0.9999, z = -sqrt(1 - r * r);
    const struct orl_vec3 in = orl_v3(r * M_SQRT1_2, r * M_SQRT1_2, z);
    for (int i = 0; i < side * side; i++) {
        const struct orl_vec3 out = orl_square_to_hemisphere(
            (struct orl_square){2 * (i / side + 0.5) / side - 1, 2 * (i % side + 0.5) / side - 1});
        sum += orl_bsdf_eval(bsdf, in, orl_v3(out.x, out.y, -out.z)).g;
    }
    orl_bsdf_unref(bsdf);
    return sum * ORL_PI / (side * side);
}

static void test_16_tall_leaf(void **state)
{
    const struct orl_vec3 in = {0, 0, -1};
    const double share = ORL_PI * pow(sin(0.1 * ORL_DEG_TO_RAD), 2);
    const double tau = 1e5 * share + 0.01 * (ORL_PI - share);
    struct orl_bsdf *bsdf = load_or_fail(peaked_matrix(1e5, 0.01));
    double filed;
    (void)state;
    stability_row(16, "leaf of 1e5 1/sr", "matrix: |sum f W - tau|",
                  fabs(integrate_rings(bsdf, in) - tau), 1e-6);
    stability_row(16, "leaf of 1e5 1/sr", "matrix: |albedo - tau|",
                  fabs(orl_bsdf_albedo(bsdf, in, ORL_BSDF_BOTH).g - tau), 1e-6);
    orl_bsdf_unref(bsdf);
    const double rescaled = integrate_leaf(&filed);
    stability_row(16, "leaf of 1e5 1/sr", "tree: |sum f W - 1|, 4.79 being rescaled",
                  fabs(rescaled - 1), 1e-6);
    stability_row(16, "leaf of 1e5 1/sr", "tree: |tau reported - 1e5 W|",
                  fabs(filed - 1e5 * ORL_PI / 65536), 1e-6);
}

/* ---- 17: one cell of 1e-12 of the total ------------------------------------------------------ */

enum { FULL = 145, SLIVER = 70 };

/* Builds a matrix and returns its first column: scattering of light along the axis. Two cells are
 * black, and one has 1e-12 of the total. */
static struct text sliver_matrix(double ret_column[FULL])
{
    struct orl_random random = orl_random_stream(17, ORL_PURPOSE_BENCH, 1);
    struct orl_basis basis;
    struct text t;
    double total = 0;
    assert_int_equal(orl_basis_standard("LBNL/Klems Full", &basis), 0);
    for (int i = 0; i < FULL; i++) {
        ret_column[i] = i == 20 || i == 21 ? 0 : 0.05 + 0.2 * uniform(&random);
        total += ret_column[i] * orl_basis_ring(&basis, i)->omega_sr;
    }
    ret_column[SLIVER] = 1e-12 * total / orl_basis_ring(&basis, SLIVER)->omega_sr;
    text_open(&t);
    make_head(t.stream, "Columns");
    make_block_head(t.stream, "Visible", "Reflection Front", "LBNL/Klems Full");
    for (int i = 0; i < FULL * FULL; i++)
        fprintf(t.stream, "%.9g ", i % FULL == 0 ? ret_column[i / FULL] : 0.1);
    make_block_tail(t.stream);
    make_tail(t.stream);
    text_close(&t);
    return t;
}

/* Returns the cell sampled for that first number; checks that the sample is sound. */
static int draw_cell(const struct orl_bsdf *bsdf, const struct orl_basis *basis, double u0,
                     double u1, long *unsound)
{
    const double u[3] = {u0, u1, 0.5};
    struct orl_vec3 out = {0, 0, 0};
    struct orl_rgb weight = {0, 0, 0};
    double pdf = 0;
    const bool drawn =
        orl_bsdf_sample(bsdf, orl_v3(0, 0, -1), ORL_BSDF_REFLECT, u, &out, &weight, &pdf);
    *unsound += !drawn || !(pdf > 0) || !isfinite(pdf) || !(weight.g > 0) || !isfinite(weight.g) ||
                !(fabs(orl_length(out) - 1) < 1e-12);
    return orl_basis_cell(basis, orl_polar_of(out), 0);
}

/* Returns true if random numbers in the sliver's own range, 1e-12 wide, sample it; found by
 * bisection. */
static bool finds_sliver(const struct orl_bsdf *bsdf, const struct orl_basis *basis, long *unsound)
{
    double low = 0, high = 1;
    while (0.5 * (low + high) > low && 0.5 * (low + high) < high) {
        const double middle = 0.5 * (low + high);
        if (draw_cell(bsdf, basis, middle, 0.5, unsound) >= SLIVER)
            high = middle;
        else
            low = middle;
    }
    return draw_cell(bsdf, basis, high, 0.5, unsound) == SLIVER;
}

/* Returns Pearson's sum over cells as a standard normal deviate (Wilson and Hilferty). */
static double deviate(const double *expected, const long *counted)
{
    double x = 0;
    int cells = 0;
    for (int i = 0; i < FULL; i++) {
        if (expected[i] < 10)
            continue;
        x += pow((double)counted[i] - expected[i], 2) / expected[i];
        cells++;
    }
    const double k = cells - 1, step = 2 / (9 * k);
    return (cbrt(x / k) - (1 - step)) / sqrt(step);
}

static void test_17_sliver(void **state)
{
    const long draws = stability_full() ? 10000000 : 1000000;
    double column[FULL], expected[FULL], total = 0;
    long counted[FULL] = {0}, unsound = 0, falls = 0, dark;
    int before = 0;
    struct orl_basis basis;
    struct orl_random random = orl_random_stream(2, ORL_PURPOSE_BENCH, 17);
    struct orl_bsdf *bsdf = load_or_fail(sliver_matrix(column));
    (void)state;
    assert_int_equal(orl_basis_standard("LBNL/Klems Full", &basis), 0);
    for (int i = 0; i < FULL; i++)
        total += column[i] * orl_basis_ring(&basis, i)->omega_sr;
    for (int i = 0; i < FULL; i++)
        expected[i] = (double)draws * column[i] * orl_basis_ring(&basis, i)->omega_sr / total;
    for (long i = 0; i < draws; i++)
        counted[draw_cell(bsdf, &basis, uniform(&random), uniform(&random), &unsound)]++;
    for (int i = 0; i <= 200000; i++) {
        const int cell = draw_cell(bsdf, &basis, fmin(i / 2e5, 1 - 0x1p-53), 0.5, &unsound);
        falls += cell < before;
        before = cell;
    }
    dark = counted[20] + counted[21];
    stability_row(17, "one cell 1e-12 of the total", "steps at which the running sum falls",
                  (double)falls, 0);
    stability_holds(17, "one cell 1e-12 of the total", "its own 1e-12 of numbers find the cell",
                    finds_sliver(bsdf, &basis, &unsound));
    stability_row(17, "one cell 1e-12 of the total", "draws of no width, value or length",
                  (double)(unsound + dark), 0);
    stability_row(17, "one cell 1e-12 of the total", "chi-square of the draws, standard deviations",
                  deviate(expected, counted), 3.1);
    orl_bsdf_unref(bsdf);
}

/* ---- 18: uniform data ------------------------------------------------------------------------ */

/* Computes the maximum of |f - diffuse| / f (required for uniform data), and of diffuse - f. */
static void compare_with_diffuse(const struct orl_bsdf *bsdf, double *difference, double *excess)
{
    struct orl_random random = orl_random_stream(3, ORL_PURPOSE_BENCH, 18);
    for (int i = 0; i < 100000; i++) {
        const struct orl_vec3 in = any_direction(&random), out = any_direction(&random);
        const double f = orl_bsdf_eval(bsdf, in, out).g;
        const double diffuse = orl_bsdf_diffuse(bsdf, in.z > 0, (in.z > 0) != (out.z > 0)).g;
        *difference = fmax(*difference, f > 0 ? fabs(f - diffuse) / f : diffuse);
        *excess = fmax(*excess, diffuse - f);
    }
}

static void test_18_uniform(void **state)
{
    struct text ones;
    struct orl_bsdf *even[3], *gainers[GAINERS];
    double difference = 0, excess = -1, ignored = 0;
    (void)state;
    text_open(&ones);
    for (int i = 0; i < 41 * 41; i++)
        fputs("0.15 ", ones.stream);
    text_close(&ones);
    even[0] = load_or_fail(four_components("TensorTree4", NULL, "{ 0.15 }"));
    even[1] = load_or_fail(four_components("TensorTree3", NULL, "{ 0.15 }"));
    even[2] = load_or_fail(four_components("Columns", "LBNL/Klems Quarter", ones.data));
    free(ones.data);
    for (int b = 0; b < 3; b++) {
        compare_with_diffuse(even[b], &difference, &excess);
        orl_bsdf_unref(even[b]);
    }
    stability_row(18, "uniform BSDF", "|f - diffuse part| / f", difference, 0);
    load_gainers(gainers);
    for (int b = 0; b < GAINERS; b++) {
        compare_with_diffuse(gainers[b], &ignored, &excess);
        orl_bsdf_unref(gainers[b]);
    }
    stability_row(18, "uniform BSDF", "diffuse part less f, rescaled data too, 1/sr", excess,
                  1e-15);
}

int main(void)
{
    static const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_13_no_direction_gains),
        cmocka_unit_test(test_13_furnace),
        cmocka_unit_test(test_13_photon_balance),
        cmocka_unit_test(test_15_black),
        cmocka_unit_test(test_16_tall_leaf),
        cmocka_unit_test(test_17_sliver),
        cmocka_unit_test(test_18_uniform),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
