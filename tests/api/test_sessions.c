/* Browser sessions by cookies, signed links, and attacks on both. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <poll.h>
#include <signal.h>
#include <sodium.h>
#include <sqlite3.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include "support/certificate.h"
#include "support/daemon.h"
#include "support/http_wire.h"

/* A daemon that requires tokens on loopback, with a job that has succeeded. */
struct fixture {
    struct daemon daemon;
    char scene[65], job[80];     /* job: its path */
    char submit[160], read[160]; /* lines: Authorization */
    char host[80], own[200];     /* lines: Host; Host and Origin */
};

static const char *const with_tokens[] = {"--tokens", "always", NULL};

static void say(const struct daemon *daemon, const char *arguments, char *ret_said, size_t size)
{
    char command[300];
    const char *build = getenv("ORIEL_BUILD");
    snprintf(command, sizeof command, "%s/orield token %s --data %s", build ? build : "build",
             arguments, daemon->root);
    FILE *pipe = popen(command, "r");
    assert_non_null(pipe);
    const size_t n = fread(ret_said, 1, size - 1, pipe);
    ret_said[n] = '\0';
    assert_int_equal(pclose(pipe), 0);
    ret_said[strcspn(ret_said, "\n")] = '\0';
}

static void make_token(const struct daemon *daemon, const char *name, const char *scope,
                       char ret_line[160])
{
    char arguments[100], said[128];
    snprintf(arguments, sizeof arguments, "add %s --scope %s", name, scope);
    say(daemon, arguments, said, sizeof said);
    snprintf(ret_line, 160, "Authorization: Bearer %s\r\n", said);
}

static void name_host(struct fixture *f)
{
    snprintf(f->host, sizeof f->host, "Host: %s\r\n", f->daemon.url + strlen("http://"));
    snprintf(f->own, sizeof f->own, "%sOrigin: %s\r\n", f->host, f->daemon.url);
}

/* Runs SQL on the database, while the daemon runs or not. */
static void change(struct fixture *f, const char *sql)
{
    char path[100];
    sqlite3 *db = NULL;
    snprintf(path, sizeof path, "%s/oriel.db", f->daemon.root);
    assert_int_equal(sqlite3_open(path, &db), SQLITE_OK);
    sqlite3_busy_timeout(db, 10000);
    assert_int_equal(sqlite3_exec(db, sql, NULL, NULL, NULL), SQLITE_OK);
    assert_int_equal(sqlite3_close(db), SQLITE_OK);
}

static int setup(void **state)
{
    static struct fixture f;
    struct reply reply;
    daemon_start(&f.daemon, NULL);
    daemon_upload_room(&f.daemon, f.scene);
    daemon_submit(&f.daemon, f.scene, 2000, 1, "north", f.job);
    daemon_wait(&f.daemon, f.job, 60, &reply);
    assert_string_equal(reply_text(&reply, "state"), "succeeded");
    reply_done(&reply);
    make_token(&f.daemon, "desk", "submit", f.submit);
    make_token(&f.daemon, "board", "read", f.read);
    assert_int_equal(daemon_end(&f.daemon, SIGTERM), 0);
    change(&f, "UPDATE jobs SET owner = (SELECT id FROM tokens WHERE name = 'desk')");
    daemon_restart(&f.daemon, with_tokens);
    name_host(&f);
    *state = &f;
    return 0;
}

static int teardown(void **state)
{
    daemon_remove(&((struct fixture *)*state)->daemon);
    return 0;
}

/* Sends one request with those lines; expects the status. */
static void send_request(struct fixture *f, const char *line, const char *first, const char *second,
                         const char *body, long wanted, struct reply *ret_reply)
{
    char headers[1200];
    snprintf(headers, sizeof headers, "%s%s%s", first, second,
             body && *body == '{' ? "Content-Type: application/json\r\n" : "");
    http_wire_ask(&f->daemon, line, headers, body, ret_reply);
    if (ret_reply->status != wanted)
        fail_msg("%s with %s: %ld: %.300s", line, headers, ret_reply->status, ret_reply->body);
}

static void expect(struct fixture *f, const char *line, const char *first, const char *second,
                   const char *body, long wanted)
{
    struct reply reply;
    send_request(f, line, first, second, body, wanted, &reply);
    reply_done(&reply);
}

