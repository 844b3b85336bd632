/* Bytes that are no HTTP request, or could be parsed as another one: refused, and the connection
 * ends. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <time.h>
#include <unistd.h>

#include "support/daemon.h"

enum { CLOSED = 0 };

/* Sends the bytes, at once with the end of the stream if `ends`; returns the status, or CLOSED. */
static int ask_bytes(const struct daemon *daemon, const char *bytes, size_t size, bool ends,
                     char *ret_answer, size_t room)
{
    const int fd = daemon_dial(daemon);
    size_t used = 0;
    int status = CLOSED;
    assert_true(send(fd, bytes, size, MSG_NOSIGNAL) == (ssize_t)size);
    if (ends)
        shutdown(fd, SHUT_WR);
    for (ssize_t n; used < room - 1 && (n = recv(fd, ret_answer + used, room - 1 - used, 0)) > 0;)
        used += (size_t)n;
    ret_answer[used] = '\0';
    close(fd);
    sscanf(ret_answer, "HTTP/1.1 %d", &status);
    return status;
}

static int ask_text(const struct daemon *daemon, const char *text, bool ends, char *ret_answer,
                    size_t room)
{
    return ask_bytes(daemon, text, strlen(text), ends, ret_answer, room);
}

#define POST "POST /v1/jobs HTTP/1.1\r\nContent-Type: application/json\r\n"
#define HOST "Host: localhost\r\n"
#define LENGTH "Content-Length: 2\r\n"
#define CHUNKED "Transfer-Encoding: chunked\r\n"
#define CODED "Transfer-Encoding: gzip, chunked\r\n"

static void test_framing(void **state)
{
    static const struct {
        const char *request, *why;
    } cases[] = {
        {POST LENGTH "\r\n{}", "no Host"},
        {POST HOST HOST LENGTH "\r\n{}", "more than one Host"},
        {POST HOST LENGTH LENGTH "\r\n{}", "more than one Content-Length"},
        {POST HOST LENGTH "Content-Length: 40\r\n\r\n{}", "more than one Content-Length"},
        {POST HOST LENGTH CHUNKED "\r\n0\r\n\r\n", "both Content-Length"},
        {POST HOST CHUNKED LENGTH "\r\n0\r\n\r\n", "both Content-Length"},
        {POST HOST CODED "\r\n0\r\n\r\n", "not chunked"},
        {POST HOST CHUNKED CHUNKED "\r\n0\r\n\r\n", "not chunked"},
        {"GET /healthz HTTP/1.1\r\n\r\n", "no Host"},
    };
    char answer[4096];
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        const int status = ask_text(*state, cases[i].request, false, answer, sizeof answer);
        if (status != 400 || !strstr(answer, cases[i].why) || !strstr(answer, "urn:oriel:error:"))
            fail_msg("%s: %s", cases[i].request, answer);
    }
}

/* Counts the occurrences of part in text. */
static int count_occurrences(const char *text, const char *part)
{
    int times = 0;
    for (const char *at = text; (at = strstr(at, part)); at += strlen(part))
        times++;
    return times;
}

/* Headers that libmicrohttpd cannot parse: one answer, in one block, and others are served. The
 * headers may come with the request line or later. */
static void test_unparsed_headers(void **state)
{
    static const char *const lengths[] = {
        "+5", "-5", "5x", "5, 5", "0x5", "5 5", "1e3", "", "99999999999999999999999"};
    static const char first[] = POST HOST;
    char request[400], answer[4096];
    for (size_t i = 0; i < 2 * (sizeof lengths / sizeof *lengths); i++) {
        const size_t at_once = i % 2 ? sizeof first - 1 : 0;
        snprintf(request, sizeof request, "%sContent-Length: %s\r\n\r\n{}{}{}", first,
                 lengths[i / 2]);
        const int fd = daemon_dial(*state);
        size_t used = 0;
        assert_true(send(fd, request, at_once, MSG_NOSIGNAL) == (ssize_t)at_once);
        assert_int_equal(
            ask_text(*state, "GET /healthz HTTP/1.0\r\n\r\n", false, answer, sizeof answer),
            200); /* headers that end within those */
        const char *rest = request + at_once;
        assert_true(send(fd, rest, strlen(rest), MSG_NOSIGNAL) == (ssize_t)strlen(rest));
        for (ssize_t n; (n = recv(fd, answer + used, sizeof answer - 1 - used, 0)) > 0;)
            used += (size_t)n;
        answer[used] = '\0';
        close(fd);
        const char *body = strstr(answer, "\r\n\r\n");
        if (count_occurrences(answer, "HTTP/1.1 ") != 1 ||
            count_occurrences(answer, "HTTP/1.1 400 ") != 1 || !body ||
            !strstr(body, "Content-Length is not a number"))
            fail_msg("Content-Length: %s: %s", lengths[i / 2], answer);
    }
}

