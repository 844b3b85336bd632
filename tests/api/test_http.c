/* The daemon's HTTP interface: routes, refusals, the contract, start and stop. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <ctype.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#include "handlers/handlers.h"
#include "support/daemon.h"

static void test_service_routes(void **state)
{
    static const struct {
        const char *path, *member;
    } routes[] = {
        {"/", "service"},        {"/healthz", "status"}, {"/readyz", "status"},
        {"/v1/limits", "views"}, {"/v1/jobs", "jobs"},   {"/v1/maps", "maps"},
    };
    for (size_t i = 0; i < sizeof routes / sizeof *routes; i++) {
        struct reply reply;
        daemon_get(*state, routes[i].path, &reply);
        assert_int_equal(reply.status, 200);
        assert_string_equal(reply_header(&reply, "Content-Type"), "application/json");
        assert_non_null(reply_at(&reply, routes[i].member));
        reply_done(&reply);
        daemon_request(*state, "HEAD", routes[i].path, NULL, NULL, 0, NULL, &reply);
        assert_int_equal(reply.status, 200);
        assert_int_equal(reply.size, 0);
        reply_done(&reply);
    }
}

/* Every refusal is a problem document whose status equals the HTTP status. */
static const struct {
    const char *method, *path, *type, *body;
    long status;
    const char *problem, *allow;
} refusals[] = {
    {"GET", "/nowhere", NULL, NULL, 404, "no-such-resource", NULL},
    {"GET", "/v1/jobs/", NULL, NULL, 404, "no-such-resource", NULL},
    {"GET", "/v1/jobs/0123", NULL, NULL, 404, "no-such-resource", NULL},
    {"DELETE", "/v1/jobs/0123", NULL, NULL, 404, "no-such-resource", NULL},
    {"GET", "/v1/jobs/0123/result", NULL, NULL, 404, "no-such-resource", NULL},
    {"GET", "/v1/jobs/0123/files/a.hdr", NULL, NULL, 404, "no-such-resource", NULL},
    {"GET", "/v1/jobs/0123/files", NULL, NULL, 404, "no-such-resource", NULL},
    {"GET", "/v1/jobs/0123/files/", NULL, NULL, 404, "no-such-resource", NULL},
    {"GET", "/results/", NULL, NULL, 404, "no-such-resource", NULL},
    {"GET", "/v1/../oriel.db", NULL, NULL, 404, "no-such-resource", NULL},
    {"GET", "/v1/jobs/0123/files/..%2Foriel.db", NULL, NULL, 404, "no-such-resource", NULL},
    {"GET", "/v1/scenes/0123", NULL, NULL, 404, "no-such-resource", NULL},
    {"GET", "/v1/bsdfs/%00%ff'; DROP TABLE jobs", NULL, NULL, 404, "no-such-resource", NULL},
    {"PUT", "/v1/jobs", "application/json", "{}", 405, "method-not-allowed", "POST, GET, HEAD"},
    {"DELETE", "/healthz", NULL, NULL, 405, "method-not-allowed", "GET, HEAD"},
    {"DELETE", "/v1/scenes", NULL, NULL, 405, "method-not-allowed", "POST, GET, HEAD"},
    {"BREW", "/v1/maps", NULL, NULL, 405, "method-not-allowed", "GET, HEAD"},
    {"POST", "/v1/jobs", "text/plain", "{}", 415, "unsupported-media-type", NULL},
    {"POST", "/v1/jobs", NULL, "{}", 415, "unsupported-media-type", NULL},
    {"POST", "/v1/scenes", "application/xml", "<a/>", 415, "unsupported-media-type", NULL},
    {"POST", "/v1/scenes", "application/jsonx", "{}", 415, "unsupported-media-type", NULL},
    {"POST", "/v1/jobs", "application/json", "{\"scene\":\n}", 400, "syntax", NULL},
    {"POST", "/v1/jobs", "application/json", "", 400, "syntax", NULL},
    {"POST", "/v1/jobs", "application/json", "{\"scene\":1,\"scene\":1}", 400, "syntax", NULL},
    {"POST", "/v1/jobs", "application/json; charset=utf-8", "{}", 422, "invalid", NULL},
    {"POST", "/v1/scenes", "multipart/form-data", "x", 400, "syntax", NULL},
    {"GET", "/v1/jobs?limit=0", NULL, NULL, 400, "invalid", NULL},
    {"GET", "/v1/jobs?limit=x", NULL, NULL, 400, "invalid", NULL},
    {"GET", "/v1/jobs?state=lost", NULL, NULL, 400, "invalid", NULL},
    {"GET", "/v1/jobs?before=0123", NULL, NULL, 400, "invalid", NULL},
};