/* Signs in; returns the Cookie line. */
static void sign_in(struct fixture *f, const char *token, char ret_cookie[160])
{
    struct reply reply;
    send_request(f, "POST /v1/session", f->own, token, "", 201, &reply);
    const char *cookie = reply_header(&reply, "Set-Cookie");
    assert_non_null(cookie);
    assert_non_null(strstr(cookie, "; Path=/; HttpOnly; SameSite=Strict; Max-Age=43200"));
    assert_null(strstr(cookie, "Domain"));
    snprintf(ret_cookie, 160, "Cookie: %.*s\r\n", (int)strcspn(cookie, ";"), cookie);
    assert_true(json_is_true(reply_at(&reply, "signed_in")));
    assert_null(strstr(reply.body, strchr(ret_cookie, '=') + 1)); /* no script can read it */
    reply_done(&reply);
}

static void test_in_and_out(void **state)
{
    struct fixture *f = *state;
    struct reply reply;
    char cookie[160], other[160];
    send_request(f, "GET /v1/session", f->host, "", NULL, 200, &reply);
    assert_true(json_is_true(reply_at(&reply, "needed")));
    assert_true(json_is_false(reply_at(&reply, "signed_in")));
    reply_done(&reply);
    sign_in(f, f->submit, cookie);
    sign_in(f, f->submit, other);
    assert_string_not_equal(cookie, other);
    send_request(f, "GET /v1/session", f->host, cookie, NULL, 200, &reply);
    assert_string_equal(reply_text(&reply, "token"), "desk");
    assert_string_equal(reply_text(&reply, "scope"), "submit");
    reply_done(&reply);
    expect(f, "GET /v1/jobs", f->host, cookie, NULL, 200);
    expect(f, "HEAD /v1/jobs", f->host, cookie, NULL, 200);
    expect(f, "POST /v1/jobs", f->own, cookie, "{}", 422);
    /* A session that signed out is over for all copies of its cookie; the other browser's session
     * stays. */
    send_request(f, "DELETE /v1/session", f->own, cookie, NULL, 204, &reply);
    assert_non_null(strstr(reply_header(&reply, "Set-Cookie"), "=; "));
    assert_non_null(strstr(reply_header(&reply, "Set-Cookie"), "Max-Age=0"));
    reply_done(&reply);
    expect(f, "GET /v1/jobs", f->host, cookie, NULL, 401);
    expect(f, "GET /v1/jobs", f->host, other, NULL, 200);
    expect(f, "DELETE /v1/session", f->own, cookie, NULL, 204);
    expect(f, "DELETE /v1/session", f->own, "", NULL, 204);
    sign_in(f, f->submit, cookie);
    expect(f, "DELETE /v1/session?all=true", f->own, cookie, NULL, 204);
    expect(f, "GET /v1/jobs", f->host, cookie, NULL, 401);
    expect(f, "GET /v1/jobs", f->host, other, NULL, 401);
}

static void test_no_way_in(void **state)
{
    struct fixture *f = *state;
    char cookie[160], line[200];
    expect(f, "POST /v1/session", f->own, "", "", 401);
    expect(f, "POST /v1/session", f->own, "Authorization: Bearer oriel_wrong\r\n", "", 401);
    expect(f, "POST /v1/session", f->own, "Authorization: Basic YTpi\r\n", "", 401);
    sign_in(f, f->read, cookie);
    expect(f, "POST /v1/session", f->own, cookie, "", 401); /* a cookie cannot create another */
    expect(f, "POST /v1/jobs", f->own, cookie, "{}", 403);  /* its token is read-only */
    /* A wrong token fails even with a valid cookie. */
    snprintf(line, sizeof line, "%sAuthorization: Bearer oriel_wrong\r\n", cookie);
    expect(f, "GET /v1/jobs", f->host, line, NULL, 401);
    char *value = strchr(cookie, '=') + 1;
    *value = *value == 'A' ? 'B' : 'A';
    expect(f, "GET /v1/jobs", f->host, cookie, NULL, 401);
    snprintf(line, sizeof line, "%.*s\r\n", (int)(value - cookie), cookie);
    expect(f, "GET /v1/jobs", f->host, line, NULL, 401);
    snprintf(line, sizeof line, "%.*s' OR 1=1 --\r\n", (int)(value - cookie), cookie);
    expect(f, "GET /v1/jobs", f->host, line, NULL, 401);
}

