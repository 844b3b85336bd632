/* The event stream of all jobs: its events, filters, resumption, and slow readers. */
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
#include <time.h>
#include <unistd.h>

#include "process/limits.h"
#include "support/daemon.h"

enum { PATIENCE_MS = 120000, MANY_PHOTONS = 100000000 };

struct stream {
    int fd;
    size_t size;
    bool ended;
    char text[1 << 22]; /* the whole stream, NUL-terminated */
};

/* Uses HTTP/1.0, so that the body is sent unchanged until the connection closes. */
static void open_stream(const struct daemon *daemon, const char *query, const char *last_id,
                        struct stream *ret_stream)
{
    char request[600];
    memset(ret_stream, 0, sizeof *ret_stream);
    ret_stream->fd = daemon_dial(daemon);
    const int size =
        snprintf(request, sizeof request, "GET /v1/events%s HTTP/1.0\r\n%s%s%s\r\n", query,
                 last_id ? "Last-Event-ID: " : "", last_id ? last_id : "", last_id ? "\r\n" : "");
    assert_int_equal(write(ret_stream->fd, request, (size_t)size), size);
}

/* Reads more; returns false if nothing came in that time, or the stream has ended. */
static bool read_more(struct stream *stream, int patience_ms)
{
    struct pollfd fd = {stream->fd, POLLIN, 0};
    assert_true(stream->size + 1 < sizeof stream->text);
    if (stream->ended || poll(&fd, 1, patience_ms) != 1)
        return false;
    const ssize_t got =
        read(stream->fd, stream->text + stream->size, sizeof stream->text - 1 - stream->size);
    stream->ended = got <= 0;
    stream->size += got > 0 ? (size_t)got : 0;
    stream->text[stream->size] = '\0';
    return true;
}

static void until(struct stream *stream, const char *wanted)
{
    while (!strstr(stream->text, wanted))
        if (!read_more(stream, PATIENCE_MS))
            fail_msg("no '%s' after '%s'", wanted, stream->text);
}

static void until_end(struct stream *stream)
{
    while (!stream->ended)
        if (!read_more(stream, PATIENCE_MS))
            fail_msg("no end after %zu bytes", stream->size);
}

/* Returns the last event's id. */
static void last_id(const struct stream *stream, char ret_id[60])
{
    const char *last = NULL;
    for (const char *at = stream->text; (at = strstr(at, "\nid: ")); at++)
        last = at + 5;
    assert_non_null(last);
    snprintf(ret_id, 60, "%.*s", (int)strcspn(last, "\n"), last);
}

static int count_occurrences(const char *text, const char *part)
{
    int found = 0;
    for (; (text = strstr(text, part)); text++)
        found++;
    return found;
}

/* Submits a small job with those members. */
static void submit(struct daemon_room *room, const char *members, int seed, char ret_id[40])
{
    char text[1200];
    struct reply reply;
    snprintf(text, sizeof text,
             "{\"scene\":\"%s\",\"technique\":\"backward\",%s\"seed\":%d,"
             "\"sensors\":[[2,1,0.8,0,0,1]]%s%s}",
             room->scene, strstr(members, "accuracy") ? "" : "\"gather_samples\":4,", seed,
             *members ? "," : "", members);
    daemon_post_json(&room->daemon, "/v1/jobs", text, &reply);
    assert_int_equal(reply.status, 202);
    snprintf(ret_id, 40, "%s", reply_text(&reply, "id"));
    reply_done(&reply);
}

static void wait_for_end(struct daemon_room *room, const char *id)
{
    char path[80];
    struct reply reply;
    snprintf(path, sizeof path, "/v1/jobs/%.32s", id);
    daemon_wait(&room->daemon, path, 30, &reply);
    reply_done(&reply);
}

static void removed(struct daemon_room *room, const char *id)
{
    char path[80];
    struct reply reply;
    snprintf(path, sizeof path, "/v1/jobs/%.32s", id);
    daemon_request(&room->daemon, "DELETE", path, NULL, NULL, 0, NULL, &reply);
    assert_int_equal(reply.status, 204);
    reply_done(&reply);
}

