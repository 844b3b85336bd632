/* Limits per client and in total: bytes being uploaded, jobs, streams. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <arpa/inet.h>
#include <cmocka.h>
#include <dirent.h>
#include <netinet/in.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <unistd.h>

#include "http/connection/connections.h"
#include "process/limits.h"
#include "support/daemon.h"
#include "support/patience.h"
#include "support/zip.h"

enum { MIB = 1 << 20, BUDGET_MIB = 4 };

/* ---- Addresses ------------------------------------------------------------------------------ */

static void key_of(const char *text, char ret_key[ORL_ADDRESS_KEY])
{
    struct sockaddr_in6 v6 = {.sin6_family = AF_INET6};
    struct sockaddr_in v4 = {.sin_family = AF_INET};
    if (inet_pton(AF_INET6, text, &v6.sin6_addr) == 1) {
        orl_address_key((const struct sockaddr *)&v6, ret_key);
    } else {
        assert_int_equal(inet_pton(AF_INET, text, &v4.sin_addr), 1);
        orl_address_key((const struct sockaddr *)&v4, ret_key);
    }
}

/* All addresses of an IPv6 network count as one client. */
static void test_addresses(void **state)
{
    static const struct {
        const char *a, *b;
        bool same;
    } pairs[] = {
        {"2001:db8::1", "2001:db8::ffff:ffff:ffff:ffff", true},
        {"2001:db8::1", "2001:db8:0:1::1", false},
        {"192.0.2.1", "192.0.2.2", false},
        {"::ffff:192.0.2.1", "192.0.2.1", true},
        {"::ffff:192.0.2.1", "::ffff:192.0.2.2", false},
        {"::1", "127.0.0.1", false},
    };
    (void)state;
    for (size_t i = 0; i < sizeof pairs / sizeof *pairs; i++) {
        char a[ORL_ADDRESS_KEY], b[ORL_ADDRESS_KEY];
        key_of(pairs[i].a, a);
        key_of(pairs[i].b, b);
        if ((strcmp(a, b) == 0) != pairs[i].same)
            fail_msg("%s is %s, %s is %s", pairs[i].a, a, pairs[i].b, b);
    }
}

/* ---- Bytes being uploaded ------------------------------------------------------------------- */

static uint64_t bytes_in_tmp(const struct daemon *daemon)
{
    char path[400];
    uint64_t bytes = 0;
    snprintf(path, sizeof path, "%s/tmp", daemon->root);
    DIR *folder = opendir(path);
    assert_non_null(folder);
    for (const struct dirent *file; (file = readdir(folder));) {
        struct stat st;
        if (file->d_name[0] != '.' && fstatat(dirfd(folder), file->d_name, &st, 0) == 0)
            bytes += (uint64_t)st.st_size;
    }
    closedir(folder);
    return bytes;
}

/* Sends the headers of an upload of that length ("chunked" for 0), and waits until the daemon asks
 * for the body, which is not sent. */
static int begin_upload(const struct daemon *daemon, size_t length, const char *header)
{
    static const char wanted[] = "HTTP/1.1 100 Continue\r\n\r\n";
    char text[400], answer[sizeof wanted] = "";
    char coding[64] = "Transfer-Encoding: chunked";
    if (length > 0)
        snprintf(coding, sizeof coding, "Content-Length: %zu", length);
    snprintf(text, sizeof text,
             "POST /v1/bsdfs HTTP/1.1\r\nHost: localhost\r\nExpect: 100-continue\r\n"
             "%s%s%s\r\n\r\n",
             header ? header : "", header ? "\r\n" : "", coding);
    const int fd = daemon_dial(daemon);
    assert_true(send(fd, text, strlen(text), MSG_NOSIGNAL) > 0);
    assert_true(recv(fd, answer, sizeof answer - 1, MSG_WAITALL) > 0);
    assert_string_equal(answer, wanted);
    return fd;
}

static void ask_for(struct daemon *daemon, size_t length, const char *header, long status,
                    const char *type)
{
    char *zeros = calloc(1, length);
    struct reply reply;
    assert_non_null(zeros);
    daemon_request(daemon, "POST", "/v1/bsdfs", "application/xml", zeros, length, header, &reply);
    free(zeros);
    if (reply.status != status || (type && !strstr(reply_text(&reply, "type"), type)))
        fail_msg("%zu bytes: %ld %s", length, reply.status, reply.body);
    if (status == 507 || status == 429)
        assert_non_null(reply_header(&reply, "Retry-After"));
    reply_done(&reply);
}

