/* Clients that hold connections do not affect others, and are cut off in the end. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <errno.h>
#include <poll.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include "support/daemon.h"
#include "support/daemon_metric.h"
#include "support/patience.h"

enum { SLOW = 200, POLLS = 200 };

static void say(int fd, const char *text)
{
    (void)!send(fd, text, strlen(text), MSG_NOSIGNAL | MSG_DONTWAIT);
}

/* Returns true if the peer has closed; reads and drops its data before. */
static bool is_closed(int fd)
{
    char dropped[4096];
    ssize_t n;
    while ((n = recv(fd, dropped, sizeof dropped, MSG_DONTWAIT)) > 0)
        continue;
    return n == 0 || (errno != EAGAIN && errno != EWOULDBLOCK);
}

/* Silent, or stalled in the middle of the headers, or of the body. */
static const char *const beginnings[] = {
    "", "GET /healthz HTTP/1.1\r\nHost: localhost\r\nX-Slow: ",
    "POST /v1/bsdfs HTTP/1.1\r\nHost: localhost\r\nContent-Length: 100000\r\n\r\n<"};
enum { KINDS = 3 };

/* Sends a byte on each slow connection that is not silent; returns the number still open. */
static size_t trickle(const int fds[SLOW])
{
    size_t open = 0;
    for (size_t i = 0; i < SLOW; i++) {
        if (is_closed(fds[i]))
            continue;
        open++;
        if (i % KINDS > 0)
            say(fds[i], "x");
    }
    return open;
}