/* The stream has all states of a job: new, running, cancelling, cancelled, removed. */
static void test_a_life(void **state)
{
    static struct stream stream;
    struct daemon_room *room = *state;
    struct reply reply;
    char path[80], wanted[120], id[40];
    open_stream(&room->daemon, "", NULL, &stream);
    until(&stream, "event: reset\ndata: {}\n\n");
    assert_non_null(strstr(stream.text, "Content-Type: text/event-stream"));
    assert_non_null(strstr(stream.text, "X-Accel-Buffering: no"));
    daemon_submit(&room->daemon, room->scene, MANY_PHOTONS, 1, NULL, path);
    snprintf(id, sizeof id, "%.32s", path + strlen("/v1/jobs/"));
    until(&stream, "\"state\":\"running\"");
    until(&stream, "\"stage\":\"photons\""); /* progress without a change of state */
    daemon_cancel(&room->daemon, path, &reply);
    reply_done(&reply);
    until(&stream, "\"state\":\"cancelling\"");
    until(&stream, "\"state\":\"cancelled\"");
    removed(room, id);
    snprintf(wanted, sizeof wanted, "event: removed\ndata: {\"id\":\"%s\"}\n\n", id);
    until(&stream, wanted);
    assert_true(strstr(stream.text, "\"state\":\"running\"") <
                strstr(stream.text, "\"state\":\"cancelling\""));
    assert_true(strstr(stream.text, "\"state\":\"cancelling\"") <
                strstr(stream.text, "\"state\":\"cancelled\""));
    close(stream.fd);
}

static void test_filters(void **state)
{
    static struct stream all, tagged, one;
    struct daemon_room *room = *state;
    char ids[3][40], query[100];
    open_stream(&room->daemon, "", NULL, &all);
    open_stream(&room->daemon, "?tag=x%20y&tag=z", NULL, &tagged);
    until(&all, "event: reset");
    until(&tagged, "event: reset");
    submit(room, "\"name\":\"a\",\"tags\":[\"x y\",\"z\"]", 1, ids[0]);
    submit(room, "\"name\":\"b\",\"tags\":[\"x y\"]", 2, ids[1]);
    snprintf(query, sizeof query, "?job=%.8s&job=0000", ids[1]);
    open_stream(&room->daemon, query, NULL, &one);
    until(&one, "event: reset");
    submit(room, "\"name\":\"c\"", 3, ids[2]);
    for (int i = 0; i < 3; i++)
        wait_for_end(room, ids[i]);
    for (int i = 0; i < 3; i++)
        removed(room, ids[i]);
    until(&all, "event: removed");
    while (count_occurrences(all.text, "event: removed") < 3)
        assert_true(read_more(&all, PATIENCE_MS));
    until(&tagged, "event: removed");
    until(&one, "event: removed");
    assert_non_null(strstr(tagged.text, ids[0]));
    assert_null(strstr(tagged.text, ids[1]));
    assert_null(strstr(tagged.text, ids[2]));
    assert_null(strstr(one.text, ids[0]));
    assert_non_null(strstr(one.text, ids[1]));
    assert_null(strstr(one.text, ids[2]));
    for (int i = 0; i < 3; i++)
        assert_non_null(strstr(all.text, ids[i]));
    close(all.fd);
    close(tagged.fd);
    close(one.fd);
}

/*
 * A resumed stream continues after the last event seen, with each job's latest event, none twice.
 */
static void test_goes_on(void **state)
{
    static struct stream stream;
    struct daemon_room *room = *state;
    char first[40], second[40], id[60], later[60];
    open_stream(&room->daemon, "", NULL, &stream);
    until(&stream, "event: reset");
    submit(room, "", 1, first);
    until(&stream, "\"state\":\"succeeded\"");
    last_id(&stream, id);
    close(stream.fd);
    submit(room, "", 2, second);
    wait_for_end(room, second);
    open_stream(&room->daemon, "", id, &stream);
    until(&stream, second);
    until(&stream, "\"state\":\"succeeded\"");
    assert_null(strstr(stream.text, "reset"));
    assert_null(strstr(stream.text, first));
    assert_int_equal(count_occurrences(stream.text, "event: job"), 1);
    last_id(&stream, later);
    close(stream.fd);
    /* Without news no event comes. */
    open_stream(&room->daemon, "", later, &stream);
    while (!strstr(stream.text, "\r\n\r\n"))
        assert_true(read_more(&stream, PATIENCE_MS));
    read_more(&stream, 600);
    assert_null(strstr(stream.text, "event: "));
    close(stream.fd);
    /* Ids that this daemon has not issued. */
    static const char *const strange[] = {"x", "0123456789abcdef-1", "-", "0-0"};
    char changed[80];
    for (size_t i = 0; i < 4; i++) {
        open_stream(&room->daemon, "", strange[i], &stream);
        until(&stream, "event: reset");
        close(stream.fd);
    }
    snprintf(changed, sizeof changed, "%s999999", later); /* an id in the future */
    open_stream(&room->daemon, "", changed, &stream);
    until(&stream, "event: reset");
    close(stream.fd);
    /* A restarted daemon has no events of before. */
    assert_int_equal(daemon_end(&room->daemon, SIGTERM), 0);
    daemon_restart(&room->daemon, NULL);
    open_stream(&room->daemon, "", later, &stream);
    until(&stream, "event: reset");
    close(stream.fd);
}