static void test_refusals(void **state)
{
    for (size_t i = 0; i < sizeof refusals / sizeof *refusals; i++) {
        char type[80], path[160];
        struct reply reply;
        /* libcurl does not escape characters that are invalid in a URL. */
        snprintf(path, sizeof path, "%s", refusals[i].path);
        for (char *c = path; *c; c++)
            if (*c == ' ')
                *c = '+';
        daemon_request(*state, refusals[i].method, path, refusals[i].type, refusals[i].body,
                       refusals[i].body ? strlen(refusals[i].body) : 0, NULL, &reply);
        snprintf(type, sizeof type, "urn:oriel:error:%s", refusals[i].problem);
        if (reply.status != refusals[i].status || strcmp(reply_text(&reply, "type"), type) != 0)
            fail_msg("%s %s: %ld %s", refusals[i].method, refusals[i].path, reply.status,
                     reply.body);
        assert_string_equal(reply_header(&reply, "Content-Type"), "application/problem+json");
        assert_true(reply_number(&reply, "status") == (double)refusals[i].status);
        assert_true(strlen(reply_text(&reply, "title")) > 0);
        if (refusals[i].allow)
            assert_string_equal(reply_header(&reply, "Allow"), refusals[i].allow);
        reply_done(&reply);
    }
}

/* Requests of web pages are refused, those of programs are served. */
static void test_guard(void **state)
{
    const struct daemon *daemon = *state;
    char own_origin[96];
    snprintf(own_origin, sizeof own_origin, "Origin: %s", daemon->url);
    const struct {
        const char *header;
        long status;
    } cases[] = {
        {"Host: localhost:9000", 200},
        {"Host: 127.0.0.1", 200},
        {"Host: [::1]:8423", 200},
        {"Host: LOCALHOST", 200},
        {"Host: evil.example", 403},
        {"Host: 127.0.0.1.evil.example:80", 403},
        {"Host: localhost.evil:80", 403},
        {"Host: [::2]:80", 403},
        {"Host: [::1", 403},
        {"Host: 127.0.0.1:80x", 403},
        {"Host: 10.0.0.1", 403},
        {"Origin: http://evil.example", 403},
        {"Origin: null", 403},
        {"Origin: https://localhost", 403},
        {"Origin: http://localhost:3", 403},
        {"Origin: http://127.0.0.1", 403},
        {own_origin, 200},
        {"Sec-Fetch-Site: same-origin", 200},
        {"Sec-Fetch-Site: none", 200},
        {"Sec-Fetch-Site: same-site", 403},
        {"Sec-Fetch-Site: cross-site", 403},
        {"Forwarded: for=192.0.2.60", 403},
        {"X-Forwarded-For: 192.0.2.60", 403},
        {"Via: 1.1 proxy", 403},
        {"Origin: http://127.0.0.1@evil.example", 403},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        struct reply reply;
        daemon_request(*state, "GET", "/healthz", NULL, NULL, 0, cases[i].header, &reply);
        if (reply.status != cases[i].status)
            fail_msg("%s: %ld", cases[i].header, reply.status);
        reply_done(&reply);
    }
}

