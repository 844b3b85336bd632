/* The rows of `make bench`, and facts about maps other than the cost of their build. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "bench/speed.h"
#include "photon/map/map.h"

/* A cheap sensor, since a job needs a request. */
static struct orl_sensor sensor = {{1, 3, 1}, {0, 0, 1}};

void speed_run(const struct speed *s, const char *maps, const struct orl_job *job,
               struct orl_result *ret_result)
{
    const struct bench_env env = {.files = &s->office.files,
                                  .pool = s->pool,
                                  .maps = maps,
                                  .memory_cache = s->memory_cache,
                                  .output = s->office.folder,
                                  .now_s = s->now_s};
    bench_run(&env, job, ret_result);
}

static void leave_caustics(struct orl_job *job)
{
    job->overrides[ORL_EFFECT_CAUSTICS_MIRROR] = job->overrides[ORL_EFFECT_CAUSTICS_BSDF] =
        ORL_OVERRIDE_SKIP;
}

static double map_seconds(const struct orl_result *r)
{
    return r->timings_s[ORL_STAGE_PHOTONS] + r->timings_s[ORL_STAGE_MAPS];
}

/* ---- Photons --------------------------------------------------------------------------------- */

static void map_job(const struct speed *s, enum speed_row_id id, struct orl_job *ret_job)
{
    office_job(ret_job);
    ret_job->sensors = &sensor;
    ret_job->n_sensors = 1;
    ret_job->gather_samples = 1;
    ret_job->photons_global = id == SPEED_CAUSTIC ? 1 : s->photons;
    ret_job->photons_caustic = s->photons;
    if (id != SPEED_CAUSTIC)
        leave_caustics(ret_job);
    if (id == SPEED_PRECOMPUTED)
        ret_job->technique = ORL_TECHNIQUE_PRECOMPUTED;
}

static double make_maps(struct speed *s, enum speed_row_id id, uint64_t seed)
{
    char maps[BENCH_PATH + 16];
    struct orl_result r;
    struct orl_job job;
    snprintf(maps, sizeof maps, "%s/new", s->office.folder);
    map_job(s, id, &job);
    job.seed = seed;
    speed_run(s, maps, &job, &r);
    const double seconds = map_seconds(&r);
    const struct orl_map_info *last = &r.maps[r.n_maps - 1];
    snprintf(s->rows[id].note, SPEED_NOTE, "%.2f M %s", (double)last->stored / 1e6,
             id == SPEED_PRECOMPUTED ? "records" : "stored");
    orl_result_done(&r);
    bench_remove_folder(maps);
    return seconds;
}

/* ---- Images ---------------------------------------------------------------------------------- */

static void image_job(const struct speed *s, enum speed_row_id id, struct orl_view_request *view,
                      struct orl_job *ret_job)
{
    static char text[] = OFFICE_VIEW, name[] = "bench";
    *view = (struct orl_view_request){
        .name = name, .view = text, .width = s->reference.width, .height = s->reference.height};
    office_job(ret_job);
    ret_job->technique =
        id == SPEED_IMAGE_GATHER ? ORL_TECHNIQUE_GATHER : ORL_TECHNIQUE_PRECOMPUTED;
    ret_job->photons_global = ret_job->photons_caustic = s->photons;
    ret_job->views = view;
    ret_job->n_views = 1;
}

/* The maps of the seed must exist before; building missing ones belongs to another stage's time. */
static double render_image(struct speed *s, enum speed_row_id id, uint64_t seed, int merged)
{
    char path[BENCH_PATH + 16];
    struct orl_view_request view;
    struct orl_result r;
    struct orl_job job;
    image_job(s, id, &view, &job);
    job.seed = seed;
    speed_run(s, s->maps, &job, &r);
    const double seconds = r.views[0].seconds;
    snprintf(path, sizeof path, "%s/bench.hdr", s->office.folder);
    if (merged >= 0) {
        double *luminances = bench_read_luminances(path, (int)view.width, (int)view.height);
        const struct bench_deviation error =
            bench_compare(&s->reference.image, luminances, OFFICE_DARKEST);
        speed_merge(&s->rows[id].error, &error, merged);
        snprintf(s->rows[id].note, SPEED_NOTE, "%.1f %% without the worst hundredth",
                 100 * error.rms_99);
        free(luminances);
    }
    orl_result_done(&r);
    return seconds;
}

