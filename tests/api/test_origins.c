/* Web pages with access to the daemon: its own, those of --allow-origin, and no others. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>

#include "handlers/handlers.h"
#include "support/daemon.h"
#include "support/http_wire.h"

/* A daemon without tokens that allows two origins; %s below is the daemon's port. */
static const char *const let_in[] = {"--allow-origin",
                                     "https://tool.example",
                                     "--allow-origin",
                                     "http://localhost:3000",
                                     "--allow-origin=http://[::1]:3000",
                                     NULL};

struct fixture {
    struct daemon closed, open, tokens;
    char token[128]; /* header line with a token of scope submit */
};

static void make_token(const struct daemon *daemon, char ret_line[128])
{
    char command[300], said[128] = "";
    const char *build = getenv("ORIEL_BUILD");
    snprintf(command, sizeof command, "%s/orield token add page --scope submit --data %s",
             build ? build : "build", daemon->root);
    FILE *pipe = popen(command, "r");
    assert_non_null(pipe);
    assert_non_null(fgets(said, sizeof said, pipe));
    assert_int_equal(pclose(pipe), 0);
    said[strcspn(said, "\n")] = '\0';
    snprintf(ret_line, 128, "Authorization: Bearer %.90s\r\n", said);
}

static int setup(void **state)
{
    static struct fixture f;
    const char *const guarded[] = {"--tokens", "always", "--allow-origin", "https://tool.example",
                                   NULL};
    daemon_start(&f.closed, NULL);
    daemon_start(&f.open, let_in);
    daemon_start(&f.tokens, NULL);
    make_token(&f.tokens, f.token);
    assert_int_equal(daemon_end(&f.tokens, SIGTERM), 0);
    daemon_restart(&f.tokens, guarded);
    *state = &f;
    return 0;
}

static int teardown(void **state)
{
    struct fixture *f = *state;
    daemon_remove(&f->closed);
    daemon_remove(&f->open);
    daemon_remove(&f->tokens);
    return 0;
}

static const char *port_of(const struct daemon *daemon)
{
    return strrchr(daemon->url, ':') + 1;
}

/* Sends a request with those headers; every $ is replaced by the daemon's port. */
static void send_request(const struct daemon *daemon, const char *line, const char *pattern,
                         const char *body, struct reply *ret_reply)
{
    char headers[1200];
    size_t at = 0;
    for (; *pattern && at + 8 < sizeof headers; pattern++)
        if (*pattern == '$')
            at += (size_t)snprintf(headers + at, sizeof headers - at, "%s", port_of(daemon));
        else
            headers[at++] = *pattern;
    headers[at] = '\0';
    http_wire_ask(daemon, line, headers, body, ret_reply);
}

static void expect(const struct daemon *daemon, const char *line, const char *headers,
                   const char *body, long status)
{
    struct reply reply;
    send_request(daemon, line, headers, body, &reply);
    if (reply.status != status)
        fail_msg("%s, %s: %ld: %s", line, headers, reply.status, reply.body);
    if (status == 403)
        assert_string_equal(reply_text(&reply, "type"), "urn:oriel:error:forbidden");
    reply_done(&reply);
}

#define OWN "Host: 127.0.0.1:$\r\n"

