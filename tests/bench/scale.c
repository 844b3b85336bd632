/*
 * `make bench-scale`: prints the tables of scale.h, and writes them as JSON. Environment, each name
 * after ORIEL_SCALE: _PHOTONS ("1 2 5 10 20 50", millions; "0.1 0.2 0.5" for a trial), _THREADS (1,
 * 2, and 4 on machines with as many cores), _LIMIT (memory in MB; default four fifths of the
 * largest map, at least 100).
 */
#include "bench/scale.h"

#include <jansson.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

struct scale {
    struct bench_list millions, threads;
    double limit_bytes; /* 0: derived from the largest map */
    struct office office;
    char maps[BENCH_PATH + 16]; /* folder of one map at a time */
    struct scale_build by_photons[BENCH_MOST_NUMBERS], by_threads[BENCH_MOST_NUMBERS];
    double search_s[BENCH_MOST_NUMBERS];
    struct scale_view free_view, limited_view;
    bool same;
};

/* Share of the largest map: about the size of a view's texels and leaves beside it, and less than
 * the map. */
static const double limit_share = 0.8;

enum { TURNS = 5 }; /* turns for each number of threads */

/* Maximum radius of a look-up, used where a sheet of surface has fewer photons than requested. */
#define EXTENT_M 1.0

static uint64_t photons_at(const struct scale *s, int at)
{
    return (uint64_t)(1e6 * s->millions.values[at] + 0.5);
}

/* ---- Photons --------------------------------------------------------------------------------- */

static double ray_times(const struct scale_build *b)
{
    return b->seconds * b->rays_per_s / b->stored;
}

/* Builds maps of increasing size; the last one remains. */
static void build_maps(struct scale *s)
{
    printf("\n  %9s %8s %9s %9s %9s %8s %8s %9s %10s\n", "photons", "s", "M/s", "rays each",
           "to first", "MB", "bytes", "peak MB", "look-up us");
    for (int i = 0; i < s->millions.n; i++) {
        struct scale_build *b = &s->by_photons[i];
        bench_remove_folder(s->maps);
        scale_build(&s->office, s->maps, photons_at(s, i), 1, b);
        s->search_s[i] = scale_search(s->maps, EXTENT_M);
        printf("  %7.2f M %8.2f %9.3f %9.3f %9.2f %8.1f %8.2f %9.1f %10.3f\n", b->stored / 1e6,
               b->seconds, b->stored / b->seconds / 1e6, ray_times(b),
               ray_times(b) / ray_times(&s->by_photons[0]), b->bytes / 1e6, b->bytes / b->stored,
               b->peak_bytes / 1e6, 1e6 * s->search_s[i]);
    }
    printf(
        "  Traced, sorted and written by one thread. Rays each: ray-times a photon, which a busy "
        "machine distorts little;\n"
        "  to first: over those of the first line, 0.80 to 1.25 wanted. Look-up: of the 50 "
        "nearest to a photon drawn at random.\n");
}

/* Least squares of y = a + b x; returns b. */
static double fit(const double *x, const double *y, int n, double *ret_a)
{
    double mx = 0, my = 0, xx = 0, xy = 0;
    for (int i = 0; i < n; i++) {
        mx += x[i] / n;
        my += y[i] / n;
    }
    for (int i = 0; i < n; i++) {
        xx += (x[i] - mx) * (x[i] - mx);
        xy += (x[i] - mx) * (y[i] - my);
    }
    *ret_a = my - (xx > 0 ? xy / xx : 0) * mx;
    return xx > 0 ? xy / xx : 0;
}

/* Fits look-up time against log N: prints the largest deviation from a straight line, and the
 * exponent of a power law in N. */