/* Requests that another page makes the browser send with the cookie: a form, a fetch, a picture. */
static void test_forged_by_other_pages(void **state)
{
    struct fixture *f = *state;
    struct reply reply;
    char cookie[160], headers[700];
    static const char *const pages[] = {
        "Origin: http://localhost:3000\r\nSec-Fetch-Site: same-site\r\n",
        "Origin: http://127.0.0.1:3000\r\nSec-Fetch-Site: same-site\r\n",
        "Origin: https://evil.example\r\nSec-Fetch-Site: cross-site\r\n",
        "Origin: null\r\n",
        "Origin: https://evil.example\r\n",
        "Sec-Fetch-Site: cross-site\r\n",
        "Sec-Fetch-Site: same-site\r\n",
        "" /* a form of an old browser, without an origin */};
    sign_in(f, f->submit, cookie);
    char cancel[120];
    snprintf(cancel, sizeof cancel, "POST %s/cancel", f->job);
    for (size_t i = 0; i < sizeof pages / sizeof *pages; i++) {
        snprintf(headers, sizeof headers, "%s%sContent-Type: application/x-www-form-urlencoded\r\n",
                 f->host, pages[i]);
        expect(f, cancel, headers, cookie, "a=b", 403);
        expect(f, "POST /v1/bsdfs", headers, cookie, "<x/>", 403);
        expect(f, "DELETE /v1/session", headers, cookie, NULL, 403);
        snprintf(headers, sizeof headers, "%s%s", f->host, pages[i]);
        expect(f, "GET /v1/jobs", headers, cookie, NULL, *pages[i] ? 403 : 200);
    }
    expect(f, "GET /v1/jobs", f->host, cookie, NULL, 200);
    snprintf(headers, sizeof headers, "%sSec-Fetch-Site: same-origin\r\n", f->own);
    expect(f, cancel, headers, cookie, "", 409); /* the daemon's own page is served */
    /* With a token the request is not forged: a browser never sends one by itself. */
    snprintf(headers, sizeof headers, "%s%s", cookie, f->submit);
    send_request(f, cancel, f->host, headers, "", 409, &reply);
    reply_done(&reply);
}

/* Forms have three encodings, two of which can carry JSON or a zip: whatever their origin and
 * target, the cookie sent with them is not sufficient. */
static void test_forms(void **state)
{
    struct fixture *f = *state;
    char cookie[160], cancel[120], links[120], headers[700], json[200];
    static const char *const ways[] = {"Content-Type: text/plain\r\n",
                                       "Content-Type: application/x-www-form-urlencoded\r\n",
                                       "Content-Type: multipart/form-data; boundary=b\r\n",
                                       "Content-Type: application/json\r\n", ""};
    static const char *const pages[] = {"Origin: null\r\n", "Origin: http://localhost:3000\r\n",
                                        "Origin: https://evil.example\r\n", ""};
    sign_in(f, f->submit, cookie);
    snprintf(cancel, sizeof cancel, "POST %s/cancel", f->job);
    snprintf(links, sizeof links, "POST %s/links", f->job);
    snprintf(json, sizeof json, " {\"scene\":\"%s\",\"sensors\":[[2,2,1,0,0,1]]}", f->scene);
    const char *const lines[] = {"POST /v1/jobs",  "POST /v1/plans", "POST /v1/scenes",
                                 "POST /v1/bsdfs", cancel,           links};
    for (size_t i = 0; i < sizeof ways / sizeof *ways; i++)
        for (size_t k = 0; k < sizeof pages / sizeof *pages; k++) {
            snprintf(headers, sizeof headers, "%s%s%s", f->host, pages[k], ways[i]);
            for (size_t l = 0; l < sizeof lines / sizeof *lines; l++)
                expect(f, lines[l], headers, cookie, json, 403);
        }
    /* Signing in needs a token, which no form can send: an attacker cannot sign a user in to
     * another account. */
    snprintf(headers, sizeof headers, "%sOrigin: https://evil.example\r\n%s", f->host, ways[0]);
    expect(f, "POST /v1/session", headers, f->submit, "", 403);
    snprintf(headers, sizeof headers, "%s%s", f->host, ways[0]);
    expect(f, "POST /v1/session", headers, "", "token=x", 401);
    snprintf(headers, sizeof headers, "%sContent-Type: application/json\r\n", f->own);
    expect(f, "POST /v1/plans", headers, cookie, json, 200); /* from the daemon's own page */
}

