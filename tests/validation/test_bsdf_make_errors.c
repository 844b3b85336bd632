/*
 * Compares the errors that `bsdf make` states with the actual errors: the number of cells within
 * one, two and three of them (in joint errors) of an independent run. That run has 4 to 32 times
 * the paths of those with a fixed number, in the short form 2 to 8 times. It states its errors by
 * the same code, so that errors stated too small by a factor show in full for any number of its
 * paths.
 *
 * Bounds. An error from 16 batches is Student's t of 15 degrees of freedom: 0.6669, 0.9361 and
 * 0.9910 of cells. A share of n cells scatters by sqrt(p (1 - p) / n); four of these are allowed,
 * and twice as many because cells of one item are not quite independent and all seeds share the
 * longer run. Cells with few paths include a margin of one more path, and are therefore more often
 * within: the upper bounds limit that margin.
 */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "bsdf/tree/shirley.h"
#include "fixtures/bsdf_ask.h"
#include "support/extent.h"
#include "support/panels.h"

static const double square[4] = {0, 1, 0, 1};
static const double nominal[3] = {0.6669, 0.9361, 0.9910};

/* Uniform diffuse transmission of half of the light. */
static const char sheet[] = "void trans s 0 0 7 .8 .8 .8 0 0 .5 0\n"
                            "s polygon p 0 0 12 0 0 0 1 0 0 1 1 0 0 1 0\n";
/* A laser cut panel, completely clear. */
static const char cut[] = "void dielectric d 0 0 5 1 1 1 1.491 0\n"
                          "!genbox d part 4 1 1.5 | xform -t -2 0 -1.5\n";
/* A saw of clear plastic with paint on a tooth's back. */
static const char saw[] = "void dielectric d 0 0 5 1 1 1 1.5 0\n"
                          "void plastic p 0 0 5 .7 .5 .2 .1 .1\n"
                          "d polygon flat 0 0 12 -1 -1 0 2 -1 0 2 2 0 -1 2 0\n"
                          "d polygon slope 0 0 12 -1 0 -.2 -1 1 -.6 2 1 -.6 2 0 -.2\n"
                          "d polygon riser 0 0 12 -1 1 -.6 -1 1 -.2 2 1 -.2 2 1 -.6\n"
                          "p polygon paint 0 0 12 0 .2 -.8 0 .5 -.8 .6 .5 -.8 .6 .2 -.8\n";
/* A sheet that scatters around the straight direction. */
static const char frosted[] = "void trans s 0 0 7 .8 .8 .8 .04 .15 .7 .8\n"
                              "s polygon p 0 0 12 0 0 0 1 0 0 1 1 0 0 1 0\n";
/* A matt blind. */
static const char blind[] = "void plastic w 0 0 5 .7 .7 .7 0 0\n"
                            "w polygon s 0 0 12 0 0 0 1 0 0 1 .6 -.6 0 .6 -.6\n";

/* ---- Counting -------------------------------------------------------------------------------- */

struct tally {
    size_t count, within[3];
    double squares; /* sum of squared differences in units of errors */
};

static void count_error(struct tally *tally, double off, double error)
{
    const double z = fabs(off) / error;
    assert_true(error > 0);
    tally->count++;
    tally->squares += z * z;
    for (int k = 0; k < 3; k++)
        tally->within[k] += z < k + 1;
}

/* room: allowed excess of the share of cells within one and two errors. */
static void assert_true_errors(const struct tally *tally, const char *name, double room)
{
    const double n = (double)tally->count;
    print_message("# %s: of %zu cells %.3f %.3f %.4f, mean square %.2f\n", name, tally->count,
                  (double)tally->within[0] / n, (double)tally->within[1] / n,
                  (double)tally->within[2] / n, tally->squares / n);
    assert_true(tally->count > extent(150, 300)); /* one seed, and two */
    /* The square of t has the mean 15/13 and the standard deviation 1.84. */
    assert_true(tally->squares / n < 15.0 / 13 + 4 * sqrt(2) * 1.84 / sqrt(n));
    for (int k = 0; k < 3; k++) {
        const double p = nominal[k], share = (double)tally->within[k] / n;
        const double chance = 4 * sqrt(2) * sqrt(p * (1 - p) / n);
        assert_true(share > p - chance);
        assert_true(share < p + chance + room * (1 - p));
    }
}

/* ---- Matrices -------------------------------------------------------------------------------- */

/* A computed BSDF with its XML parsed. */
struct made {
    struct orl_bsdf_make_result made;
    struct orl_bsdf *bsdf, *errors; /* errors: for trees */
};