/* The stream ends when the daemon ends. */
static void test_ends_with_the_daemon(void **state)
{
    static struct stream stream;
    struct daemon_room *room = *state;
    open_stream(&room->daemon, "", NULL, &stream);
    until(&stream, "event: reset");
    assert_int_equal(daemon_end(&room->daemon, SIGTERM), 0);
    until_end(&stream);
    daemon_restart(&room->daemon, NULL);
}

/*
 * More jobs start and end than the daemon keeps events of, while one reader does not read. It is
 * cut off or catches up, others receive all events meanwhile, and its last id is no longer known.
 */
static void test_slow_reader(void **state)
{
    static struct stream slow, quick;
    struct daemon_room *room = *state;
    char id[40], seen[60], name[600];
    struct reply reply;
    char blocker[80];
    submit(room, "\"accuracy\":{\"deadline_s\":600}", 1, id); /* a job without a growing map */
    snprintf(blocker, sizeof blocker, "/v1/jobs/%.32s", id);
    daemon_wait_running(&room->daemon, blocker, -1);
    open_stream(&room->daemon, "", NULL, &quick);
    until(&quick, "event: reset");
    last_id(&quick, seen);
    open_stream(&room->daemon, "", NULL, &slow);
    until(&slow, "event: reset");
    /* Long names, so that few events reach the limit. */
    size_t at = (size_t)snprintf(name, sizeof name, "\"name\":\"");
    for (int i = 0; i < 100; i++)
        at += (size_t)snprintf(name + at, sizeof name - at, "\xf0\x9f\x8c\x9e");
    snprintf(name + at, sizeof name - at, "\"");
    for (int i = 0; i < (int)ORL_SERVER_BROKER_EVENTS + 100; i++) {
        char path[100];
        submit(room, name, i, id);
        snprintf(path, sizeof path, "/v1/jobs/%.32s", id);
        daemon_cancel(&room->daemon, path, &reply);
        reply_done(&reply);
        quick.size = 0; /* reads on, and drops the text */
        while (read_more(&quick, 0) && quick.size + (1 << 16) < sizeof quick.text)
            continue;
    }
    assert_false(quick.ended);
    quick.size = 0;
    quick.text[0] = '\0';
    submit(room, "\"name\":\"last\"", 1, id);
    until(&quick, id);
    /* The sockets' buffers still arrive; then the end, unless the buffers held everything. */
    while (!slow.ended && !strstr(slow.text, id))
        assert_true(read_more(&slow, PATIENCE_MS));
    close(slow.fd);
    open_stream(&room->daemon, "", seen, &slow); /* resumes at an id that has been dropped */
    until(&slow, "event: reset");
    close(slow.fd);
    close(quick.fd);
    daemon_cancel(&room->daemon, blocker, &reply);
    reply_done(&reply);
}

static void test_refusals(void **state)
{
    static const char *const wrong[] = {"job=",
                                        "job=012",
                                        "job=xyzw",
                                        "job=0123456789abcdef0123456789abcdef0",
                                        "tag=",
                                        "tag=a,b",
                                        "tag=1&tag=2&tag=3&tag=4&tag=5"};
    struct daemon_room *room = *state;
    struct reply reply;
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        char path[120];
        snprintf(path, sizeof path, "/v1/events?%s", wrong[i]);
        daemon_get(&room->daemon, path, &reply);
        if (reply.status != 400)
            fail_msg("%s: %ld", wrong[i], reply.status);
        reply_done(&reply);
    }
    daemon_request(&room->daemon, "HEAD", "/v1/events", NULL, NULL, 0, NULL, &reply);
    assert_int_equal(reply.status, 200);
    reply_done(&reply);
}

#define EACH(test) cmocka_unit_test_setup_teardown(test, daemon_room_set_up, daemon_room_tear_down)
int main(void)
{
    const struct CMUnitTest tests[] = {
        EACH(test_a_life),      EACH(test_filters),
        EACH(test_goes_on),     EACH(test_ends_with_the_daemon),
        EACH(test_slow_reader), EACH(test_refusals),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
