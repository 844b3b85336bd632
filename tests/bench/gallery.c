/*
 * `make gallery`: scenes that provoke artefacts, by every technique, below <build>/gallery:
 *
 * <scene>-<technique>.hdr and .png as a job writes them;
 * <scene>.png, the techniques side by side above their relative differences from the backward
 * reference;
 * index.html, which shows all of it.
 *
 * The reference is two independent halves. Its own noise, half the difference of the two, is shown
 * below it; the figures are those of compare.h. ORIEL_GALLERY_SAMPLES: samples per pixel of each
 * half; ORIEL_GALLERY_SCENE: renders only that scene.
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include <oriel/base/vec.h>

#include "bench/canvas.h"
#include "bench/compare.h"
#include "bench/office.h"
#include "support/hdr.h"

enum { TECHNIQUES = 4, GAP = 4, PATH_BYTES = 1024 };
/* relative difference shown as full red or blue */
static const double full = 0.25;
static const char scenes_folder[] = "tests/bench/scenes";

static const enum orl_technique techniques[TECHNIQUES] = {
    ORL_TECHNIQUE_BACKWARD, ORL_TECHNIQUE_GATHER, ORL_TECHNIQUE_PRECOMPUTED, ORL_TECHNIQUE_DIRECT};

struct scene {
    const char *name, *file; /* NULL: the office */
    const char *view, *about;
    int width, height;
};
static const struct scene scenes[] = {
    {"office", NULL, OFFICE_VIEW, "the paper's office, from its depth", 400, 300},
    {"desk", NULL, "-vtv -vp 1.2 4.2 1.5 -vd 0.3 -1 -0.35 -vu 0 0 1 -vh 60 -vv 46.8",
     "the office's desk and chair: small things, sun patches, corners", 400, 300},
    {"wall", "wall.rad", "-vtl -vp 2.99 1.5 2.45 -vd 0 0 -1 -vu 0 1 0 -vh 5.96 -vv 2.98",
     "from above: a bright and a dark room, a wall of 1 mm between them", 160, 80},
    {"wall_bright", "wall.rad", "-vtv -vp 0.4 2.6 1.4 -vd 1 -0.5 -0.2 -vu 0 0 1 -vh 80 -vv 64.4",
     "the bright room's side of the wall", 400, 300},
    {"wall_dark", "wall.rad", "-vtv -vp 5.6 2.6 1.3 -vd -1 -0.5 -0.2 -vu 0 0 1 -vh 80 -vv 64.4",
     "the dark room's side of the wall", 400, 300},
    {"mirror", "mirror.rad", "-vtv -vp 0 -0.6 2.5 -vd 0 0.35 -1 -vu 0 1 0 -vh 60 -vv 46.8",
     "the sun thrown together by a half ring of flat mirrors", 400, 300},
    {"table", "table.rad", "-vtv -vp 2.7 3.6 1.6 -vd -0.75 -1 -0.1 -vu 0 0 1 -vh 75 -vv 59.8",
     "a lacquered table and a metal tray in the sun", 400, 300},
};
enum { SCENES = sizeof scenes / sizeof *scenes };

struct picture {
    double (*rgb)[3];
    double *luminances;
    double seconds; /* render time of the view on all cores */
};

struct gallery {
    struct office office;
    struct orl_thread_pool *pool;
    char folder[BENCH_PATH];
    uint32_t samples; /* samples per pixel of each half of the reference */
    FILE *index;
};

static size_t pixels(const struct scene *s)
{
    return (size_t)s->width * (size_t)s->height;
}