static struct made make_bsdf(struct panel panel, uint64_t seed)
{
    panel.seed = seed;
    panel.threads = 2;
    struct made m = {.made = panel_make(&panel)};
    m.bsdf = panel_read(&m.made);
    if (panel.want_errors) {
        struct orl_error err = {0};
        if (orl_bsdf_load_xml("errors.xml", m.made.errors_xml, m.made.errors_xml_size, &m.errors,
                              &err) < 0)
            fail_msg("line %d: %s", err.line, err.message);
    }
    return m;
}

static void done(struct made *m)
{
    orl_bsdf_unref(m->bsdf);
    orl_bsdf_unref(m->errors);
    orl_bsdf_make_result_done(&m->made);
}

/* Returns the direction from which light of a cell comes, on that side. */
static struct orl_vec3 origin(const struct orl_bsdf_make_result *made, size_t cell, double side)
{
    const struct orl_bsdf_make_direction *d = &made->directions[cell];
    const double s = sin(d->theta_deg * ORL_DEG_TO_RAD), phi = d->phi_deg * ORL_DEG_TO_RAD;
    return direction(s * cos(phi), s * sin(phi), side);
}

/* Value in a part of a matrix, by the incident direction and the outgoing cell. */
static double value(const struct made *m, int part, size_t i, size_t k)
{
    const bool front = part / 2, transmitted = part % 2;
    const struct orl_vec3 in = origin(&m->made, i, front ? 1 : -1);
    struct orl_vec3 out = orl_neg(origin(&m->made, k, 1));
    out.z = front == transmitted ? -fabs(out.z) : fabs(out.z);
    return eval(m->bsdf, in, out);
}

static void compare_part(const struct made *m, const struct made *longer, int part,
                         struct tally *tally)
{
    const size_t n = m->made.n_directions;
    double peak = 0;
    for (size_t i = 0; i < n * n; i++)
        peak = fmax(peak, value(longer, part, i / n, i % n));
    for (size_t i = 0; i < n * n && peak > 0; i++) {
        const double is = value(longer, part, i / n, i % n);
        const double e0 = (double)m->made.errors[part / 2][part % 2][i];
        const double e1 = (double)longer->made.errors[part / 2][part % 2][i];
        if (is >= 0.01 * peak)
            count_error(tally, value(m, part, i / n, i % n) - is, hypot(e0, e1));
    }
}

/* Compares the directions' reflected and transmitted shares. If almost nothing is random, as for a
 * sheet that scatters evenly, they may be known better than the smallest stated error. */
static void compare_shares(const struct orl_bsdf_make_result *made,
                           const struct orl_bsdf_make_result *longer, struct tally *tally)
{
    const double least = 1e-6;
    for (size_t i = 0; i < 4 * made->n_directions; i++) {
        const struct orl_bsdf_share *a = &made->directions[i / 4].shares[i / 2 % 2][i % 2];
        const struct orl_bsdf_share *b = &longer->directions[i / 4].shares[i / 2 % 2][i % 2];
        if (a->value > 0 || b->value > 0)
            count_error(tally, a->value - b->value, hypot(hypot(a->error, b->error), least));
    }
}

/* Tallies all seeds, with that many paths or to an accuracy; returns the largest stated error. */
static double tally_up(struct panel panel, const struct made *longer, const char *name, double room)
{
    struct tally tally = {0}, shares = {0};
    double worst = 0;
    for (uint64_t seed = 1; seed <= extent(1, 2); seed++) {
        struct made m = make_bsdf(panel, seed);
        assert_true(m.made.reached);
        worst = fmax(worst, m.made.worst);
        for (int part = 0; part < 4; part++)
            compare_part(&m, longer, part, &tally);
        compare_shares(&m.made, &longer->made, &shares);
        done(&m);
    }
    assert_true_errors(&tally, name, room);
    assert_true_errors(&shares, "shares", 1);
    return worst;
}

static const struct {
    const char *name, *text;
    const double *cell;
    uint32_t paths; /* few: as low as ten in a cell; for the saw, where one may weigh 50 others,
                       some hundred */
    double room, accuracy;
} cases[] = {{"sheet", sheet, NULL, 512, 0.4, 0.15},
             {"laser cut panel", cut, square, 512, 0.4, 0.05},
             {"saw", saw, square, 2048, 0.4, 0.3},
             {"blind", blind, NULL, 512, 0.5, 0.6}};

