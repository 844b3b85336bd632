/* Metrics, and the log in both its forms. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "support/daemon.h"

/* Returns the value of a sample by its name and labels, as written; NaN if absent. */
static double sample(const char *text, const char *name)
{
    const size_t length = strlen(name);
    for (const char *line = text; line && *line;) {
        if (strncmp(line, name, length) == 0 && line[length] == ' ')
            return strtod(line + length, NULL);
        line = strchr(line, '\n');
        line = line ? line + 1 : NULL;
    }
    return (double)NAN;
}

static char *fetch(struct daemon *daemon)
{
    struct reply reply;
    daemon_get(daemon, "/metrics", &reply);
    assert_int_equal(reply.status, 200);
    assert_string_equal(reply_header(&reply, "Content-Type"),
                        "text/plain; version=0.0.4; charset=utf-8");
    char *text = strdup(reply.body);
    assert_non_null(text);
    reply_done(&reply);
    return text;
}

static bool is_name(const char *text, size_t length)
{
    static const char first[] = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ_:";
    return length > 0 && strchr(first, *text) &&
           strspn(text, "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ_:0123456789") >=
               length;
}

/* Skips {name="value",...} and returns the position after it. Values here hold no quotes or
 * backslashes. */
static const char *skip_labels(const char *text)
{
    if (*text++ != '{')
        return NULL;
    for (;;) {
        const size_t name = strcspn(text, "=");
        if (!is_name(text, name) || strncmp(text + name, "=\"", 2) != 0)
            return NULL;
        text = strchr(text + name + 2, '"');
        if (!text || (text[1] != ',' && text[1] != '}'))
            return NULL;
        text += 2;
        if (text[-1] == '}')
            return text;
    }
}

/* Checks the exposition format, line by line; samples belong to the family of the last TYPE. */
static void check_line(const char *line, char family[128], char type[16])
{
    if (strncmp(line, "# HELP ", 7) == 0)
        return;
    if (sscanf(line, "# TYPE %127s %15s", family, type) == 2) {
        if (strcmp(type, "gauge") && strcmp(type, "counter") && strcmp(type, "histogram"))
            fail_msg("%s", line);
        return;
    }
    const size_t name = strcspn(line, "{ ");
    const char *rest = line[name] == '{' ? skip_labels(line + name) : line + name;
    char *end = NULL;
    if (!is_name(line, name) || strncmp(line, family, strlen(family)) != 0 || !rest || *rest != ' ')
        fail_msg("%s (in %s)", line, family);
    strtod(rest + 1, &end);
    if (end == rest + 1 || *end)
        fail_msg("%s", line);
    if (strcmp(type, "counter") == 0 && !strstr(family, "_total"))
        fail_msg("%s is a counter without _total", family);
}

static void test_format(void **state)
{
    struct daemon_room *room = *state;
    char family[128] = "?", type[16] = "", *save = NULL, *text = fetch(&room->daemon);
    assert_int_equal(text[strlen(text) - 1], '\n');
    for (char *line = strtok_r(text, "\n", &save); line; line = strtok_r(NULL, "\n", &save))
        check_line(line, family, type);
    free(text);
}

static void run_job(struct daemon_room *room, int seed, const char *view)
{
    char job[80];
    struct reply reply;
    daemon_submit(&room->daemon, room->scene, 20000, seed, view, job);
    daemon_wait(&room->daemon, job, 60, &reply);
    assert_string_equal(reply_text(&reply, "state"), "succeeded");
    reply_done(&reply);
}

static void test_jobs_are_counted(void **state)
{
    struct daemon_room *room = *state;
    run_job(room, 1, NULL);
    char *text = fetch(&room->daemon);
    assert_true(sample(text, "oriel_job_runs_total{state=\"succeeded\"}") == 1);
    assert_true(sample(text, "oriel_jobs{state=\"succeeded\"}") == 1);
    assert_true(sample(text, "oriel_queue_depth") == 0);
    assert_true(sample(text, "oriel_photons_total") > 10000);
    assert_true(sample(text, "oriel_rays_total") > 10000);
    assert_true(sample(text, "oriel_cache_misses_total") >= 1);
    assert_true(sample(text, "oriel_cache_hits_total") == 0);
    assert_true(sample(text, "oriel_cache_bytes") > 0);
    assert_true(sample(text, "oriel_stage_seconds_count{stage=\"photons\"}") == 1);
    assert_true(sample(text, "oriel_stage_seconds_bucket{stage=\"photons\",le=\"+Inf\"}") == 1);
    assert_true(sample(text, "oriel_stage_seconds_sum{stage=\"photons\"}") > 0);
    assert_true(sample(text, "oriel_health_total{what=\"non_finite\"}") == 0);
    free(text);
    run_job(room, 1, NULL);
    text = fetch(&room->daemon);
    assert_true(sample(text, "oriel_job_runs_total{state=\"succeeded\"}") == 2);
    assert_true(sample(text, "oriel_cache_hits_total") >= 1);
    free(text);
}

