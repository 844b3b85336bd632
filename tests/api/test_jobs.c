/* Jobs through a real daemon: states, shared maps, cancelling, and refusals. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <curl/curl.h>
#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#include <oriel/job/plan.h>

#include "process/limits.h"
#include "support/daemon.h"

enum { PHOTONS = 20000, MANY_PHOTONS = 100000000 };

struct fixture {
    struct daemon daemon;
    char scene[65];
};

static int setup_with(void **state, const char *const *extra)
{
    static struct fixture fixture;
    daemon_start(&fixture.daemon, extra);
    daemon_upload_room(&fixture.daemon, fixture.scene);
    *state = &fixture;
    return 0;
}

static int setup(void **state)
{
    return setup_with(state, NULL);
}

static int setup_two_at_once(void **state)
{
    static const char *const extra[] = {"--threads", "4", "--jobs", "2", NULL};
    return setup_with(state, extra);
}

static int teardown(void **state)
{
    daemon_remove(&((struct fixture *)*state)->daemon);
    return 0;
}

static void expect_success(struct daemon *daemon, const char *path, struct reply *reply)
{
    daemon_wait(daemon, path, 120, reply);
    if (strcmp(reply_text(reply, "state"), "succeeded") != 0)
        fail_msg("%s: %s", path, reply->body);
}

/* Sums the hits over all listed maps, and counts the maps. */
static void count_maps(struct daemon *daemon, size_t *ret_maps, double *ret_hits)
{
    struct reply reply;
    daemon_get(daemon, "/v1/maps", &reply);
    *ret_maps = json_array_size(reply_at(&reply, "maps"));
    *ret_hits = 0;
    for (size_t i = 0; i < *ret_maps; i++) {
        char path[48];
        snprintf(path, sizeof path, "maps.%zu.hits", i);
        *ret_hits += reply_number(&reply, path);
    }
    reply_done(&reply);
}

/* ---- One job at a time ---------------------------------------------------------------------- */

static void check_hdr(struct daemon *daemon, const char *path)
{
    struct reply reply;
    char header[200];
    daemon_get(daemon, path, &reply);
    assert_int_equal(reply.status, 200);
    assert_int_equal(strncmp(reply.body, "#?RADIANCE\n", 11), 0);
    assert_non_null(strstr(reply.body, "VIEW="));
    assert_non_null(strstr(reply.body, "-Y 24 +X 32\n"));
    snprintf(header, sizeof header, "If-None-Match: %s", reply_header(&reply, "ETag"));
    reply_done(&reply);
    daemon_request(daemon, "GET", path, NULL, NULL, 0, header, &reply);
    assert_int_equal(reply.status, 304);
    reply_done(&reply);
}

static void check_png(struct daemon *daemon, const char *path)
{
    static const unsigned char png[] = {0x89, 'P', 'N', 'G'};
    struct reply reply;
    daemon_get(daemon, path, &reply);
    assert_int_equal(reply.status, 200);
    assert_string_equal(reply_header(&reply, "Content-Type"), "image/png");
    assert_memory_equal(reply.body, png, sizeof png);
    reply_done(&reply);
}

/* The picture and its error map. */
static void check_images(struct daemon *daemon, const char *job)
{
    static const char *const stems[] = {"a", "a.error"};
    struct reply reply;
    char path[160];
    for (int i = 0; i < 2; i++) {
        snprintf(path, sizeof path, "%s/files/%s.hdr", job, stems[i]);
        check_hdr(daemon, path);
        snprintf(path, sizeof path, "%s/files/%s.png", job, stems[i]);
        check_png(daemon, path);
    }
    snprintf(path, sizeof path, "%s/files/b.hdr", job);
    daemon_get(daemon, path, &reply);
    assert_int_equal(reply.status, 404);
    reply_done(&reply);
}

