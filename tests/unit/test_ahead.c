/*
 * What is left of a run, and when it is thought to end, on clocks of the test's own: stages that
 * take other times than foreseen, stages that tell nothing, many skies, jobs with goals; and what a
 * job for a deadline does with its time.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <oriel/eta.h>

#include "run/ahead.h"
#include "run/deadline.h"

static const double foreseen[ORL_STAGE_COUNT] = {0.2, 0.05, 0.1, 4, 1, 10};

struct moment {
    double elapsed, left, eta, share, fraction;
    enum orl_stage stage;
};

/* A run whose stages take those times, evenly, looked at `count` times. */
static void follow(const double real[ORL_STAGE_COUNT], struct moment *ret_moments, size_t count)
{
    double all = 0, told = 0;
    for (int i = 0; i < ORL_STAGE_COUNT; i++)
        all += real[i];
    for (size_t k = 0; k < count; k++) {
        struct moment *m = &ret_moments[k];
        struct orl_ahead ahead = {.stage = ORL_STAGE_LOAD};
        m->elapsed = all * ((double)k + 0.5) / (double)count;
        m->left = all - m->elapsed;
        double began = 0;
        while (ahead.stage + 1 < ORL_STAGE_COUNT && m->elapsed > began + real[ahead.stage]) {
            ahead.spent_s[ahead.stage] = real[ahead.stage];
            began += real[ahead.stage];
            ahead.stage++;
        }
        for (int i = 0; i < ORL_STAGE_COUNT; i++)
            ahead.foreseen_s[i] = foreseen[i];
        ahead.in_stage_s = m->elapsed - began;
        if (ahead.stage >= ORL_STAGE_PHOTONS)
            ahead.fraction = ahead.in_stage_s / real[ahead.stage];
        told = fmax(told, orl_ahead_share(m->elapsed, orl_ahead_left_s(&ahead)));
        m->stage = ahead.stage;
        m->fraction = ahead.fraction;
        m->share = told;
        m->eta = orl_eta_s(told, 0, m->elapsed, 0);
    }
}

enum { MOMENTS = 200 };

/*
 * A machine k times as slow as was thought, or as fast: from a fifth of the photons on it is known,
 * to what 0.2 s of trust are beside 0.8 s foreseen: a fifth of the way from k to 1.
 */
static void test_any_machine(void **state)
{
    (void)state;
    for (double k = 0.3; k < 6; k *= 1.7) {
        double real[ORL_STAGE_COUNT];
        struct moment m[MOMENTS];
        double least = INFINITY, all = 0;
        for (int i = 0; i < ORL_STAGE_COUNT; i++) {
            real[i] = foreseen[i] * (i >= ORL_STAGE_PHOTONS ? k : 1);
            all += real[i];
        }
        follow(real, m, MOMENTS);
        for (int i = 0; i < MOMENTS; i++) {
            if (m[i].stage < ORL_STAGE_PHOTONS ||
                (m[i].stage == ORL_STAGE_PHOTONS && m[i].fraction < 0.2))
                continue;
            if (!(m[i].eta < 1.6 * m[i].left + 0.02 * all &&
                  m[i].eta > m[i].left / 1.6 - 0.02 * all))
                fail_msg("pace %.2f at %.2f s: %.2f s thought, %.2f s left", k, m[i].elapsed,
                         m[i].eta, m[i].left);
            /* It does not rise by more than a tenth of the whole. */
            if (m[i].eta > least + 0.1 * all)
                fail_msg("pace %.2f at %.2f s: from %.2f up to %.2f s", k, m[i].elapsed, least,
                         m[i].eta);
            least = fmin(least, m[i].eta);
        }
    }
}

/* Photons that take thirteen times what was thought, and rendering that does not. */
static void test_photons_without_yield(void **state)
{
    const double real[ORL_STAGE_COUNT] = {0.2, 0.05, 0.1, 54, 1, 10};
    struct moment m[MOMENTS];
    (void)state;
    follow(real, m, MOMENTS);
    for (int i = 0; i < MOMENTS; i++)
        if (m[i].stage > ORL_STAGE_PHOTONS || m[i].fraction > 0.2)
            assert_true(m[i].eta < m[i].left + 8 * 10.5 && m[i].eta > 0.4 * m[i].left - 1);
}

/* A stage that tells nothing for twelve seconds: what is told moves all the same, and never all the
 * way. */