static double metric(struct daemon *daemon, const char *name)
{
    char *text = fetch(daemon);
    const double value = sample(text, name);
    free(text);
    return value;
}

/* Metrics include the memory cache, and omit it if it is off. */
static void test_shelf_is_told(void **state)
{
    static const char *const none[] = {"--shelf", "0", NULL};
    struct daemon_room *room = *state;
    struct reply reply;
    assert_int_equal(daemon_end(&room->daemon, SIGTERM), 0);
    daemon_restart(&room->daemon, NULL);
    assert_true(metric(&room->daemon, "oriel_shelf_bytes") == 0);
    assert_true(metric(&room->daemon, "oriel_shelf_items") == 0);
    run_job(room, 2, "first");
    assert_true(metric(&room->daemon, "oriel_shelf_bytes") > 0);
    assert_true(metric(&room->daemon, "oriel_shelf_items") >= 1);
    assert_true(metric(&room->daemon, "oriel_shelf_hits_total") == 0);
    assert_true(metric(&room->daemon, "oriel_shelf_scenes") == 1);
    run_job(room, 2, "second");
    assert_true(metric(&room->daemon, "oriel_shelf_hits_total") >= 1);
    assert_true(metric(&room->daemon, "oriel_shelf_scenes") == 1);
    assert_true(metric(&room->daemon, "oriel_shelf_scene_hits_total") == 1);
    assert_int_equal(daemon_end(&room->daemon, SIGTERM), 0);
    daemon_restart(&room->daemon, none);
    run_job(room, 2, "third");
    assert_true(metric(&room->daemon, "oriel_shelf_bytes") == 0);
    assert_true(metric(&room->daemon, "oriel_shelf_items") == 0);
    daemon_get(&room->daemon, "/v1/limits", &reply);
    assert_true(reply_number(&reply, "shelf_bytes") == 0);
    reply_done(&reply);
    assert_int_equal(daemon_end(&room->daemon, SIGTERM), 0);
    daemon_restart(&room->daemon, NULL);
}

/* Buckets are cumulative, and the last equals the count. */
static void test_requests_are_counted(void **state)
{
    enum { HEALTHS = 7 };
    static const char *const bounds[] = {"0.0005", "0.001", "0.002", "0.005", "0.01",
                                         "0.02",   "0.05",  "0.1",   "0.25",  "0.5",
                                         "1",      "5",     "30",    "300",   "+Inf"};
    struct daemon_room *room = *state;
    struct reply reply;
    double before = 0;
    for (int i = 0; i < HEALTHS; i++) {
        daemon_get(&room->daemon, "/healthz", &reply);
        assert_non_null(reply_header(&reply, "X-Request-Id"));
        reply_done(&reply);
    }
    daemon_get(&room->daemon, "/nowhere", &reply);
    reply_done(&reply);
    daemon_get(&room->daemon, "/v1/scenes/0123", &reply);
    reply_done(&reply);
    char *text = fetch(&room->daemon);
    for (size_t i = 0; i < sizeof bounds / sizeof *bounds; i++) {
        char name[160];
        snprintf(name, sizeof name,
                 "oriel_http_request_seconds_bucket{method=\"GET\",route=\"/healthz\","
                 "class=\"2xx\",le=\"%s\"}",
                 bounds[i]);
        assert_true(sample(text, name) >= before);
        before = sample(text, name);
    }
    assert_true(before == HEALTHS);
    assert_true(sample(text, "oriel_http_request_seconds_count{method=\"GET\",route=\"/healthz\","
                             "class=\"2xx\"}") == HEALTHS);
    assert_true(sample(text, "oriel_http_request_seconds_count{method=\"\",route=\"\","
                             "class=\"4xx\"}") == 1);
    assert_true(sample(text, "oriel_http_request_seconds_count{method=\"GET\","
                             "route=\"/v1/scenes/{}\",class=\"4xx\"}") == 1);
    assert_true(sample(text, "oriel_http_connections") >= 1);
    assert_true(sample(text, "process_resident_memory_bytes") > 1e6);
    free(text);
}

static FILE *open_log(const struct daemon *daemon)
{
    char path[96];
    snprintf(path, sizeof path, "%s.log", daemon->root);
    FILE *log = fopen(path, "r");
    assert_non_null(log);
    return log;
}

/* No line can move a terminal's cursor: it has neither control characters (C1 included, as a byte
 * or in UTF-8) nor characters that change the direction of text. */