static void check_result(struct daemon *daemon, const char *job)
{
    struct reply reply;
    char path[160];
    snprintf(path, sizeof path, "%s/result", job);
    daemon_get(daemon, path, &reply);
    assert_int_equal(reply.status, 200);
    assert_string_equal(reply_text(&reply, "state"), "succeeded");
    assert_int_equal(json_array_size(reply_at(&reply, "sensors")), 2);
    const double near = reply_number(&reply, "sensors.0.illuminance_lx");
    const double far = reply_number(&reply, "sensors.1.illuminance_lx");
    assert_true(near > far && far > 10 && near < 100000);
    assert_string_equal(reply_text(&reply, "views.0.hdr"), "a.hdr");
    assert_string_equal(reply_text(&reply, "views.0.error_hdr"), "a.error.hdr");
    assert_string_equal(reply_text(&reply, "views.0.error_png"), "a.error.png");
    assert_true(reply_number(&reply, "timings_s.total") > 0);
    assert_string_equal(reply_text(&reply, "plan.technique"), "gather");
    assert_int_equal(json_array_size(reply_at(&reply, "plan.effects")), ORL_EFFECT_COUNT);
    reply_done(&reply);
}

static void test_life_of_a_job(void **state)
{
    struct fixture *f = *state;
    struct reply reply;
    char job[80];
    daemon_submit(&f->daemon, f->scene, PHOTONS, 1, "a", job);
    expect_success(&f->daemon, job, &reply);
    assert_true(reply_number(&reply, "percent") == 100);
    assert_true(reply_number(&reply, "attempts") == 1);
    assert_string_equal(reply_text(&reply, "scene"), f->scene);
    assert_true(strlen(reply_text(&reply, "finished")) > 0);
    assert_int_equal(json_array_size(reply_at(&reply, "links.files")), 6);
    assert_true(json_is_false(reply_at(&reply, "maps.0.cached")));
    assert_string_equal(reply_text(&reply, "maps.0.kind"), "global");
    assert_string_equal(reply_text(&reply, "technique"), "gather");
    reply_done(&reply);
    check_result(&f->daemon, job);
    check_images(&f->daemon, job);
}

/* A job's effect overrides and samples reach its plan; the plan selects the technique if none is
 * named. */
static void test_wishes_reach_the_plan(void **state)
{
    struct fixture *f = *state;
    struct reply reply;
    char text[512], job[80], path[96], wish[48];
    snprintf(text, sizeof text,
             "{\"scene\":\"%s\",\"effects\":{\"caustics\":\"skip\",\"sky\":\"force\"},"
             "\"pixel_samples\":2,\"gather_samples\":16,\"photons\":{\"global\":2000},"
             "\"sensors\":[[2,1,0.8,0,0,1]]}",
             f->scene);
    daemon_post_json(&f->daemon, "/v1/jobs", text, &reply);
    assert_int_equal(reply.status, 202);
    snprintf(job, sizeof job, "%s", reply_text(&reply, "links.self"));
    reply_done(&reply);
    expect_success(&f->daemon, job, &reply);
    assert_string_not_equal(reply_text(&reply, "technique"), "auto");
    reply_done(&reply);
    snprintf(path, sizeof path, "%s/result", job);
    daemon_get(&f->daemon, path, &reply);
    for (int i = 0; i < ORL_EFFECT_COUNT; i++) {
        const bool caustics = strncmp(orl_effect_name((enum orl_effect)i), "caustics_", 9) == 0;
        snprintf(wish, sizeof wish, "plan.effects.%d.wish", i);
        assert_string_equal(reply_text(&reply, wish), caustics              ? "skip"
                                                      : i == ORL_EFFECT_SKY ? "force"
                                                                            : "auto");
    }
    reply_done(&reply);
}

