/*
 * Annual glare at viewpoints in the office: DGP of every lit hour and its cost, compared with
 * pictures of some hours by view jobs.
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "bench/annual.h"

enum { VIEWPOINTS = 2 };
/* One viewpoint at the desk, looking half way to the window; one in the middle, looking at it. */
static char desk[] = "desk", middle[] = "middle";
static struct orl_viewpoint viewpoints[VIEWPOINTS] = {{desk, {1.3, 2, 1.2}, {1, -1, 0}},
                                                      {middle, {1.3, 2.5, 1.2}, {0, -1, 0}}};

struct dgp_errors {
    double rms, worst, worst_dgp, stated;
    size_t n, covered;
};

/* ---- Pictures -------------------------------------------------------------------------------- */

struct picture {
    double dgp, low, high;
};

static bool render_picture(struct annual_bench *bench, const struct orl_annual_step *step,
                           const struct orl_viewpoint *viewpoint, uint32_t side, uint32_t samples,
                           struct picture *ret)
{
    static char name[] = "eye";
    char text[256];
    struct orl_view_request view = {
        .name = name, .view = text, .width = side, .height = side, .metrics = 1U << ORL_GLARE_DGP};
    struct orl_result result;
    struct orl_job job;
    uint32_t wider;
    annual_job(bench, step, &job);
    snprintf(text, sizeof text, "-vta -vp %.9g %.9g %.9g -vd %.9g %.9g %.9g -vh 180 -vv 180",
             viewpoint->at.x, viewpoint->at.y, viewpoint->at.z, viewpoint->towards.x,
             viewpoint->towards.y, viewpoint->towards.z);
    job.pixel_samples = samples;
    job.seed = 2000 + step->column;
    job.views = &view;
    job.n_views = 1;
    annual_run_job(bench, &job, &result);
    const struct orl_glare *glare = result.views[0].glare;
    const struct orl_glare_value *dgp = &glare->values[ORL_GLARE_DGP];
    const bool blurred = orl_glare_is_blurred(glare, side, &wider);
    *ret = (struct picture){dgp->value, dgp->interval_95[0], dgp->interval_95[1]};
    orl_result_done(&result);
    return blurred;
}

/* Renders a picture; where its pixels blur the sun, once more with a quarter of their width. */
static void take_picture(struct annual_bench *bench, const struct orl_annual_step *step,
                         const struct orl_viewpoint *viewpoint, struct picture *ret)
{
    const uint32_t side = (uint32_t)bench_number("ORIEL_ANNUAL_EYE_SIDE", 400);
    const uint32_t samples = (uint32_t)bench_number("ORIEL_ANNUAL_EYE_SAMPLES", 32);
    if (render_picture(bench, step, viewpoint, side, samples, ret))
        render_picture(bench, step, viewpoint, 4 * side, samples / 8 > 2 ? samples / 8 : 2, ret);
}

static bool read_pictures(const char *path, struct picture *pictures, size_t n)
{
    FILE *file = fopen(path, "r");
    size_t i = 0;
    while (file && i < n &&
           fscanf(file, "%lf %lf %lf", &pictures[i].dgp, &pictures[i].low, &pictures[i].high) == 3)
        i++;
    if (file)
        fclose(file);
    return i == n;
}

static void keep_pictures(const char *path, const struct picture *pictures, size_t n)
{
    char part[BENCH_PATH + 8];
    snprintf(part, sizeof part, "%s.part", path);
    FILE *file = fopen(part, "w");
    if (!file)
        bench_fail("DGP of pictures cannot be kept", NULL);
    for (size_t i = 0; i < n; i++)
        fprintf(file, "%.6f %.6f %.6f\n", pictures[i].dgp, pictures[i].low, pictures[i].high);
    if (fclose(file) != 0 || rename(part, path) != 0)
        bench_fail("DGP of pictures cannot be kept", NULL);
}

/* Reads the pictures of the hours from the build folder, or renders and stores them. */
static struct picture *need_pictures(struct annual_bench *bench,
                                     const struct orl_annual_result *year,
                                     const struct annual_truth *hours, int viewpoint)
{
    struct picture *pictures = calloc(hours->n_hours + 1, sizeof *pictures);
    char name[128], path[BENCH_PATH], weather[ANNUAL_WORD];
    if (!pictures)
        bench_fail("out of memory", NULL);
    annual_name_weather(bench, weather);
    snprintf(name, sizeof name, "annual-eye-%d-%d-%s-%zu-%llu-%llu.txt", (int)bench->scene,
             viewpoint, weather, hours->n_hours,
             (unsigned long long)bench_number("ORIEL_ANNUAL_EYE_SIDE", 400),
             (unsigned long long)bench_number("ORIEL_ANNUAL_EYE_SAMPLES", 32));
    bench_kept(name, path);
    if (read_pictures(path, pictures, hours->n_hours))
        return pictures;
    fprintf(stderr, "  %zu pictures of a seat are computed, once\n", hours->n_hours);
    for (size_t i = 0; i < hours->n_hours; i++)
        take_picture(bench, &year->steps[hours->steps[i]], &viewpoints[viewpoint], &pictures[i]);
    keep_pictures(path, pictures, hours->n_hours);
    return pictures;
}