static void check_text(const char *line)
{
    for (const unsigned char *at = (const unsigned char *)line; *at; at++) {
        if (*at < 0x20 && *at != '\n')
            fail_msg("a control character: %s", line);
        if (*at == 0x7f || (*at >= 0x80 && *at < 0xa0 && at[-1] < 0xc3) || *at == 0xed ||
            *at == 0xc0 || (*at == 0xe2 && at[1] == 0x80 && at[2] == 0xae))
            fail_msg("a control character, or no UTF-8: %s", line);
    }
}

/* Every event is a line of pairs; a submission has job and request in one line. */
static void test_log_of_pairs(void **state)
{
    struct daemon_room *room = *state;
    struct reply reply;
    char line[4096], method[16], job[64];
    bool submitted = false, forged = false;
    static const char *const paths[] = {
        "/v1/jobs/b%C3%BCro",    "/v1/scenes/%0Atime=x%20level=error",
        "/v1/scenes/%9b31m",     "/v1/scenes/%c2%9b31m",
        "/v1/scenes/%1b[31m%7f", "/v1/x%e2%80%ae",
        "/v1/scenes/%ed%a0%80",  "/healthz"};
    bool legible = false;
    for (size_t i = 0; i < sizeof paths / sizeof *paths; i++) {
        daemon_get(&room->daemon, paths[i], &reply);
        reply_done(&reply);
    }
    FILE *log = open_log(&room->daemon);
    while (fgets(line, sizeof line, log)) {
        assert_int_equal(strncmp(line, "time=20", 7), 0);
        assert_non_null(strstr(line, " level="));
        assert_non_null(strstr(line, " event="));
        forged |= strncmp(line, "time=x", 6) == 0;
        check_text(line);
        legible |= strstr(line, "/v1/jobs/b\xc3\xbcro") != NULL;
        const char *request = strstr(line, " event=request ");
        if (request &&
            sscanf(request, " event=request id=%*d job=%63s token=- method=%15s", job, method) == 2)
            submitted |= strcmp(method, "POST") == 0 && strlen(job) == 32;
    }
    fclose(log);
    assert_true(submitted);
    assert_true(legible);
    assert_false(forged);
}

/* The line of a request in the log has the id that its answer has. */
static void test_request_id_is_logged(void **state)
{
    struct daemon_room *room = *state;
    struct reply reply;
    char line[4096], wanted[96];
    bool found = false;
    daemon_get(&room->daemon, "/v1/scenes/request-id", &reply);
    snprintf(wanted, sizeof wanted, " event=request id=%.40s ",
             reply_header(&reply, "X-Request-Id"));
    reply_done(&reply);
    assert_int_equal(daemon_end(&room->daemon, SIGTERM), 0);
    FILE *log = open_log(&room->daemon);
    while (fgets(line, sizeof line, log))
        if (strstr(line, "/v1/scenes/request-id")) {
            found = true;
            assert_non_null(strstr(line, wanted));
        }
    fclose(log);
    assert_true(found);
    daemon_restart(&room->daemon, NULL);
}

static void test_log_of_objects(void **state)
{
    struct daemon_room *room = *state;
    struct reply reply;
    const char *const extra[] = {"--log-format", "json", NULL};
    char line[4096];
    size_t requests = 0;
    assert_int_equal(daemon_end(&room->daemon, SIGTERM), 0);
    daemon_restart(&room->daemon, extra);
    daemon_get(&room->daemon, "/v1/scenes/%ff%fe%22%5c%0a%9b%c2%9b", &reply);
    reply_done(&reply);
    daemon_get(&room->daemon, "/v1/jobs/b%C3%BCro", &reply);
    reply_done(&reply);
    assert_int_equal(daemon_end(&room->daemon, SIGTERM), 0);
    FILE *log = open_log(&room->daemon);
    while (fgets(line, sizeof line, log)) {
        if (line[0] != '{')
            continue; /* of the earlier daemon */
        json_t *doc = json_loads(line, 0, NULL);
        if (!doc)
            fail_msg("no JSON: %s", line);
        check_text(line);
        assert_true(json_is_string(json_object_get(doc, "time")));
        assert_true(json_is_string(json_object_get(doc, "level")));
        if (strcmp(json_string_value(json_object_get(doc, "event")), "request") == 0) {
            assert_true(json_is_integer(json_object_get(doc, "id")));
            assert_true(json_is_number(json_object_get(doc, "ms")));
            requests++;
        }
        json_decref(doc);
    }
    fclose(log);
    assert_int_equal(requests, 2);
    daemon_restart(&room->daemon, NULL);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_format),
        cmocka_unit_test(test_jobs_are_counted),
        cmocka_unit_test(test_requests_are_counted),
        cmocka_unit_test(test_log_of_pairs),
        cmocka_unit_test(test_request_id_is_logged),
        cmocka_unit_test(test_log_of_objects),
        cmocka_unit_test(test_shelf_is_told),
        cmocka_unit_test(test_format),
    };
    return cmocka_run_group_tests(tests, daemon_room_set_up, daemon_room_tear_down);
}