static void of_matrices(void **state)
{
    (void)state;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        struct panel panel = {
            .text = cases[i].text, .basis = ORL_BSDF_KLEMS_QUARTER, .cell = cases[i].cell};
        panel.paths = (uint32_t)extent(1 << 12, 1 << 14);
        struct made longer = make_bsdf(panel, 77);
        panel.paths = cases[i].paths;
        tally_up(panel, &longer, cases[i].name, cases[i].room);
        panel.paths = 128;
        panel.paths_most = 1 << 14;
        panel.accuracy = cases[i].accuracy;
        /* Among thousands of errors of 15 degrees of freedom the largest is twice too large. */
        assert_true(tally_up(panel, &longer, "to an accuracy", 0.2) < 2 * panel.accuracy);
        done(&longer);
    }
}

/* ---- Trees ----------------------------------------------------------------------------------- */

/* Returns the middle of a cell of the square, with that many cells per side. */
static struct orl_vec3 cell_middle(size_t cell, size_t side, bool above)
{
    struct orl_vec3 d = orl_square_to_hemisphere(
        (struct orl_square){2 * ((double)(cell % side) + 0.5) / (double)side - 1,
                            2 * ((double)(cell / side) + 0.5) / (double)side - 1});
    d.z = above ? d.z : -d.z;
    return d;
}

static void compare_tree(const struct made *m, const struct made *longer, size_t side, int part,
                         struct tally *tally)
{
    const bool front = part / 2, transmitted = part % 2;
    const size_t cells = side * side;
    double peak = 0;
    for (int pass = 0; pass < 2; pass++)
        for (size_t i = 0; i < cells * cells; i++) {
            const struct orl_vec3 in = cell_middle(i / cells, side, front);
            const struct orl_vec3 out = cell_middle(i % cells, side, front != transmitted);
            const double is = eval(longer->bsdf, in, out);
            peak = pass == 0 ? fmax(peak, is) : peak;
            const double value = eval(m->bsdf, in, out);
            if (pass == 1 && value >= 0.01 * peak && value > 0)
                count_error(tally, value - is,
                            hypot(eval(m->errors, in, out), eval(longer->errors, in, out)));
        }
}

static const struct {
    const char *name, *text;
    const double *cell;
    uint32_t side;
    enum orl_bsdf_symmetry symmetry;
    double cull, accuracy, room; /* accuracy 0: 4096 paths, in the short form 2048 */
} trees[] = {
    {"cut panel's tree", cut, square, 16, ORL_BSDF_QUADRILATERAL, 1e-6, 0, 0.3},
    {"to an accuracy", cut, square, 16, ORL_BSDF_QUADRILATERAL, 1e-6, 0.05, 0.3},
    {"saw's tree", saw, square, 8, ORL_BSDF_ASYMMETRIC, 1e-6, 0.2, 0.3},
    {"blind's tree, half of its cells joined", blind, NULL, 8, ORL_BSDF_ASYMMETRIC, 1e-6, 0, 0.3},
    {"cells joined within a fifth of their mean", frosted, NULL, 8, ORL_BSDF_ASYMMETRIC, 0.2, 0,
     0.7}};

/* Merged cells are right or wrong together, apart from their individual deviations: because of the
 * common deviation the shares scatter more than those of n cells. */
static void of_trees(void **state)
{
    struct made longer = {.bsdf = NULL};
    (void)state;
    for (size_t i = 0; i < sizeof trees / sizeof *trees; i++) {
        struct panel panel = {.text = trees[i].text,
                              .basis = ORL_BSDF_TENSOR_TREE_4,
                              .cell = trees[i].cell,
                              .resolution = trees[i].side,
                              .symmetry = trees[i].symmetry,
                              .want_errors = true};
        struct tally tally = {0};
        panel.cull = 1e-9;
        panel.paths = (uint32_t)extent(1 << 12, 1 << 14);
        if (i == 0 || trees[i].text != trees[i - 1].text) {
            done(&longer); /* an equal panel has an equal longer run */
            longer = make_bsdf(panel, 77);
        }
        panel.cull = trees[i].cull;
        panel.accuracy = trees[i].accuracy;
        panel.paths_most = 1 << 15;
        panel.paths = panel.accuracy > 0 ? 2048 : (uint32_t)extent(2048, 4096);
        for (uint64_t seed = 1; seed <= extent(1, 2); seed++) {
            struct made m = make_bsdf(panel, seed);
            assert_true(m.made.reached);
            assert_true(panel.accuracy == 0 || m.made.worst < 2 * panel.accuracy);
            assert_true((m.made.merge_error > 0.02) == (i > 2));
            for (int part = 0; part < 4; part++)
                compare_tree(&m, &longer, trees[i].side, part, &tally);
            done(&m);
        }
        assert_true_errors(&tally, trees[i].name, trees[i].room);
    }
    done(&longer);
}

int main(void)
{
    static const struct CMUnitTest tests[] = {
        cmocka_unit_test(of_matrices),
        cmocka_unit_test(of_trees),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