/* A page on another port of this machine is another origin: it may neither read nor write. */
static void test_another_loopback_port(void **state)
{
    struct fixture *f = *state;
    static const char *const others[] = {
        "Origin: http://localhost:3000\r\n",
        "Origin: http://127.0.0.1:3000\r\n",
        "Origin: http://[::1]:3000\r\n",
        "Origin: http://127.0.0.2:$\r\n",
        "Origin: http://localhost:$\r\n", /* another name, so an origin different from Host */
        "Origin: http://127.0.0.1\r\n",
        "Origin: https://127.0.0.1:$\r\n",
        "Origin: http://127.0.0.1:$0\r\n",
        "Origin: http://127.0.0.1:$/\r\n",
        "Origin: http://127.0.0.1.:$\r\n",
        "Origin: http://127.0.0.1:$@evil.example\r\n",
        "Origin: null\r\n",
        "Origin:\r\n",
        "Origin: http://tool.example\r\n",
        "Origin: file://\r\n",
    };
    for (size_t i = 0; i < sizeof others / sizeof *others; i++) {
        char headers[256];
        snprintf(headers, sizeof headers, OWN "%s", others[i]);
        expect(&f->closed, "GET /v1/jobs", headers, NULL, 403);
        expect(&f->closed, "POST /v1/jobs/0123/cancel", headers, "", 403);
        expect(&f->closed, "POST /v1/bsdfs", headers, "<x/>", 403);
        expect(&f->closed, "DELETE /v1/jobs/0123", headers, NULL, 403);
    }
    expect(&f->closed, "GET /v1/jobs", OWN "Origin: http://127.0.0.1:$\r\n", NULL, 200);
    expect(&f->closed, "GET /v1/jobs", "Host: localhost:$\r\nOrigin: http://localhost:$\r\n", NULL,
           200);
    expect(&f->closed, "GET /v1/jobs", "Host: [::1]:$\r\nOrigin: http://[::1]:$\r\n", NULL, 200);
    expect(&f->closed, "GET /v1/jobs", OWN, NULL, 200);
}

/* DNS rebinding: the attacker's name points to this machine, so Host and Origin agree, and are both
 * the attacker's. */
static void test_rebinding(void **state)
{
    struct fixture *f = *state;
    static const char *const hosts[] = {"evil.example:$",
                                        "localhost.evil.example:$",
                                        "127.0.0.1.evil.example:$",
                                        "localhost.:$",
                                        "127.0.0.1.:$",
                                        "0.0.0.0:$",
                                        "tool.example"};
    for (size_t i = 0; i < sizeof hosts / sizeof *hosts; i++) {
        char headers[256];
        snprintf(headers, sizeof headers, "Host: %s\r\nOrigin: http://%s\r\n", hosts[i], hosts[i]);
        expect(&f->closed, "GET /v1/jobs", headers, NULL, 403);
        expect(&f->open, "GET /v1/jobs", headers, NULL, 403);
        snprintf(headers, sizeof headers, "Host: %s\r\nOrigin: https://tool.example\r\n", hosts[i]);
        expect(&f->open, "GET /v1/jobs", headers, NULL, 403);
        snprintf(headers, sizeof headers, "Host: %s\r\n", hosts[i]);
        expect(&f->closed, "GET /v1/jobs", headers, NULL, 403);
    }
}

/* Asserts the CORS headers of the answer: the allowed origin, and the readable headers. */
static void assert_open_to(const struct reply *reply, const char *origin)
{
    const char *vary = reply_header(reply, "Vary");
    assert_non_null(vary);
    assert_string_equal(vary, "Origin");
    const char *allowed = reply_header(reply, "Access-Control-Allow-Origin");
    if (!origin) {
        assert_null(allowed);
        assert_null(reply_header(reply, "Access-Control-Expose-Headers"));
        return;
    }
    assert_non_null(allowed);
    assert_string_equal(allowed, origin);
    static const char *const exposed[] = {"ETag", "Location", "X-Request-Id", "Retry-After",
                                          "Link"};
    for (size_t i = 0; i < sizeof exposed / sizeof *exposed; i++)
        assert_non_null(strstr(reply_header(reply, "Access-Control-Expose-Headers"), exposed[i]));
    assert_null(reply_header(reply, "Access-Control-Allow-Credentials"));
}

