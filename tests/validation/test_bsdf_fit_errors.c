/*
 * Compares the standard error that `bsdf fit` states of a total with the actual error, for samples
 * in closed form (tests/support/scatterers.h): with noise and without, with many rows and few, from
 * steep to grazing light, with several seeds.
 *
 * Bounds. The ratio of the actual rms to the stated rms, of n scans, scatters by 1/sqrt(2 n): it is
 * at most 2.2 of these above 1. For the 5 scans of the short form's one seed it scatters by 32 %,
 * and is at most 1.70; for the 20 of the long suite's four seeds by 16 %, and is at most 1.35. The
 * stated error includes more than noise (rows too far apart, the rim without measurements), so that
 * it may be several times too large in good cases; over all kinds the ratio is at least a third.
 * Shares within one, two and three errors are at least those of a normal distribution, less four
 * standard deviations of that number.
 */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "bsdf/fit/measurements/measurements.h"
#include "bsdf/fit/scan/scan_light.h"
#include "support/extent.h"
#include "support/scatterers.h"

enum { ANGLES = 5 };
static const double thetas[ANGLES] = {8, 32, 56, 74, 83};
static const double normal_shares[3] = {0.6827, 0.9545, 0.9973};
/* Levels of a tree of rank 4 with 64 cells per side, for lobes. */
static const unsigned levels[2] = {6, 9};

struct tally {
    size_t count, within[3];
    double made2, stated2;
};

static struct orl_fit_shape shape_of(enum scatterer which, const struct scatterer_scan *scan)
{
    static const struct orl_fit_read_options reading = {0};
    static const struct orl_fit_rbf_options making = {0};
    enum orl_bsdf_fit_symmetry symmetry;
    struct orl_fit_data data = {0};
    struct orl_fit_rbf centers;
    struct orl_fit_shape shape;
    struct orl_error err = {0};
    char *text = NULL;
    size_t size = 0;
    FILE *out = open_memstream(&text, &size);
    assert_non_null(out);
    scatterer_write(out, which, scan);
    assert_int_equal(fclose(out), 0);
    assert_int_equal(orl_fit_read("scan.txt", 0, text, size, &reading, &data, &err), 0);
    assert_int_equal(orl_fit_sort_scans(&data, ORL_BSDF_FIT_ISOTROPIC, &symmetry, &err), 0);
    assert_int_equal(orl_fit_rbf_make(&data.scans[0], &making, &centers, &err), 0);
    assert_int_equal(orl_fit_shape_make(&centers, data.scans[0].in, levels, NULL, &shape, &err), 0);
    orl_fit_rbf_done(&centers);
    orl_fit_data_done(&data);
    free(text);
    return shape;
}

static void count_error(struct tally *tally, double made, double stated)
{
    tally->count++;
    tally->made2 += made * made;
    tally->stated2 += stated * stated;
    for (int k = 0; k < 3; k++)
        tally->within[k] += fabs(made) < (k + 1) * stated;
}

/* Returns the albedo by the number of the angle; computed once. */
static double albedo_of(enum scatterer which, size_t angle)
{
    static double known[SCATTERERS][ANGLES];
    double *const albedo = &known[which][angle];
    if (*albedo == 0)
        *albedo = scatterer_albedo(which, scatterer_direction(thetas[angle], 180));
    return *albedo;
}

static void of_kind(enum scatterer which, double noise, unsigned rows, struct tally *all)
{
    struct tally tally = {0};
    for (size_t i = 0; i < ANGLES; i++) {
        const double albedo = albedo_of(which, i);
        for (uint64_t seed = 1; seed <= extent(1, 4); seed++) {
            const struct scatterer_scan scan = {thetas[i], 180, rows, noise, true, 100 * i + seed};
            struct orl_fit_shape shape = shape_of(which, &scan);
            count_error(&tally, shape.total - albedo, shape.total_error);
            count_error(all, shape.total - albedo, shape.total_error);
            orl_fit_shape_done(&shape);
        }
    }
    const double ratio = sqrt(tally.made2 / tally.stated2);
    print_message("# %s, noise %g, %u rows: made %.5f, stated %.5f, ratio %.2f\n",
                  scatterers[which].name, noise, rows, sqrt(tally.made2 / (double)tally.count),
                  sqrt(tally.stated2 / (double)tally.count), ratio);
    assert_true(ratio < 1 + 2.2 / sqrt(2 * (double)tally.count));
}

static void totals_are_as_wrong_as_stated(void **state)
{
    struct tally all = {0};
    (void)state;
    for (int which = 0; which < SCATTERERS; which++)
        for (int few = 0; few < 2; few++)
            for (int noisy = 0; noisy < 2; noisy++)
                of_kind((enum scatterer)which, noisy ? 0.02 : 0, few ? 3000 : 10000, &all);
    const double n = (double)all.count;
    print_message("# all: %zu scans, within %.3f %.3f %.3f, ratio %.2f\n", all.count,
                  (double)all.within[0] / n, (double)all.within[1] / n, (double)all.within[2] / n,
                  sqrt(all.made2 / all.stated2));
    assert_true(all.made2 > all.stated2 / 9);
    for (int k = 0; k < 3; k++) {
        const double p = normal_shares[k];
        assert_true((double)all.within[k] / n > p - 4 * sqrt(p * (1 - p) / n));
    }
}

int main(void)
{
    static const struct CMUnitTest tests[] = {cmocka_unit_test(totals_are_as_wrong_as_stated)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