static int by_value(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static void print_polls(struct daemon *daemon, const char *what)
{
    double ms[POLLS];
    for (int i = 0; i < POLLS; i++) {
        struct reply reply;
        daemon_get(daemon, "/healthz", &reply);
        assert_int_equal(reply.status, 200);
        ms[i] = 1000 * reply.seconds;
        reply_done(&reply);
    }
    qsort(ms, POLLS, sizeof *ms, by_value);
    print_message("# %d polls %s: median %.2f ms, p99 %.2f ms\n", POLLS, what, ms[POLLS / 2],
                  ms[POLLS * 99 / 100 - 1]);
}

/*
 * Slow clients outlast the idle timeout with a byte now and then, but not the daemon's total limit.
 */
static void test_slow_clients(void **state)
{
    const struct timespec moment = {0, 250000000};
    struct daemon daemon;
    const char *const extra[] = {"--idle-timeout", "2", NULL};
    int fds[SLOW];
    size_t open = SLOW;
    (void)state;
    daemon_start(&daemon, extra);
    print_polls(&daemon, "before any slow client");
    for (size_t i = 0; i < SLOW; i++) {
        fds[i] = daemon_dial(&daemon);
        say(fds[i], beginnings[i % KINDS]);
    }
    print_polls(&daemon, "beside 200 slow clients");
    assert_true(trickle(fds) > 0);
    for (double until = patience_until(); open > 0 && patience_nap(until);) {
        nanosleep(&moment, NULL); /* a byte now and then */
        open = trickle(fds);
    }
    assert_int_equal(open, 0);
    for (size_t i = 0; i < SLOW; i++)
        close(fds[i]);
    print_polls(&daemon, "after them");
    daemon_remove(&daemon);
}

/* A client that is slow within the limits gets its answer. */
static void test_patience(void **state)
{
    const struct timespec moment = {0, 200000000};
    static const char *const parts[] = {
        "GET /health", "z HTTP/1.1\r\nHost: ", "localhost\r\nConnection: close\r\n", "\r\n"};
    struct daemon daemon;
    char text[1000];
    (void)state;
    daemon_start(&daemon, NULL);
    const int fd = daemon_dial(&daemon);
    for (size_t i = 0; i < sizeof parts / sizeof *parts; i++) {
        say(fd, parts[i]);
        nanosleep(&moment, NULL);
    }
    const ssize_t n = recv(fd, text, sizeof text - 1, 0);
    assert_true(n > 0);
    text[n] = '\0';
    assert_non_null(strstr(text, "200 OK"));
    close(fd);
    daemon_remove(&daemon);
}

/* Expects answers to requests that use the pool, and so need the loop to handle its results. If
 * others starve the loop none is answered; the limit detects that. */
static void expect_posts_answered(struct daemon *daemon)
{
    enum { POSTS = 20 };
    double longest_s = 0;
    for (int i = 0; i < POSTS; i++) {
        struct reply reply;
        daemon_request(daemon, "POST", "/v1/bsdfs", "application/xml", "<x/>", 4, NULL, &reply);
        assert_int_equal(reply.status, 400);
        longest_s = reply.seconds > longest_s ? reply.seconds : longest_s;
        reply_done(&reply);
    }
    print_message("# %d POSTs, the longest of %.2f s\n", POSTS, longest_s);
    assert_true(longest_s < 60);
}

/* A chunk's first line longer than the daemon's buffer, complete or not: the loop continues, and
 * the connections are cut off although they are not silent. */
static void test_endless_chunk_lines(void **state)
{
    enum { LINES = 4 };
    static const size_t lengths[LINES] = {32600, 33000, 100000, 100000};
    static const char head[] = "GET /healthz HTTP/1.1\r\nHost: localhost\r\n"
                               "Transfer-Encoding: chunked\r\n\r\n1;";
    const char *const patient[] = {"--idle-timeout", "3600", NULL};
    static char line[100000];
    struct daemon daemon;
    int fds[LINES], open = LINES;
    (void)state;
    memset(line, 'x', sizeof line);
    daemon_start(&daemon, patient);
    for (int i = 0; i < LINES; i++) {
        fds[i] = daemon_dial(&daemon);
        say(fds[i], head);
        (void)!send(fds[i], line, lengths[i], MSG_NOSIGNAL | MSG_DONTWAIT);
    }
    expect_posts_answered(&daemon);
    for (double until = patience_until(); open > 0 && patience_nap(until);) {
        open = 0;
        for (int i = 0; i < LINES; i++)
            open += !is_closed(fds[i]);
    }
    assert_int_equal(open, 0);
    for (int i = 0; i < LINES; i++)
        close(fds[i]);
    daemon_remove(&daemon);
}

/* Until all are cut off, the loop would only read them again, so they are closed at once, not by
 * three sweeps. */
static void test_endless_chunk_lines_go_at_once(void **state)
{
    enum { TIMES = 5, ROUNDS = 2000 };
    static const char head[] = "GET /healthz HTTP/1.1\r\nHost: localhost\r\n"
                               "Transfer-Encoding: chunked\r\n\r\n1;";
    const struct timespec moment = {0, 10000000};
    const char *const patient[] = {"--idle-timeout", "3600", NULL};
    static char line[100000];
    struct daemon daemon;
    int soonest = ROUNDS;
    (void)state;
    memset(line, 'x', sizeof line);
    daemon_start(&daemon, patient);
    for (int i = 0; i < TIMES; i++) {
        const int fd = daemon_dial(&daemon);
        int round = 0;
        say(fd, head);
        (void)!send(fd, line, sizeof line, MSG_NOSIGNAL | MSG_DONTWAIT);
        for (; round < ROUNDS && !is_closed(fd); round++)
            nanosleep(&moment, NULL);
        soonest = round < soonest ? round : soonest;
        close(fd);
    }
    if (soonest > 190) /* three sweeps take at least two seconds */
        fail_msg("the soonest was cut off after %d ms", 10 * soonest);
    daemon_remove(&daemon);
}

/* Floods the daemon with requests on that many connections, as fast as they are answered, until the
 * process is killed. */
static void flood(const struct daemon *daemon)
{
    enum { CONNECTIONS = 16, AT_ONCE = 64 };
    static const char get[] = "GET /healthz HTTP/1.1\r\nHost: localhost\r\n\r\n";
    static char gets[AT_ONCE * sizeof get];
    struct pollfd fds[CONNECTIONS];
    size_t length = 0;
    for (int i = 0; i < AT_ONCE; i++)
        length += (size_t)sprintf(gets + length, "%s", get);
    for (int i = 0; i < CONNECTIONS; i++)
        fds[i] = (struct pollfd){.fd = daemon_dial(daemon), .events = POLLIN | POLLOUT};
    while (poll(fds, CONNECTIONS, -1) > 0)
        for (int i = 0; i < CONNECTIONS; i++) {
            (void)is_closed(fds[i].fd); /* reads the available bytes */
            (void)!send(fds[i].fd, gets, length, MSG_NOSIGNAL | MSG_DONTWAIT);
        }
}

static void test_floods_leave_turns_to_others(void **state)
{
    enum { FLOOD = 2000 };
    static const char answered[] = "oriel_http_request_seconds_count{method=\"GET\","
                                   "route=\"/healthz\",class=\"2xx\"}";
    struct daemon daemon;
    struct reply reply;
    (void)state;
    daemon_start(&daemon, NULL);
    daemon_get(&daemon, "/healthz", &reply); /* the first counted one */
    reply_done(&reply);
    const pid_t pid = fork();
    assert_true(pid >= 0);
    if (pid == 0) {
        flood(&daemon);
        _exit(0);
    }
    daemon_metric_wait(&daemon, answered, FLOOD);
    const double before = daemon_metric(&daemon, answered);
    expect_posts_answered(&daemon);
    assert_true(daemon_metric(&daemon, answered) > before); /* the flood continued meanwhile */
    kill(pid, SIGKILL);
    waitpid(pid, NULL, 0);
    daemon_remove(&daemon);
}

static void test_headers_are_bounded(void **state)
{
    enum { HEADER = 200000 };
    struct daemon daemon;
    struct reply reply;
    char *header = malloc(HEADER);
    (void)state;
    assert_non_null(header);
    memset(header, 'x', HEADER);
    memcpy(header, "X-Long: ", 8);
    header[HEADER - 1] = '\0';
    daemon_start(&daemon, NULL);
    daemon_request(&daemon, "GET", "/healthz", NULL, NULL, 0, header, &reply);
    assert_int_equal(reply.status, 431);
    reply_done(&reply);
    free(header);
    daemon_remove(&daemon);
}

/*
 * Returns true if a new connection's request is answered; a connection above the limit is closed.
 */
static bool is_served(const struct daemon *daemon)
{
    const int fd = daemon_dial(daemon);
    char first;
    say(fd, "GET /healthz HTTP/1.1\r\nHost: localhost\r\n\r\n");
    const bool served = recv(fd, &first, 1, 0) == 1;
    close(fd);
    return served;
}

static void test_one_address_has_its_share(void **state)
{
    enum { SHARE = 3 };
    struct daemon daemon;
    const char *const extra[] = {"--address-connections", "3", NULL};
    int fds[SHARE];
    struct reply reply;
    (void)state;
    daemon_start(&daemon, extra);
    for (int i = 0; i < SHARE; i++)
        fds[i] = daemon_dial(&daemon);
    const int more = daemon_dial(&daemon);
    struct pollfd wait = {.fd = more, .events = POLLIN};
    assert_int_equal(poll(&wait, 1, 120000), 1);
    assert_true(is_closed(more));
    close(more);
    for (int i = 0; i < SHARE; i++) {
        assert_false(is_closed(fds[i]));
        close(fds[i]);
    }
    /* A new connection is accepted as soon as the daemon has noticed the closed ones. */
    bool has_room = false;
    for (double until = patience_until(); !has_room && patience_nap(until);)
        has_room = is_served(&daemon);
    assert_true(has_room);
    daemon_get(&daemon, "/healthz", &reply);
    assert_int_equal(reply.status, 200);
    reply_done(&reply);
    daemon_remove(&daemon);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_slow_clients),
        cmocka_unit_test(test_patience),
        cmocka_unit_test(test_endless_chunk_lines),
        cmocka_unit_test(test_endless_chunk_lines_go_at_once),
        cmocka_unit_test(test_floods_leave_turns_to_others),
        cmocka_unit_test(test_headers_are_bounded),
        cmocka_unit_test(test_one_address_has_its_share),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
