/*
 * Estimates of a run's remaining time and its end, on simulated clocks: stages that take other
 * times than predicted, stages without reports, fluctuating estimates; and the use of time by jobs
 * with a deadline.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <oriel/base/eta.h>

#include "run/estimate/progress.h"
#include "run/goals/rounds.h"
#include "run/run_state.h"

static const double estimated[ORL_STAGE_COUNT] = {0.2, 0.05, 0.1, 4, 1, 10};

struct moment {
    double elapsed, left, eta, share, fraction;
    enum orl_stage stage;
};

/* Simulates a run whose stages take those times, at constant speed, sampled `count` times. */
static void simulate_run(const double real[ORL_STAGE_COUNT], struct moment *ret_moments,
                         size_t count)
{
    double all = 0, told = 0, before = 0;
    struct orl_eta eta = {0};
    for (int i = 0; i < ORL_STAGE_COUNT; i++)
        all += real[i];
    for (size_t k = 0; k < count; k++) {
        struct moment *m = &ret_moments[k];
        struct orl_remaining_time remaining = {.stage = ORL_STAGE_LOAD};
        m->elapsed = all * ((double)k + 0.5) / (double)count;
        m->left = all - m->elapsed;
        double began = 0;
        while (remaining.stage + 1 < ORL_STAGE_COUNT &&
               m->elapsed > began + real[remaining.stage]) {
            remaining.spent_s[remaining.stage] = real[remaining.stage];
            began += real[remaining.stage];
            remaining.stage++;
        }
        for (int i = 0; i < ORL_STAGE_COUNT; i++)
            remaining.estimated_s[i] = estimated[i];
        remaining.stage_elapsed_s = m->elapsed - began;
        if (remaining.stage >= ORL_STAGE_PHOTONS)
            remaining.fraction = remaining.stage_elapsed_s / real[remaining.stage];
        told =
            orl_remaining_time_share(told, m->elapsed - before, orl_remaining_time_s(&remaining));
        before = m->elapsed;
        orl_eta_update(&eta, orl_remaining_time_s(&remaining), 1 + m->elapsed);
        m->stage = remaining.stage;
        m->fraction = remaining.fraction;
        m->share = told;
        m->eta = orl_eta_s(&eta, 1 + m->elapsed);
    }
}

enum { MOMENTS = 200 };

/*
 * A machine k times slower or faster than predicted. From a fifth of the photons on, the speed is
 * known up to the prior: 0.2 s of trust beside 0.8 s predicted are a fifth of the way from k to 1.
 */
static void test_any_machine(void **state)
{
    (void)state;
    for (double k = 0.3; k < 6; k *= 1.7) {
        double real[ORL_STAGE_COUNT];
        struct moment m[MOMENTS];
        double least = INFINITY, all = 0;
        for (int i = 0; i < ORL_STAGE_COUNT; i++) {
            real[i] = estimated[i] * (i >= ORL_STAGE_PHOTONS ? k : 1);
            all += real[i];
        }
        simulate_run(real, m, MOMENTS);
        for (int i = 0; i < MOMENTS; i++) {
            if (m[i].stage < ORL_STAGE_PHOTONS ||
                (m[i].stage == ORL_STAGE_PHOTONS && m[i].fraction < 0.2))
                continue;
            if (!(m[i].eta < 1.6 * m[i].left + 0.02 * all &&
                  m[i].eta > m[i].left / 1.6 - 0.02 * all))
                fail_msg("pace %.2f at %.2f s: %.2f s thought, %.2f s left", k, m[i].elapsed,
                         m[i].eta, m[i].left);
            /* The estimate does not rise by more than a tenth of the whole. */
            if (m[i].eta > least + 0.1 * all)
                fail_msg("pace %.2f at %.2f s: from %.2f up to %.2f s", k, m[i].elapsed, least,
                         m[i].eta);
            least = fmin(least, m[i].eta);
        }
    }
}

