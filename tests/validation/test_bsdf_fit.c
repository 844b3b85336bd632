/*
 * BSDFs fitted to what a goniophotometer would measure of samples in closed form
 * (tests/support/scatterers.h): 12 incident directions, 10 000 rows each, 2 % of noise, nothing
 * beyond 88 degrees nor around where light comes from.
 *
 * Bounds. Totals: 1 %, 2 % from 75 degrees on. A Gaussian of scatter that 10 000 places see, half
 * of them on a raster of 2 degrees, is told by its density to a few per mille; noise adds 2 % over
 * the root of some hundred rows. Peaks: 0.5 degrees, and 3 % of the light within 5 degrees, both of
 * the sample averaged over the cells of the tree, which is all that a tree can have. In rings of
 * incidence that the tree has, at their middle, but for the last ones, which are 5 degrees wide and
 * more.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include <oriel/bsdf.h>
#include <oriel/bsdf_fit.h>

#include "bsdf/shirley.h"
#include "support/scatterers.h"

enum { SIDE = 64, SCANS = 24 };

/* ---- Fitting --------------------------------------------------------------------------------- */

struct bench {
    char names[SCANS][16];
    const char *name_list[SCANS];
    struct orl_file contents[SCANS];
    size_t n;
};

static void measure(struct bench *bench, enum scatterer which, double theta, double phi)
{
    const struct scatterer_scan scan = {theta, phi, 10000, 0.02, true, bench->n + 1};
    char *text = NULL;
    size_t size = 0;
    FILE *out = open_memstream(&text, &size);
    assert_non_null(out);
    scatterer_write(out, which, &scan);
    assert_int_equal(fclose(out), 0);
    sprintf(bench->names[bench->n], "s%zu.txt", bench->n);
    bench->name_list[bench->n] = bench->names[bench->n];
    bench->contents[bench->n++] = (struct orl_file){.data = text, .size = size};
}

static void clear(struct bench *bench)
{
    for (size_t i = 0; i < bench->n; i++) {
        char *text = (char *)(uintptr_t)bench->contents[i].data;
        free(text);
    }
}

static struct orl_bsdf_fitted fit(struct bench *bench, enum orl_bsdf_basis basis,
                                  uint32_t resolution, uint32_t threads)
{
    struct orl_memory_files memory = {bench->name_list, bench->contents, bench->n};
    const struct orl_files files = orl_files_from_memory(&memory);
    struct orl_crew *crew = orl_crew_start(threads);
    const struct orl_bsdf_make_env env = {.files = &files, .crew = crew};
    struct orl_bsdf_fit_request request;
    struct orl_bsdf_fitted fitted = {0};
    struct orl_error err = {0};
    char *names[SCANS];
    orl_bsdf_fit_request_init(&request);
    for (size_t i = 0; i < bench->n; i++)
        names[i] = bench->names[i];
    request.files = names;
    request.n_files = bench->n;
    request.has_basis = true;
    request.basis = basis;
    request.resolution = resolution;
    assert_non_null(crew);
    if (orl_bsdf_fit(&request, &env, &fitted, &err) < 0)
        fail_msg("%s:%d: %s", err.file, err.line, err.message);
    orl_crew_stop(crew);
    return fitted;
}

static struct orl_bsdf *load(const struct orl_bsdf_fitted *fitted)
{
    struct orl_bsdf *bsdf = NULL;
    struct orl_error err = {0};
    if (orl_bsdf_load_xml("fitted.xml", fitted->xml, fitted->xml_size, &bsdf, &err) < 0)
        fail_msg("line %d: %s", err.line, err.message);
    return bsdf;
}

/* ---- Looking --------------------------------------------------------------------------------- */

struct seen {
    double total, cone[2];
    struct orl_vec3 middle[2]; /* of the light in the cone */
};

static struct orl_vec3 in_cell(int x, int y, double u, double v)
{
    return orl_square_to_hemisphere(
        (struct orl_square){2 * (x + u) / SIDE - 1, 2 * (y + v) / SIDE - 1});
}

/* Over a cell; close to a peak of a third of a degree by many places. */
static double mean_of(enum scatterer which, struct orl_vec3 in, int x, int y)
{
    struct orl_vec3 peaks[2];
    int fine = 3;
    for (int k = scatterer_peaks(which, in, peaks); k > 0; k--)
        if (orl_dot(in_cell(x, y, 0.5, 0.5), peaks[k - 1]) > cos(8 * ORL_DEG_TO_RAD))
            fine = 16;
    double sum = 0;
    for (int i = 0; i < fine * fine; i++)
        sum += scatterer_value(
            which, in, in_cell(x, y, (i % fine + 0.5) / fine, ((double)(i / fine) + 0.5) / fine));
    return sum / (fine * fine);
}

