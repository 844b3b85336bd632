/* Transport plans: marginals, and the least cost, against all permutations and against sorting. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#include <cmocka.h>

#include "base/sampling/sampling.h"
#include "bsdf/fit/transport/transport.h"

enum { MOST = 200 };

static double cost_of(const struct orl_fit_flow *flows, size_t n, const float *cost, size_t columns)
{
    double sum = 0;
    for (size_t i = 0; i < n; i++)
        sum += flows[i].amount * (double)cost[flows[i].from * columns + flows[i].to];
    return sum;
}

/* Tolerance is the rounding of sums of at most MOST terms of at most 1. */
static void assert_marginals(const struct orl_fit_flow *flows, size_t n, const double *supply,
                             size_t n_from, const double *demand, size_t n_to)
{
    double out[MOST] = {0}, in[MOST] = {0};
    for (size_t i = 0; i < n; i++) {
        assert_true(flows[i].amount >= 0 && flows[i].from < n_from && flows[i].to < n_to);
        out[flows[i].from] += flows[i].amount;
        in[flows[i].to] += flows[i].amount;
    }
    for (size_t i = 0; i < n_from; i++)
        assert_true(fabs(out[i] - supply[i]) < 1e-12);
    for (size_t j = 0; j < n_to; j++)
        assert_true(fabs(in[j] - demand[j]) < 1e-12);
}

/* Returns the least cost of a permutation. With equal masses some permutation is optimal
 * (Birkhoff). */
static double best_permutation(const float *cost, unsigned n, unsigned row, unsigned used)
{
    double best = row == n ? 0 : INFINITY;
    for (unsigned j = 0; j < n && row < n; j++)
        if (!(used >> j & 1))
            best = fmin(best, (double)cost[row * n + j] / n +
                                  best_permutation(cost, n, row + 1, used | 1U << j));
    return best;
}

static void equal_masses_go_by_the_best_permutation(void **state)
{
    (void)state;
    for (uint64_t seed = 1; seed <= 50; seed++) {
        enum { N = 6 };
        struct orl_random random = orl_random_stream(seed, ORL_PURPOSE_BENCH, 0);
        double masses[N];
        float cost[N * N];
        struct orl_fit_flow *flows;
        size_t n;
        for (int i = 0; i < N; i++)
            masses[i] = 1.0 / N;
        for (int i = 0; i < N * N; i++)
            cost[i] = (float)orl_random_uniform(&random);
        assert_int_equal(orl_fit_transport(masses, N, masses, N, cost, NULL, &flows, &n), 0);
        assert_marginals(flows, n, masses, N, masses, N);
        const double best = best_permutation(cost, N, 0, 0);
        /* The solver skips arcs that would gain less than 1e-7 of the largest cost. */
        if (fabs(cost_of(flows, n, cost, N) - best) > 1e-6)
            fail_msg("seed %d: %g, not %g", (int)seed, cost_of(flows, n, cost, N), best);
        free(flows);
    }
}

static void fill_masses(double *masses, double *places, size_t n, struct orl_random *random)
{
    double sum = 0, place = 0;
    for (size_t i = 0; i < n; i++) {
        masses[i] = orl_random_uniform(random) + 1e-3;
        places[i] = place += orl_random_uniform(random);
        sum += masses[i];
    }
    for (size_t i = 0; i < n; i++) {
        masses[i] /= sum;
        places[i] /= place;
    }
}

/* Returns the cost of the plan in sorted order. On a line with squared distances it is optimal. */
static double cost_in_order(const double *supply, const double *x, size_t n_from,
                            const double *demand, const double *y, size_t n_to)
{
    size_t i = 0, j = 0;
    double left = supply[0], wanted = demand[0], cost = 0;
    while (i < n_from && j < n_to) {
        const double amount = fmin(left, wanted);
        cost += amount * (x[i] - y[j]) * (x[i] - y[j]);
        left -= amount;
        wanted -= amount;
        if (left <= wanted && ++i < n_from)
            left = supply[i];
        else if (left > wanted && ++j < n_to)
            wanted = demand[j];
    }
    return cost;
}

static void nothing_overtakes_on_a_line(void **state)
{
    (void)state;
    for (uint64_t seed = 1; seed <= 10; seed++) {
        struct orl_random random = orl_random_stream(seed, ORL_PURPOSE_BENCH, 1);
        const size_t n_from = 20 * seed, n_to = MOST - 15 * seed;
        double supply[MOST], demand[MOST], x[MOST], y[MOST];
        struct orl_fit_flow *flows;
        size_t n;
        fill_masses(supply, x, n_from, &random);
        fill_masses(demand, y, n_to, &random);
        float *cost = malloc(n_from * n_to * sizeof *cost);
        assert_non_null(cost);
        /* Sinks are in another order, so that the first plan is not already optimal. */
        for (size_t i = 0; i < n_from; i++)
            for (size_t j = 0; j < n_to; j++) {
                const double off = x[i] - y[n_to - 1 - j];
                cost[i * n_to + j] = (float)(off * off);
            }
        double turned[MOST];
        for (size_t j = 0; j < n_to; j++)
            turned[j] = demand[n_to - 1 - j];
        assert_int_equal(orl_fit_transport(supply, n_from, turned, n_to, cost, NULL, &flows, &n),
                         0);
        assert_marginals(flows, n, supply, n_from, turned, n_to);
        const double best = cost_in_order(supply, x, n_from, demand, y, n_to);
        const double found = cost_of(flows, n, cost, n_to);
        /* Costs are floats: 6e-8 of each; and the skipped arcs as above. */
        if (fabs(found - best) > 1e-6)
            fail_msg("seed %d: %g, not %g", (int)seed, found, best);
        free(flows);
        free(cost);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(equal_masses_go_by_the_best_permutation),
        cmocka_unit_test(nothing_overtakes_on_a_line),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