/* Restarts with those options; the ports change. */
static void restart(struct fixture *f, const char *const *extra)
{
    assert_int_equal(daemon_end(&f->daemon, SIGTERM), 0);
    daemon_restart(&f->daemon, extra);
    name_host(f);
}

static void test_sessions_end(void **state)
{
    struct fixture *f = *state;
    char token[160], cookie[160], other[160], said[300], secret[64];
    sign_in(f, f->submit, cookie);
    restart(f, with_tokens);
    expect(f, "GET /v1/jobs", f->host, cookie, NULL, 200); /* not ended by the daemon's restart */
    /* No stored data can serve as a cookie. */
    snprintf(secret, sizeof secret, "%.43s", strchr(cookie, '=') + 1);
    snprintf(said, sizeof said, "! grep -rqF -e '%s' %s %s.log", secret, f->daemon.root,
             f->daemon.root);
    assert_int_equal(system(said), 0);
    change(f, "UPDATE sessions SET expires_ms = 1 + created_ms - 1");
    expect(f, "GET /v1/jobs", f->host, cookie, NULL, 401); /* it has expired */
    make_token(&f->daemon, "guest", "read", token);
    sign_in(f, token, cookie);
    sign_in(f, f->submit, other);
    say(&f->daemon, "remove guest", said, sizeof said);
    expect(f, "GET /v1/jobs", f->host, cookie, NULL, 401); /* removed with its token */
    expect(f, "GET /v1/jobs", f->host, other, NULL, 200);
    make_token(&f->daemon, "guest", "read", token); /* a different token */
    expect(f, "GET /v1/jobs", f->host, cookie, NULL, 401);
}

static int open_stream(struct fixture *f, const char *path, const char *credential)
{
    char request[400], text[1000];
    const int fd = daemon_dial(&f->daemon);
    const int size =
        snprintf(request, sizeof request, "GET %s HTTP/1.0\r\n%s%s\r\n", path, f->host, credential);
    assert_int_equal(write(fd, request, (size_t)size), size);
    assert_true(read(fd, text, sizeof text) > 12);
    assert_int_equal(strncmp(text + 8, " 200", 4), 0);
    return fd;
}

/* Reads the stream to its end; returns false if that has not come after that many seconds. */
static bool ends_within(int fd, int seconds)
{
    struct pollfd wait = {fd, POLLIN, 0};
    const time_t last = time(NULL) + seconds;
    char text[4096];
    do {
        if (poll(&wait, 1, seconds > 0 ? 1000 : 0) == 1 && read(fd, text, sizeof text) <= 0)
            return true;
    } while (time(NULL) < last);
    return false;
}

/* A stream ends with the session that opened it, and others continue. */
static void test_streams_end(void **state)
{
    struct fixture *f = *state;
    char token[160], cookie[160], other[160], said[100];
    make_token(&f->daemon, "screen", "read", token);
    sign_in(f, token, cookie);
    sign_in(f, token, other);
    const int first = open_stream(f, "/v1/events", cookie);
    const int second = open_stream(f, "/v1/events", other);
    const int third = open_stream(f, "/v1/events", token);
    const int fourth = open_stream(f, "/v1/events", f->submit);
    expect(f, "DELETE /v1/session", f->own, cookie, NULL, 204);
    assert_true(ends_within(first, 60));
    assert_false(ends_within(second, 0));
    say(&f->daemon, "remove screen", said, sizeof said);
    assert_true(ends_within(second, 60));
    assert_true(ends_within(third, 60));
    assert_false(ends_within(fourth, 0));
    close(first);
    close(second);
    close(third);
    close(fourth);
}

