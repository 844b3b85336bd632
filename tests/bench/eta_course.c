/*
 * Predicted remaining time and fraction of one job over its own processor time, shared by its
 * threads. Other work on the machine has no influence.
 *
 * Usage: eta_course FOLDER [THREADS [curve]], where the job is in FOLDER/job.json. Prints a line
 * for each report, "report seconds stage stage_fraction fraction left_s"; a line for each poll,
 * twenty times a second, "poll seconds fraction eta_s"; and finally "end seconds". With curve it
 * first prints the plan's cost of accuracies, "curve seconds error".
 */
#include <jansson.h>
#include <stdio.h>
#include <stdlib.h>

#include <oriel/base/eta.h>
#include <oriel/job/skies.h>

#include "bench/bench.h"
#include "job/job_request_json.h"

struct course {
    double started_s, polled_s, fraction;
    uint32_t threads;
    struct orl_eta eta;
};

static double own_s(void *ctx)
{
    const struct course *course = ctx;
    return bench_cpu_s(NULL) / course->threads;
}

/* Prints the polls that are due before the next report. */
static void poll_until(struct course *course, double now)
{
    const double every_s = 0.05;
    for (; course->polled_s < now; course->polled_s += every_s)
        printf("poll %.4f %.6f %.5f\n", course->polled_s - course->started_s, course->fraction,
               orl_eta_s(&course->eta, course->polled_s));
}

static void on_progress(void *ctx, enum orl_stage stage, double stage_fraction, double job_fraction,
                        double left_s)
{
    struct course *course = ctx;
    const double now = own_s(course);
    poll_until(course, now);
    orl_eta_update(&course->eta, left_s, now);
    course->fraction = job_fraction;
    printf("report %.4f %s %.5f %.6f %.5f\n", now - course->started_s, orl_stage_name(stage),
           stage_fraction, job_fraction, left_s);
}

static int on_sky_done(void *ctx, size_t index, const struct orl_result *result,
                       struct orl_error *err)
{
    (void)ctx, (void)index, (void)result, (void)err;
    return 0;
}

static struct orl_job_request read_job_request(const char *folder)
{
    char path[BENCH_PATH];
    struct orl_error err = {0};
    struct orl_job_request job_request;
    snprintf(path, sizeof path, "%s/job.json", folder);
    json_t *doc = json_load_file(path, 0, NULL);
    if (!doc || orl_job_request_from_json(doc, ORL_JOB_LOCAL, &job_request, NULL, &err) < 0)
        bench_fail(path, &err);
    json_decref(doc);
    return job_request;
}

static int tell_curve(void *ctx, const char *sky, const struct orl_result *planned,
                      const struct orl_accuracy_curve *curve, struct orl_error *err)
{
    struct course *course = ctx;
    (void)sky, (void)planned, (void)err;
    for (uint32_t i = 0; curve && i < curve->n_points; i++)
        printf("curve %.4f %.5f\n", curve->points[i].seconds, curve->points[i].error);
    course->started_s = course->polled_s = own_s(course);
    course->eta = (struct orl_eta){0};
    return 0;
}

int main(int argc, char **argv)
{
    const long threads = argc > 2 ? strtol(argv[2], NULL, 10) : 1;
    if (argc < 2 || threads < 1)
        return 2;
    struct orl_job_request job_request = read_job_request(argv[1]);
    struct course course = {.threads = (uint32_t)threads};
    course.started_s = course.polled_s = own_s(&course);
    struct orl_folder_store maps;
    struct orl_result result = {0};
    struct orl_error err = {0};
    atomic_bool cancel = false;
    char output[BENCH_PATH];
    bench_make_folder(output);
    snprintf(maps.folder, sizeof maps.folder, "%s", output);
    const struct orl_map_store store = orl_map_store_in_folder(&maps);
    const struct orl_files files = orl_files_from_folder(argv[1]);
    const struct orl_skies_env skies = {.done = on_sky_done};
    const struct orl_run_env env = {.pool = orl_thread_pool_start(course.threads),
                                    .files = &files,
                                    .store = &store,
                                    .output_folder = output,
                                    .cancel = &cancel,
                                    .now_s = own_s,
                                    .progress = on_progress,
                                    .ctx = &course};
    const struct orl_job *job = &job_request.of.render;
    struct orl_run_env quiet = env;
    quiet.progress = NULL;
    if (argc > 3 && orl_plan_skies(job, &quiet, 1, tell_curve, &course, &err) < 0)
        bench_fail("the plan", &err);
    const int code = job->n_skies > 0 ? orl_run_skies(job, &env, &skies, &err)
                                      : orl_run(job, &env, &result, &err);
    if (code < 0)
        bench_fail("the job", &err);
    const double ended = own_s(&course);
    poll_until(&course, ended);
    printf("end %.4f\n", ended - course.started_s);
    if (result.outcome.asked)
        fprintf(stderr, "%s\n", result.outcome.why);
    orl_result_done(&result);
    orl_thread_pool_stop(env.pool);
    orl_job_request_done(&job_request);
    bench_remove_folder(output);
    return 0;
}