/* Photons take thirteen times the predicted time; rendering takes the predicted time. */
static void test_photons_without_yield(void **state)
{
    const double real[ORL_STAGE_COUNT] = {0.2, 0.05, 0.1, 54, 1, 10};
    struct moment m[MOMENTS];
    (void)state;
    simulate_run(real, m, MOMENTS);
    for (int i = 0; i < MOMENTS; i++)
        if (m[i].stage > ORL_STAGE_PHOTONS || m[i].fraction > 0.2)
            assert_true(m[i].eta < m[i].left + 8 * 10.5 && m[i].eta > 0.4 * m[i].left - 1);
}

/* A stage of two phases: the first is predicted to be half of the stage but is a tenth. The
 * remaining time is right again once the second phase progresses. */
static void test_phases(void **state)
{
    struct orl_remaining_time remaining = {
        .stage = ORL_STAGE_RENDER, .phase_from = 0.5, .phase_to = 1};
    (void)state;
    for (double done = 0.1; done < 1; done += 0.1) {
        remaining.fraction = 0.5 + 0.5 * done;
        remaining.phase_elapsed_s = 9 * done;
        remaining.stage_elapsed_s = 1 + 9 * done;
        assert_true(fabs(orl_remaining_time_s(&remaining) - 9 * (1 - done)) < 1e-9);
    }
    /* The first percent takes ten times as long as others: the estimate keeps the right order of
     * magnitude. */
    remaining.fraction = 0.5 + 0.5 * 0.01;
    remaining.phase_elapsed_s = 0.1;
    remaining.stage_elapsed_s = 1.1;
    assert_true(fabs(orl_remaining_time_s(&remaining) - 1) < 1);
    /* The setup before the first phase does not count towards the speed. */
    remaining =
        (struct orl_remaining_time){.stage = ORL_STAGE_PHOTONS, .phase_to = 1, .estimated_s = {0}};
    remaining.estimated_s[ORL_STAGE_PHOTONS] = 1;
    for (double done = 0.001; done < 1; done *= 1.5) {
        remaining.fraction = done;
        remaining.phase_elapsed_s = done;
        remaining.stage_elapsed_s = 0.1 + done;
        assert_true(fabs(orl_remaining_time_s(&remaining) - (1 - done)) < 0.15);
    }
    /* The time after the phase is predicted by the share of the stage done before it. */
    remaining = (struct orl_remaining_time){.stage = ORL_STAGE_RENDER, .phase_to = 0.8};
    remaining.fraction = 0.4;
    remaining.stage_elapsed_s = remaining.phase_elapsed_s = 4;
    assert_true(fabs(orl_remaining_time_s(&remaining) - 6) < 1e-9);
}

/* If a pilot has measured the machine's speed in a scene, the predicted render time is
 * proportional to the root of the measured ray time. */
static void test_a_slow_machine(void **state)
{
    const struct orl_run_env env = {.pool = NULL};
    const struct orl_job job = {.gather_samples = 4096};
    double render_s[2];
    (void)state;
    for (int i = 0; i < 2; i++) {
        struct orl_result result = {.plan = {.technique = ORL_TECHNIQUE_GATHER,
                                             .sensor_technique = ORL_TECHNIQUE_GATHER,
                                             .photons_global = 1000000,
                                             .forecast = {.known = true, .ray_s = 2e-7 * (1 + i)}}};
        struct orl_run_state run = {.job = &job, .env = &env, .result = &result, .n_sensors = 50};
        orl_run_estimate_stages(&run);
        render_s[i] = run.clock.cost_s[ORL_STAGE_RENDER];
    }
    assert_true(render_s[0] > 0 && fabs(render_s[1] / render_s[0] - sqrt(2)) < 1e-9);
}

/* For a map that earlier jobs have read only rays cost time; a map read by half costs half of the
 * difference. */
static void test_a_map_that_was_read(void **state)
{
    const struct orl_run_env env = {.pool = NULL};
    const struct orl_job job = {.gather_samples = 4096};
    double render_s[3];
    (void)state;
    for (int i = 0; i < 3; i++) {
        struct orl_result result = {.plan = {.technique = ORL_TECHNIQUE_GATHER,
                                             .sensor_technique = ORL_TECHNIQUE_GATHER,
                                             .photons_global = 1000000}};
        struct orl_run_state run = {.job = &job, .env = &env, .result = &result, .n_sensors = 50};
        orl_run_estimate_stages(&run);
        orl_run_discount_map_reads(&run, 0.5 * i);
        render_s[i] = run.clock.cost_s[ORL_STAGE_RENDER];
        /* For an unread map the first sensors take most of the time; for a read one, all take the
         * same. */
        const double tenth = orl_run_sensors_time_share(&run, 0.1);
        assert_true(i == 2 ? fabs(tenth - 0.1) < 1e-12 : tenth > 0.15);
    }
    assert_true(render_s[2] > 0 && render_s[2] < 0.7 * render_s[0]);
    assert_true(fabs(render_s[1] - 0.5 * (render_s[0] + render_s[2])) < 1e-9);
}

