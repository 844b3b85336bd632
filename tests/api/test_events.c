/* Event streams of a real daemon: their events, their ends, and a thousand at once. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <arpa/inet.h>
#include <cmocka.h>
#include <dirent.h>
#include <errno.h>
#include <netinet/in.h>
#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <unistd.h>

#include "process/limits.h"
#include "support/daemon.h"

enum { PHOTONS = 200000, MANY_PHOTONS = 100000000, PATIENCE_MS = 120000 };

struct stream {
    int fd;
    size_t size;
    bool ended;
    char text[1 << 16]; /* the latest part, NUL-terminated */
};

/* Uses HTTP/1.0, so that the body is sent unchanged until the connection closes. */
static void open_stream(const struct daemon *daemon, const char *job, const char *last_id,
                        struct stream *ret_stream)
{
    struct sockaddr_in address = {.sin_family = AF_INET};
    char request[512];
    memset(ret_stream, 0, sizeof *ret_stream);
    address.sin_port = htons((uint16_t)atoi(strrchr(daemon->url, ':') + 1));
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    ret_stream->fd = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
    assert_true(ret_stream->fd >= 0);
    if (connect(ret_stream->fd, (struct sockaddr *)&address, sizeof address) != 0)
        fail_msg("no connection: %s", strerror(errno));
    const int size =
        snprintf(request, sizeof request, "GET %s/events HTTP/1.0\r\n%s%s%s\r\n", job,
                 last_id ? "Last-Event-ID: " : "", last_id ? last_id : "", last_id ? "\r\n" : "");
    assert_int_equal(write(ret_stream->fd, request, (size_t)size), size);
}

static void close_stream(struct stream *stream)
{
    close(stream->fd);
}

/* Reads on until wanted has come, or, for NULL, to the end. */
static void read_until(struct stream *stream, const char *wanted)
{
    while (!stream->ended && !(wanted && strstr(stream->text, wanted))) {
        struct pollfd fd = {stream->fd, POLLIN, 0};
        assert_true(stream->size + 1 < sizeof stream->text);
        if (poll(&fd, 1, PATIENCE_MS) != 1)
            fail_msg("no '%s' after '%s'", wanted ? wanted : "end", stream->text);
        const ssize_t got =
            read(stream->fd, stream->text + stream->size, sizeof stream->text - 1 - stream->size);
        stream->ended = got <= 0;
        stream->size += got > 0 ? (size_t)got : 0;
        stream->text[stream->size] = '\0';
    }
    if (wanted && !strstr(stream->text, wanted))
        fail_msg("it ended without '%s': %s", wanted, stream->text);
}

/* Returns the value of the last id in the stream. */
static void last_id(const struct stream *stream, char ret_id[160])
{
    const char *last = NULL;
    for (const char *at = stream->text; (at = strstr(at, "\nid: ")); at++)
        last = at + 5;
    assert_non_null(last);
    snprintf(ret_id, 160, "%.*s", (int)strcspn(last, "\n"), last);
}

static void cancel(struct daemon *daemon, const char *job)
{
    struct reply reply;
    daemon_cancel(daemon, job, &reply);
    assert_int_equal(reply.status / 100, 2);
    reply_done(&reply);
}

/* ---- Events --------------------------------------------------------------------------------- */

/* Checks that each event is complete and in order, and that the stream ends with the job. Returns
 * the number of events. */
static int check_events(char *text)
{
    static const char *const states[] = {"queued", "running", "succeeded"};
    char *save = NULL, *body = strstr(text, "\r\n\r\n");
    double percent = 0;
    int state = 0, count = 0;
    assert_non_null(body);
    for (char *line = strtok_r(body, "\r\n", &save); line; line = strtok_r(NULL, "\n", &save)) {
        if (strcmp(line, ":") == 0)
            continue;
        assert_int_equal(strncmp(line, "id: ", 4), 0);
        assert_string_equal(strtok_r(NULL, "\n", &save), "event: status");
        const char *data = strtok_r(NULL, "\n", &save);
        assert_int_equal(strncmp(data, "data: ", 6), 0);
        json_t *doc = json_loads(data + 6, 0, NULL);
        assert_non_null(doc);
        const char *name = json_string_value(json_object_get(doc, "state"));
        while (state < 2 && strcmp(states[state], name) != 0)
            state++;
        assert_string_equal(name, states[state]);
        assert_non_null(json_object_get(doc, "stage"));
        assert_non_null(json_object_get(doc, "eta_s"));
        const double now = json_number_value(json_object_get(doc, "percent"));
        assert_true(now >= percent);
        percent = now;
        json_decref(doc);
        count++;
    }
    assert_int_equal(state, 2);
    assert_true(percent == 100);
    return count;
}