/* The number of browsers of a token is limited; one more ends the oldest session. */
static void test_bounded(void **state)
{
    struct fixture *f = *state;
    char first[160], cookie[160], reader[160];
    const struct timespec moment = {0, 2000000};
    sign_in(f, f->read, reader);
    sign_in(f, f->submit, first);
    for (int i = 0; i < 64; i++) {
        nanosleep(&moment, NULL); /* by the clock's milliseconds */
        sign_in(f, f->submit, cookie);
        if (i == 62)
            expect(f, "GET /v1/jobs", f->host, first, NULL, 200);
    }
    expect(f, "GET /v1/jobs", f->host, first, NULL, 401);
    expect(f, "GET /v1/jobs", f->host, cookie, NULL, 200);
    expect(f, "GET /v1/jobs", f->host, reader, NULL, 200);
}

/* Pages of --allow-origin cannot use the cookie; behind TLS it is Secure. */
static void test_elsewhere(void **state)
{
    struct fixture *f = *state;
    static const char *const open[] = {"--tokens", "always", "--allow-origin",
                                       "http://localhost:3000", NULL};
    struct reply reply;
    char cookie[160], headers[400];
    restart(f, open);
    sign_in(f, f->submit, cookie);
    snprintf(headers, sizeof headers, "%sOrigin: http://localhost:3000\r\n", f->host);
    send_request(f, "GET /v1/jobs", headers, cookie, NULL, 401, &reply);
    assert_null(reply_header(&reply, "Access-Control-Allow-Credentials"));
    reply_done(&reply);
    expect(f, "GET /v1/jobs", headers, f->submit, NULL, 200);
    snprintf(
        headers, sizeof headers,
        "Host: oriel.example\r\nOrigin: https://oriel.example\r\nX-Forwarded-Proto: https\r\n");
    send_request(f, "POST /v1/session", headers, f->submit, "", 201, &reply);
    assert_int_equal(strncmp(reply_header(&reply, "Set-Cookie"), "__Host-oriel-", 13), 0);
    assert_non_null(strstr(reply_header(&reply, "Set-Cookie"), "; Secure"));
    reply_done(&reply);
    restart(f, with_tokens);
}

static void test_cookie_over_tls(void **state)
{
    struct fixture *f = *state;
    char cert[90], key[90];
    struct reply reply;
    snprintf(cert, sizeof cert, "%s/c.pem", f->daemon.root);
    snprintf(key, sizeof key, "%s/k.pem", f->daemon.root);
    certificate_make(cert, key);
    const char *const extra[] = {"--tokens", "always", "--tls-cert", cert, "--tls-key", key, NULL};
    restart(f, extra);
    snprintf(f->daemon.ca, sizeof f->daemon.ca, "%.79s", cert);
    char line[160];
    snprintf(line, sizeof line, "%.*s", (int)strcspn(f->submit, "\r"), f->submit);
    daemon_request(&f->daemon, "POST", "/v1/session", NULL, "", 0, line, &reply);
    assert_int_equal(reply.status, 201);
    assert_int_equal(strncmp(reply_header(&reply, "Set-Cookie"), "__Host-oriel-0=", 15), 0);
    assert_non_null(strstr(reply_header(&reply, "Set-Cookie"), "; Secure"));
    reply_done(&reply);
    f->daemon.ca[0] = '\0';
    restart(f, with_tokens);
}

/* ---- Links ---------------------------------------------------------------------------------- */

/* Makes "GET /v1/...": a link to that file of the job. */
static void make_link(struct fixture *f, const char *who, const char *file, int seconds,
                      char ret_line[400])
{
    struct reply reply;
    char line[120], body[200];
    snprintf(line, sizeof line, "POST %s/links", f->job);
    snprintf(body, sizeof body, "{\"files\":[\"%s\"],\"seconds\":%d}", file, seconds);
    send_request(f, line, f->own, who, body, 201, &reply);
    snprintf(ret_line, 400, "GET %s", reply_text(&reply, "links.0.url"));
    assert_string_equal(reply_text(&reply, "links.0.file"), file);
    reply_done(&reply);
}

