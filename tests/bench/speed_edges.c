/*
 * Stitches and specks: the deviation of the worst thousandth of pixels from their neighbourhood
 * (bench_worst_pixels), in pictures at default settings. The scenes provoke them: seams of
 * surfaces, tops of faint gloss, and a floor that mirrors windows.
 */
#include <stdio.h>
#include <stdlib.h>

#include "bench/speed.h"

enum { WIDTH = 200, HEIGHT = 150, PIXELS = WIDTH * HEIGHT };
static const double percentile = 99.9;
static const char scenes_folder[] = "tests/bench/scenes";

struct picture {
    const char *key, *file; /* NULL: the office */
    const char *view, *about;
    double wanted; /* per cent: half of the first measured value */
};
/* The thousandth is undecided if a larger share of pixels is unknown to the reference. */
static const double most_unsure = 0.002;
static const struct picture pictures[] = {
    {"edges_office", NULL, OFFICE_VIEW, "the office", 15.2},
    {"edges_desks", "desks.rad", "-vtv -vp 5.2 4.6 1.7 -vd -0.7 -1 -0.35 -vu 0 0 1 -vh 70 -vv 55.4",
     "four desks", 45},
    {"edges_floor", "varnish.rad",
     "-vtv -vp 1.3 8.6 1.6 -vd -0.08 -1 -0.22 -vu 0 0 1 -vh 60 -vv 46.8", "a varnished floor", 25},
};
enum { PICTURES = sizeof pictures / sizeof *pictures };

/* A picture and its request. */
struct sitting {
    struct speed *speed;
    const struct picture *picture;
    struct orl_files folder, *files;
    char *names[1];
};

/* Renders the picture; pixel_samples: by backward; 0: default settings. Returns seconds. */
static double render(const struct sitting *sitting, uint64_t seed, uint32_t pixel_samples,
                     double *ret_luminances)
{
    char name[] = "edges", maps[BENCH_PATH + 16], path[BENCH_PATH + 16];
    const struct speed *s = sitting->speed;
    struct orl_view_request view = {.name = name,
                                    .view = (char *)(uintptr_t)sitting->picture->view,
                                    .width = WIDTH,
                                    .height = HEIGHT};
    struct orl_result r;
    struct orl_job job;
    snprintf(maps, sizeof maps, "%s/edges", s->office.folder);
    snprintf(path, sizeof path, "%s/edges.hdr", s->office.folder);
    office_job(&job);
    if (sitting->picture->file) {
        job.scene_files = (char **)(uintptr_t)sitting->names;
        job.n_scene_files = 1;
    }
    job.photons_exact = false;
    job.technique = pixel_samples ? ORL_TECHNIQUE_BACKWARD : ORL_TECHNIQUE_AUTO;
    job.pixel_samples = pixel_samples;
    job.seed = seed;
    job.views = &view;
    job.n_views = 1;
    const struct bench_env env = {.files = sitting->files,
                                  .pool = s->pool,
                                  .maps = maps,
                                  .output = s->office.folder,
                                  .now_s = s->now_s};
    bench_run(&env, &job, &r);
    const double seconds = r.total_s;
    double *read = bench_read_luminances(path, WIDTH, HEIGHT);
    for (int i = 0; i < PIXELS; i++)
        ret_luminances[i] = read[i];
    free(read);
    orl_result_done(&r);
    bench_remove_folder(maps);
    return seconds;
}

static void render_half(const void *ctx, uint64_t seed, double *ret_values)
{
    const struct sitting *sitting = ctx;
    render(sitting, seed, sitting->speed->reference.edge_samples, ret_values);
}

/* The digest identifies the scene, as it does for the office. */
static void name_file(const struct sitting *sitting, char ret_name[BENCH_PATH])
{
    const bool is_office = !sitting->picture->file;
    struct orl_scene_summary summary = {0};
    struct orl_error err = {0};
    if (orl_scene_check(is_office ? (const char *const *)(uintptr_t)office_names
                                  : (const char *const *)(uintptr_t)sitting->names,
                        is_office ? OFFICE_FILES : 1, sitting->files, NULL, &summary, &err) < 0)
        bench_fail(sitting->picture->about, &err);
    snprintf(ret_name, BENCH_PATH, "%s-%.16s-%ux%u-%u.bin", sitting->picture->key, summary.digest,
             WIDTH, HEIGHT, sitting->speed->reference.edge_samples);
    orl_scene_summary_done(&summary);
}

static void measure_picture(struct speed *s, const struct picture *picture)
{
    struct sitting sitting = {.speed = s,
                              .picture = picture,
                              .folder = orl_files_from_folder(scenes_folder),
                              .names = {(char *)(uintptr_t)picture->file}};
    double *halves = malloc((size_t)2 * PIXELS * sizeof *halves),
           *pixels = malloc(PIXELS * sizeof *pixels);
    double seconds[BENCH_MOST_RUNS], worst = 0, unsure;
    char name[BENCH_PATH];
    if (!halves || !pixels)
        bench_fail("out of memory", NULL);
    sitting.files = picture->file ? &sitting.folder : &s->office.files;
    fprintf(stderr, "  edges and specks: %s\n", picture->about);
    name_file(&sitting, name);
    bench_reference_find(name, PIXELS, render_half, &sitting, halves);
    const struct bench_reference reference = {halves, halves + PIXELS, PIXELS};
    for (int run = 0; run < s->runs; run++) {
        seconds[run] = render(&sitting, (uint64_t)run + 1, 0, pixels);
        worst += bench_worst_pixels(&reference, pixels, WIDTH, percentile, &unsure) / s->runs;
    }
    if (unsure > most_unsure)
        bench_fail("the reference knows too few pixels: ORIEL_BENCH_REFERENCE_EDGES", NULL);
    speed_add_fact(s, picture->key, "%", 100 * worst, picture->wanted,
                   "%s: worst thousandth, %.2f s (of the reference: %.0f; %.2f %% not known)",
                   picture->about, bench_median(seconds, s->runs),
                   100 * bench_worst_pixels(&reference, NULL, WIDTH, percentile, NULL),
                   100 * unsure);
    free(halves);
    free(pixels);
}

void speed_measure_edges(struct speed *speed)
{
    for (int i = 0; i < PICTURES; i++)
        measure_picture(speed, &pictures[i]);
}
