/* Jobs with a goal: by accuracy, by deadline, and to half of an earlier error. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "bench/calibration.h"

/* ---- Fixed settings -------------------------------------------------------------------------- */

/* Cost and error of a fixed setting: the mean over seeds, and the 90th percentile. */
struct rung {
    double total_s, mean, nine;
};
enum { RUNGS = 6, RUNG_SEEDS = 10 };

/* Rungs from coarse to fine: each has four times the rays of the one before and, for gather, four
 * times the photons. */
struct ladder {
    enum orl_technique technique;
    uint32_t first_samples;
    uint64_t first_photons; /* 0: chosen by the plan */
    struct rung rungs[RUNGS];
    int n;
};
enum { LADDERS = 2 };
static const struct ladder ladders[LADDERS] = {{ORL_TECHNIQUE_BACKWARD, 32, 0, {{0, 0, 0}}, 0},
                                               {ORL_TECHNIQUE_GATHER, 64, 30000, {{0, 0, 0}}, 0}};

static int compare_errors(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static struct rung measure_rung(const struct calibration *c, const struct calibration_scene *scene,
                                const struct ladder *ladder, int at)
{
    struct rung rung = {0};
    double p95[RUNG_SEEDS];
    for (uint64_t seed = 1; seed <= RUNG_SEEDS; seed++) {
        struct orl_result r;
        struct orl_job job;
        calibration_job(scene, &job);
        job.technique = ladder->technique;
        job.seed = 500 + seed;
        job.gather_samples = ladder->first_samples << (2 * at);
        if (ladder->first_photons > 0)
            job.photons_global = job.photons_caustic = ladder->first_photons << (2 * at);
        calibration_run(c, scene, &job, &r, NULL);
        rung.total_s += r.total_s / RUNG_SEEDS;
        p95[seed - 1] = calibration_judge(scene, r.illuminance_lx).p95;
        rung.mean += p95[seed - 1] / RUNG_SEEDS;
        orl_result_done(&r);
    }
    qsort(p95, RUNG_SEEDS, sizeof *p95, compare_errors);
    rung.nine = p95[RUNG_SEEDS * 9 / 10 - 1];
    return rung;
}

/* Returns the seconds at which a ladder reaches that error, by a power law between rungs; or
 * infinity. */
static double seconds_at(const struct ladder *ladder, double error, bool in_the_mean)
{
    double before = INFINITY;
    for (int i = 0; i < ladder->n; i++) {
        const struct rung *rung = &ladder->rungs[i];
        const double here = in_the_mean ? rung->mean : rung->nine;
        if (here <= error && i == 0)
            return rung->total_s;
        if (here <= error)
            return rung[-1].total_s *
                   pow(rung->total_s / rung[-1].total_s, log(before / error) / log(before / here));
        before = here;
    }
    return INFINITY;
}

/*
 * Climbs until a rung meets the least requested error, the ladder ends, or a rung takes longer than
 * another ladder does to that error; later rungs cannot be the best.
 */
static void climb(const struct calibration *c, const struct calibration_scene *scene,
                  struct ladder *ladder, const struct ladder *other)
{
    double least = INFINITY;
    for (int i = 0; i < c->knobs.errors.n; i++)
        least = fmin(least, c->knobs.errors.values[i]);
    const double longest_s = other ? seconds_at(other, least, false) : INFINITY;
    for (ladder->n = 0; ladder->n < RUNGS;) {
        const struct rung rung = measure_rung(c, scene, ladder, ladder->n);
        ladder->rungs[ladder->n++] = rung;
        fprintf(stderr, "  %s: %s, %u samples: p95 %.2f %%, in nine of ten %.2f %%, in %.2f s\n",
                scene->name, orl_technique_name(ladder->technique),
                ladder->first_samples << (2 * (ladder->n - 1)), 100 * rung.mean, 100 * rung.nine,
                rung.total_s);
        if (rung.nine <= least || rung.total_s > longest_s)
            return;
    }
}

/* ---- By accuracy ----------------------------------------------------------------------------- */

static void run_goal(const struct calibration *c, const struct calibration_scene *scene,
                     struct orl_goal goal, uint64_t seed, struct orl_result *ret_result)
{
    struct orl_job job;
    calibration_job(scene, &job);
    job.goal = goal;
    job.seed = seed;
    calibration_run(c, scene, &job, ret_result, NULL);
}

static void print_goal(const struct calibration *c, const struct calibration_scene *scene,
                       double error, const struct ladder *fixed)
{
    const uint32_t seeds = c->knobs.goal_seeds;
    double seconds = 0, p95 = 0, achieved = 0, best = INFINITY, best_mean = INFINITY;
    uint32_t kept = 0, met = 0;
    for (uint32_t seed = 1; seed <= seeds; seed++) {
        const struct orl_goal goal = {.relative_error = error, .at = 0.95};
        struct orl_result r;
        run_goal(c, scene, goal, seed, &r);
        const struct calibration_error e = calibration_judge(scene, r.illuminance_lx);
        kept += e.p95 <= error;
        met += r.outcome.met;
        p95 += e.p95 / seeds;
        achieved += r.outcome.achieved / seeds;
        seconds += r.total_s / seeds;
        orl_result_done(&r);
    }
    for (int i = 0; i < LADDERS; i++) {
        best = fmin(best, seconds_at(&fixed[i], error, false));
        best_mean = fmin(best_mean, seconds_at(&fixed[i], error, true));
    }
    printf("  %-7s %8.1f %5u/%-3u %5u/%-3u %9.2f %9.2f %9.2f %9.2f %7.2f %7.2f  %s\n", scene->name,
           100 * error, kept, seeds, met, seeds, 100 * achieved, 100 * p95, seconds, best,
           seconds / best, seconds / best_mean,
           10 * kept >= 9 * seeds && seconds <= 1.5 * best ? "yes" : "no");
}

void calibration_goals(struct calibration *c)
{
    printf("\nJobs by relative error, %u threads\n\n", c->knobs.threads);
    printf("  %-7s %8s %9s %9s %9s %9s %9s %9s %7s %7s  %s\n", "scene", "error %", "kept",
           "said met", "stated %", "p95 %", "seconds", "fixed s", "ratio", "to mean", "ok");
    for (size_t i = 0; i < CALIBRATION_SCENES; i++) {
        struct calibration_scene *scene = &c->scenes[i];
        struct ladder fixed[LADDERS];
        if (!calibration_wants(c, i))
            continue;
        calibration_refer(c, scene);
        memcpy(fixed, ladders, sizeof fixed);
        for (int k = 0; k < LADDERS; k++)
            climb(c, scene, &fixed[k], k > 0 ? &fixed[k - 1] : NULL);
        for (int k = 0; k < c->knobs.errors.n; k++)
            print_goal(c, scene, c->knobs.errors.values[k], fixed);
    }
    printf("\n  kept: seeds whose 95th percentile of relative errors is within the goal; stated: "
           "what jobs said of it;\n  p95: what it is, mean. fixed s: what backward or gather take "
           "to a p95 of that in nine of ten seeds, as jobs\n  are to, by settings a factor of four "
           "apart and powers in between; inf: none of them comes to it. to mean: the\n  ratio to "
           "what takes the mean p95 there. ok: nine in ten kept, at most 1.5 times fixed s.\n");
}

/* ---- By deadline ----------------------------------------------------------------------------- */

static void print_deadline(const struct calibration *c, const struct calibration_scene *scene,
                           double deadline_s)
{
    const uint32_t seeds = c->knobs.deadline_seeds;
    double share = 0, worst = 0, squares = 0, p95 = 0;
    for (uint32_t seed = 1; seed <= seeds; seed++) {
        const struct orl_goal goal = {.deadline_s = deadline_s, .at = 0.95};
        struct orl_result r;
        run_goal(c, scene, goal, seed, &r);
        const struct calibration_error e = calibration_judge(scene, r.illuminance_lx);
        const double of_deadline = r.total_s / deadline_s;
        share += of_deadline / seeds;
        if (fabs(of_deadline - 1) >= fabs(worst - 1) || seed == 1)
            worst = of_deadline;
        squares += e.rms * e.rms / seeds;
        p95 += e.p95 / seeds;
        orl_result_done(&r);
    }
    printf("  %-7s %10.1f %10.3f %10.3f %10.2f %10.2f  %s\n", scene->name, deadline_s, share, worst,
           100 * sqrt(squares), 100 * p95, fabs(worst - 1) <= 0.1 ? "yes" : "no");
}

void calibration_deadlines(struct calibration *c)
{
    printf("\nJobs by deadline, %u threads, %u seeds\n\n", c->knobs.threads,
           c->knobs.deadline_seeds);
    printf("  %-7s %10s %10s %10s %10s %10s  %s\n", "scene", "deadline s", "mean of it", "worst",
           "rms %", "p95 %", "ok");
    for (size_t i = 0; i < CALIBRATION_SCENES; i++) {
        if (!calibration_wants(c, i))
            continue;
        calibration_refer(c, &c->scenes[i]);
        for (int k = 0; k < c->knobs.deadlines_s.n; k++)
            print_deadline(c, &c->scenes[i], c->knobs.deadlines_s.values[k]);
    }
    printf("\n  mean, worst: total time over the deadline. ok: the worst within 10 %%; errors are "
           "to fall from one deadline to the next.\n");
}

/* ---- Half the error -------------------------------------------------------------------------- */

/* Predicts, from a first job, the time to another error with every seed, then runs to half the
 * first job's error. Returns true if the time is within the factor. */
static bool print_next(const struct calibration *c, const struct calibration_scene *scene,
                       uint64_t seed)
{
    const double factor = 1.5;
    const struct orl_goal first = {
        .relative_error = c->knobs.errors.values[(seed - 1) % (uint64_t)c->knobs.errors.n],
        .at = 0.95};
    struct orl_result r;
    run_goal(c, scene, first, seed, &r);
    const double error = r.cost.error, predicted = r.cost.halve_s, took = r.total_s;
    orl_result_done(&r);
    if (!(error > 0) || !isfinite(predicted)) {
        printf("  %-7s %5llu  no prediction\n", scene->name, (unsigned long long)seed);
        return false;
    }
    const struct orl_goal second = {.relative_error = error / 2, .at = 0.95};
    run_goal(c, scene, second, seed + 100, &r);
    const double ratio = r.total_s / predicted;
    const bool ok = ratio <= factor && ratio >= 1 / factor;
    printf("  %-7s %5llu %9.2f %9.2f %9.2f %9.2f %9.2f %7.2f  %s\n", scene->name,
           (unsigned long long)seed, 100 * error, took, predicted, 100 * r.cost.error, r.total_s,
           ratio, ok ? "yes" : "no");
    orl_result_done(&r);
    return ok;
}

void calibration_next(struct calibration *c)
{
    uint32_t jobs = 0, ok = 0;
    printf("\nPredicted seconds to half the error\n\n");
    printf("  %-7s %5s %9s %9s %9s %9s %9s %7s  %s\n", "scene", "seed", "error %", "seconds",
           "predicted", "then %", "took", "ratio", "ok");
    for (uint32_t seed = 1; jobs < c->knobs.next_seeds; seed++) {
        for (size_t i = 0; i < CALIBRATION_SCENES && jobs < c->knobs.next_seeds; i++) {
            if (!calibration_wants(c, i))
                continue;
            ok += print_next(c, &c->scenes[i], seed);
            jobs++;
        }
        if (c->wanted == 0)
            break;
    }
    printf("\n  error: what a job by relative error states of itself, and its time; predicted: "
           "cost.next of it; then: what a\n  job for half that error states, and what it took. "
           "%u of %u within a factor of 1.5.\n",
           ok, jobs);
}
