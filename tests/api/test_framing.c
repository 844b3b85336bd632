/* Bytes that are no HTTP request, or could be read as another one: refused, and the connection
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
#include <unistd.h>

#include "support/daemon.h"

enum { CLOSED = 0 };

/* Sends it, all at once with the end if so wished; returns the status, or CLOSED. */
static int ask(const struct daemon *daemon, const char *text, bool ends, char *ret_answer,
               size_t room)
{
    const int fd = daemon_dial(daemon);
    size_t used = 0;
    int status = CLOSED;
    assert_true(send(fd, text, strlen(text), MSG_NOSIGNAL) == (ssize_t)strlen(text));
    if (ends)
        shutdown(fd, SHUT_WR);
    for (ssize_t n; used < room - 1 && (n = recv(fd, ret_answer + used, room - 1 - used, 0)) > 0;)
        used += (size_t)n;
    ret_answer[used] = '\0';
    close(fd);
    sscanf(ret_answer, "HTTP/1.1 %d", &status);
    return status;
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
        const int status = ask(*state, cases[i].request, false, answer, sizeof answer);
        if (status != 400 || !strstr(answer, cases[i].why) || !strstr(answer, "urn:oriel:error:"))
            fail_msg("%s: %s", cases[i].request, answer);
    }
}

/* Those beside them are as good as ever. */
static void test_good(void **state)
{
    static const struct {
        const char *request;
        int status;
    } cases[] = {
        {"GET /healthz HTTP/1.1\r\n" HOST "Connection: close\r\n\r\n", 200},
        {"GET /healthz HTTP/1.0\r\n\r\n", 200},
        {POST HOST "Connection: close\r\n" CHUNKED "\r\n2\r\n{}\r\n0\r\n\r\n", 422},
        {POST HOST "Connection: close\r\nTransfer-Encoding: Chunked\r\n\r\n2\r\n{}\r\n0\r\n\r\n",
         422},
    };
    char answer[8192];
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
        assert_int_equal(ask(*state, cases[i].request, false, answer, sizeof answer),
                         cases[i].status);
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
        assert_int_equal(ask(*state, cases[i].bytes, false, answer, sizeof answer),
                         cases[i].status);
}

/* A client that hangs up with its last bytes is not waited for, as long as headers or bodies may
 * take: this program's time would be over before. */
static void test_broken_off(void **state)
{
    static const char *const cases[] = {
        "GET", "GET /healthz HTTP/1.1\r\nHost: ", POST HOST "Content-Length: 50\r\n\r\n{"};
    struct daemon *daemon = *state;
    char answer[4096];
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
        assert_int_equal(ask(daemon, cases[i], true, answer, sizeof answer), CLOSED);
    assert_int_equal(
        ask(daemon, "GET /healthz HTTP/1.1\r\n" HOST "\r\n", true, answer, sizeof answer), 200);
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
        cmocka_unit_test(test_framing),
        cmocka_unit_test(test_good),
        cmocka_unit_test(test_no_request),
        cmocka_unit_test(test_broken_off),
    };
    return cmocka_run_group_tests(tests, setup, daemon_tear_down);
}