/* Another view, size and set of sensors reuse the maps; another seed does not. */
static void test_second_view_hits_the_maps(void **state)
{
    struct fixture *f = *state;
    struct reply reply;
    char job[80];
    size_t before, after;
    double hits_before, hits_after;
    daemon_submit(&f->daemon, f->scene, PHOTONS, 2, "a", job);
    expect_success(&f->daemon, job, &reply);
    const size_t n_maps = json_array_size(reply_at(&reply, "maps"));
    assert_true(n_maps >= 1);
    reply_done(&reply);
    count_maps(&f->daemon, &before, &hits_before);

    daemon_submit(&f->daemon, f->scene, PHOTONS, 2, "other", job);
    expect_success(&f->daemon, job, &reply);
    for (size_t i = 0; i < n_maps; i++) {
        char path[48];
        snprintf(path, sizeof path, "maps.%zu.cached", i);
        assert_true(json_is_true(reply_at(&reply, path)));
        snprintf(path, sizeof path, "maps.%zu.seconds", i);
        assert_true(reply_number(&reply, path) > 0);
    }
    reply_done(&reply);
    count_maps(&f->daemon, &after, &hits_after);
    assert_int_equal(after, before);
    assert_true(hits_after == hits_before + (double)n_maps);

    daemon_submit(&f->daemon, f->scene, PHOTONS, 3, NULL, job);
    expect_success(&f->daemon, job, &reply);
    assert_true(json_is_false(reply_at(&reply, "maps.0.cached")));
    reply_done(&reply);
    count_maps(&f->daemon, &after, &hits_after);
    assert_int_equal(after, before + n_maps);
}

static void test_cancel(void **state)
{
    struct fixture *f = *state;
    struct reply reply;
    char running[80], waiting[80], path[128];
    daemon_submit(&f->daemon, f->scene, MANY_PHOTONS, 4, NULL, running);
    daemon_submit(&f->daemon, f->scene, PHOTONS, 1, NULL, waiting);
    daemon_wait_running(&f->daemon, running, -1);

    daemon_get(&f->daemon, waiting, &reply);
    assert_string_equal(reply_text(&reply, "state"), "queued");
    assert_true(reply_number(&reply, "queue_position") == 1);
    reply_done(&reply);
    snprintf(path, sizeof path, "%s/result", running);
    daemon_get(&f->daemon, path, &reply);
    assert_int_equal(reply.status, 409);
    assert_non_null(reply_header(&reply, "Retry-After"));
    reply_done(&reply);

    daemon_cancel(&f->daemon, waiting, &reply);
    assert_int_equal(reply.status, 200);
    assert_string_equal(reply_text(&reply, "state"), "cancelled");
    reply_done(&reply);
    snprintf(path, sizeof path, "%s/cancel", running);
    daemon_request(&f->daemon, "POST", path, NULL, "", 0, NULL, &reply);
    assert_int_equal(reply.status, 202);
    assert_string_equal(reply_text(&reply, "state"), "cancelling"); /* not cancelled yet */
    assert_true(json_is_true(reply_at(&reply, "cancelling")));
    reply_done(&reply);
    daemon_wait(&f->daemon, running, 10, &reply); /* soon: within a batch of photons */
    assert_string_equal(reply_text(&reply, "state"), "cancelled");
    reply_done(&reply);
    /* A second cancellation changes nothing, and is no error. */
    daemon_cancel(&f->daemon, running, &reply);
    assert_int_equal(reply.status, 200);
    reply_done(&reply);
    daemon_expect_no_files(&f->daemon, "tmp");
}

static void test_finished_jobs_cannot_be_cancelled(void **state)
{
    struct fixture *f = *state;
    struct reply reply;
    char job[80];
    daemon_submit(&f->daemon, f->scene, PHOTONS, 1, NULL, job);
    expect_success(&f->daemon, job, &reply);
    reply_done(&reply);
    daemon_cancel(&f->daemon, job, &reply);
    assert_int_equal(reply.status, 409);
    reply_done(&reply);
}