static void test_let_in(void **state)
{
    struct fixture *f = *state;
    static const char *const origins[] = {"https://tool.example", "http://localhost:3000",
                                          "http://[::1]:3000"};
    struct reply reply;
    for (size_t i = 0; i < sizeof origins / sizeof *origins; i++) {
        static const struct {
            const char *line, *more, *body;
            long status;
        } asks[] = {{"GET /v1/jobs", "", NULL, 200},
                    {"GET /v1/jobs", "Sec-Fetch-Site: cross-site\r\n", NULL, 200},
                    {"GET /v1/jobs/0123", "", NULL, 404},
                    {"PUT /v1/jobs", "", "", 405},
                    {"OPTIONS /v1/jobs", "", NULL, 405}, /* has no Access-Control-Request-Method */
                    {"POST /v1/jobs", "Content-Type: application/json\r\n", "{}", 422}};
        for (size_t k = 0; k < sizeof asks / sizeof *asks; k++) {
            char headers[300];
            snprintf(headers, sizeof headers, OWN "Origin: %s\r\n%s", origins[i], asks[k].more);
            send_request(&f->open, asks[k].line, headers, asks[k].body, &reply);
            if (reply.status != asks[k].status)
                fail_msg("%s from %s: %ld", asks[k].line, origins[i], reply.status);
            assert_open_to(&reply, origins[i]);
            reply_done(&reply);
        }
    }
    /* Answers to programs, and to the daemon's own pages, have Vary: Origin. */
    send_request(&f->open, "GET /v1/jobs", OWN, NULL, &reply);
    assert_int_equal(reply.status, 200);
    assert_open_to(&reply, NULL);
    reply_done(&reply);
    send_request(&f->closed, "GET /v1/jobs", OWN, NULL, &reply);
    assert_null(reply_header(&reply, "Vary"));
    reply_done(&reply);
}

/* Origins match exactly: no prefix, other case, scheme, port or dot, no list, no second header. */
static void test_kept_out(void **state)
{
    struct fixture *f = *state;
    static const char *const others[] = {
        "Origin: http://tool.example\r\n",
        "Origin: https://tool.example:443\r\n",
        "Origin: https://tool.example:8443\r\n",
        "Origin: https://tool.example.\r\n",
        "Origin: https://tool.example/\r\n",
        "Origin: https://TOOL.example\r\n",
        "Origin: HTTPS://tool.example\r\n",
        "Origin: https://a.tool.example\r\n",
        "Origin: https://tool.example.evil\r\n",
        "Origin: https://tool.exampl\r\n",
        "Origin: https://eviltool.example\r\n",
        "Origin: https://x@tool.example\r\n",
        "Origin: https://localhost:3000\r\n",
        "Origin: http://localhost:3001\r\n",
        "Origin: http://localhost\r\n",
        "Origin: http://127.0.0.1:3000\r\n",
        "Origin: http://localhost.:3000\r\n",
        "Origin: null\r\n",
        "Origin: *\r\n",
        "Origin: https://tool.example https://evil.example\r\n",
        /* A picture or script of an unknown page. */
        "Sec-Fetch-Site: cross-site\r\n",
        "Sec-Fetch-Site: same-site\r\n",
        "Origin: https://tool.example\r\nX-Forwarded-For: 192.0.2.60\r\n",
    };
    struct reply reply;
    for (size_t i = 0; i < sizeof others / sizeof *others; i++) {
        char headers[300];
        snprintf(headers, sizeof headers, OWN "%s", others[i]);
        expect(&f->open, "GET /v1/jobs", headers, NULL, 403);
        expect(&f->open, "POST /v1/bsdfs", headers, "<x/>", 403);
        snprintf(headers, sizeof headers, OWN "%sAccess-Control-Request-Method: GET\r\n",
                 others[i]);
        send_request(&f->open, "OPTIONS /v1/jobs", headers, NULL, &reply);
        assert_int_equal(reply.status, 403);
        assert_null(reply_header(&reply, "Access-Control-Allow-Methods"));
        if (!strstr(others[i], "tool.example\r\nX-"))
            assert_null(reply_header(&reply, "Access-Control-Allow-Origin"));
        reply_done(&reply);
    }
}