/* ---- All of them ----------------------------------------------------------------------------- */

void speed_prepare(struct speed *s, enum speed_row_id id)
{
    struct speed_row *row = &s->rows[id];
    if (row->judge == SPEED_BY_SENSORS)
        speed_choose(s, row);
    for (int run = 0; row->judge == SPEED_BY_IMAGE && run < s->runs; run++)
        render_image(s, id, (uint64_t)run + 1, -1);
}

double speed_work(struct speed *s, enum speed_row_id id, uint64_t seed, int merged)
{
    struct speed_row *row = &s->rows[id];
    struct bench_deviation error;
    if (row->judge == SPEED_NO_ERROR)
        return make_maps(s, id, seed);
    if (row->judge == SPEED_BY_IMAGE)
        return render_image(s, id, seed, merged);
    const double seconds = speed_sensors(s, &row->setting, seed, &error);
    if (merged >= 0)
        speed_merge(&row->error, &error, merged);
    return seconds;
}

/* ---- Maps that are there --------------------------------------------------------------------- */

/* Measures bytes per photon, of the records alone and of the whole file. */
static void measure_bytes(struct speed *s, const char *maps, const struct orl_map_info *info)
{
    char path[2 * BENCH_PATH];
    struct orl_photon_map *map;
    struct orl_error err = {0};
    snprintf(path, sizeof path, "%s/%s-%s.opm", maps, info->kind, info->key);
    if (orl_photon_map_open(path, false, &map, &err) < 0)
        bench_fail("opening a map", &err);
    const struct orl_map_header *h = orl_photon_map_header(map);
    const double n = (double)h->count;
    speed_add_fact(s, "photon_bytes", "bytes", (double)(h->boxes - h->places) / n, 16,
                   "a photon in the file");
    speed_add_fact(s, "photon_bytes_indexed", "bytes", (double)h->size / n, 24,
                   "a photon in the file, with its index");
    orl_photon_map_free(map);
}

/*
 * A second view of a cached scene by gather: the time of all map stages before rendering, texels
 * included. Measured with the results of an earlier job in the daemon's memory cache, and in a
 * process without one.
 */
void speed_measure_maps(struct speed *s)
{
    double with[BENCH_MOST_RUNS], without[BENCH_MOST_RUNS];
    char maps[BENCH_PATH + 16], text[] = OFFICE_VIEW, name[] = "second";
    struct orl_view_request view = {.name = name, .view = text, .width = 16, .height = 12};
    struct orl_memory_cache *memory_cache = orl_memory_cache_new(256UL << 20);
    struct orl_result r;
    struct orl_job job;
    fprintf(stderr, "  a second view of a cached scene\n");
    snprintf(maps, sizeof maps, "%s/second", s->office.folder);
    map_job(s, SPEED_GLOBAL, &job);
    job.n_sensors = 0;
    job.views = &view;
    job.n_views = 1;
    for (int run = -1; run < s->runs; run++) {
        for (int kept = 0; kept < 2; kept++) {
            s->memory_cache = kept ? memory_cache : NULL;
            speed_run(s, maps, &job, &r);
            if (run >= 0)
                (kept ? with : without)[run] = 1e3 * map_seconds(&r);
            if (run >= 0 && (r.n_maps != 1 || !r.maps[0].cached))
                bench_fail("the map was made twice", NULL);
            if (run + 1 < s->runs || !kept)
                orl_result_done(&r);
        }
    }
    s->memory_cache = NULL;
    speed_add_fact(s, "second_view_ms", "ms", bench_median(with, s->runs), 10,
                   "a second view: its map of %.2f M photons opened, all ready",
                   (double)r.maps[0].stored / 1e6);
    speed_add_fact(s, "second_process_ms", "ms", bench_median(without, s->runs), 0,
                   "the same in a new process: leaves and texels made");
    measure_bytes(s, maps, &r.maps[0]);
    orl_result_done(&r);
    orl_memory_cache_free(memory_cache);
    bench_remove_folder(maps);
}