static void test_links(void **state)
{
    struct fixture *f = *state;
    char cookie[160], link[400], headers[200];
    sign_in(f, f->read, cookie);
    make_link(f, cookie, "north.png", 3600, link);
    expect(f, link, f->host, "", NULL, 200);
    expect(f, link, f->host, "Range: bytes=0-9\r\n", NULL, 206);
    restart(f, with_tokens);
    expect(f, link, f->host, "", NULL, 200); /* it survives a restart */
    /* A page of another site may show it: this is its purpose. */
    snprintf(headers, sizeof headers, "%sSec-Fetch-Site: cross-site\r\n", f->host);
    expect(f, link, headers, "", NULL, 200);
    /* It also works if the browser sends the cookie along, as to another port of the same host. */
    snprintf(headers, sizeof headers, "%sSec-Fetch-Site: same-site\r\n", f->host);
    expect(f, link, headers, cookie, NULL, 200);
    expect(f, "GET /v1/jobs", headers, cookie, NULL, 403);
    make_link(f, f->submit, "absent.png", 3600, link);
    expect(f, link, f->host, "", NULL, 404);
    make_link(f, f->submit, "a b/\xc3\xa4?&#.png", 3600,
              link); /* a signed link to a missing file */
    expect(f, link, f->host, "", NULL, 404);
}

/* Changing any part of a link makes it invalid, and it opens nothing else. */
static void test_changed_links(void **state)
{
    struct fixture *f = *state;
    char link[400], changed[500];
    make_link(f, f->submit, "north.png", 3600, link);
    const char *query = strchr(link, '?');
    const int head = (int)(query - link);
    static const char *const others[] = {"/files/north.hdr", "/files/result.json", "/result", "",
                                         "/events",          "/files/north.png/",  "/links"};
    for (size_t i = 0; i < sizeof others / sizeof *others; i++) {
        snprintf(changed, sizeof changed, "GET %s%s%s", f->job, others[i], query);
        struct reply reply;
        char headers[100];
        snprintf(headers, sizeof headers, "%s", f->host);
        http_wire_ask(&f->daemon, changed, headers, NULL, &reply);
        if (reply.status != 401 && reply.status != 403 && reply.status != 405)
            fail_msg("%s: %ld", changed, reply.status);
        reply_done(&reply);
    }
    for (const char *at = query + 1; *at; at++) { /* each character of it */
        if (strchr("=&", *at) || (at[1] == '\0')) /* the last character has unused bits */
            continue;
        snprintf(changed, sizeof changed, "%s", link);
        changed[at - link] = *at == '1' ? '2' : '1';
        struct reply reply;
        http_wire_ask(&f->daemon, changed, f->host, NULL, &reply);
        if (reply.status != 401 && reply.status != 403)
            fail_msg("%s: %ld", changed, reply.status);
        reply_done(&reply);
    }
    snprintf(changed, sizeof changed, "DELETE %.*s%s", head - 4, link + 4, query);
    expect(f, changed, f->own, "", NULL, 405);
    snprintf(changed, sizeof changed, "%.*s", head, link);
    expect(f, changed, f->host, "", NULL, 401);
    snprintf(changed, sizeof changed, "GET /v1/jobs%s", query);
    expect(f, changed, f->host, "", NULL, 401);
    snprintf(changed, sizeof changed, "GET /v1/jobs/%s/files/north.png%s",
             "00000000000000000000000000000000", query);
    expect(f, changed, f->host, "", NULL, 403);
    snprintf(changed, sizeof changed, "%s&until=99999999999", link);
    expect(f, changed, f->host, "", NULL, 200); /* the first value counts, which was signed */
    snprintf(changed, sizeof changed, "%.*s?until=99999999999&%s", head, link, query + 1);
    expect(f, changed, f->host, "", NULL, 403);
}

/* Expects that the link opens the file until the time in it, and no longer. */
static void expect_until(const struct fixture *f, char *link)
{
    const time_t until_s = strtoll(strstr(link, "until=") + 6, NULL, 10);
    for (bool over = false; !over;) {
        struct reply reply;
        over = time(NULL) > until_s;
        http_wire_ask(&f->daemon, link, f->host, NULL, &reply);
        const bool valid = time(NULL) + 1 < until_s; /* the clock may be a tick behind */
        if ((over && reply.status != 403) || (valid && reply.status != 200))
            fail_msg("%ld %s", reply.status, over ? "after the time" : "before the time");
        reply_done(&reply);
        nanosleep(&(struct timespec){0, 100000000}, NULL);
    }
}