/* Renders into the gallery's folder, as <name>.hdr and .png, and reads the picture back. */
static struct picture render(const struct gallery *g, const struct scene *s, char *name,
                             enum orl_technique technique, uint64_t seed)
{
    const struct orl_files folder = orl_files_from_folder(scenes_folder);
    char maps[PATH_BYTES], path[PATH_BYTES], *files[1] = {(char *)(uintptr_t)s->file};
    struct orl_view_request view = {.name = name,
                                    .view = (char *)(uintptr_t)s->view,
                                    .width = (uint32_t)s->width,
                                    .height = (uint32_t)s->height};
    struct picture p = {.rgb = malloc(pixels(s) * sizeof *p.rgb)};
    struct orl_result r;
    struct orl_job job;
    snprintf(maps, sizeof maps, "%s/maps", g->office.folder);
    const struct bench_env env = {.files = s->file ? &folder : &g->office.files,
                                  .pool = g->pool,
                                  .maps = maps,
                                  .output = g->folder,
                                  .now_s = bench_wall_s};
    office_job(&job);
    if (s->file) {
        job.scene_files = files;
        job.n_scene_files = 1;
    }
    job.technique = technique;
    job.seed = seed;
    job.pixel_samples = g->samples;
    job.views = &view;
    job.n_views = 1;
    bench_run(&env, &job, &r);
    p.seconds = r.views[0].seconds;
    for (size_t i = 0; i < r.n_warnings; i++)
        printf("  (%s: %s)\n", name, r.warnings[i]);
    orl_result_done(&r);
    snprintf(path, sizeof path, "%s/%s.hdr", g->folder, name);
    if (!p.rgb)
        bench_fail("out of memory", NULL);
    hdr_read(path, s->width, s->height, p.rgb);
    p.luminances = bench_read_luminances(path, s->width, s->height);
    return p;
}

static void picture_done(struct picture *p)
{
    free(p->rgb);
    free(p->luminances);
}

/* Returns the log average, the radiance that is shown grey. */
static double log_average(const struct picture *p, size_t n)
{
    double sum = 0, lit = 0;
    for (size_t i = 0; i < n; i++) {
        if (p->luminances[i] > 0) {
            sum += log(p->luminances[i] / ORL_EFFICACY_LM_PER_W);
            lit++;
        }
    }
    return lit > 0 ? exp(sum / lit) : 1;
}

/* Draws one column of the sheet: the picture, and its differences below. */
static void draw_column(struct bench_canvas *sheet, const struct scene *s, int column,
                        const struct picture *p, double average, const double *differences)
{
    const int left = column * (s->width + GAP), below = s->height + GAP;
    for (int y = 0; y < s->height; y++) {
        for (int x = 0; x < s->width; x++) {
            const size_t i = (size_t)y * (size_t)s->width + (size_t)x;
            bench_canvas_set_radiance(sheet, left + x, y, p->rgb[i], average);
            bench_canvas_set_share(sheet, left + x, below + y, differences[i] / full);
        }
    }
}

/*
 * Differences relative to the reference, or to a thousandth of its mean where it is nearly black.
 */
static void find_differences(const struct bench_reference *r, const double *values,
                             double *ret_differences)
{
    double mean = 0;
    for (size_t i = 0; i < r->n; i++)
        mean += (r->a[i] + r->b[i]) / 2 / (double)r->n;
    for (size_t i = 0; i < r->n; i++) {
        const double at = (r->a[i] + r->b[i]) / 2;
        const double d = values ? values[i] - at : (r->a[i] - r->b[i]) / 2;
        ret_differences[i] = d / fmax(at, 1e-3 * mean);
    }
}

static void caption(const struct gallery *g, const char *name, const struct bench_reference *r,
                    const struct picture *p, const double *values)
{
    char text[256];
    if (values) {
        const struct bench_deviation d = bench_compare(r, values, 0.01);
        snprintf(text, sizeof text,
                 "rms %.1f %%, without the worst hundredth %.1f %%, bias %+.2f %%", 100 * d.rms,
                 100 * d.rms_99, 100 * bench_bias_of_mean(r, values));
    } else {
        snprintf(text, sizeof text, "its own standard error %.1f %%",
                 100 * bench_reference_noise(r, 0.01));
    }
    printf("  %-24s %s, %.1f s\n", name, text, p->seconds);
    fprintf(g->index, "<td><a href=\"%s.png\">%s</a>: %s</td>\n", name, name, text);
}