/* A browser's preflight request for every route. */
static void test_preflight(void **state)
{
    struct fixture *f = *state;
    const struct daemon *const daemons[] = {&f->open, &f->tokens}; /* the preflight has no token */
    struct reply reply;
    for (size_t i = 0; i < orl_routes.count; i++)
        for (size_t d = 0; d < 2; d++) {
            char line[200] = "OPTIONS ", headers[300];
            size_t at = strlen(line);
            for (const char *c = orl_routes.table[i].path; *c; c++)
                if (*c == '{')
                    line[at++] = '0';
                else if (*c != '}' && *c != '*')
                    line[at++] = *c;
            line[at] = '\0';
            snprintf(headers, sizeof headers,
                     OWN "Origin: https://tool.example\r\nAccess-Control-Request-Method: %s\r\n"
                         "Access-Control-Request-Headers: authorization\r\n",
                     orl_routes.table[i].method);
            send_request(daemons[d], line, headers, NULL, &reply);
            if (reply.status != 204)
                fail_msg("%s: %ld", line, reply.status);
            assert_open_to(&reply, "https://tool.example");
            assert_non_null(strstr(reply_header(&reply, "Access-Control-Allow-Methods"),
                                   orl_routes.table[i].method));
            assert_non_null(
                strstr(reply_header(&reply, "Access-Control-Allow-Headers"), "Authorization"));
            assert_null(reply_header(&reply, "Access-Control-Allow-Private-Network"));
            reply_done(&reply);
        }
    send_request(&f->open, "OPTIONS /v1/jobs",
                 OWN "Origin: https://tool.example\r\nAccess-Control-Request-Method: POST\r\n"
                     "Access-Control-Request-Private-Network: true\r\n",
                 NULL, &reply);
    assert_string_equal(reply_header(&reply, "Access-Control-Allow-Private-Network"), "true");
    reply_done(&reply);
    expect(&f->open, "OPTIONS /nowhere",
           OWN "Origin: https://tool.example\r\nAccess-Control-Request-Method: GET\r\n", NULL, 404);
    expect(&f->closed, "OPTIONS /v1/jobs",
           OWN "Origin: https://tool.example\r\nAccess-Control-Request-Method: GET\r\n", NULL, 403);
    expect(&f->closed, "OPTIONS /v1/jobs", OWN "Access-Control-Request-Method: GET\r\n", NULL, 405);
}

/* With tokens any Host is accepted, but a page's origin is checked all the same. */
static void test_with_tokens(void **state)
{
    struct fixture *f = *state;
    static const struct {
        const char *headers;
        long status;
    } cases[] = {
        {"Host: oriel.example\r\n", 200},
        {"Host: oriel.example\r\nOrigin: https://tool.example\r\n", 200},
        {"Host: oriel.example\r\nOrigin: https://oriel.example\r\n", 200}, /* behind a proxy */
        {"Host: oriel.example\r\nOrigin: http://oriel.example\r\n", 200},
        {"Host: oriel.example\r\nOrigin: http://oriel.example\r\nX-Forwarded-Proto: https\r\n",
         403},
        {"Host: oriel.example\r\nOrigin: https://oriel.example\r\nX-Forwarded-Proto: https\r\n",
         200},
        {"Host: oriel.example\r\nOrigin: https://evil.example\r\n", 403},
        {"Host: oriel.example\r\nOrigin: null\r\n", 403},
        {"Host: oriel.example:1\r\nOrigin: https://oriel.example\r\n", 403},
        {"Host: oriel.example\r\nOrigin: https://oriel.example.\r\n", 403},
        {"Host: oriel.example\r\nSec-Fetch-Site: cross-site\r\n", 200}, /* a link followed */
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char headers[400];
        snprintf(headers, sizeof headers, "%s%s", cases[i].headers, f->token);
        expect(&f->tokens, "GET /v1/jobs", headers, NULL, cases[i].status);
    }
    struct reply reply;
    send_request(&f->tokens, "GET /v1/jobs", OWN "Origin: https://tool.example\r\n", NULL, &reply);
    assert_int_equal(reply.status, 401); /* the page can read that answer */
    assert_open_to(&reply, "https://tool.example");
    reply_done(&reply);
}

/* An origin that no browser sends is refused at start as a mistake. */
static void test_command_line(void **state)
{
    static const char *const wrong[] = {"*",
                                        "null",
                                        "tool.example",
                                        "https://",
                                        "https://*",
                                        "ftp://x",
                                        "https://tool.example/",
                                        "https://Tool.example",
                                        "https://a:443",
                                        "http://a:80",
                                        "https://a:0",
                                        "https://a:65536",
                                        "https://a:",
                                        "https://a b",
                                        "https://u@a",
                                        "https://.a",
                                        "http://[::1",
                                        "http://[0:0:0:0:0:0:0:1]",
                                        "https://a?b",
                                        ""};
    const char *build = getenv("ORIEL_BUILD");
    char command[400];
    (void)state;
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        snprintf(command, sizeof command,
                 "timeout 120 %s/orield --port 0 --data /nowhere --allow-origin '%s' 2>&1 | "
                 "grep -q 'not the origin of a web page'",
                 build ? build : "build", wrong[i]);
        if (system(command) != 0)
            fail_msg("--allow-origin '%s' is taken", wrong[i]);
    }
    char many[900];
    size_t at =
        (size_t)snprintf(many, sizeof many, "timeout 120 %s/orield --port 0 --data /nowhere",
                         build ? build : "build");
    for (int i = 0; i < 17; i++)
        at += (size_t)snprintf(many + at, sizeof many - at, " --allow-origin http://a");
    snprintf(many + at, sizeof many - at, " 2>&1 | grep -q 'may be given at most 16 times'");
    assert_int_equal(system(many), 0);
}