/* After photons as predicted, the first part of rendering takes five times as long as others: the
 * estimate does not extrapolate from it. */
static void test_a_slow_beginning(void **state)
{
    struct orl_remaining_time remaining = {.stage = ORL_STAGE_RENDER, .phase_to = 1};
    (void)state;
    remaining.estimated_s[ORL_STAGE_PHOTONS] = remaining.spent_s[ORL_STAGE_PHOTONS] = 4;
    remaining.estimated_s[ORL_STAGE_RENDER] = 10;
    for (double done = 0.02; done < 1; done += 0.02) {
        remaining.fraction = done;
        remaining.stage_elapsed_s = remaining.phase_elapsed_s = 0.8 + 10 * done;
        const double left = orl_remaining_time_s(&remaining), truth = 10 * (1 - done);
        assert_true(left > truth / 1.5 && left < 1.5 * truth);
    }
}

/* A stage without a report for twelve seconds: the reported progress still increases and never
 * reaches the end. */
static void test_a_silent_stage(void **state)
{
    const double real[ORL_STAGE_COUNT] = {12, 0.05, 0.1, 4, 1, 10};
    struct moment m[MOMENTS];
    (void)state;
    simulate_run(real, m, MOMENTS);
    for (int i = 1; i < MOMENTS; i++)
        assert_true(m[i].share >= m[i - 1].share && m[i].share < 1);
    for (int i = 1; i < MOMENTS && m[i].elapsed < 4; i++)
        assert_true(m[i].share > m[i - 1].share);
    assert_true(m[20].share > 0.05);
}

/* If the initial estimate is right, progress is the share of time. */
static void test_share_of_time(void **state)
{
    double share = 0;
    (void)state;
    for (int i = 1; i <= 40; i++) {
        share = orl_remaining_time_share(share, 0.25, 10 - 0.25 * i);
        assert_true(fabs(share - 0.025 * i) < 1e-12);
    }
}

/* A first round shows that the work is ten times as much as estimated, or a tenth. Progress
 * continues at once, without a jump or a step back, and ends with the run. */
static void test_found_out_late(void **state)
{
    (void)state;
    for (double truth = 1; truth < 200; truth *= 10) {
        const double thought = 10, known_at = 0.05 * truth, step = truth / 1000;
        double share = 0, before = 0, most = 0;
        for (double t = step; t < truth - step / 2; t += step) {
            const double left = t < known_at ? thought - t : truth - t;
            share = orl_remaining_time_share(share, step, left);
            assert_true(share > before && share < 1);
            most = fmax(most, share - before);
            before = share;
        }
        print_message("%.0f s: %.4f at last, %.4f at once\n", truth, share, most);
        assert_true(share > 0.99 && most <= 1.1 * fmax(step / thought, step / truth));
    }
}

/* Between two reports the remaining time decreases with the clock; it never reaches zero. */
static void test_between_reports(void **state)
{
    struct orl_eta eta = {0};
    (void)state;
    assert_true(isnan(orl_eta_s(&eta, 100)));
    orl_eta_update(&eta, (double)NAN, 100);
    assert_true(isnan(orl_eta_s(&eta, 100)));
    orl_eta_update(&eta, 10, 100);
    assert_true(fabs(orl_eta_s(&eta, 100) - 10) < 1e-9);
    assert_true(fabs(orl_eta_s(&eta, 104) - 6) < 1e-9);
    assert_true(fabs(orl_eta_s(&eta, 160) - 1) < 1e-9);
    orl_eta_update(&eta, (double)NAN, 104); /* NaN is ignored */
    assert_true(fabs(orl_eta_s(&eta, 104) - 6) < 1e-9);
}