/* Of light from in, by the means of cells: of the sample, or of its BSDF. */
static struct seen look(enum scatterer which, struct orl_vec3 in, const struct orl_bsdf *bsdf)
{
    struct orl_vec3 peaks[2];
    struct seen seen = {0};
    const int n_peaks = scatterer_peaks(which, in, peaks);
    for (int i = 0; i < SIDE * SIDE; i++) {
        const int x = i % SIDE, y = i / SIDE;
        struct orl_vec3 out = in_cell(x, y, 0.5, 0.5);
        const struct orl_vec3 up = out;
        if (scatterers[which].transmits)
            out.z = -out.z;
        const double light =
            ORL_PI / (SIDE * SIDE) *
            (bsdf ? orl_luma(orl_bsdf_eval(bsdf, in, out)) : mean_of(which, in, x, y));
        seen.total += light;
        for (int k = 0; k < n_peaks; k++) {
            if (orl_dot(up, peaks[k]) < cos(5 * ORL_DEG_TO_RAD))
                continue;
            seen.cone[k] += light;
            seen.middle[k] = orl_madd(seen.middle[k], up, light);
        }
    }
    return seen;
}

static double apart_deg(struct orl_vec3 a, struct orl_vec3 b)
{
    const struct orl_vec3 u = orl_normalize(a), v = orl_normalize(b);
    return 2 * asin(0.5 * orl_length(orl_sub(u, v))) / ORL_DEG_TO_RAD;
}

static void compare(enum scatterer which, const struct orl_bsdf *bsdf, int ring, double cone_bound)
{
    const double r = (ring + 0.5) / (SIDE / 2.0), theta = asin(r) / ORL_DEG_TO_RAD;
    const struct orl_vec3 in = orl_v3(-r, 0, sqrt(1 - r * r));
    const struct seen truth = look(which, in, NULL), got = look(which, in, bsdf);
    struct orl_vec3 peaks[2];
    const int n_peaks = scatterer_peaks(which, in, peaks);
    const double off = got.total / scatterer_albedo(which, in) - 1;
    print_message("# %s, theta %.1f: total %+.2f %%", scatterers[which].name, theta, 100 * off);
    for (int k = 0; k < n_peaks; k++)
        print_message("; peak off by %.3f degrees, cone %+.2f %%",
                      apart_deg(truth.middle[k], got.middle[k]),
                      100 * (got.cone[k] / truth.cone[k] - 1));
    print_message("\n");
    assert_true(fabs(off) < (theta < 75 ? 0.01 : 0.02));
    for (int k = 0; k < n_peaks; k++) {
        assert_true(apart_deg(truth.middle[k], got.middle[k]) < 0.5);
        assert_true(fabs(got.cone[k] / truth.cone[k] - 1) < cone_bound);
    }
}

static void measure_row(struct bench *bench, enum scatterer which)
{
    static const double thetas[] = {8, 16, 24, 32, 40, 48, 56, 62, 68, 74, 79, 83};
    for (size_t i = 0; i < sizeof thetas / sizeof *thetas; i++)
        measure(bench, which, thetas[i], 180);
}

/* Of perfectly diffuse light: rings of the same projected solid angle. */
static double diffuse_of(enum scatterer which)
{
    enum { RINGS = 40 };
    double sum = 0;
    for (int i = 0; i < RINGS; i++)
        sum += scatterer_albedo(
            which, scatterer_direction(asin(sqrt((i + 0.5) / RINGS)) / ORL_DEG_TO_RAD, 180));
    return sum / RINGS;
}

/* What scans tell: totals, and those of the ones left out as the others predict them. */
static void check_scans(enum scatterer which, const struct orl_bsdf_fitted *fitted)
{
    double squares = 0;
    size_t left_out = 0;
    for (size_t i = 0; i < fitted->n_scans; i++) {
        const struct orl_bsdf_fitted_scan *s = &fitted->scans[i];
        const double albedo = scatterer_albedo(which, scatterer_direction(s->theta_deg, 180));
        assert_true(fabs(s->total / albedo - 1) < (s->theta_deg < 75 ? 0.01 : 0.02));
        /* Four errors are next to never; leaves' own quadrature is good to 0.2 %. */
        assert_true(fabs(s->total - albedo) < 4 * s->total_error + 0.002);
        if (!s->left_out)
            continue;
        squares += (s->predicted - albedo) * (s->predicted - albedo);
        left_out++;
    }
    /* All but the last, as the first one's mirror image stands on its other side. */
    assert_int_equal(left_out, fitted->n_scans - 1);
    const double rms = sqrt(squares / (double)left_out);
    const struct orl_bsdf_share told =
        fitted->diffuse[fitted->scans[0].front][fitted->scans[0].transmitted];
    const double diffuse = diffuse_of(which);
    print_message("# %s: left out, off by %.1e, told %.1e; diffuse light %.5f off by %+.1e\n",
                  scatterers[which].name, rms, told.error, diffuse, told.value - diffuse);
    assert_true(fabs(told.value - diffuse) < 2 * told.error + 0.0005);
    /* What is told compares with measured totals, which have errors of their own. */
    assert_true(told.error < 2 * rms + 0.003 && rms < 2 * told.error + 0.003);
}