static void test_life_of_a_job(void **state)
{
    struct daemon_room *f = *state;
    struct stream *stream = calloc(1, sizeof *stream);
    char job[80], id[160];
    daemon_submit(&f->daemon, f->scene, PHOTONS, 1, "a", job);
    open_stream(&f->daemon, job, NULL, stream);
    read_until(stream, NULL);
    assert_non_null(strstr(stream->text, "Content-Type: text/event-stream\r\n"));
    assert_non_null(strstr(stream->text, "Cache-Control: no-store\r\n"));
    assert_non_null(strstr(stream->text, "X-Accel-Buffering: no\r\n"));
    last_id(stream, id);
    assert_true(check_events(stream->text) >= 2);
    close_stream(stream);

    /* Again from the start, from before the end, and from the end. */
    open_stream(&f->daemon, job, NULL, stream);
    read_until(stream, NULL);
    assert_int_equal(check_events(stream->text), 1);
    close_stream(stream);
    open_stream(&f->daemon, job, "running-1-render-800-0-0-0", stream);
    read_until(stream, NULL);
    assert_int_equal(check_events(stream->text), 1);
    close_stream(stream);
    open_stream(&f->daemon, job, id, stream);
    read_until(stream, NULL);
    assert_non_null(strstr(stream->text, " 204 "));
    close_stream(stream);
    free(stream);
}

/* A resumed stream of a waiting job sends nothing until its state changes. */
static void test_coming_back(void **state)
{
    struct daemon_room *f = *state;
    struct stream *stream = calloc(1, sizeof *stream);
    char running[80], waiting[80], id[160];
    daemon_submit(&f->daemon, f->scene, MANY_PHOTONS, 2, NULL, running);
    daemon_submit(&f->daemon, f->scene, PHOTONS, 2, NULL, waiting);
    daemon_wait_running(&f->daemon, running, -1);
    open_stream(&f->daemon, waiting, NULL, stream);
    read_until(stream, "\"queue_position\":1");
    last_id(stream, id);
    close_stream(stream);
    open_stream(&f->daemon, waiting, id, stream);
    read_until(stream, "\r\n\r\n");
    cancel(&f->daemon, waiting);
    read_until(stream, NULL);
    assert_null(strstr(stream->text, "\"queued\""));
    assert_non_null(strstr(stream->text, "\"state\":\"cancelled\""));
    close_stream(stream);
    open_stream(&f->daemon, running, NULL, stream);
    read_until(stream, "\"state\":\"running\"");
    cancel(&f->daemon, running);
    read_until(stream, NULL);
    assert_non_null(strstr(stream->text, "\"state\":\"cancelled\""));
    close_stream(stream);
    free(stream);
}

static void test_other_answers(void **state)
{
    struct daemon_room *f = *state;
    struct reply reply;
    char job[80], path[128];
    daemon_get(&f->daemon, "/v1/jobs/0123/events", &reply);
    assert_int_equal(reply.status, 404);
    reply_done(&reply);
    daemon_submit(&f->daemon, f->scene, MANY_PHOTONS, 2, NULL, job);
    snprintf(path, sizeof path, "%s/events", job);
    /* Uses one connection, where an extra byte would spoil the next answer. */
    for (int i = 0; i < 20; i++) {
        daemon_request(&f->daemon, "HEAD", path, NULL, NULL, 0, NULL, &reply);
        assert_int_equal(reply.status, 200);
        assert_string_equal(reply_header(&reply, "Content-Type"), "text/event-stream");
        reply_done(&reply);
    }
    cancel(&f->daemon, job);
    daemon_wait(&f->daemon, job, 10, &reply);
    reply_done(&reply);
}

/* A silent stream gets comments, here soon because of a short heartbeat. */
static void test_heartbeat(void **state)
{
    static const char *const extra[] = {"--idle-timeout", "1", NULL};
    struct stream *stream = calloc(1, sizeof *stream);
    struct daemon daemon;
    char scene[65], running[80], waiting[80];
    (void)state;
    daemon_start(&daemon, extra);
    daemon_upload_room(&daemon, scene);
    daemon_submit(&daemon, scene, MANY_PHOTONS, 2, NULL, running);
    daemon_submit(&daemon, scene, PHOTONS, 2, NULL, waiting);
    daemon_wait_running(&daemon, running, -1);
    open_stream(&daemon, waiting, NULL, stream);
    read_until(stream, "\n:\n\n:\n\n:\n\n");
    assert_non_null(strstr(stream->text, "\"queue_position\":1"));
    /* The daemon stops: the stream ends, and the job does not. */
    assert_int_equal(daemon_end(&daemon, 15), 0);
    read_until(stream, NULL);
    assert_null(strstr(stream->text, "cancelled"));
    close_stream(stream);
    daemon_remove(&daemon);
    free(stream);
}