static void test_list(void **state)
{
    struct fixture *f = *state;
    struct reply reply;
    char first[80], second[80];
    daemon_submit(&f->daemon, f->scene, PHOTONS, 1, NULL, first);
    daemon_submit(&f->daemon, f->scene, PHOTONS, 1, NULL, second);
    expect_success(&f->daemon, second, &reply);
    reply_done(&reply);
    daemon_get(&f->daemon, "/v1/jobs?limit=2", &reply);
    assert_int_equal(json_array_size(reply_at(&reply, "jobs")), 2);
    assert_string_equal(reply_text(&reply, "jobs.0.links.self"), second);
    assert_string_equal(reply_text(&reply, "jobs.1.links.self"), first);
    reply_done(&reply);
    daemon_get(&f->daemon, "/v1/jobs?state=queued", &reply);
    assert_int_equal(json_array_size(reply_at(&reply, "jobs")), 0);
    reply_done(&reply);
}

static void test_references_must_be_here(void **state)
{
    struct fixture *f = *state;
    struct reply reply;
    char text[512];
    snprintf(text, sizeof text, "{\"scene\":\"%064d\",\"sensors\":[[0,0,0,0,0,1]]}", 1);
    daemon_post_json(&f->daemon, "/v1/jobs", text, &reply);
    assert_int_equal(reply.status, 422);
    assert_string_equal(reply_text(&reply, "primitive"), "scene");
    reply_done(&reply);
    snprintf(text, sizeof text, "{\"scene\":\"%s\",\"sensors\":{\"file\":\"none.txt\"}}", f->scene);
    daemon_post_json(&f->daemon, "/v1/jobs", text, &reply);
    assert_int_equal(reply.status, 422);
    assert_string_equal(reply_text(&reply, "primitive"), "sensors.file");
    reply_done(&reply);
    snprintf(text, sizeof text,
             "{\"scene\":\"%s\",\"views\":[{\"name\":\"../a\",\"view\":\"-vtv\",\"width\":4,"
             "\"height\":4}]}",
             f->scene);
    daemon_post_json(&f->daemon, "/v1/jobs", text, &reply);
    assert_int_equal(reply.status, 422);
    reply_done(&reply);
    snprintf(text, sizeof text,
             "{\"scene\":\"%s\",\"views\":[{\"name\":\"a\",\"view\":\"-vtq\",\"width\":4,"
             "\"height\":4}]}",
             f->scene);
    daemon_post_json(&f->daemon, "/v1/jobs", text, &reply);
    assert_in_range(reply.status, 400, 422);
    reply_done(&reply);
}

/* An hour without measurements, found only by the run: the job fails, and the error names the
 * place. */
/* A job's document is what the client sent, blanks and the order of members included. */
static void test_document_is_kept(void **state)
{
    struct fixture *f = *state;
    struct reply reply;
    char text[300], path[96];
    snprintf(text, sizeof text,
             "{ \"sensors\" : [[2, 1, 0.80, 0, 0, 1]],\n\t\"gather_samples\":16, \"technique\": "
             "\"backward\",  \"scene\": \"%s\"}\n",
             f->scene);
    daemon_post_json(&f->daemon, "/v1/jobs", text, &reply);
    assert_int_equal(reply.status, 202);
    snprintf(path, sizeof path, "%.80s/document", reply_text(&reply, "links.self"));
    reply_done(&reply);
    daemon_get(&f->daemon, path, &reply);
    assert_int_equal(reply.status, 200);
    assert_string_equal(reply_header(&reply, "Content-Type"), "application/json");
    assert_int_equal(reply.size, strlen(text));
    assert_memory_equal(reply.body, text, reply.size);
    reply_done(&reply);
}