static void fit_searches(const struct scale *s)
{
    double x[BENCH_MOST_NUMBERS] = {0}, y[BENCH_MOST_NUMBERS] = {0}, logs[BENCH_MOST_NUMBERS] = {0};
    double a, c, worst = 0;
    for (int i = 0; i < s->millions.n; i++) {
        x[i] = log2(s->by_photons[i].stored);
        y[i] = 1e6 * s->search_s[i];
        logs[i] = log2(y[i]);
    }
    const double b = fit(x, y, s->millions.n, &a), power = fit(x, logs, s->millions.n, &c);
    for (int i = 0; i < s->millions.n; i++)
        worst = fmax(worst, fabs(y[i] / (a + b * x[i]) - 1));
    printf("  Look-up = %.3f us + %.4f us log2 N, within %.1f %%; as a power of N: N^%.3f\n", a, b,
           100 * worst, power);
}

/* ---- Threads --------------------------------------------------------------------------------- */

/* Prints the median over the turns of one number of threads, and its gain over the first, turn by
 * turn. */
static void print_gain(struct scale *s, int at, struct scale_build (*turns)[TURNS])
{
    double seconds[TURNS], rates[TURNS], each[TURNS], gains[TURNS], error;
    struct scale_build *b = &s->by_threads[at];
    for (int t = 0; t < TURNS; t++) {
        seconds[t] = turns[at][t].seconds;
        rates[t] = turns[at][t].rays_per_s;
        each[t] = ray_times(&turns[at][t]);
        gains[t] = s->threads.values[at] / s->threads.values[0] * ray_times(&turns[0][t]) / each[t];
    }
    *b = turns[at][0];
    b->seconds = bench_median(seconds, TURNS);
    b->rays_per_s = bench_median(rates, TURNS);
    const double gain = bench_median_error(gains, TURNS, &error);
    printf("  %9.0f %8.2f %9.3f %7.2f +- %.2f %9.2f %9.2f\n", s->threads.values[at], b->seconds,
           bench_median(each, TURNS), gain, error, s->by_threads[0].seconds / b->seconds,
           b->rays_per_s / s->by_threads[0].rays_per_s);
}

static void spread_out(struct scale *s)
{
    struct scale_build turns[BENCH_MOST_NUMBERS][TURNS];
    char maps[BENCH_PATH + 16];
    const uint64_t photons = photons_at(s, s->millions.n > 1 ? 1 : 0);
    snprintf(maps, sizeof maps, "%s/threads", s->office.folder);
    for (int t = 0; t < TURNS; t++) {
        for (int i = 0; i < s->threads.n; i++) {
            scale_build(&s->office, maps, photons, (uint32_t)s->threads.values[i], &turns[i][t]);
            bench_remove_folder(maps);
        }
    }
    printf("\n  %9s %8s %9s %15s %9s %9s\n", "threads", "s", "rays each", "speed-up", "on clock",
           "Embree's");
    for (int i = 0; i < s->threads.n; i++)
        print_gain(s, i, turns);
    printf(
        "  %.3g M photons, medians of %d turns. Speed-up: by ray-times, with its standard error; "
        "on clock: by seconds;\n  Embree's: of its rays alone. Wanted: 0.95 a thread.\n",
        (double)photons / 1e6, TURNS);
}

/* ---- Memory ---------------------------------------------------------------------------------- */

static bool same_bytes(const char *one, const char *other)
{
    const char *const argv[] = {"cmp", "-s", one, other, NULL};
    return bench_spawn(argv, NULL, NULL, NULL, NULL) == 0;
}