/* ---- A thousand ----------------------------------------------------------------------------- */

static size_t count_threads(const struct daemon *daemon)
{
    char path[64];
    size_t count = 0;
    snprintf(path, sizeof path, "/proc/%d/task", (int)daemon->pid);
    DIR *folder = opendir(path);
    assert_non_null(folder);
    for (const struct dirent *entry; (entry = readdir(folder));)
        count += entry->d_name[0] != '.';
    closedir(folder);
    return count;
}

static long resident_kib(const struct daemon *daemon)
{
    char path[64], line[128];
    long kib = -1;
    snprintf(path, sizeof path, "/proc/%d/status", (int)daemon->pid);
    FILE *file = fopen(path, "r");
    assert_non_null(file);
    while (fgets(line, sizeof line, file))
        if (strncmp(line, "VmRSS:", 6) == 0)
            kib = atol(line + 6);
    fclose(file);
    return kib;
}

static void expect_refusal(const struct daemon *daemon, const char *job)
{
    struct stream *stream = calloc(1, sizeof *stream);
    open_stream(daemon, job, NULL, stream);
    read_until(stream, NULL);
    assert_non_null(strstr(stream->text, " 429 "));
    assert_non_null(strstr(stream->text, "Retry-After: "));
    close_stream(stream);
    free(stream);
}

static void print_polls(struct daemon *daemon, const char *job)
{
    enum { POLLS = 200 };
    double worst = 0, sum = 0;
    for (int i = 0; i < POLLS; i++) {
        struct reply reply;
        daemon_get(daemon, job, &reply);
        assert_int_equal(reply.status, 200);
        worst = reply.seconds > worst ? reply.seconds : worst;
        sum += reply.seconds;
        reply_done(&reply);
    }
    print_message("# polls beside %u streams: mean %.2f ms, worst %.2f ms\n", ORL_SERVER_STREAMS,
                  1000 * sum / POLLS, 1000 * worst);
}

/* All streams of one running job, without extra threads; the one beyond the limit is refused. */
static void test_a_thousand_streams(void **state)
{
    struct daemon_room *f = *state;
    struct stream *streams = calloc(ORL_SERVER_STREAMS, sizeof *streams);
    struct rlimit limit;
    char job[80];
    assert_non_null(streams);
    assert_int_equal(getrlimit(RLIMIT_NOFILE, &limit), 0);
    limit.rlim_cur = limit.rlim_max;
    setrlimit(RLIMIT_NOFILE, &limit);
    daemon_submit(&f->daemon, f->scene, MANY_PHOTONS, 3, NULL, job);
    daemon_wait_running(&f->daemon, job, 0);
    const size_t threads = count_threads(&f->daemon);
    const long before_kib = resident_kib(&f->daemon);
    for (unsigned i = 0; i < ORL_SERVER_STREAMS; i++)
        open_stream(&f->daemon, job, NULL, &streams[i]);
    for (unsigned i = 0; i < ORL_SERVER_STREAMS; i++)
        read_until(&streams[i], "\"state\":\"running\"");
    assert_int_equal(count_threads(&f->daemon), threads);
    print_message("# %u streams and the job's photons: %ld MiB more\n", ORL_SERVER_STREAMS,
                  (resident_kib(&f->daemon) - before_kib) >> 10);
    expect_refusal(&f->daemon, job);
    print_polls(&f->daemon, job);
    /* Half of them hang up; the others receive the end. */
    for (unsigned i = 0; i < ORL_SERVER_STREAMS / 2; i++)
        close_stream(&streams[i]);
    cancel(&f->daemon, job);
    for (unsigned i = ORL_SERVER_STREAMS / 2; i < ORL_SERVER_STREAMS; i++) {
        read_until(&streams[i], NULL);
        assert_non_null(strstr(streams[i].text, "\"state\":\"cancelled\""));
        close_stream(&streams[i]);
    }
    free(streams);
    /* A new stream is accepted again. */
    struct stream *stream = calloc(1, sizeof *stream);
    open_stream(&f->daemon, job, NULL, stream);
    read_until(stream, "\"state\":\"cancelled\"");
    close_stream(stream);
    free(stream);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_life_of_a_job),      cmocka_unit_test(test_coming_back),
        cmocka_unit_test(test_other_answers),      cmocka_unit_test(test_heartbeat),
        cmocka_unit_test(test_a_thousand_streams),
    };
    return cmocka_run_group_tests(tests, daemon_room_set_up, daemon_room_tear_down);
}