static void test_failure_is_told(void **state)
{
    struct fixture *f = *state;
    struct reply reply;
    char text[512], job[80], path[128];
    const char gap[] = "place here\nlatitude 47\nlongitude -8\ntime_zone -15\nsite_elevation 4\n"
                       "weather_data_file_units 1\n3 21 11.5 9999 9999\n";
    const struct upload_file files[] = {{"room.rad", room_scene, strlen(room_scene), false},
                                        {"w.wea", gap, strlen(gap), true}};
    daemon_upload(&f->daemon, files, 2, NULL, &reply);
    assert_int_equal(reply.status, 201);
    snprintf(text, sizeof text,
             "{\"scene\":\"%s\",\"sensors\":[[1,1,1,0,0,1]],\"sky\":{\"weather\":{\"file\":"
             "\"w.wea\",\"month\":3,\"day\":21,\"hour\":11.5}}}",
             reply_text(&reply, "id"));
    reply_done(&reply);
    daemon_post_json(&f->daemon, "/v1/jobs", text, &reply);
    assert_int_equal(reply.status, 202);
    snprintf(job, sizeof job, "%s", reply_text(&reply, "links.self"));
    reply_done(&reply);
    daemon_wait(&f->daemon, job, 60, &reply);
    assert_string_equal(reply_text(&reply, "state"), "failed");
    assert_string_equal(reply_text(&reply, "error.file"), "w.wea");
    assert_true(reply_number(&reply, "error.line") == 7);
    reply_done(&reply);
    snprintf(path, sizeof path, "%s/result", job);
    daemon_get(&f->daemon, path, &reply);
    assert_int_equal(reply.status, 409);
    assert_non_null(strstr(reply_text(&reply, "detail"), "in its document"));
    reply_done(&reply);
}

/* Pages through all jobs, each once, with the largest page size; returns their number. */
static size_t count_by_pages(struct daemon *daemon)
{
    char path[120] = "/v1/jobs?limit=1000", last[40] = "";
    size_t count = 0;
    for (bool more = true; more;) {
        struct reply reply;
        daemon_get(daemon, path, &reply);
        assert_int_equal(reply.status, 200);
        const json_t *jobs = reply_at(&reply, "jobs");
        const size_t here = json_array_size(jobs);
        assert_in_range(here, 1, 200);
        count += here;
        more = json_is_true(reply_at(&reply, "more"));
        const char *id = json_string_value(json_object_get(json_array_get(jobs, here - 1), "id"));
        assert_non_null(id);
        assert_string_not_equal(id, last);
        snprintf(last, sizeof last, "%s", id ? id : "");
        snprintf(path, sizeof path, "/v1/jobs?limit=1000&before=%s", last);
        reply_done(&reply);
    }
    return count;
}

/* Several clients at once: one sync serves all that arrive meanwhile. */
static void submit_many(const struct fixture *f, unsigned count)
{
    enum { CLIENTS = 8 };
    pid_t clients[CLIENTS];
    for (unsigned i = 0; i < CLIENTS; i++) {
        clients[i] = fork();
        assert_true(clients[i] >= 0);
        if (clients[i] == 0) {
            struct daemon own = f->daemon;
            char job[80];
            own.curl = curl_easy_init(); /* a separate connection */
            for (unsigned k = i; k < count; k += CLIENTS)
                daemon_submit(&own, f->scene, PHOTONS, 1, NULL, job);
            _exit(0);
        }
    }
    for (unsigned i = 0; i < CLIENTS; i++) {
        int status;
        assert_int_equal(waitpid(clients[i], &status, 0), clients[i]);
        assert_int_equal(status, 0);
    }
}