/* Cookies that take more memory than a connection has also get one header block. */
static void test_many_cookies(void **state)
{
    static char request[32000], answer[8192];
    size_t used = (size_t)sprintf(request, "GET /healthz HTTP/1.1\r\n" HOST "Cookie: ");
    for (int i = 0; i < 6000; i++)
        used += (size_t)sprintf(request + used, "a;");
    sprintf(request + used, "\r\n\r\n");
    const int status = ask_text(*state, request, false, answer, sizeof answer);
    if (status < 400 || count_occurrences(answer, "HTTP/1.1 ") != 1)
        fail_msg("%d: %s", status, answer);
}

#define GET "GET /healthz HTTP/1.1\r\n" HOST

/* Malformed headers, followed by bytes that could be parsed as a body or as another request. */
static void test_headers(void **state)
{
    static const char none[] = "an invalid name", hidden[] = "has no name, has a NUL, or continues",
                      controls[] = "control characters";
    static const struct {
        const char *request;
        size_t size;
        const char *why;
    } cases[] = {
#define BYTES(text) text, sizeof(text) - 1
        {BYTES(POST HOST "Content-Length : 2\r\n\r\n{}"), none},
        {BYTES(POST HOST "Content-Length\t: 2\r\n\r\n{}"), none},
        {BYTES(POST " Content-Length: 2\r\n" HOST "\r\n{}"), none},
        {BYTES(GET ": empty\r\n\r\n"), hidden},
        {BYTES(GET " : blank\r\n\r\n"), none},
        {BYTES(GET "X(Y): z\r\n\r\n"), none},
        {BYTES(GET "X\xc3\xa4: z\r\n\r\n"), none},
        {BYTES(GET "X: a\0b\r\n\r\n"), hidden},
        {BYTES(GET "X: a\0\r\n\r\n"), hidden},
        {BYTES(GET "X: a\0\0\0b\r\nY: c\r\n\r\n"), hidden},
        {BYTES(GET "\0X: a\r\n\r\n"), hidden},
        {BYTES(GET "\0\r\n"), hidden},
        {BYTES("GET /healthz HTTP/1.1\r\n\0" HOST "\r\n"), hidden},
        {BYTES(POST HOST "Content-: 2\r\n Length\r\n\r\n{}"), hidden},
        {BYTES(POST "Ho: localhost\r\n st\r\n" LENGTH "\r\n{}"), hidden},
        {BYTES(GET "X: a\rY: b\r\n\r\n"), controls},
        {BYTES(GET "X: a\033[2J\r\n\r\n"), controls},
        {BYTES(GET "X: a\177\r\n\r\n"), controls},
        {BYTES("GET /healthz\0/x HTTP/1.1\r\n" HOST "\r\n"), "its target has a NUL"},
        {BYTES("POST /v1/jobs HTTP/1.0\r\n" HOST CHUNKED "\r\n0\r\n\r\n"),
         "HTTP/1.0 has no Transfer-Encoding"},
#undef BYTES
    };
    char answer[4096];
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        const int status =
            ask_bytes(*state, cases[i].request, cases[i].size, true, answer, sizeof answer);
        if (status != 400 || !strstr(answer, cases[i].why))
            fail_msg("%zu, %s: %d %s", i, cases[i].request, status, answer);
    }
}

/* More arguments, or a longer target, than the limits allow: an error answer, and the next request
 * works. */