static void check(enum scatterer which, double cone_bound)
{
    static const int rings[] = {6, 12, 18, 20, 25, 29, 30};
    struct bench bench = {0};
    measure_row(&bench, which);
    struct orl_bsdf_fitted fitted = fit(&bench, ORL_BSDF_TENSOR_TREE_3, SIDE, 2);
    struct orl_bsdf *bsdf = load(&fitted);
    assert_int_equal(fitted.symmetry, ORL_BSDF_FIT_ISOTROPIC);
    check_scans(which, &fitted);
    for (size_t i = 0; i < sizeof rings / sizeof *rings; i++)
        compare(which, bsdf, rings[i], cone_bound);
    orl_bsdf_unref(bsdf);
    orl_bsdf_fitted_done(&fitted);
    clear(&bench);
}

/* ---- Cases ----------------------------------------------------------------------------------- */

static void lambert(void **state)
{
    (void)state;
    check(SCATTERER_LAMBERT, 0);
}

static void ward(void **state)
{
    (void)state;
    check(SCATTERER_WARD, 0.03);
}

static void slab(void **state)
{
    (void)state;
    check(SCATTERER_SLAB, 0.03);
}

static void peak(void **state)
{
    (void)state;
    check(SCATTERER_PEAK, 0.03);
}

static void crossing(void **state)
{
    (void)state;
    /* Where lobes of 4 degrees part, within two of their widths, which is whose is nobody's to
     * tell. */
    check(SCATTERER_CROSSING, 0.06);
}

/* Of light along the normal what is mirrored goes where the lamp stands. */
static void a_hidden_peak_is_told(void **state)
{
    struct bench bench = {0};
    (void)state;
    measure(&bench, SCATTERER_PEAK, 0, 180);
    measure(&bench, SCATTERER_PEAK, 20, 180);
    struct orl_bsdf_fitted fitted = fit(&bench, ORL_BSDF_TENSOR_TREE_3, 8, 1);
    assert_int_equal(fitted.n_scans, 2);
    assert_true(fitted.scans[0].hidden_deg > 3.9 && fitted.scans[0].hidden_deg < 4.2);
    assert_true(fitted.scans[1].hidden_deg == 0);
    orl_bsdf_fitted_done(&fitted);
    clear(&bench);
}

static void threads_do_not_matter(void **state)
{
    struct bench bench = {0};
    (void)state;
    for (double phi = 0; phi <= 90; phi += 45) {
        measure(&bench, SCATTERER_ANISOTROPIC, 25, phi);
        measure(&bench, SCATTERER_ANISOTROPIC, 60, phi);
    }
    struct orl_bsdf_fitted one = fit(&bench, ORL_BSDF_TENSOR_TREE_4, 8, 1);
    struct orl_bsdf_fitted three = fit(&bench, ORL_BSDF_TENSOR_TREE_4, 8, 3);
    assert_int_equal(one.symmetry, ORL_BSDF_FIT_QUADRILATERAL);
    assert_int_equal(one.xml_size, three.xml_size);
    assert_memory_equal(one.xml, three.xml, one.xml_size);
    struct orl_bsdf *bsdf = load(&one);
    /* Mirror images are the same, to the last bit. */
    for (int i = 0; i < 100; i++) {
        const struct orl_vec3 in = scatterer_direction(37 + 0.4 * i, 11 + i);
        const struct orl_vec3 out = scatterer_direction(80 - 0.7 * i, 47 - 3 * i);
        const double f = orl_bsdf_eval(bsdf, in, out).g;
        assert_true(f ==
                    orl_bsdf_eval(bsdf, orl_v3(-in.x, in.y, in.z), orl_v3(-out.x, out.y, out.z)).g);
        assert_true(f ==
                    orl_bsdf_eval(bsdf, orl_v3(in.x, -in.y, in.z), orl_v3(out.x, -out.y, out.z)).g);
    }
    orl_bsdf_unref(bsdf);
    orl_bsdf_fitted_done(&one);
    orl_bsdf_fitted_done(&three);
    clear(&bench);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(lambert),
        cmocka_unit_test(ward),
        cmocka_unit_test(slab),
        cmocka_unit_test(peak),
        cmocka_unit_test(crossing),
        cmocka_unit_test(a_hidden_peak_is_told),
        cmocka_unit_test(threads_do_not_matter),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