static void test_json_mistake_has_its_line(void **state)
{
    struct reply reply;
    daemon_post_json(*state, "/v1/jobs", "{\"seed\": 1,\n\"scene\": }", &reply);
    assert_int_equal(reply.status, 400);
    assert_true(reply_number(&reply, "line") == 2);
    reply_done(&reply);
    daemon_post_json(*state, "/v1/jobs", "{\"photons\": {\"globl\": 1}, \"scene\": \"x\"}", &reply);
    assert_int_equal(reply.status, 422);
    reply_done(&reply);
}

/* A body too large is refused by its length before it is sent; without a length it is read and then
 * refused. */
static void test_too_large(void **state)
{
    static const char zeros[8000];
    struct reply reply;
    daemon_request(*state, "POST", "/v1/jobs", "application/json", "{}", 2,
                   "Content-Length: 99999999999", &reply);
    assert_int_equal(reply.status, 413);
    assert_string_equal(reply_text(&reply, "type"), "urn:oriel:error:limit");
    reply_done(&reply);
    daemon_request(*state, "POST", "/v1/jobs/0/cancel", NULL, zeros, sizeof zeros,
                   "Transfer-Encoding: chunked", &reply);
    assert_int_equal(reply.status, 413);
    reply_done(&reply);
}

/* A client that sends its body without asking gets the refusal, not a broken connection. */
static void test_refused_with_its_body(void **state)
{
    enum { BYTES = 20 << 20 };
    char *zeros = calloc(1, BYTES);
    struct reply reply;
    assert_non_null(zeros);
    daemon_request(*state, "POST", "/v1/scenes", "application/xml", zeros, BYTES,
                   "Expect:", &reply);
    assert_int_equal(reply.status, 415);
    assert_string_equal(reply_text(&reply, "type"), "urn:oriel:error:unsupported-media-type");
    reply_done(&reply);
    daemon_request(*state, "PUT", "/nowhere", NULL, zeros, BYTES, "Expect:", &reply);
    assert_int_equal(reply.status, 404);
    reply_done(&reply);
    free(zeros);
}

/* Returns the methods that a path of the contract allows, by the daemon's 405. */
static void ask_allow(struct daemon *daemon, const char *line, char ret_allow[64])
{
    char path[128];
    struct reply reply;
    snprintf(path, sizeof path, "%.*s", (int)strlen(line) - 3, line + 2);
    for (char *brace; (brace = strchr(path, '{'));) {
        char *end = strchr(brace, '}');
        assert_non_null(end);
        *brace = 'x';
        memmove(brace + 1, end + 1, strlen(end));
    }
    daemon_request(daemon, "BREW", path, NULL, NULL, 0, NULL, &reply);
    if (reply.status != 405)
        fail_msg("the contract names %s, which the daemon does not know", path);
    snprintf(ret_allow, 64, "%s", reply_header(&reply, "Allow"));
    reply_done(&reply);
}

/* Every operation of the contract is served, and the daemon has equally many routes. */
static void test_contract_matches(void **state)
{
    static const char *const methods[] = {"get", "post", "delete", "put", "patch"};
    struct reply contract;
    char allow[64] = "", *save = NULL;
    size_t operations = 0;
    daemon_get(*state, "/openapi.yaml", &contract);
    assert_int_equal(contract.status, 200);
    assert_int_equal(strncmp(contract.body, "openapi: 3.1", 12), 0);
    for (char *line = strtok_r(contract.body, "\n", &save); line;
         line = strtok_r(NULL, "\n", &save)) {
        if (strncmp(line, "  /", 3) == 0)
            ask_allow(*state, line, allow);
        for (size_t i = 0; i < sizeof methods / sizeof *methods; i++) {
            char key[16], verb[16] = "";
            snprintf(key, sizeof key, "    %s:", methods[i]);
            if (strcmp(line, key) != 0)
                continue;
            for (size_t k = 0; methods[i][k]; k++)
                verb[k] = (char)toupper((unsigned char)methods[i][k]);
            if (!strstr(allow, verb))
                fail_msg("the contract's %s is not among '%s'", verb, allow);
            operations++;
        }
    }
    assert_int_equal(operations, orl_routes.count);
    reply_done(&contract);
}