static void squeeze(struct scale *s)
{
    const uint64_t photons = photons_at(s, s->millions.n - 1);
    const double map_bytes = s->by_photons[s->millions.n - 1].bytes;
    const double limit = s->limit_bytes > 0 ? s->limit_bytes : fmax(limit_share * map_bytes, 100e6);
    char one[BENCH_PATH + 16], other[BENCH_PATH + 16];
    snprintf(one, sizeof one, "%s/free.hdr", s->office.folder);
    snprintf(other, sizeof other, "%s/limited.hdr", s->office.folder);
    scale_render(&s->office, s->maps, photons, 0, one, &s->free_view);
    scale_render(&s->office, s->maps, photons, limit, other, &s->limited_view);
    s->same = same_bytes(one, other);
    printf("\n  A view of 200x150 by gather, from the map of %.0f MB\n", map_bytes / 1e6);
    printf("  %-20s %8.2f s %9.1f MB resident at most (2048 wanted)\n", "without a limit",
           s->free_view.seconds, s->free_view.peak_bytes / 1e6);
    printf("  in %4.0f MB %9s %8.2f s %9.1f MB, %s\n", limit / 1e6, "", s->limited_view.seconds,
           s->limited_view.peak_bytes / 1e6,
           s->limited_view.by_kernel ? "pages of files included: the kernel's limit (cgroup)"
                                     : "resident at most; a thread sends pages back to the disk, "
                                       "for groups of limited memory are not allowed here");
    printf("  Memory limit %s than the map: finishes, %s, %.1f times slower; the limit was %s.\n",
           limit < map_bytes ? "smaller" : "NOT smaller",
           s->same ? "same bytes" : "NOT THE SAME BYTES",
           s->limited_view.seconds / s->free_view.seconds,
           s->limited_view.peak_bytes <= limit ? "kept to" : "NOT kept to");
}

/* ---- All of it ------------------------------------------------------------------------------- */

static json_t *build_json(const struct scale_build *b, double threads, double search_s)
{
    return json_pack("{s:f, s:f, s:f, s:f, s:f, s:f, s:f, s:f}", "stored", b->stored,
                     "ray_times_each", ray_times(b), "bytes", b->bytes, "peak_bytes", b->peak_bytes,
                     "threads", threads, "seconds", b->seconds, "rays_per_s", b->rays_per_s,
                     "look_up_s", search_s);
}

static json_t *view_json(const struct scale_view *v)
{
    return json_pack("{s:f, s:f, s:f, s:b}", "seconds", v->seconds, "peak_bytes", v->peak_bytes,
                     "paged_bytes", v->paged_bytes, "by_kernel", v->by_kernel);
}

static void write_json(const struct scale *s)
{
    json_t *photons = json_array(), *threads = json_array();
    char path[BENCH_PATH];
    for (int i = 0; i < s->millions.n; i++)
        json_array_append_new(photons, build_json(&s->by_photons[i], 1, s->search_s[i]));
    for (int i = 0; i < s->threads.n; i++)
        json_array_append_new(threads, build_json(&s->by_threads[i], s->threads.values[i], 0));
    json_t *root = json_pack("{s:o, s:o, s:{s:o, s:o, s:b}}", "photons", photons, "threads",
                             threads, "view", "free", view_json(&s->free_view), "limited",
                             view_json(&s->limited_view), "same_bytes", s->same);
    snprintf(path, sizeof path, "%s/bench-scale.json", bench_build());
    if (!root || json_dump_file(root, path, JSON_INDENT(2) | JSON_REAL_PRECISION(6)) < 0)
        bench_fail("cannot write the JSON", NULL);
    json_decref(root);
    printf("\n  The same as JSON: %s\n", path);
}

static void read_knobs(struct scale *s)
{
    static const struct bench_list millions = {{1, 2, 5, 10, 20, 50}, 6};
    const struct bench_list threads = {{1, 2, 4}, sysconf(_SC_NPROCESSORS_ONLN) >= 4 ? 3 : 2};
    s->millions = bench_numbers("ORIEL_SCALE_PHOTONS", &millions);
    s->threads = bench_numbers("ORIEL_SCALE_THREADS", &threads);
    s->limit_bytes = 1e6 * (double)bench_number("ORIEL_SCALE_LIMIT", 0);
}

int main(int argc, char **argv)
{
    static struct scale scale;
    if (argc > 1)
        return scale_child(argc - 1, argv + 1);
    setvbuf(stdout, NULL, _IOLBF, 0);
    read_knobs(&scale);
    office_open(&scale.office, NULL);
    snprintf(scale.maps, sizeof scale.maps, "%s/maps", scale.office.folder);
    printf("Scaling: the office, its panel of 2^6\n");
    build_maps(&scale);
    fit_searches(&scale);
    spread_out(&scale);
    squeeze(&scale);
    write_json(&scale);
    office_close(&scale.office);
    return 0;
}