/*
 * Another page's link to the dashboard opens the page, as if typed. Other requests are refused:
 * other paths, methods, frames or scripts, a foreign Host.
 */
static void test_followed_link(void **state)
{
    struct fixture *f = *state;
#define GOES "Sec-Fetch-Mode: navigate\r\nSec-Fetch-Dest: document\r\n"
#define HTML "Accept: text/html,*/*;q=0.8\r\n"
#define CROSS "Sec-Fetch-Site: cross-site\r\n"
    static const struct {
        const char *line, *headers;
        long status;
    } cases[] = {
        {"GET /", OWN CROSS GOES HTML, 200},
        {"GET /", OWN "Sec-Fetch-Site: same-site\r\n" GOES HTML, 200},
        {"GET /?from=mail", OWN CROSS GOES HTML, 200},
        {"GET /", OWN CROSS GOES "Accept: application/json\r\n", 403},
        {"GET /", OWN CROSS GOES, 403},
        {"GET /", OWN CROSS HTML, 403},
        {"GET /", OWN CROSS HTML "Sec-Fetch-Mode: navigate\r\n", 403},
        {"GET /", OWN CROSS HTML "Sec-Fetch-Mode: navigate\r\nSec-Fetch-Dest: iframe\r\n", 403},
        {"GET /", OWN CROSS HTML "Sec-Fetch-Mode: no-cors\r\nSec-Fetch-Dest: document\r\n", 403},
        {"GET /", OWN CROSS HTML "Sec-Fetch-Mode: cors\r\nSec-Fetch-Dest: empty\r\n", 403},
        {"GET /", OWN CROSS GOES HTML "Origin: https://evil.example\r\n", 403},
        {"GET /", OWN CROSS GOES HTML "Origin: null\r\n", 403},
        {"GET /", OWN CROSS GOES HTML "X-Forwarded-For: 192.0.2.60\r\n", 403},
        {"GET /", "Host: evil.example\r\n" CROSS GOES HTML, 403},
        {"GET /v1/jobs", OWN CROSS GOES HTML, 403},
        {"GET /healthz", OWN CROSS GOES HTML, 403},
        {"GET /openapi.yaml", OWN CROSS GOES HTML, 403},
        {"POST /", OWN CROSS GOES HTML, 403},
        {"POST /v1/bsdfs", OWN CROSS GOES HTML, 403},
    };
    const struct daemon *const daemons[] = {&f->closed, &f->open};
    for (size_t d = 0; d < 2; d++)
        for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
            expect(daemons[d], cases[i].line, cases[i].headers, NULL, cases[i].status);
    struct reply reply;
    send_request(&f->closed, "GET /", OWN CROSS GOES HTML, NULL, &reply);
    assert_non_null(strstr(reply_header(&reply, "Content-Type"), "text/html"));
    assert_non_null(
        strstr(reply_header(&reply, "Content-Security-Policy"), "frame-ancestors 'none'"));
    assert_string_equal(reply_header(&reply, "Cross-Origin-Opener-Policy"), "same-origin");
    reply_done(&reply);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_another_loopback_port),
        cmocka_unit_test(test_rebinding),
        cmocka_unit_test(test_let_in),
        cmocka_unit_test(test_kept_out),
        cmocka_unit_test(test_preflight),
        cmocka_unit_test(test_with_tokens),
        cmocka_unit_test(test_followed_link),
        cmocka_unit_test(test_command_line),
    };
    return cmocka_run_group_tests(tests, setup, teardown);
}