static void test_targets(void **state)
{
    static const char tail[] = " HTTP/1.1\r\n" HOST "Connection: close\r\n\r\n";
    static const struct {
        const char *part;
        int times, status;
    } cases[] = {{"a&", 4000, 414},     {"&", 4000, 414},       {"main=a&", 4000, 414},
                 {"x", 10000, 414},     {"%61=%62&", 400, 414}, {"x", 8000, 200},
                 {"limit=9&", 90, 200}, {"a=b&", 200, 414}};
    static char request[40000], answer[4096];
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        size_t used = (size_t)sprintf(request, "GET /healthz?");
        for (int k = 0; k < cases[i].times; k++)
            used += (size_t)sprintf(request + used, "%s", cases[i].part);
        sprintf(request + used, "%s", tail);
        const int status = ask_text(*state, request, false, answer, sizeof answer);
        if (status != cases[i].status)
            fail_msg("%d times '%s': %d %s", cases[i].times, cases[i].part, status, answer);
    }
}

/* A query after a NUL, with more arguments than the limit: the connection ends before the header
 * timeout (15 s), and others are served. */
static void test_hidden_queries(void **state)
{
    static const struct {
        const char *part;
        int times;
    } cases[] = {{"a&", 4000}, {"a=1&", 900}, {"&", 9000}, {"a", 1}};
    static char request[40000], answer[4096];
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        struct timespec from, to;
        size_t used = (size_t)sprintf(request, "GET /healthz") + 1;
        used += (size_t)sprintf(request + used, "x?");
        for (int k = 0; k < cases[i].times; k++)
            used += (size_t)sprintf(request + used, "%s", cases[i].part);
        used += (size_t)sprintf(request + used, " HTTP/1.1\r\n" HOST "\r\n");
        clock_gettime(CLOCK_MONOTONIC, &from);
        const int status = ask_bytes(*state, request, used, false, answer, sizeof answer);
        clock_gettime(CLOCK_MONOTONIC, &to);
        assert_int_equal(status, CLOSED);
        assert_true(to.tv_sec - from.tv_sec < 12);
    }
    assert_int_equal(ask_text(*state, "GET /%00 HTTP/1.1\r\n" HOST "Connection: close\r\n\r\n",
                              false, answer, sizeof answer),
                     404);
    assert_int_equal(
        ask_text(*state, GET "Connection: close\r\n\r\n", false, answer, sizeof answer), 200);
}

/* Valid requests similar to the refused ones still work. */
static void test_good(void **state)
{
    static const struct {
        const char *request;
        int status;
    } cases[] = {
        {"GET /healthz HTTP/1.1\r\n" HOST "Connection: close\r\n\r\n", 200},
        {"GET /healthz HTTP/1.0\r\n\r\n", 200},
        {"GET /healthz HTTP/1.0\n\n", 200},
        {GET "X:\r\nY:  \tz \t\r\nZ: \xc3\xa4\r\nConnection: close\r\n\r\n", 200},
        {"GET /healthz?a=%41&b HTTP/1.1\nHost: localhost\nCookie: a=b; c\nConnection: close\n\n",
         200},
        {POST HOST "Connection: close\r\n" CHUNKED "\r\n2\r\n{}\r\n0\r\n\r\n", 422},
        {POST HOST "Connection: close\r\nTransfer-Encoding: Chunked\r\n\r\n2\r\n{}\r\n0\r\n\r\n",
         422},
    };
    char answer[8192];
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
        assert_int_equal(ask_text(*state, cases[i].request, false, answer, sizeof answer),
                         cases[i].status);
}

/*
 * Targets in absolute form are reduced to their paths, only for the daemon's own scheme and names.
 */