static void test_one_daemon_per_folder(void **state)
{
    struct daemon *daemon = *state;
    char command[400];
    const char *build = getenv("ORIEL_BUILD");
    snprintf(command, sizeof command,
             "%s/orield --port 0 --data %s 2>&1 | grep -q 'another daemon'",
             build ? build : "build", daemon->root);
    assert_int_equal(system(command), 0);
}

static int run_orield(const char *arguments)
{
    char command[400];
    const char *build = getenv("ORIEL_BUILD");
    snprintf(command, sizeof command, "%s/orield %s >/dev/null 2>&1", build ? build : "build",
             arguments);
    const int status = system(command);
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

static void test_command_line(void **state)
{
    (void)state;
    assert_int_equal(run_orield("--help"), 0);
    assert_int_equal(run_orield("--version"), 0);
    static const char *const wrong[] = {
        "--listen 0.0.0.0:1",
        "--listen 192.168.1.2:80",
        "--listen [::]:1",
        "--listen nonsense",
        "--port 70000",
        "--port -1",
        "--threads 0",
        "--threads x",
        "--threads",
        "--what 1",
        "--jobs 0",
        "--log-level loud",
        "--listen 127.0.0.1:1x",
        "--listen example.org:80",
    };
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++)
        if (run_orield(wrong[i]) != 2)
            fail_msg("orield %s did not end with status 2", wrong[i]);
}

/* Limits of a daemon without options, as the guide and api/openapi state them. */
static void test_documented_limits(void **state)
{
    static const struct {
        const char *name;
        double value;
    } limits[] = {
        {"session_s", 12 * 3600},
        {"link_s", 3600},
        {"idempotency_key_s", 86400},
        {"unfetched_results_s", 600},
        {"shelf_bytes", 256 << 20},
        {"address_connections", 128},
        {"body_bytes_per_s", 1024},
        {"links", 100},
        {"study_runs", 500},
        {"accuracy_samples", 1 << 20},
        {"priority", 9},
        {"heat_maps", 16},
        {"photons", 1e8},
        {"sensors", 4e6},
        {"skies", 1024},
        {"views", 1024},
        {"grids", 4096},
        {"image_side", 16384},
    };
    struct reply reply;
    daemon_get(*state, "/v1/limits", &reply);
    assert_int_equal(reply.status, 200);
    for (size_t i = 0; i < sizeof limits / sizeof *limits; i++)
        if (reply_number(&reply, limits[i].name) != limits[i].value)
            fail_msg("%s is %g, not %g", limits[i].name, reply_number(&reply, limits[i].name),
                     limits[i].value);
    reply_done(&reply);
}

static void test_stops_cleanly(void **state)
{
    struct daemon *daemon = *state;
    assert_int_equal(daemon_end(daemon, SIGTERM), 0);
    daemon_restart(daemon, NULL);
    assert_int_equal(daemon_end(daemon, SIGINT), 0);
    daemon_restart(daemon, NULL);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_service_routes),
        cmocka_unit_test(test_refusals),
        cmocka_unit_test(test_guard),
        cmocka_unit_test(test_json_mistake_has_its_line),
        cmocka_unit_test(test_too_large),
        cmocka_unit_test(test_refused_with_its_body),
        cmocka_unit_test(test_contract_matches),
        cmocka_unit_test(test_one_daemon_per_folder),
        cmocka_unit_test(test_command_line),
        cmocka_unit_test(test_documented_limits),
        cmocka_unit_test(test_stops_cleanly),
    };
    return cmocka_run_group_tests(tests, daemon_set_up, daemon_tear_down);
}