static void test_a_silent_stage(void **state)
{
    const double real[ORL_STAGE_COUNT] = {12, 0.05, 0.1, 4, 1, 10};
    struct moment m[MOMENTS];
    (void)state;
    follow(real, m, MOMENTS);
    for (int i = 1; i < MOMENTS; i++)
        assert_true(m[i].share >= m[i - 1].share && m[i].share < 1);
    for (int i = 1; i < MOMENTS && m[i].elapsed < 4; i++)
        assert_true(m[i].share > m[i - 1].share);
    assert_true(m[20].share > 0.05);
}

/* Of a thousand skies each is a part of the whole: from some seconds on their end is known. */
static void test_many_skies(void **state)
{
    const double each = 2, skies = 1000;
    (void)state;
    for (double elapsed = 6.5; elapsed < each * skies; elapsed += 97) {
        const double sky = floor(elapsed / each), in_sky = elapsed - each * sky;
        const double share = (sky + orl_ahead_share(in_sky, each - in_sky)) / skies;
        const double eta = orl_eta_s(share, 0, elapsed, 0), left = each * skies - elapsed;
        assert_true(fabs(eta - left) < 1e-6 * each * skies);
    }
    assert_true(isnan(orl_eta_s(0.0005, 0, 1, 0)));
    assert_true(isnan(orl_eta_s(0, 0, 10, 0)));
    /* Half of the skies were there from before. */
    assert_true(fabs(orl_eta_s(0.75, 0.5, 10, 0) - 10) < 1e-9);
}

/* Between two reports the rest goes down with the clock, and does not rise. */
static void test_between_reports(void **state)
{
    (void)state;
    assert_true(fabs(orl_eta_s(0.5, 0, 10, 4) - 6) < 1e-9);
    assert_true(fabs(orl_eta_s(0.5, 0, 10, 60) - 1) < 1e-9);
}

/* A run that was thought to take ten seconds is never told as done before it is. */
static void test_what_was_thought(void **state)
{
    double before = -1;
    (void)state;
    assert_true(fabs(orl_ahead_share_of(5, 10) - 0.5) < 1e-12);
    for (double elapsed = 0; elapsed < 20; elapsed += 0.25) {
        const double share = orl_ahead_share_of(elapsed, 10);
        assert_true(share > before && share < 1);
        before = share;
    }
}

/* ---- Deadlines ------------------------------------------------------------------------------- */

/* A job whose rounds take what its pace says, but for a factor; returns the seconds it took. */
static double spend(const struct orl_work *work, double fixed_s, double sample_s, double slower,
                    double deadline, struct orl_deadline_next *ret_last)
{
    struct orl_pace pace = {0};
    double elapsed = 0, samples = work->least;
    for (int round = 0; round < 1000; round++) {
        const double seconds = (fixed_s + sample_s * samples) * (round > 0 ? slower : 1);
        elapsed += seconds;
        pace.rounds++;
        pace.samples += samples;
        pace.render_s += work->of_views ? seconds : sample_s * samples;
        pace.beside_s += work->of_views ? 0 : seconds - sample_s * samples;
        *ret_last = orl_deadline_next(&pace, work, deadline, deadline - elapsed);
        if (ret_last->step != ORL_DEADLINE_ROUND)
            return elapsed;
        samples = ret_last->samples;
    }
    fail_msg("no end");
    return 0;
}

/* Sensors: rounds of any size; what is left at last is crumbs. */
static void test_a_deadline_is_used(void **state)
{
    const struct orl_work work = {
        .technique = ORL_TECHNIQUE_BACKWARD, .least = 16, .most = 1 << 18};
    struct orl_deadline_next last;
    (void)state;
    for (double sample_s = 1e-4; sample_s < 0.02; sample_s *= 3) {
        const double took = spend(&work, 0.05, sample_s, 1, 30, &last);
        print_message("%.4f s a sample: %.2f of 30 s\n", sample_s, took);
        assert_true(took > 0.88 * 30 && took < 1.1 * 30);
        assert_int_equal(last.step, ORL_DEADLINE_USED_UP);
    }
}

/*
 * Views by photon maps take as long each round: 9 s go into 30 three times, 19 s once. What is left
 * then is not "used up".
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

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_any_machine),        cmocka_unit_test(test_photons_without_yield),
        cmocka_unit_test(test_a_silent_stage),     cmocka_unit_test(test_many_skies),
        cmocka_unit_test(test_between_reports),    cmocka_unit_test(test_what_was_thought),
        cmocka_unit_test(test_a_deadline_is_used), cmocka_unit_test(test_no_room)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