/*
 * Estimates that fluctuate by 15 % either way, read twenty times a second: the displayed time
 * rises in at most one reading of fifty, and stays within a factor of 1.5 of the truth.
 */
static void test_wavering(void **state)
{
    const double all = 30, least_s = 0.5;
    struct orl_eta eta = {0};
    double before = INFINITY;
    int rises = 0, looks = 0;
    (void)state;
    for (double t = 0; t < all; t += 0.05) {
        const double left = all - t, wrong = 0.15 * sin(37 * t) * cos(11 * t);
        orl_eta_update(&eta, left * (1 + wrong), 1 + t);
        const double said = orl_eta_s(&eta, 1 + t);
        looks++;
        rises += said > before + 0.05;
        before = said;
        if (fabs(said - left) > least_s)
            assert_true(said < 1.5 * left && said > left / 1.5);
    }
    print_message("%d of %d rise\n", rises, looks);
    assert_true(rises * 50 <= looks);
}

/* Changes by an order of magnitude are shown at once. */
static void test_news(void **state)
{
    struct orl_eta eta = {0};
    (void)state;
    orl_eta_update(&eta, 10, 1);
    orl_eta_update(&eta, 100, 2);
    assert_true(fabs(orl_eta_s(&eta, 2) - 100) < 1e-9);
    orl_eta_update(&eta, 3, 3);
    assert_true(fabs(orl_eta_s(&eta, 3) - 3) < 1e-9);
}

/* ---- Deadlines ------------------------------------------------------------------------------- */

/* Simulates a job whose rounds take the time of its pace model, times a factor. Returns the
 * seconds it took. */
static double spend(const struct orl_work *work, double fixed_s, double sample_s, double slower,
                    double deadline, struct orl_deadline_next *ret_last)
{
    struct orl_throughput throughput = {0};
    double elapsed = 0, samples = work->least;
    for (int round = 0; round < 1000; round++) {
        const double seconds = (fixed_s + sample_s * samples) * (round > 0 ? slower : 1);
        elapsed += seconds;
        throughput.rounds++;
        throughput.samples += samples;
        throughput.render_s += work->of_views ? seconds : sample_s * samples;
        throughput.other_s += work->of_views ? 0 : seconds - sample_s * samples;
        *ret_last = orl_deadline_next(&throughput, work, deadline, deadline - elapsed);
        if (ret_last->step != ORL_DEADLINE_ROUND)
            return elapsed;
        samples = ret_last->samples;
    }
    fail_msg("no end");
    return 0;
}

/* Sensors allow rounds of any size; only a small rest of the time is left. */
static void test_a_deadline_is_used(void **state)
{
    const struct orl_work work = {
        .technique = ORL_TECHNIQUE_BACKWARD, .least = 16, .most = 1 << 18};
    struct orl_deadline_next last;
    (void)state;
    for (double sample_s = 1e-4; sample_s < 0.02; sample_s *= 3) {
        const double took = spend(&work, 0.05, sample_s, 1, 30, &last);
        print_message("%.4f s a sample: %.2f of 30 s\n", sample_s, took);
        assert_true(took > 0.9 * 30 && took < 1.1 * 30);
        assert_int_equal(last.step, ORL_DEADLINE_USED_UP);
    }
}

/* Rounds with a fixed cost, whose times differ from the first round's: nine tenths of the time are
 * used, or no round fits into the rest. */
static void test_whatever_rounds_take(void **state)
{
    const struct orl_work work = {
        .technique = ORL_TECHNIQUE_BACKWARD, .least = 16, .most = 1 << 18};
    const double deadline = 30;
    (void)state;
    for (double slower = 0.6; slower < 1.5; slower += 0.2)
        for (double fixed_s = 0.02; fixed_s < 6; fixed_s *= 2)
            for (double sample_s = 1e-4; sample_s < 0.03; sample_s *= 3) {
                struct orl_deadline_next last;
                const double took = spend(&work, fixed_s, sample_s, slower, deadline, &last);
                if (took < 0.9 * deadline &&
                    !(last.step == ORL_DEADLINE_NO_ROOM && deadline - took < last.least_s))
                    fail_msg("%.2f s + %.4f s a sample, %.1f times: %.2f s", fixed_s, sample_s,
                             slower, took);
                assert_true(took < 1.1 * deadline);
            }
}