/* The queue is limited; a refused job is not stored. */
static void test_full_queue(void **state)
{
    struct fixture *f = *state;
    struct reply reply;
    char blocker[80], job[80];
    daemon_submit(&f->daemon, f->scene, MANY_PHOTONS, 7, NULL, blocker);
    daemon_wait_running(&f->daemon, blocker, -1);
    submit_many(f, ORL_SERVER_QUEUE - 1);
    daemon_submit(&f->daemon, f->scene, PHOTONS, 1, NULL, job);
    daemon_get(&f->daemon, "/readyz", &reply);
    assert_int_equal(reply.status, 503);
    reply_done(&reply);
    daemon_request(&f->daemon, "POST", "/v1/jobs", "application/json", "{\"a\":", 5,
                   "Idempotency-Key: new", &reply);
    assert_int_equal(reply.status, 400);
    reply_done(&reply);
    daemon_post_json(&f->daemon, "/v1/jobs", "{}", &reply);
    assert_int_equal(reply.status, 429);
    assert_non_null(reply_header(&reply, "Retry-After"));
    reply_done(&reply);
    daemon_cancel(&f->daemon, job, &reply);
    assert_int_equal(reply.status, 200);
    reply_done(&reply);
    daemon_get(&f->daemon, "/readyz", &reply);
    assert_int_equal(reply.status, 200);
    reply_done(&reply);
    assert_true(count_by_pages(&f->daemon) > ORL_SERVER_QUEUE);
}

/* ---- Two jobs at once ----------------------------------------------------------------------- */

static void test_two_jobs_build_one_map(void **state)
{
    struct fixture *f = *state;
    struct reply reply;
    char jobs[2][80];
    size_t maps;
    double hits;
    int cached = 0;
    for (int i = 0; i < 2; i++)
        daemon_submit(&f->daemon, f->scene, 20 * PHOTONS, 5, i ? "a" : NULL, jobs[i]);
    for (int i = 0; i < 2; i++) {
        expect_success(&f->daemon, jobs[i], &reply);
        cached += json_is_true(reply_at(&reply, "maps.0.cached"));
        reply_done(&reply);
    }
    assert_int_equal(cached, 1);
    count_maps(&f->daemon, &maps, &hits);
    assert_true(maps >= 1 && maps <= 2);
    assert_true(hits == (double)maps);
}

/* The building job is cancelled while the other waits for it: the other builds. */
static void test_waiting_job_takes_over(void **state)
{
    struct fixture *f = *state;
    struct reply reply;
    char builder[80], waiter[80];
    daemon_submit(&f->daemon, f->scene, MANY_PHOTONS, 6, NULL, builder);
    daemon_wait_running(&f->daemon, builder, 0);
    daemon_submit(&f->daemon, f->scene, MANY_PHOTONS, 6, "a", waiter);
    daemon_wait_running(&f->daemon, waiter, -1);
    daemon_cancel(&f->daemon, builder, &reply);
    reply_done(&reply);
    daemon_wait(&f->daemon, builder, 10, &reply);
    assert_string_equal(reply_text(&reply, "state"), "cancelled");
    reply_done(&reply);
    daemon_wait_running(&f->daemon, waiter, 0);
    daemon_cancel(&f->daemon, waiter, &reply);
    reply_done(&reply);
    daemon_wait(&f->daemon, waiter, 10, &reply);
    assert_string_equal(reply_text(&reply, "state"), "cancelled");
    reply_done(&reply);
}

static int run_single(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_life_of_a_job),
        cmocka_unit_test(test_wishes_reach_the_plan),
        cmocka_unit_test(test_second_view_hits_the_maps),
        cmocka_unit_test(test_cancel),
        cmocka_unit_test(test_finished_jobs_cannot_be_cancelled),
        cmocka_unit_test(test_list),
        cmocka_unit_test(test_references_must_be_here),
        cmocka_unit_test(test_document_is_kept),
        cmocka_unit_test(test_failure_is_told),
        cmocka_unit_test(test_full_queue), /* last, since it leaves the queue full */
    };
    return cmocka_run_group_tests(tests, setup, teardown);
}

int main(void)
{
    const struct CMUnitTest pairs[] = {
        cmocka_unit_test(test_two_jobs_build_one_map),
        cmocka_unit_test(test_waiting_job_takes_over),
    };
    const int failed = run_single();
    return failed + cmocka_run_group_tests(pairs, setup_two_at_once, teardown);
}
