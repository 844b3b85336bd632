/* A request has at most one pending operation; a handler that starts a second one gets a 500. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <netinet/in.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include "http/context.h"
#include "http/http_server.h"
#include "http/response/reply.h"
#include "support/http_wire.h"

/* ---- A server with one route, in a child process --------------------------------------------- */

static void work_first(struct orl_request *request)
{
    (void)request;
    usleep(20000); /* the second operation starts while this one is on the pool */
}

static void end_first(struct orl_request *request)
{
    orl_reply_text(request, "text/plain", "first");
}

static void run_second(struct orl_request *request)
{
    (void)request;
    _exit(3);
}

static void handle_once(struct orl_request *request)
{
    orl_request_work(request, work_first, end_first);
}

static void handle_twice(struct orl_request *request)
{
    orl_request_work(request, work_first, end_first);
    orl_request_work(request, run_second, run_second);
}

static struct orl_http_server *http;

static void on_served(struct orl_server *server)
{
    (void)server;
}

static void on_worked(struct orl_server *server)
{
    (void)server;
    orl_http_kick(http);
}

static void on_swept(struct orl_server *server)
{
    (void)server;
}

static struct orl_quota *find_upload_quota(struct orl_server *server)
{
    static struct orl_quota upload_quota;
    (void)server;
    return &upload_quota;
}

static uint64_t budget_bytes(const struct orl_server *server)
{
    (void)server;
    return 1 << 20;
}

static void serve(int out)
{
    static const struct orl_route table[] = {
        {.method = "GET", .path = "/once", .handler = handle_once},
        {.method = "GET", .path = "/twice", .handler = handle_twice},
    };
    static const struct orl_routes routes = {table, 2};
    static const struct orl_http_calls calls = {.upload_quota = find_upload_quota,
                                                .budget = budget_bytes,
                                                .work_done = on_worked,
                                                .on_tick = on_swept,
                                                .on_served = on_served};
    static const struct orl_config config = {.idle_timeout_s = 60, .address_connections = 8};
    static const struct orl_log log;
    static const struct orl_folders folders;
    static struct orl_metrics metrics;
    struct orl_http_context context = {.calls = &calls,
                                       .loop = uv_default_loop(),
                                       .config = &config,
                                       .routes = &routes,
                                       .log = &log,
                                       .folders = &folders,
                                       .metrics = &metrics};
    struct sockaddr_in address = {.sin_family = AF_INET, .sin_addr = {htonl(INADDR_LOOPBACK)}};
    struct sockaddr_storage bound;
    struct orl_error err;
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    signal(SIGSEGV, SIG_DFL); /* cmocka's handler would continue with the tests */
    if (orl_http_start(&context, (struct sockaddr *)&address, &http, &err))
        _exit(4);
    orl_http_address(http, &bound);
    const unsigned port = ntohs(((struct sockaddr_in *)&bound)->sin_port);
    if (write(out, &port, sizeof port) != sizeof port)
        _exit(5);
    uv_run(context.loop, UV_RUN_DEFAULT);
    _exit(6);
}

static int start_server(void **state)
{
    struct daemon *server = calloc(1, sizeof *server);
    int fds[2];
    unsigned port = 0;
    *state = server;
    if (pipe(fds) != 0)
        return -1;
    server->pid = fork();
    if (server->pid == 0)
        serve(fds[1]);
    close(fds[1]);
    const ssize_t n = read(fds[0], &port, sizeof port);
    close(fds[0]);
    snprintf(server->url, sizeof server->url, "http://127.0.0.1:%u", port);
    return n == sizeof port ? 0 : -1;
}

static int stop_server(void **state)
{
    struct daemon *server = *state;
    kill(server->pid, SIGKILL);
    waitpid(server->pid, NULL, 0);
    free(server);
    return 0;
}

static void send_request(const struct daemon *server, const char *line, struct reply *ret_reply)
{
    char host[64];
    snprintf(host, sizeof host, "Host: localhost:%s\r\n", strrchr(server->url, ':') + 1);
    http_wire_ask(server, line, host, NULL, ret_reply);
}

/* ---- Tests ----------------------------------------------------------------------------------- */

static void test_one_operation_replies(void **state)
{
    struct reply reply;
    send_request(*state, "GET /once", &reply);
    assert_int_equal(reply.status, 200);
    assert_string_equal(reply.body, "first");
    reply_done(&reply);
}

#ifdef ORL_DEBUG
static void test_second_operation_aborts(void **state)
{
    struct daemon *server = *state;
    int status = 0;
    const int fd = daemon_dial(server);
    assert_true(write(fd, "GET /twice HTTP/1.1\r\nHost: localhost\r\n\r\n", 40) == 40);
    waitpid(server->pid, &status, 0);
    close(fd);
    assert_true(WIFSIGNALED(status) && WTERMSIG(status) == SIGABRT);
}
#else
/* The first operation ends, the second never runs, and the server stays up. */
static void test_second_operation_is_a_500(void **state)
{
    struct reply reply;
    send_request(*state, "GET /twice", &reply);
    assert_int_equal(reply.status, 500);
    reply_done(&reply);
    send_request(*state, "GET /once", &reply);
    assert_int_equal(reply.status, 200);
    reply_done(&reply);
}
#endif

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(test_one_operation_replies, start_server, stop_server),
#ifdef ORL_DEBUG
        cmocka_unit_test_setup_teardown(test_second_operation_aborts, start_server, stop_server),
#else
        cmocka_unit_test_setup_teardown(test_second_operation_is_a_500, start_server, stop_server),
#endif
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