/* A round that leaves too little for another is the last one, and the remaining time follows it,
 * not the deadline. */
static void test_what_is_left_of_a_deadline(void **state)
{
    (void)state;
    assert_true(fabs(orl_deadline_left_s(5, 18, 30) - 18) < 1e-9);
    assert_true(fabs(orl_deadline_left_s(17.5, 18, 30) - 17.5) < 1e-9);
    assert_true(fabs(orl_deadline_left_s(0.01, 0.6, 30) - 0.01) < 1e-9);
    assert_true(fabs(orl_deadline_left_s(9, 4, 30) - 9) < 1e-9);
}

/*
 * Rounds of views by photon maps have a constant time: 9 s fit three times into 30, 19 s once. The
 * time left then does not count as "used up".
 */
static void test_no_room(void **state)
{
    const struct orl_work work = {
        .technique = ORL_TECHNIQUE_GATHER, .of_views = true, .least = 4096, .most = 1 << 18};
    struct orl_deadline_next last;
    (void)state;
    assert_true(fabs(spend(&work, 9, 0, 1, 30, &last) - 27) < 1e-9);
    assert_int_equal(last.step, ORL_DEADLINE_NO_ROOM);
    assert_true(fabs(last.least_s - 9) < 1e-9);
    assert_true(fabs(spend(&work, 19, 0, 1, 30, &last) - 19) < 1e-9);
    assert_int_equal(last.step, ORL_DEADLINE_NO_ROOM);
    assert_true(fabs(spend(&work, 10, 0, 1, 30, &last) - 30) < 1e-9);
    assert_int_equal(last.step, ORL_DEADLINE_USED_UP);
    assert_true(spend(&work, 40, 0, 1, 30, &last) > 30);
    assert_int_equal(last.step, ORL_DEADLINE_TOO_LATE);
}

/*
 * Views by photon maps whose photons take at least a third of their rendering time. Rounds of
 * fewer and of more photons use nine tenths of the time, if two rounds fit at all.
 */
static void test_views_by_maps(void **state)
{
    const double deadline = 20, usual = 4096;
    const struct orl_work work = {.technique = ORL_TECHNIQUE_GATHER,
                                  .of_views = true,
                                  .photons = {1000000, 1000000},
                                  .least = 1024,
                                  .most = 4 * 4096};
    double least_used = 1;
    (void)state;
    for (double render_s = 0.2; render_s < 9; render_s *= 1.13)
        for (double photon_s = render_s / 3; photon_s < 4 * render_s; photon_s *= 1.3) {
            struct orl_throughput throughput = {0};
            struct orl_deadline_next next = {.samples = work.least};
            double elapsed = 0;
            if (2 * (render_s + photon_s / 4) > 0.93 * deadline)
                continue;
            do {
                const double shooting_s = photon_s * next.samples / usual;
                elapsed += render_s + shooting_s;
                throughput.rounds++;
                throughput.samples += next.samples;
                throughput.photons += 2e6 * next.samples / usual;
                throughput.photon_s += shooting_s;
                throughput.render_s += render_s;
                next = orl_deadline_next(&throughput, &work, deadline, deadline - elapsed);
            } while (next.step == ORL_DEADLINE_ROUND);
            if (elapsed < 0.9 * deadline || elapsed > 1.05 * deadline)
                print_message("%.2f s and %.2f s of photons: %.2f of %.0f s\n", render_s, photon_s,
                              elapsed, deadline);
            least_used = fmin(least_used, elapsed / deadline);
        }
    print_message("%.3f of the time at the least\n", least_used);
    assert_true(least_used >= 0.9);
}

/*
 * Views rendered as a whole, so slow that no second round fits. The first round's photons fill 85
 * % of the time by the predicted costs, up to the number of photons that views can use. A
 * prediction that is a tenth too low still ends in time.
 */
