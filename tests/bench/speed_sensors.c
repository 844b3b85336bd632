/* Sensors to a given error without cached maps: searches for the cheapest settings. */
#include <math.h>
#include <stdio.h>

#include "bench/speed.h"

enum { SEEDS = 3, RUNGS = 9 };
/* Margin: a setting is selected with a few seeds and judged with others, so it must be this much
 * better than required. */
static const double chosen_below = 0.85;

/* Rungs from coarse to fine: both numbers grow by their factor at each rung. */
static const struct ladder {
    struct speed_setting first;
    uint32_t photons_factor, samples_factor;
} ladders[] = {
    {{ORL_TECHNIQUE_BACKWARD, 0, 64}, 1, 2},
    {{ORL_TECHNIQUE_GATHER, 30000, 1024}, 2, 2},
    {{ORL_TECHNIQUE_DIRECT, 120000, 256}, 2, 1},
    {{ORL_TECHNIQUE_PRECOMPUTED, 120000, 256}, 2, 1},
};
enum { LADDERS = sizeof ladders / sizeof *ladders };

double speed_sensors(struct speed *s, const struct speed_setting *setting, uint64_t seed,
                     struct bench_deviation *ret_error)
{
    char maps[BENCH_PATH + 16];
    struct orl_result r;
    struct orl_job job;
    snprintf(maps, sizeof maps, "%s/sensors", s->office.folder);
    office_job(&job);
    job.technique = setting->technique;
    job.sensors_file = office_sensors;
    job.seed = seed;
    job.gather_samples = setting->samples;
    if (setting->photons > 0)
        job.photons_global = job.photons_caustic = setting->photons;
    speed_run(s, maps, &job, &r);
    *ret_error = bench_compare(&s->reference.sensors, r.illuminance_lx, 0);
    const double seconds = r.total_s;
    orl_result_done(&r);
    bench_remove_folder(maps);
    return seconds;
}

/* Tries a setting with three seeds; reuses a trial of another row. */
static const struct speed_trial *try_setting(struct speed *s, const struct speed_setting *setting)
{
    struct bench_deviation pooled = {0}, error;
    double seconds[SEEDS];
    for (int i = 0; i < s->n_trials; i++)
        if (s->trials[i].setting.technique == setting->technique &&
            s->trials[i].setting.photons == setting->photons &&
            s->trials[i].setting.samples == setting->samples)
            return &s->trials[i];
    if (s->n_trials >= SPEED_TRIALS)
        bench_fail("too many settings", NULL);
    for (int seed = 0; seed < SEEDS; seed++) {
        seconds[seed] = speed_sensors(s, setting, (uint64_t)seed + 1, &error);
        speed_merge(&pooled, &error, seed);
    }
    struct speed_trial *trial = &s->trials[s->n_trials++];
    *trial = (struct speed_trial){*setting, bench_median(seconds, SEEDS), pooled.rms};
    fprintf(stderr, "    %s, %llu photons, %u samples: %.2f %% in %.2f s\n",
            orl_technique_name(setting->technique), (unsigned long long)setting->photons,
            setting->samples, 100 * trial->rms, trial->seconds);
    return trial;
}

/* Climbs the ladder until the error is met, or a rung takes longer than the best so far. */
static void climb(struct speed *s, const struct ladder *ladder, struct speed_row *row,
                  double *best_s)
{
    struct speed_setting setting = ladder->first;
    for (int rung = 0; rung < RUNGS; rung++) {
        const struct speed_trial *trial = try_setting(s, &setting);
        if (trial->seconds >= *best_s)
            return;
        if (trial->rms <= chosen_below * row->wanted_error) {
            *best_s = trial->seconds;
            row->setting = setting;
            return;
        }
        setting.photons *= ladder->photons_factor;
        setting.samples *= ladder->samples_factor;
    }
}

void speed_choose(struct speed *s, struct speed_row *row)
{
    double best_s = INFINITY;
    for (int i = 0; i < LADDERS; i++)
        climb(s, &ladders[i], row, &best_s);
    if (isinf(best_s)) {
        row->setting = ladders[0].first;
        snprintf(row->note, SPEED_NOTE, "no setting tried keeps to that error");
        return;
    }
    if (row->setting.photons > 0)
        snprintf(row->note, SPEED_NOTE, "%s, %.0f k photons, %u samples",
                 orl_technique_name(row->setting.technique), (double)row->setting.photons / 1e3,
                 row->setting.samples);
    else
        snprintf(row->note, SPEED_NOTE, "%s, %u samples",
                 orl_technique_name(row->setting.technique), row->setting.samples);
}

/* 95 % of normal errors are within twice their rms. */
void speed_measure_goal(struct speed *s, const struct speed_row *row)
{
    const struct orl_goal goal = {.relative_error = 2 * row->wanted_error, .at = 0.95};
    double ray_times[SEEDS];
    struct bench_deviation pooled = {0};
    char maps[BENCH_PATH + 16];
    snprintf(maps, sizeof maps, "%s/sensors", s->office.folder);
    for (int seed = 0; seed < SEEDS; seed++) {
        struct orl_result r;
        struct orl_job job;
        office_job(&job);
        job.technique = ORL_TECHNIQUE_AUTO;
        job.sensors_file = office_sensors;
        job.seed = (uint64_t)seed + 1;
        job.goal = goal;
        const double rate = office_rate(&s->office, s->pool, 1);
        speed_run(s, maps, &job, &r);
        ray_times[seed] = r.total_s * rate;
        const struct bench_deviation error =
            bench_compare(&s->reference.sensors, r.illuminance_lx, 0);
        speed_merge(&pooled, &error, seed);
        orl_result_done(&r);
        bench_remove_folder(maps);
    }
    speed_add_fact(s, row->wanted_error > 0.02 ? "goal_5" : "goal_1", "M ray-times",
                   bench_median(ray_times, SEEDS) / 1e6, 0,
                   "a job by relative_error %g: its sensors' rms %.2f %%", goal.relative_error,
                   100 * pooled.rms);
}