/* Waits until a body of that length is accepted: reservations of others have been released. */
static void wait_for_room(struct daemon *daemon, size_t length)
{
    char *zeros = calloc(1, length);
    long status = 507;
    assert_non_null(zeros);
    for (double until = patience_until(); status == 507 && patience_nap(until);) {
        struct reply reply;
        daemon_request(daemon, "POST", "/v1/bsdfs", "application/xml", zeros, length, NULL, &reply);
        status = reply.status;
        reply_done(&reply);
    }
    free(zeros);
}

/* Announced bytes count before they arrive, and are released when their client is gone. */
static void test_announced(void **state)
{
    const char *const extra[] = {"--storage-budget", "4M", NULL};
    struct daemon daemon;
    (void)state;
    daemon_start(&daemon, extra);
    ask_for(&daemon, 5 * MIB, NULL, 507, "storage-full");
    const int fd = begin_upload(&daemon, 3 * MIB, NULL);
    ask_for(&daemon, 2 * MIB, NULL, 507, "storage-full");
    ask_for(&daemon, MIB / 2, NULL, 400, "syntax");
    close(fd);
    wait_for_room(&daemon,
                  3 * MIB); /* a hang-up is noticed within a second, or later on a busy machine */
    ask_for(&daemon, 3 * MIB, NULL, 400, "syntax");
    daemon_remove(&daemon);
}

/* Bodies without a length: bytes beyond the budget are not written. */
static void test_chunked(void **state)
{
    enum { UPLOADS = 3, CHUNK = 1 << 16, CHUNKS = 100 };
    static char chunk[CHUNK + 16];
    const char *const extra[] = {"--storage-budget", "4M", NULL};
    struct daemon daemon;
    uint64_t most = 0;
    int fds[UPLOADS];
    (void)state;
    daemon_start(&daemon, extra);
    memset(chunk, ' ', sizeof chunk);
    memcpy(chunk, "10000\r\n", 7);
    memcpy(chunk + 7 + CHUNK, "\r\n", 2);
    for (int i = 0; i < UPLOADS; i++)
        fds[i] = begin_upload(&daemon, 0, NULL);
    for (int k = 0; k < CHUNKS; k++) {
        for (int i = 0; i < UPLOADS; i++)
            for (size_t sent = 0; sent < CHUNK + 9;) {
                const ssize_t n = send(fds[i], chunk + sent, CHUNK + 9 - sent, MSG_NOSIGNAL);
                assert_true(n > 0);
                sent += (size_t)n;
            }
        const uint64_t bytes = bytes_in_tmp(&daemon);
        most = bytes > most ? bytes : most;
    }
    for (int i = 0; i < UPLOADS; i++) {
        char answer[1000] = "";
        assert_true(send(fds[i], "0\r\n\r\n", 5, MSG_NOSIGNAL) == 5);
        assert_true(recv(fds[i], answer, sizeof answer - 1, 0) > 0);
        assert_non_null(strstr(answer, "HTTP/1.1 507"));
        close(fds[i]);
    }
    assert_in_range(most, 1, BUDGET_MIB * MIB);
    daemon_expect_no_files(&daemon, "tmp");
    daemon_remove(&daemon);
}

/* Unpacked files count as well. */
static void test_unpacked(void **state)
{
    const char *const extra[] = {"--storage-budget", "4M", NULL};
    struct daemon daemon;
    struct reply reply;
    size_t size = 0;
    char *zip = zip_make_bomb("a.rad", 30 * MIB, &size);
    (void)state;
    daemon_start(&daemon, extra);
    assert_true(size < 64 << 10);
    daemon_request(&daemon, "POST", "/v1/scenes", "application/zip", zip, size, NULL, &reply);
    if (reply.status != 507)
        fail_msg("%ld %s", reply.status, reply.body);
    reply_done(&reply);
    free(zip);
    daemon_expect_no_files(&daemon, "tmp");
    daemon_remove(&daemon);
}