static void test_only_round(void **state)
{
    const double left = 20, usual = 4096;
    const struct orl_work work = {.technique = ORL_TECHNIQUE_DIRECT,
                                  .of_views = true,
                                  .photons = {1000000, 1000000},
                                  .least = 1024,
                                  .most = 4 * 4096};
    (void)state;
    for (double render_s = 1; render_s < 30; render_s *= 1.2)
        for (double photon_s = 1; photon_s < 20; photon_s *= 1.5) {
            const double samples = orl_deadline_first(&work, photon_s, render_s, left);
            const double all = render_s + photon_s * samples / usual;
            const double one = render_s + photon_s * work.least / usual;
            assert_true(samples >= work.least && samples <= work.most);
            if (2 * one <= 0.85 * left)
                assert_true(samples == work.least);
            else if (samples > work.least)
                assert_true(all <= 0.85 * left && 1.1 * all < left);
            if (2 * one > 0.85 * left && one < 0.84 * left && samples < work.most)
                assert_true(all > 0.84 * left);
        }
    struct orl_work of_sensors = work;
    of_sensors.of_views = false;
    assert_true(orl_deadline_first(&of_sensors, 1, 15, left) == work.least);
}

/*
 * Views by final gathering, whose rays and photons both scale with samples. Nine tenths of the
 * time are used if it holds two of the smallest rounds, for a prediction a fifth too high or too
 * low. Otherwise the rest holds no other round and is less than a fifth.
 */
static void test_views_by_rays(void **state)
{
    const double deadline = 30, usual = 4096;
    const struct orl_work work = {.technique = ORL_TECHNIQUE_GATHER,
                                  .of_views = true,
                                  .photons = {1000000, 1000000},
                                  .least = 1024,
                                  .most = 2.25 * 4096,
                                  .ray_time_share = 0.5};
    double least_used = 1, sum = 0;
    int n = 0;
    (void)state;
    for (double part = 0.4; part < 0.61; part += 0.1)
        for (double view_s = 0.3; view_s < 20; view_s *= 1.07) {
            struct orl_throughput throughput = {0};
            struct orl_deadline_next next = {.samples = work.least};
            double elapsed = 0;
            if (2 * view_s * (1 - part + part / 4 + 0.1) > 0.8 * deadline)
                continue;
            do {
                const double share = next.samples / usual;
                const double painting_s = view_s * (1 - part + part * share);
                elapsed += painting_s + 0.4 * view_s * share;
                throughput.rounds++;
                throughput.samples += next.samples;
                throughput.photons += 2e6 * share;
                throughput.photon_s += 0.4 * view_s * share;
                throughput.render_s += painting_s;
                throughput.views_s += painting_s;
                next = orl_deadline_next(&throughput, &work, deadline, deadline - elapsed);
            } while (next.step == ORL_DEADLINE_ROUND);
            if (elapsed < 0.9 * deadline || elapsed > 1.05 * deadline)
                print_message("%.2f s a view, %.1f of it by rays: %.2f of %.0f s\n", view_s, part,
                              elapsed, deadline);
            assert_true(elapsed < 1.1 * deadline);
            least_used = fmin(least_used, elapsed / deadline);
            sum += elapsed / deadline;
            n++;
        }
    print_message("%.3f of the time at the least, %.3f on average\n", least_used, sum / n);
    assert_true(least_used >= 0.9);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_any_machine),
                                       cmocka_unit_test(test_photons_without_yield),
                                       cmocka_unit_test(test_phases),
                                       cmocka_unit_test(test_a_slow_machine),
                                       cmocka_unit_test(test_a_map_that_was_read),
                                       cmocka_unit_test(test_a_slow_beginning),
                                       cmocka_unit_test(test_a_silent_stage),
                                       cmocka_unit_test(test_share_of_time),
                                       cmocka_unit_test(test_found_out_late),
                                       cmocka_unit_test(test_between_reports),
                                       cmocka_unit_test(test_wavering),
                                       cmocka_unit_test(test_news),
                                       cmocka_unit_test(test_a_deadline_is_used),
                                       cmocka_unit_test(test_whatever_rounds_take),
                                       cmocka_unit_test(test_what_is_left_of_a_deadline),
                                       cmocka_unit_test(test_no_room),
                                       cmocka_unit_test(test_views_by_maps),
                                       cmocka_unit_test(test_only_round),
                                       cmocka_unit_test(test_views_by_rays)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