/* ---- The year -------------------------------------------------------------------------------- */

static double run_viewpoint(struct annual_bench *bench, const struct orl_annual_result *year,
                            int viewpoint, struct orl_viewpoint_hours **ret_hours)
{
    const struct orl_viewpoint_request viewpoint_request = {&viewpoints[viewpoint], 1};
    struct orl_folder_store folder;
    struct orl_error err = {0};
    unsigned char *wanted = malloc(year->n_columns + 1);
    if (!wanted)
        bench_fail("out of memory", NULL);
    memset(wanted, 1, year->n_columns);
    snprintf(folder.folder, sizeof folder.folder, "%s", bench->office.folder);
    const struct orl_map_store store = orl_map_store_in_folder(&folder);
    const struct orl_run_env run = annual_run_env(bench, &store);
    const struct orl_annual_request request = annual_request(bench, year->samples, NULL, 0);
    const double started = bench_own_s(NULL);
    if (orl_annual_glare_compute(&viewpoint_request, &request, year, wanted, &run, ret_hours,
                                 &err) < 0)
        bench_fail("glare of a seat", &err);
    free(wanted);
    return bench_own_s(NULL) - started;
}

static void tell_pictures(const struct annual_bench *bench, const struct orl_viewpoint *viewpoint,
                          const struct annual_truth *hours, const struct picture *pictures)
{
    double *dgp = calloc(hours->n_hours + 1, sizeof *dgp);
    if (!dgp)
        bench_fail("out of memory", NULL);
    for (size_t i = 0; i < hours->n_hours; i++)
        dgp[i] = pictures[i].dgp;
    annual_write_viewpoint(bench, viewpoint, hours, dgp);
    free(dgp);
}

static struct dgp_errors compare_dgp(const struct orl_annual_result *year,
                                     const struct annual_truth *hours,
                                     const struct picture *pictures,
                                     const struct orl_viewpoint_hours *viewpoint)
{
    struct dgp_errors e = {.n = hours->n_hours};
    for (size_t i = 0; i < hours->n_hours; i++) {
        const struct orl_annual_step *step = &year->steps[hours->steps[i]];
        const double dgp = (double)viewpoint->dgp[step->column], off = dgp - pictures[i].dgp;
        e.rms += off * off / (double)e.n;
        e.stated = fmax(e.stated, (pictures[i].high - pictures[i].low) / 2);
        e.covered += (double)viewpoint->low[step->column] <= pictures[i].high &&
                     pictures[i].low <= (double)viewpoint->high[step->column];
        if (fabs(off) > e.worst) {
            e.worst = fabs(off);
            e.worst_dgp = pictures[i].dgp;
        }
        if (getenv("ORIEL_ANNUAL_LIST"))
            printf("  %2d/%2d %4.1f h: %.4f [%.4f, %.4f] %6.0f lx, picture %.4f [%.4f, %.4f]\n",
                   step->month, step->day, step->hour, dgp, (double)viewpoint->low[step->column],
                   (double)viewpoint->high[step->column], (double)viewpoint->eye_lx[step->column],
                   pictures[i].dgp, pictures[i].low, pictures[i].high);
    }
    e.rms = sqrt(e.rms);
    return e;
}

void annual_print_glare(struct annual_bench *bench, FILE *json, bool *first, const char *title,
                        double rate, const struct orl_annual_result *year)
{
    struct annual_truth hours = {.n_hours = 0};
    annual_choose_hours(&hours, year, (size_t)bench_number("ORIEL_ANNUAL_EYE_HOURS", 24));
    printf("DGP of a seat, %zu lit hours, %s; target: 60 s, rms 0.01, none off by 0.05\n",
           year->n_columns, title);
    printf("    seat  seconds ray-times      rms    worst (of a DGP)  pictures'   overlap\n");
    for (int i = 0; i < VIEWPOINTS; i++) {
        struct orl_viewpoint_hours *found = NULL;
        const double seconds = run_viewpoint(bench, year, i, &found);
        struct picture *pictures = need_pictures(bench, year, &hours, i);
        const struct dgp_errors e = compare_dgp(year, &hours, pictures, found);
        printf("%8s %8.2f %9.1f %8.4f %8.4f %10.3f +- %8.4f %3zu of %zu\n", viewpoints[i].name,
               seconds, seconds * rate / 1e6, e.rms, e.worst, e.worst_dgp, e.stated, e.covered,
               e.n);
        fprintf(json,
                "%s\n    {\"scene\": \"%s\", \"seat\": \"%s\", \"hours\": %zu, \"seconds\": %.3f, "
                "\"ray_times_m\": %.2f, \"rms_dgp\": %.5f, \"worst_dgp\": %.5f, \"pictures\": %zu}",
                *first ? "" : ",", title, viewpoints[i].name, year->n_columns, seconds,
                seconds * rate / 1e6, e.rms, e.worst, e.n);
        *first = false;
        tell_pictures(bench, &viewpoints[i], &hours, pictures);
        free(pictures);
        orl_viewpoint_hours_free(found, 1);
    }
    free(hours.steps);
}
