/*
 * Glare at a desk of the office with the sun on its laser cut panel: a job requests DGP to 0.01 of
 * a 400 x 400 fisheye. Compared with rpict with an ambient cache, and evalglare. (With the sun in
 * view DGP is 1 regardless of sampling, so that would measure nothing.)
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "bench/speed.h"

#define EYE "-vta -vp 1.3 2.5 1.2 -vd 0 -1 0 -vu 0 0 1 -vh 180 -vv 180"
enum { SIDE = 400 };
static const double wanted_error = 0.01, wanted_share = 0.1;
/* The options that speed_radiance.c uses for sensors. */
static const char rpict_options[] = "-ps 1 -ab 4 -aa .1 -ar 128 -ad 4096 -as 2048 -lw 1e-4";

/* Results of the runs. */
struct sightings {
    double ray_times[BENCH_MOST_RUNS], seconds[BENCH_MOST_RUNS], dgp[BENCH_MOST_RUNS];
    double stated; /* half width of the widest interval */
};

static void render_glare(struct speed *s, int run, struct sightings *found)
{
    static char name[] = "eye", view_text[] = EYE;
    struct orl_view_request view = {.name = name,
                                    .view = view_text,
                                    .width = SIDE,
                                    .height = SIDE,
                                    .formats = ORL_PICTURE_BIT(ORL_PICTURE_HDR),
                                    .metrics = 1U << ORL_GLARE_DGP};
    char maps[BENCH_PATH + 16];
    struct orl_result r;
    struct orl_job job;
    office_job(&job);
    job.technique = ORL_TECHNIQUE_AUTO;
    job.photons_global = job.photons_caustic = ORL_PHOTONS_BY_PLAN;
    job.photons_exact = false;
    job.gather_samples = 0;
    job.goal = (struct orl_goal){.dgp_error = wanted_error, .at = 0.95};
    job.seed = (uint64_t)run + 1;
    job.views = &view;
    job.n_views = 1;
    snprintf(maps, sizeof maps, "%s/glare", s->office.folder);
    const double before = office_rate(&s->office, s->pool, 3);
    speed_run(s, maps, &job, &r);
    const double rate = 0.5 * (before + office_rate(&s->office, s->pool, 3));
    const struct orl_glare_value *dgp = &r.views[0].glare->values[ORL_GLARE_DGP];
    found->seconds[run] = r.total_s;
    found->ray_times[run] = r.total_s * rate;
    found->dgp[run] = dgp->value;
    found->stated = fmax(found->stated, (dgp->interval_95[1] - dgp->interval_95[0]) / 2);
    orl_result_done(&r);
    bench_remove_folder(maps);
}

static double spread_of(const double *values, int n)
{
    double sum = 0, squares = 0;
    for (int i = 0; i < n; i++)
        sum += values[i] / n;
    for (int i = 0; i < n; i++)
        squares += (values[i] - sum) * (values[i] - sum);
    return n > 1 ? sqrt(squares / (n - 1)) : 0;
}

/* Returns evalglare's DGP of the picture in the folder: the first number of its line. */
static double rate_picture(const struct radiance *radiance)
{
    char path[BENCH_PATH + 64], line[512];
    double dgp = NAN;
    radiance_run(radiance, NULL, "dgp.txt", "evalglare eye.hdr");
    snprintf(path, sizeof path, "%s/dgp.txt", radiance->folder);
    FILE *file = fopen(path, "r");
    while (file && fgets(line, sizeof line, file)) {
        const char *numbers = strchr(line, ':');
        if (strncmp(line, "dgp,", 4) == 0 && numbers)
            dgp = strtod(numbers + 1, NULL);
    }
    if (file)
        fclose(file);
    if (isnan(dgp))
        bench_fail("evalglare told no DGP", NULL);
    return dgp;
}

static void add_radiance(struct speed *s, struct speed_fact *fact, double ours)
{
    struct radiance radiance;
    fprintf(stderr, "  Radiance: glare\n");
    radiance_open(&radiance, &s->office, "radiance-glare");
    const double rate = office_rate(&s->office, s->pool, 3);
    const struct bench_use taken =
        radiance_run(&radiance, NULL, "eye.hdr", "rpict %s -x %d -y %d -pa 0 %s office.oct", EYE,
                     SIDE, SIDE, rpict_options);
    const double ray_times = taken.cpu_s * rate, dgp = rate_picture(&radiance);
    fact->radiance = ray_times / 1e6;
    speed_add_fact(s, "glare_share", "share", ours / ray_times, wanted_share,
                   "of what rpict takes (%.0f s; evalglare then finds %.4f)", taken.cpu_s, dgp);
}

void speed_measure_glare(struct speed *s)
{
    struct sightings found = {.stated = 0};
    for (int run = 0; run < s->runs; run++) {
        fprintf(stderr, "  glare, seed %d\n", run + 1);
        render_glare(s, run, &found);
    }
    const double ray_times = bench_median(found.ray_times, s->runs);
    struct speed_fact *fact = speed_add_fact(
        s, "glare", "M rays", ray_times / 1e6, 0,
        "DGP of a fisheye to 0.01: %.4f, stated +- %.4f, spread %.4f, in %.1f s", found.dgp[0],
        found.stated, spread_of(found.dgp, s->runs), bench_median(found.seconds, s->runs));
    if (s->radiance && !radiance_missing() && radiance_has("evalglare"))
        add_radiance(s, fact, ray_times);
}
