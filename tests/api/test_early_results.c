/*
 * Clients fetch a job's result at the moment in which its events report its end.
 *
 * The job's last row may not be on disk yet and its files not verified yet, so that the daemon has
 * two reasons to wait at once. Clients also hang up at random, and delete jobs while they fetch.
 * $ORIEL_EARLY_JOBS sets the number of jobs (200).
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <sys/wait.h>
#include <unistd.h>

#include "support/daemon.h"

enum { CLIENTS = 8, REPLY_MAX = 1 << 16 };

/* ---- A client: a separate process, so that it shares nothing with the test ------------------- */

struct client {
    const struct daemon *daemon;
    const char *scene;
    uint64_t random;
    char reply[REPLY_MAX];
};

static unsigned random_below(struct client *client, unsigned n)
{
    client->random = client->random * 6364136223846793005u + 1442695040888963407u;
    return (unsigned)(client->random >> 33) % n;
}

static void give_up(struct client *client, const char *what)
{
    fprintf(stderr, "# %s: %.300s\n", what, client->reply);
    _exit(1);
}

static int open_connection(const struct client *client)
{
    const struct timeval patience = {.tv_sec = 120};
    const int fd = daemon_dial(client->daemon);
    setsockopt(fd, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
    return fd;
}

static int send_request(struct client *client, const char *method, const char *path,
                        const char *body)
{
    char text[2048];
    const int fd = open_connection(client);
    const int length =
        snprintf(text, sizeof text,
                 "%s %s HTTP/1.1\r\nHost: localhost:%s\r\nConnection: close\r\n"
                 "Content-Type: application/json\r\nContent-Length: %zu\r\n\r\n%s",
                 method, path, strrchr(client->daemon->url, ':') + 1, strlen(body), body);
    client->reply[0] = '\0';
    if (send(fd, text, (size_t)length, MSG_NOSIGNAL) != length)
        give_up(client, "the daemon takes no request");
    return fd;
}

/* Reads until the text has come (true) or the connection ends; NULL: to the end. */
static bool receive_until(struct client *client, int fd, const char *text)
{
    size_t used = 0;
    ssize_t n;
    while (used + 1 < REPLY_MAX && (n = read(fd, client->reply + used, REPLY_MAX - 1 - used)) > 0) {
        used += (size_t)n;
        client->reply[used] = '\0';
        if (text && strstr(client->reply, text))
            return true;
    }
    return false;
}

/* Closes the connection, half of the time with a reset. */
static void hang_up(struct client *client, int fd)
{
    const struct linger reset = {.l_onoff = (int)random_below(client, 2)};
    setsockopt(fd, SOL_SOCKET, SO_LINGER, &reset, sizeof reset);
    close(fd);
}

static void submit(struct client *client, char ret_path[96])
{
    char document[512];
    snprintf(document, sizeof document,
             "{\"kind\":\"render\",\"scene\":\"%s\",\"sensors\":[[2,2,0.8,0,0,1]],"
             "\"technique\":\"backward\",\"gather_samples\":8,\"seed\":%u}",
             client->scene, 1 + random_below(client, 1u << 30));
    const int fd = send_request(client, "POST", "/v1/jobs", document);
    receive_until(client, fd, NULL);
    close(fd);
    const char *id = strstr(client->reply, "\"id\":\"");
    if (strncmp(client->reply, "HTTP/1.1 202", 12) != 0 || !id)
        give_up(client, "a job was refused");
    snprintf(ret_path, 96, "/v1/jobs/%.*s", (int)strcspn(id + 6, "\""), id + 6);
}

static void await_success(struct client *client, const char *job)
{
    char path[128];
    snprintf(path, sizeof path, "%s/events", job);
    const int fd = send_request(client, "GET", path, "");
    if (!receive_until(client, fd, "\"succeeded\""))
        give_up(client, "the events do not say that the job has succeeded");
    hang_up(client, fd);
}

/* Fetches at once; one in four hangs up without reading, and one in eight deletes meanwhile. */
static void fetch(struct client *client, const char *job)
{
    static const char *const names[] = {"result", "files/result.json"};
    char path[128];
    snprintf(path, sizeof path, "%s/%s", job, names[random_below(client, 2)]);
    const int fd = send_request(client, random_below(client, 8) > 0 ? "GET" : "HEAD", path, "");
    const unsigned course = random_below(client, 8);
    if (course < 2) {
        hang_up(client, fd);
        return;
    }
    if (course == 2) {
        const int other = send_request(client, "DELETE", job, "");
        if (!receive_until(client, other, "HTTP/1.1 204"))
            give_up(client, "the job was not deleted");
        close(other);
    }
    receive_until(client, fd, NULL);
    close(fd);
    const bool found = strncmp(client->reply, "HTTP/1.1 200", 12) == 0;
    const bool gone = course == 2 && strncmp(client->reply, "HTTP/1.1 404", 12) == 0;
    if (!found && !gone)
        give_up(client, "no result");
}

static void run_client(const struct daemon *daemon, const char *scene, unsigned number, int jobs)
{
    static struct client client;
    client.daemon = daemon;
    client.scene = scene;
    client.random = 77 + number;
    for (int i = 0; i < jobs; i++) {
        char job[96];
        submit(&client, job);
        await_success(&client, job);
        fetch(&client, job);
    }
    _exit(0);
}

/* ---- The test -------------------------------------------------------------------------------- */

static int count_jobs(void)
{
    const char *text = getenv("ORIEL_EARLY_JOBS");
    return text ? atoi(text) : 200;
}

static void test_daemon_survives_early_fetches(void **state)
{
    struct daemon_room *f = *state;
    const int jobs = count_jobs();
    pid_t clients[CLIENTS];
    for (int i = 0; i < CLIENTS; i++) {
        clients[i] = fork();
        assert_true(clients[i] >= 0);
        if (clients[i] == 0)
            run_client(&f->daemon, f->scene, (unsigned)i, (jobs + i) / CLIENTS);
    }
    int failed = 0;
    for (int i = 0; i < CLIENTS; i++) {
        int status = -1;
        waitpid(clients[i], &status, 0);
        failed += status != 0;
    }
    assert_int_equal(failed, 0);
    struct reply reply;
    daemon_get(&f->daemon, "/healthz", &reply);
    assert_int_equal(reply.status, 200);
    reply_done(&reply);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(test_daemon_survives_early_fetches, daemon_room_set_up,
                                        daemon_room_tear_down),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