/* A stolen link works until it expires. */
static void test_stolen_link(void **state)
{
    struct fixture *f = *state;
    char token[160], link[400], brief[400], said[100], longer[400];
    make_token(&f->daemon, "thief", "read", token);
    make_link(f, token, "north.png", 3600, link);
    make_link(f, f->submit, "north.png", 10, brief);
    expect(f, link, f->host, "", NULL, 200);
    say(&f->daemon, "remove thief", said, sizeof said);
    expect(f, link, f->host, "", NULL, 403); /* no longer than its token */
    expect_until(f, brief);
    expect(f, brief, f->host, f->submit, NULL, 200); /* a token needs no link */
    /* Its expiry cannot be changed. */
    char *until = strstr(brief, "until=") + 6;
    snprintf(longer, sizeof longer, "%.*s9%s", (int)(until - brief), brief, until);
    expect(f, longer, f->host, "", NULL, 403);
}

/* Signs a link with KEY and the token's hash, which a copy of the database contains. */
static void forge(const struct fixture *f, const char *id, const char *file, long long until_s,
                  const unsigned char *key, char ret_line[400])
{
    unsigned char hash[32] = {0}, mac[32];
    char path[100], text[400], signature[44];
    const char *hex = NULL;
    sqlite3 *db = NULL;
    sqlite3_stmt *stmt = NULL;
    snprintf(path, sizeof path, "%s/oriel.db", f->daemon.root);
    assert_int_equal(sqlite3_open(path, &db), SQLITE_OK);
    sqlite3_busy_timeout(db, 10000);
    sqlite3_prepare_v2(db, "SELECT hash FROM tokens WHERE id = ?", -1, &stmt, NULL);
    sqlite3_bind_text(stmt, 1, id, 16, SQLITE_STATIC);
    assert_int_equal(sqlite3_step(stmt), SQLITE_ROW);
    hex = (const char *)sqlite3_column_text(stmt, 0);
    sodium_hex2bin(hash, sizeof hash, hex, 64, NULL, NULL, NULL);
    const int size = key ? snprintf(text, sizeof text, "oriel-link 2\n%.16s\n%s\n%s\n%lld\n%s", id,
                                    hex, strrchr(f->job, '/') + 1, until_s, file)
                         : snprintf(text, sizeof text, "oriel-link 1\n%s\n%lld\n%s",
                                    strrchr(f->job, '/') + 1, until_s, file);
    crypto_generichash(mac, sizeof mac, (const unsigned char *)text, (unsigned long long)size,
                       key ? key : hash, 32);
    sodium_bin2base64(signature, sizeof signature, mac, sizeof mac,
                      sodium_base64_VARIANT_URLSAFE_NO_PADDING);
    snprintf(ret_line, 400, "GET %s/files/%s?by=%.16s&until=%lld&signature=%s", f->job, file, id,
             until_s, signature);
    sqlite3_finalize(stmt);
    sqlite3_close(db);
}

/* The database alone cannot sign links, and even the key signs for at most an hour. */
static void test_forged_links(void **state)
{
    struct fixture *f = *state;
    unsigned char key[32] = {0};
    char path[100], id[17], line[400], link[400], said[400];
    struct stat st = {0};
    const long long now_s = (long long)time(NULL);
    snprintf(id, sizeof id, "%.16s", strstr(f->submit, "oriel_") + 6);
    forge(f, id, "north.png", now_s + 60, NULL, line);
    expect(f, line, f->host, "", NULL, 403);
    forge(f, id, "north.png", 99999999999, NULL, line);
    expect(f, line, f->host, "", NULL, 403);

    snprintf(path, sizeof path, "%s/oriel.key", f->daemon.root);
    assert_int_equal(stat(path, &st), 0);
    assert_int_equal(st.st_mode & 0777, 0600);
    FILE *file = fopen(path, "r");
    assert_int_equal(fread(key, 1, sizeof key, file), sizeof key);
    fclose(file);
    forge(f, id, "north.png", now_s + 3000, key, line);
    expect(f, line, f->host, "", NULL, 200);
    forge(f, id, "north.png", now_s + 2 * 3600, key, line);
    expect(f, line, f->host, "", NULL, 403);

    /* A backup does not contain the key; a folder without one creates another. */
    const char *build = getenv("ORIEL_BUILD");
    snprintf(said, sizeof said,
             "%s/orield backup %s.copy --data %s >/dev/null && ! test -e %s.copy/oriel.key; "
             "s=$?; rm -rf %s.copy; exit $s",
             build ? build : "build", f->daemon.root, f->daemon.root, f->daemon.root,
             f->daemon.root);
    assert_int_equal(system(said), 0);
    make_link(f, f->submit, "north.png", 3600, link);
    assert_int_equal(unlink(path), 0);
    restart(f, with_tokens);
    expect(f, link, f->host, "", NULL, 403);
    make_link(f, f->submit, "north.png", 3600, link);
    expect(f, link, f->host, "", NULL, 200);
}

