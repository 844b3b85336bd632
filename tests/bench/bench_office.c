/*
 * Speed on the paper's office, one thread, in ray-times: seconds times the rate at which Embree
 * alone answers incoherent single rays in the same scene, measured in the same run. Ray-times hold
 * on any machine; seconds do not. Medians of several runs.
 *
 * Run from the top of the project, by `make bench`. ORIEL_BENCH_PHOTONS and ORIEL_BENCH_RUNS make
 * it smaller.
 */
#include <stdio.h>
#include <stdlib.h>

#include "bench/office.h"
#include "photon/facing.h"
#include "photon/leaves.h"

struct bench {
    struct office office;
    struct orl_crew *crew;
    uint64_t photons;
    int runs;
    double rate;    /* Embree's rays a second */
    char map[1024]; /* a global photon map of `photons` */
};

static void run_job(struct bench *b, const char *maps, const struct orl_job *job,
                    struct orl_result *ret_result)
{
    char folder[BENCH_PATH + 64];
    snprintf(folder, sizeof folder, "%s/%s", b->office.folder, maps);
    const struct bench_env env = {.files = &b->office.files,
                                  .crew = b->crew,
                                  .maps = folder,
                                  .output = b->office.folder,
                                  .now_s = bench_wall_s};
    bench_run(&env, job, ret_result);
}

static void row(const struct bench *b, const char *what, double seconds, const char *note)
{
    printf("  %-46s %8.2f s %9.1f M ray-times   %s\n", what, seconds, seconds * b->rate / 1e6,
           note);
}

/* Photons of one kind, distributed and indexed; the sensor is there because a job needs one. */
static void bench_photons(struct bench *b, bool caustic)
{
    struct orl_sensor sensor = {orl_v3(1, 3, 1), orl_v3(0, 0, 1)};
    double seconds[BENCH_MOST_RUNS];
    char maps[64], what[64];
    struct orl_job job;
    struct orl_result r;
    office_job(&job);
    job.sensors = &sensor;
    job.n_sensors = 1;
    job.gather_samples = 1;
    job.photons_global = caustic ? 1 : b->photons;
    job.photons_caustic = caustic ? b->photons : 0;
    for (int run = 0; run < b->runs; run++) {
        snprintf(maps, sizeof maps, "%s-%d", caustic ? "caustic" : "global", run);
        run_job(b, maps, &job, &r);
        seconds[run] = r.timings_s[ORL_STAGE_PHOTONS] + r.timings_s[ORL_STAGE_MAPS];
        if (run + 1 == b->runs) {
            const struct orl_map_info *m = &r.maps[r.n_maps - 1];
            snprintf(what, sizeof what, "%.2f M %s photons, traced and indexed",
                     (double)m->stored / 1e6, m->kind);
            row(b, what, bench_median(seconds, b->runs),
                caustic ? "(Radiance: about 125 M)" : "(Radiance: about 100 M; wanted <= 40 M)");
            if (!caustic)
                snprintf(b->map, sizeof b->map, "%s/%s/global-%s.opm", b->office.folder, maps,
                         m->key);
            printf("  %-46s %8.2f bytes\n", "bytes a photon in the file, index included",
                   (double)m->bytes / (double)m->stored);
        }
        orl_result_done(&r);
    }
}

static void bench_image(struct bench *b)
{
    char view[] = OFFICE_VIEW;
    char name[] = "bench";
    struct orl_view_request request = {name, view, 400, 300};
    struct orl_job job;
    struct orl_result r;
    double seconds[BENCH_MOST_RUNS];
    office_job(&job);
    job.views = &request;
    job.n_views = 1;
    job.photons_global = job.photons_caustic = b->photons;
    for (int run = 0; run < b->runs; run++) {
        run_job(b, "image", &job, &r);
        seconds[run] = r.views[0].seconds;
        orl_result_done(&r);
    }
    row(b, "400x300 image, gather, maps ready", bench_median(seconds, b->runs),
        "(Radiance: about 105 M)");
}

static void bench_sensors(struct bench *b)
{
    struct orl_job job;
    struct orl_result r;
    double seconds[BENCH_MOST_RUNS];
    office_job(&job);
    job.sensors_file = office_sensors;
    job.photons_global = job.photons_caustic = b->photons;
    for (int run = 0; run < b->runs; run++) {
        run_job(b, "image", &job, &r);
        seconds[run] = r.timings_s[ORL_STAGE_RENDER];
        orl_result_done(&r);
    }
    row(b, "57 sensors, gather, maps ready", bench_median(seconds, b->runs),
        "(Radiance: about 29 M)");
}

/* From opening the file to the first answered query. */
static void bench_open(struct bench *b)
{
    double seconds[BENCH_MOST_RUNS], verified[BENCH_MOST_RUNS];
    struct orl_search *search = calloc(1, sizeof *search);
    struct orl_error err = {0};
    for (int run = 0; run < b->runs; run++) {
        for (int verify = 0; verify < 2; verify++) {
            struct orl_photon_map *map;
            const double started = bench_wall_s(NULL);
            if (!search || orl_photon_map_open(b->map, verify, &map, &err) < 0)
                bench_fail("opening a map", &err);
            const struct orl_photon p = orl_photon_map_get(map, 0);
            const struct orl_density_query query = {
                .point = orl_v3(p.position[0], p.position[1], p.position[2]),
                .normal = orl_normal_decode(p.normal),
                .k = 50,
                .max_radius = 1};
            if (orl_density_estimate(map, &query, search).found == 0)
                bench_fail("the first query found nothing", NULL);
            (verify ? verified : seconds)[run] = bench_wall_s(NULL) - started;
            orl_photon_map_free(map);
        }
    }
    free(search);
    printf("  %-46s %8.3f ms (%.1f ms with the whole body verified)\n",
           "opening a map, to the first query", 1e3 * bench_median(seconds, b->runs),
           1e3 * bench_median(verified, b->runs));
}

int main(void)
{
    struct bench b = {.photons = bench_number("ORIEL_BENCH_PHOTONS", 2000000),
                      .runs = (int)bench_number("ORIEL_BENCH_RUNS", 3)};
    if (b.runs < 1 || b.runs > BENCH_MOST_RUNS)
        b.runs = 3;
    office_open(&b.office);
    b.crew = orl_crew_start(1);
    if (!b.crew)
        bench_fail("out of memory", NULL);
    b.rate = office_rate(&b.office, b.runs, bench_wall_s);
    printf("Office, laser cut panel 2^6, one thread, medians of %d\n", b.runs);
    printf("  %-46s %8.2f M rays/s\n", "Embree alone, incoherent single rays (R)", b.rate / 1e6);
    bench_photons(&b, false);
    bench_photons(&b, true);
    bench_open(&b);
    bench_sensors(&b);
    bench_image(&b);
    orl_crew_stop(b.crew);
    office_close(&b.office);
    return 0;
}