static void show(struct gallery *g, const struct scene *s)
{
    char name[64], path[PATH_BYTES];
    const size_t n = pixels(s);
    double *differences = malloc(n * sizeof *differences);
    struct bench_canvas sheet =
        bench_canvas_new(TECHNIQUES * (s->width + GAP) - GAP, 2 * s->height + GAP);
    if (!differences)
        bench_fail("out of memory", NULL);
    printf("%s: %s\n", s->name, s->about);
    fprintf(g->index, "<h2>%s</h2><p>%s</p><table><tr>\n", s->name, s->about);
    snprintf(name, sizeof name, "%s-second_half", s->name);
    struct picture second = render(g, s, name, ORL_TECHNIQUE_BACKWARD, 2);
    snprintf(name, sizeof name, "%s-backward", s->name);
    struct picture first = render(g, s, name, ORL_TECHNIQUE_BACKWARD, 1);
    const struct bench_reference reference = {first.luminances, second.luminances, n};
    const double average = log_average(&first, n);
    for (int i = 0; i < TECHNIQUES; i++) {
        const char *technique = orl_technique_name(techniques[i]);
        struct picture p = first;
        snprintf(name, sizeof name, "%s-%s", s->name, technique);
        if (i > 0)
            p = render(g, s, name, techniques[i], 1);
        find_differences(&reference, i > 0 ? p.luminances : NULL, differences);
        draw_column(&sheet, s, i, &p, average, differences);
        caption(g, name, &reference, &p, i > 0 ? p.luminances : NULL);
        if (i > 0)
            picture_done(&p);
    }
    snprintf(path, sizeof path, "%s/%s.png", g->folder, s->name);
    bench_canvas_write(&sheet, path);
    fprintf(g->index, "</tr><tr><td colspan=%d><img src=\"%s.png\" alt=\"\"></td></tr></table>\n",
            TECHNIQUES, s->name);
    bench_canvas_done(&sheet);
    picture_done(&first);
    picture_done(&second);
    free(differences);
}

static void begin_index(struct gallery *g)
{
    char path[PATH_BYTES];
    snprintf(path, sizeof path, "%s/index.html", g->folder);
    g->index = fopen(path, "w");
    if (!g->index)
        bench_fail("cannot write the gallery's index", NULL);
    fprintf(g->index,
            "<!doctype html><meta charset=utf-8><title>Oriel: gallery</title>\n"
            "<style>body{font:14px sans-serif}td{width:25%%}img{width:100%%}</style>\n"
            "<h1>All techniques, side by side</h1>\n"
            "<p>Above: the pictures. Below: relative differences from the backward reference, blue "
            "%.0f %% too dark, red %.0f %% too bright; under the reference, its own noise.</p>\n",
            100 * full, 100 * full);
}

int main(void)
{
    static struct gallery g;
    const long cores = sysconf(_SC_NPROCESSORS_ONLN);
    const char *only = getenv("ORIEL_GALLERY_SCENE");
    g.samples = (uint32_t)bench_number("ORIEL_GALLERY_SAMPLES", 24);
    g.pool = orl_thread_pool_start(cores > 1 ? (uint32_t)cores : 1);
    if (!g.pool)
        bench_fail("out of memory", NULL);
    setvbuf(stdout, NULL, _IOLBF, 0);
    snprintf(g.folder, sizeof g.folder, "%s/gallery", bench_build());
    mkdir(g.folder, 0777);
    office_open(&g.office, NULL);
    begin_index(&g);
    for (int i = 0; i < SCENES; i++)
        if (!only || strcmp(only, scenes[i].name) == 0)
            show(&g, &scenes[i]);
    if (fclose(g.index) != 0)
        bench_fail("cannot write the gallery's index", NULL);
    office_close(&g.office);
    orl_thread_pool_stop(g.pool);
    printf("%s/index.html\n", g.folder);
    return 0;
}