static void test_refused_wishes(void **state)
{
    struct fixture *f = *state;
    char line[120], many[3000] = "{\"files\":[";
    snprintf(line, sizeof line, "POST %s/links", f->job);
    static const char *const wrong[] = {"{}",
                                        "{\"files\":[]}",
                                        "{\"files\":\"a\"}",
                                        "{\"files\":[1]}",
                                        "{\"files\":[\"\"]}",
                                        "{\"files\":[\"a\"],\"seconds\":9}",
                                        "{\"files\":[\"a\"],\"seconds\":3601}",
                                        "{\"files\":[\"a\"],\"seconds\":-1}",
                                        "{\"files\":[\"a\"],\"seconds\":1e300}",
                                        "{\"files\":[\"a\"],\"other\":1}"};
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        struct reply reply;
        char headers[400];
        snprintf(headers, sizeof headers, "%s%sContent-Type: application/json\r\n", f->own,
                 f->submit);
        http_wire_ask(&f->daemon, line, headers, wrong[i], &reply);
        if (reply.status != 422 && reply.status != 413)
            fail_msg("%s: %ld", wrong[i], reply.status);
        reply_done(&reply);
    }
    for (int i = 0; i < 101; i++)
        snprintf(many + strlen(many), sizeof many - strlen(many), "%s\"f%d\"", i ? "," : "", i);
    snprintf(many + strlen(many), sizeof many - strlen(many), "]}");
    expect(f, line, f->own, f->submit, many, 413);
    expect(f, line, f->own, f->submit, "{", 400);
    expect(f, line, f->own, "", "{\"files\":[\"a\"]}", 401);
}

/* Without tokens there are no sessions, and links are plain. */
static void test_without_tokens(void **state)
{
    struct fixture *f = *state;
    struct reply reply;
    char line[120], link[400];
    restart(f, NULL);
    send_request(f, "POST /v1/session", f->own, "", "", 409, &reply);
    reply_done(&reply);
    send_request(f, "GET /v1/session", f->own, "", NULL, 200, &reply);
    assert_true(json_is_false(reply_at(&reply, "needed")));
    reply_done(&reply);
    snprintf(line, sizeof line, "POST %s/links", f->job);
    make_link(f, "", "north.png", 3600, link);
    assert_null(strchr(link, '?'));
    expect(f, link, f->host, "", NULL, 200);
    restart(f, with_tokens);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_in_and_out),
        cmocka_unit_test(test_no_way_in),
        cmocka_unit_test(test_forged_by_other_pages),
        cmocka_unit_test(test_forms),
        cmocka_unit_test(test_sessions_end),
        cmocka_unit_test(test_streams_end),
        cmocka_unit_test(test_bounded),
        cmocka_unit_test(test_elsewhere),
        cmocka_unit_test(test_cookie_over_tls),
        cmocka_unit_test(test_links),
        cmocka_unit_test(test_changed_links),
        cmocka_unit_test(test_stolen_link),
        cmocka_unit_test(test_forged_links),
        cmocka_unit_test(test_refused_wishes),
        cmocka_unit_test(test_without_tokens),
    };
    return cmocka_run_group_tests(tests, setup, teardown);
}