/* Results of sensors from a file count as well: the document does not state their number. */
static void test_sensors_of_a_file(void **state)
{
    enum { SENSORS = 20000, LINE = 20 };
    const char *const extra[] = {"--storage-budget", "3M", NULL};
    static char lines[SENSORS * LINE];
    struct daemon daemon;
    struct reply reply;
    char text[300], scene[65];
    size_t used = 0;
    (void)state;
    for (int i = 0; i < SENSORS; i++)
        used += (size_t)sprintf(lines + used, "2 1 0.8 0 0 1\n");
    const struct upload_file files[] = {{"room.rad", room_scene, strlen(room_scene), false},
                                        {"sky.rad", room_sky, strlen(room_sky), false},
                                        {"many.pts", lines, used, true},
                                        {"few.pts", lines, 14, true}};
    daemon_start(&daemon, extra);
    daemon_upload(&daemon, files, 4, NULL, &reply);
    assert_int_equal(reply.status, 201);
    snprintf(scene, sizeof scene, "%s", reply_text(&reply, "id"));
    reply_done(&reply);
    for (int few = 0; few < 2; few++) {
        snprintf(text, sizeof text,
                 "{\"scene\":\"%s\",\"technique\":\"backward\",\"gather_samples\":16,"
                 "\"sensors\":{\"file\":\"%s.pts\"}}",
                 scene, few ? "few" : "many");
        daemon_post_json(&daemon, "/v1/jobs", text, &reply);
        if (reply.status != (few ? 202 : 507))
            fail_msg("%ld %s", reply.status, reply.body);
        reply_done(&reply);
    }
    daemon_remove(&daemon);
}

/* ---- Several clients ------------------------------------------------------------------------- */

struct pair {
    struct daemon daemon;
    char scene[65], one[128], other[128]; /* Authorization headers of two tokens */
};

/* Runs `orield token COMMAND`; returns its first line. */
static void run_token_command(const struct daemon *daemon, const char *arguments,
                              char ret_line[128])
{
    char command[400];
    const char *build = getenv("ORIEL_BUILD");
    ret_line[0] = '\0';
    snprintf(command, sizeof command, "timeout 120 %s/orield token %s --data %s",
             build ? build : "build", arguments, daemon->root);
    FILE *pipe = popen(command, "r");
    assert_non_null(pipe);
    if (!fgets(ret_line, 128, pipe))
        ret_line[0] = '\0';
    assert_int_equal(pclose(pipe), 0);
    ret_line[strcspn(ret_line, "\n")] = '\0';
}

static void make_token(const struct daemon *daemon, const char *name, char ret_header[128])
{
    char arguments[80], said[128];
    snprintf(arguments, sizeof arguments, "add %s --scope submit", name);
    run_token_command(daemon, arguments, said);
    snprintf(ret_header, 128, "Authorization: Bearer %.90s", said);
}

static int pair_set_up(void **state)
{
    static struct pair pair;
    const char *const extra[] = {"--tokens", "always", "--storage-budget", "64M", NULL};
    daemon_start(&pair.daemon, NULL);
    daemon_upload_room(&pair.daemon, pair.scene);
    make_token(&pair.daemon, "one", pair.one);
    make_token(&pair.daemon, "other", pair.other);
    assert_int_equal(daemon_end(&pair.daemon, SIGTERM), 0);
    daemon_restart(&pair.daemon, extra);
    *state = &pair;
    return 0;
}

/* No client gets more than half of the budget for uploads. */
static void test_share_of_bytes(void **state)
{
    struct pair *pair = *state;
    const int fd = begin_upload(&pair->daemon, 30 * MIB, pair->one);
    ask_for(&pair->daemon, 3 * MIB, pair->one, 429, "too-many-bytes");
    ask_for(&pair->daemon, 3 * MIB, pair->other, 400, "syntax");
    ask_for(&pair->daemon, 33 * MIB, pair->other, 507, "storage-full"); /* it could never succeed */
    close(fd);
}

static long post_job(struct pair *pair, const char *header, unsigned seed)
{
    char text[300];
    struct reply reply;
    snprintf(text, sizeof text,
             "{\"scene\":\"%s\",\"seed\":%u,\"technique\":\"backward\",\"gather_samples\":1000000,"
             "\"sensors\":[[2,1,0.8,0,0,1]]}",
             pair->scene, seed);
    daemon_request(&pair->daemon, "POST", "/v1/jobs", "application/json", text, strlen(text),
                   header, &reply);
    const long status = reply.status;
    if (status == 429)
        assert_non_null(reply_header(&reply, "Retry-After"));
    else if (status != 202)
        fail_msg("%ld %s", status, reply.body);
    reply_done(&reply);
    return status;
}