static void test_absolute_form(void **state)
{
#define END "Connection: close\r\n\r\n"
    static const struct {
        const char *request;
        int status;
    } cases[] = {
        {"GET http://127.0.0.1:8423/healthz HTTP/1.1\r\n" HOST END, 200},
        {"GET HTTP://LocalHost/healthz?a=b HTTP/1.1\r\n" HOST END, 200},
        {"GET http://[::1]:1/v1/jobs HTTP/1.1\r\n" HOST END, 200},
        {"GET http://localhost HTTP/1.1\r\n" HOST END, 200},
        {"GET http://localhost?x HTTP/1.1\r\n" HOST END, 200},
        {"GET http://localhost/v1/none HTTP/1.1\r\n" HOST END, 404},
        {"GET http://localhost/healthz HTTP/1.0\r\n\r\n", 200},
        {"POST http://localhost/healthz HTTP/1.1\r\n" HOST "Content-Length: 0\r\n" END, 405},
        /* another machine's name, in either place */
        {"GET http://rebound.example/healthz HTTP/1.1\r\n" HOST END, 403},
        {"GET http://localhost/healthz HTTP/1.1\r\nHost: rebound.example\r\n" END, 403},
        {"GET https://localhost/healthz HTTP/1.1\r\n" HOST END, 403},
        /* the authority decides: its own page, and that of another site */
        {"GET http://localhost:9/healthz HTTP/1.1\r\n" HOST "Origin: http://localhost:9\r\n" END,
         200},
        {"GET http://localhost:9/healthz HTTP/1.1\r\n" HOST "Origin: http://localhost\r\n" END,
         403},
        {"GET http://localhost/healthz HTTP/1.1\r\n" END, 400}, /* without Host */
        {"GET http:///healthz HTTP/1.1\r\n" HOST END, 400},
        {"GET http://me@localhost/healthz HTTP/1.1\r\n" HOST END, 400},
        {"GET ftp://localhost/healthz HTTP/1.1\r\n" HOST END, 404},
        {"GET localhost/healthz HTTP/1.1\r\n" HOST END, 404},
    };
    char answer[8192], request[600] = "GET http://";
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        const int status = ask_text(*state, cases[i].request, false, answer, sizeof answer);
        if (status != cases[i].status)
            fail_msg("%s: %d in place of %d", cases[i].request, status, cases[i].status);
    }
    memset(request + 11, 'a', 300);
    strcpy(request + 311, "/healthz HTTP/1.1\r\n" HOST END);
    assert_int_equal(ask_text(*state, request, false, answer, sizeof answer), 400);
}

static void test_no_request(void **state)
{
    static const struct {
        const char *bytes;
        int status;
    } cases[] = {
        {"GET / HTTP/2.0\r\n\r\n", 505},
        {"GET / HTTP/0.9\r\n\r\n", 505},
        {"GET / HTTX/1.1\r\n\r\n", 400},
        {"GET / http/1.1\r\n\r\n", 400},
        {"GET /\r\n\r\n", 400},
        {"GET\r\n\r\n", CLOSED},
        {" GET / HTTP/1.1\r\n\r\n", CLOSED},
    };
    char answer[4096];
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
        assert_int_equal(ask_text(*state, cases[i].bytes, false, answer, sizeof answer),
                         cases[i].status);
}

/* A client that hangs up after its last bytes does not occupy the daemon for the timeout of headers
 * or bodies, which would exceed this program's time. */
static void test_broken_off(void **state)
{
    static const char *const cases[] = {
        "GET", "GET /healthz HTTP/1.1\r\nHost: ", POST HOST "Content-Length: 50\r\n\r\n{"};
    struct daemon *daemon = *state;
    char answer[4096];
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
        assert_int_equal(ask_text(daemon, cases[i], true, answer, sizeof answer), CLOSED);
    assert_int_equal(
        ask_text(daemon, "GET /healthz HTTP/1.1\r\n" HOST "\r\n", true, answer, sizeof answer),
        200);
}

static int setup(void **state)
{
    static struct daemon daemon;
    static const char *const patient[] = {"--idle-timeout", "3600", NULL};
    daemon_start(&daemon, patient);
    *state = &daemon;
    return 0;
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_framing),       cmocka_unit_test(test_unparsed_headers),
        cmocka_unit_test(test_many_cookies),  cmocka_unit_test(test_headers),
        cmocka_unit_test(test_targets),       cmocka_unit_test(test_good),
        cmocka_unit_test(test_absolute_form), cmocka_unit_test(test_no_request),
        cmocka_unit_test(test_broken_off),    cmocka_unit_test(test_hidden_queries),
    };
    return cmocka_run_group_tests(tests, setup, daemon_tear_down);
}