/* Identical jobs, which share a computation, count like others. */
static void test_share_of_queue(void **state)
{
    struct pair *pair = *state;
    unsigned taken = 0;
    while (taken < 2 * ORL_SERVER_CLIENT_JOBS && post_job(pair, pair->one, taken / 2) == 202)
        taken++;
    /* Jobs that end meanwhile free their places. */
    assert_in_range(taken, ORL_SERVER_CLIENT_JOBS, ORL_SERVER_CLIENT_JOBS + 64);
    assert_int_equal(post_job(pair, pair->other, 1), 202);
}

/*
 * A later token of the same name is independent of the jobs of a removed one: they neither count
 * against its limit nor delay it.
 */
static void test_another_token_of_the_name(void **state)
{
    struct pair *pair = *state;
    struct reply reply;
    char line[128], text[300];
    run_token_command(&pair->daemon, "remove one", line);
    make_token(&pair->daemon, "one", pair->one);
    snprintf(text, sizeof text,
             "{\"scene\":\"%s\",\"seed\":1000,\"technique\":\"backward\","
             "\"gather_samples\":1000000,\"sensors\":[[2,1,0.8,0,0,1]]}",
             pair->scene);
    daemon_request(&pair->daemon, "POST", "/v1/jobs", "application/json", text, strlen(text),
                   pair->one, &reply);
    assert_int_equal(reply.status, 202);
    assert_string_equal(reply_text(&reply, "client"), "token:one");
    if (strcmp(reply_text(&reply, "state"), "queued") ==
        0) /* one turn for each of two other clients */
        assert_in_range((int)reply_number(&reply, "queue_position"), 1, 3);
    reply_done(&reply);
}

static void test_share_of_streams(void **state)
{
    enum { STREAMS = ORL_SERVER_CLIENT_STREAMS };
    struct pair *pair = *state;
    struct reply reply;
    char request[400], path[120];
    static int fds[STREAMS];
    daemon_request(&pair->daemon, "GET", "/v1/jobs?state=queued&limit=1", NULL, NULL, 0, pair->one,
                   &reply);
    snprintf(path, sizeof path, "%.60s/events", reply_text(&reply, "jobs.0.links.self"));
    reply_done(&reply);
    snprintf(request, sizeof request, "GET %s HTTP/1.1\r\nHost: localhost\r\n%s\r\n\r\n", path,
             pair->one);
    for (int i = 0; i < STREAMS; i++) {
        char answer[12];
        fds[i] = daemon_dial(&pair->daemon);
        assert_true(send(fds[i], request, strlen(request), MSG_NOSIGNAL) > 0);
        assert_int_equal(recv(fds[i], answer, sizeof answer, MSG_WAITALL), sizeof answer);
        assert_memory_equal(answer, "HTTP/1.1 200", sizeof answer);
    }
    daemon_request(&pair->daemon, "GET", path, NULL, NULL, 0, pair->one, &reply);
    assert_int_equal(reply.status, 429);
    assert_non_null(reply_header(&reply, "Retry-After"));
    reply_done(&reply);
    const int fd = daemon_dial(&pair->daemon);
    char answer[13] = "";
    snprintf(request, sizeof request, "GET %s HTTP/1.1\r\nHost: localhost\r\n%s\r\n\r\n", path,
             pair->other);
    assert_true(send(fd, request, strlen(request), MSG_NOSIGNAL) > 0);
    assert_int_equal(recv(fd, answer, 12, MSG_WAITALL), 12);
    assert_string_equal(answer, "HTTP/1.1 200");
    close(fd);
    for (int i = 0; i < STREAMS; i++)
        close(fds[i]);
}

static int pair_tear_down(void **state)
{
    struct pair *pair = *state;
    daemon_remove(&pair->daemon);
    return 0;
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_addresses),         cmocka_unit_test(test_announced),
        cmocka_unit_test(test_chunked),           cmocka_unit_test(test_unpacked),
        cmocka_unit_test(test_sensors_of_a_file),
    };
    const struct CMUnitTest pairs[] = {
        cmocka_unit_test(test_share_of_bytes),
        cmocka_unit_test(test_share_of_queue),
        cmocka_unit_test(test_another_token_of_the_name),
        cmocka_unit_test(test_share_of_streams),
    };
    const int failed = cmocka_run_group_tests(tests, NULL, NULL);
    return failed + cmocka_run_group_tests(pairs, pair_set_up, pair_tear_down);
}
