/*
 * Stored files: removed on request, fetched in ranges, left by crashes, changed while being read.
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
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include "store/files/folders.h"
#include "support/storage.h"

/* ---- DELETE --------------------------------------------------------------------------------- */

static void test_delete_job(void **state)
{
    struct daemon_room *f = *state;
    struct reply reply;
    char done[80], running[80], waiting[80], path[300];
    storage_run_job(&f->daemon, f->scene, 1, "v", done);
    const size_t blobs = daemon_count_files(&f->daemon, "blobs");
    storage_expect(&f->daemon, "DELETE", done, 204, NULL);
    storage_expect(&f->daemon, "DELETE", done, 404, "no-such-resource");
    storage_expect(&f->daemon, "GET", done, 404, "no-such-resource");
    snprintf(path, sizeof path, "%s/result", done);
    storage_expect(&f->daemon, "GET", path, 404, "no-such-resource");
    daemon_expect_no_files(&f->daemon, "results");
    assert_int_equal(daemon_count_files(&f->daemon, "blobs"), blobs - 1);
    assert_true(storage_bytes_of(&f->daemon, "results") == 0);
    daemon_submit(&f->daemon, f->scene, 50000000, 2, NULL, running);
    daemon_wait_running(&f->daemon, running, 0);
    daemon_submit(&f->daemon, f->scene, 50000000, 3, NULL, waiting);
    storage_expect(&f->daemon, "DELETE", running, 409, "in-use");
    storage_expect(&f->daemon, "DELETE", waiting, 409, "in-use");
    daemon_cancel(&f->daemon, waiting, &reply);
    reply_done(&reply);
    daemon_cancel(&f->daemon, running, &reply);
    reply_done(&reply);
    daemon_wait(&f->daemon, running, 10, &reply);
    reply_done(&reply);
    storage_expect(&f->daemon, "DELETE", waiting, 204, NULL);
    storage_expect(&f->daemon, "DELETE", running, 204, NULL);
    daemon_get(&f->daemon, "/v1/jobs", &reply);
    assert_int_equal(json_array_size(reply_at(&reply, "jobs")), 0);
    reply_done(&reply);
}

static void test_delete_scene(void **state)
{
    struct daemon_room *f = *state;
    struct reply reply;
    char scene[96], running[80], done[80];
    snprintf(scene, sizeof scene, "/v1/scenes/%s", f->scene);
    storage_run_job(&f->daemon, f->scene, 1, NULL, done);
    daemon_submit(&f->daemon, f->scene, 50000000, 2, NULL, running);
    storage_expect(&f->daemon, "DELETE", scene, 409, "in-use");
    daemon_cancel(&f->daemon, running, &reply);
    reply_done(&reply);
    daemon_wait(&f->daemon, running, 10, &reply);
    reply_done(&reply);
    storage_expect(&f->daemon, "DELETE", scene, 204, NULL);
    storage_expect(&f->daemon, "DELETE", scene, 404, "no-such-resource");
    storage_expect(&f->daemon, "HEAD", scene, 404, NULL);
    assert_int_equal(daemon_count_files(&f->daemon, "blobs"), 2); /* the jobs' documents */
    /* The job that used it continues, also over a restart; a new job's error names the missing
     * scene. */
    assert_int_equal(daemon_end(&f->daemon, SIGTERM), 0);
    daemon_restart(&f->daemon, NULL);
    storage_fetch(&f->daemon, done, 200);
    char again[65];
    daemon_upload_room(&f->daemon, again);
    assert_string_equal(again, f->scene);
    storage_run_job(&f->daemon, f->scene, 3, NULL, done);
}

static void test_delete_bsdf(void **state)
{
    struct daemon_room *f = *state;
    storage_expect(&f->daemon, "DELETE",
                   "/v1/bsdfs/0123456789abcdef0123456789abcdef0123456789abcdef0123456789abcdef",
                   404, "no-such-resource");
}

static void test_delete_map(void **state)
{
    struct daemon_room *f = *state;
    struct reply reply;
    char job[80], path[128];
    storage_run_job(&f->daemon, f->scene, 1, NULL, job);
    daemon_get(&f->daemon, "/v1/maps", &reply);
    const size_t count = json_array_size(reply_at(&reply, "maps"));
    snprintf(path, sizeof path, "/v1/maps/%s/%s", reply_text(&reply, "maps.0.kind"),
             reply_text(&reply, "maps.0.key"));
    assert_true(count > 0);
    reply_done(&reply);
    storage_expect(&f->daemon, "DELETE", path, 204, NULL);
    storage_expect(&f->daemon, "DELETE", path, 404, "no-such-resource");
    storage_expect(&f->daemon, "DELETE", "/v1/maps/global/0123", 404, "no-such-resource");
    assert_int_equal(storage_count_maps(&f->daemon), count - 1);
    assert_int_equal(daemon_count_files(&f->daemon, "maps"), count - 1);
    /* It is built again. */
    char again[80];
    daemon_submit(&f->daemon, f->scene, STORAGE_PHOTONS, 1, "v", again);
    daemon_wait(&f->daemon, again, 60, &reply);
    assert_string_equal(reply_text(&reply, "state"), "succeeded");
    reply_done(&reply);
    assert_int_equal(storage_count_maps(&f->daemon), count);
}

/* ---- Tags and ranges ------------------------------------------------------------------------ */

static void get_with(struct daemon *daemon, const char *path, const char *header, long status,
                     struct reply *ret_reply)
{
    daemon_request(daemon, "GET", path, NULL, NULL, 0, header, ret_reply);
    if (ret_reply->status != status)
        fail_msg("%s: %ld in place of %ld", header, ret_reply->status, status);
}

static void test_parts(void **state)
{
    static const struct {
        const char *range;
        long status;
        size_t first, count; /* measured from the end if first is 0 of -N */
    } cases[] = {{"bytes=0-9", 206, 0, 10},    {"bytes=5-5", 206, 5, 1},
                 {"bytes=2-3,5-6", 200, 0, 0}, {"lines=1-2", 200, 0, 0},
                 {"bytes=9-2", 200, 0, 0},     {"bytes=99999999-", 416, 0, 0},
                 {"bytes=-0", 416, 0, 0},      {"bytes=99999999999999999999-", 416, 0, 0},
                 {"bytes=x", 200, 0, 0},       {"bytes=-", 200, 0, 0}};
    struct daemon_room *f = *state;
    struct reply whole, part;
    char job[80], path[300], header[160], sha[ORL_SHA_HEX];
    storage_run_job(&f->daemon, f->scene, 1, "v", job);
    snprintf(path, sizeof path, "%s/files/v.hdr", job);
    daemon_get(&f->daemon, path, &whole);
    assert_string_equal(reply_header(&whole, "Accept-Ranges"), "bytes");
    /* The tag is the digest of the bytes. */
    orl_sha256_hex(whole.body, whole.size, sha);
    snprintf(header, sizeof header, "\"%s\"", sha);
    assert_string_equal(reply_header(&whole, "ETag"), header);
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        snprintf(header, sizeof header, "Range: %s", cases[i].range);
        get_with(&f->daemon, path, header, cases[i].status, &part);
        if (cases[i].status == 206) {
            assert_int_equal(part.size, cases[i].count);
            assert_memory_equal(part.body, whole.body + cases[i].first, part.size);
            assert_non_null(reply_header(&part, "Content-Range"));
        } else if (cases[i].status == 200) {
            assert_int_equal(part.size, whole.size);
        } else {
            assert_non_null(strstr(reply_header(&part, "Content-Range"), "bytes */"));
        }
        reply_done(&part);
    }
    get_with(&f->daemon, path, "Range: bytes=-7", 206, &part);
    assert_int_equal(part.size, 7);
    assert_memory_equal(part.body, whole.body + whole.size - 7, 7);
    reply_done(&part);
    snprintf(header, sizeof header, "Range: bytes=10-\r\nIf-Range: \"%s\"", sha);
    get_with(&f->daemon, path, header, 206, &part);
    assert_int_equal(part.size, whole.size - 10);
    reply_done(&part);
    get_with(&f->daemon, path, "Range: bytes=10-\r\nIf-Range: \"other\"", 200, &part);
    reply_done(&part);
    snprintf(header, sizeof header, "If-None-Match: \"%s\"", sha);
    get_with(&f->daemon, path, header, 304, &part);
    reply_done(&part);
    daemon_request(&f->daemon, "HEAD", path, NULL, NULL, 0, "Range: bytes=0-9", &part);
    assert_int_equal(part.status, 200);
    assert_int_equal(strtoul(reply_header(&part, "Content-Length"), NULL, 10), whole.size);
    reply_done(&part);
    reply_done(&whole);
}

/* Leaves a file below the data folder, as a crash might. */
static void leave_file(const struct daemon *daemon, const char *folder, const char *name)
{
    char path[600];
    snprintf(path, sizeof path, "%s/%s", daemon->root, folder);
    mkdir(path, 0700);
    snprintf(path, sizeof path, "%s/%s/%s", daemon->root, folder, name);
    FILE *file = fopen(path, "w");
    assert_non_null(file);
    fputs("left", file);
    fclose(file);
}

/* ---- Orphans -------------------------------------------------------------------------------- */

/* Files left by a crash are removed at the next start, and no others. */
static void test_orphans(void **state)
{
    static const char sha[] = "abcdef0123456789abcdef0123456789abcdef0123456789abcdef0123456789";
    struct daemon_room *f = *state;
    struct reply reply;
    char done[80], cancelled[80], folder[300], map[96];
    storage_run_job(&f->daemon, f->scene, 1, "v", done);
    daemon_submit(&f->daemon, f->scene, 50000000, 2, NULL, cancelled);
    daemon_cancel(&f->daemon, cancelled, &reply);
    reply_done(&reply);
    daemon_wait(&f->daemon, cancelled, 10, &reply);
    reply_done(&reply);
    const size_t blobs = daemon_count_files(&f->daemon, "blobs");
    const size_t results = daemon_count_files(&f->daemon, "results");
    const size_t maps = daemon_count_files(&f->daemon, "maps");
    assert_int_equal(daemon_end(&f->daemon, SIGKILL), -1);
    leave_file(&f->daemon, "blobs/ab", sha);
    snprintf(map, sizeof map, "global-%s.opm", sha);
    leave_file(&f->daemon, "maps", map);
    leave_file(&f->daemon, "tmp", "body");
    snprintf(folder, sizeof folder, "results%s", strrchr(cancelled, '/'));
    leave_file(&f->daemon, folder, "result.json");
    leave_file(&f->daemon, "results/0123456789abcdef", "result.json");
    snprintf(folder, sizeof folder, "partial%s", strrchr(done, '/'));
    leave_file(&f->daemon, folder, "v.hdr");
    daemon_restart(&f->daemon, NULL);
    assert_int_equal(daemon_count_files(&f->daemon, "blobs"), blobs);
    assert_int_equal(daemon_count_files(&f->daemon, "results"), results);
    assert_int_equal(daemon_count_files(&f->daemon, "maps"), maps);
    daemon_expect_no_files(&f->daemon, "partial");
    daemon_expect_no_files(&f->daemon, "tmp");
    storage_fetch(&f->daemon, done, 200);
}

/* An upload that fails at its last step, the row, leaves no file, even before the next start. */
static void test_uploads_that_fail_late(void **state)
{
    static const char ball[] = "void plastic x 0 0 5 .5 .5 .5 0 0\nx sphere s 0 0 4 0 0 0 1\n";
    struct daemon_room *f = *state;
    struct reply reply;
    char text[512];
    const size_t blobs = daemon_count_files(&f->daemon, "blobs");
    storage_run_sql(&f->daemon,
                    "CREATE TRIGGER a BEFORE INSERT ON scenes BEGIN SELECT RAISE(ABORT, 'no'); END;"
                    "CREATE TRIGGER b BEFORE INSERT ON jobs BEGIN SELECT RAISE(ABORT, 'no'); END;");
    const struct upload_file file = {"ball.rad", ball, strlen(ball), false};
    daemon_upload(&f->daemon, &file, 1, NULL, &reply);
    assert_int_equal(reply.status, 500);
    reply_done(&reply);
    snprintf(text, sizeof text, "{\"scene\":\"%s\",\"sensors\":[[2,1,0.8,0,0,1]]}", f->scene);
    daemon_post_json(&f->daemon, "/v1/jobs", text, &reply);
    assert_int_equal(reply.status, 500);
    reply_done(&reply);
    assert_int_equal(daemon_count_files(&f->daemon, "blobs"), blobs);
    storage_run_sql(&f->daemon, "DROP TRIGGER a; DROP TRIGGER b;");
    daemon_upload(&f->daemon, &file, 1, NULL, &reply);
    assert_int_equal(reply.status, 201);
    reply_done(&reply);
    daemon_post_json(&f->daemon, "/v1/jobs", text, &reply);
    assert_int_equal(reply.status, 202);
    reply_done(&reply);
    assert_int_equal(daemon_count_files(&f->daemon, "blobs"), blobs + 2);
}

/* ---- Files that change while they are read --------------------------------------------------- */

/*
 * A reader that has the file open still reads the old content; a failed write keeps that in place.
 */
static void test_files_are_whole_while_they_are_written(void **state)
{
    char folder[] = "/tmp/oriel-test-XXXXXX", path[64], part[80], text[16] = "";
    const struct rlimit tiny = {2, RLIM_INFINITY};
    struct rlimit usual;
    struct orl_error err = {0};
    (void)state;
    assert_non_null(mkdtemp(folder));
    snprintf(path, sizeof path, "%s/result.json", folder);
    snprintf(part, sizeof part, "%s.part", path);
    assert_int_equal(orl_write_file(path, "first", 5, &err), 0);
    FILE *reader = fopen(path, "rb");
    assert_non_null(reader);
    assert_int_equal(orl_write_file(path, "the second", 10, &err), 0);
    assert_int_equal(fread(text, 1, sizeof text, reader), 5);
    assert_memory_equal(text, "first", 5);
    fclose(reader);
    signal(SIGXFSZ, SIG_IGN);
    getrlimit(RLIMIT_FSIZE, &usual);
    setrlimit(RLIMIT_FSIZE, &tiny);
    const int code = orl_write_file(path, "the third", 9, &err);
    setrlimit(RLIMIT_FSIZE, &usual);
    assert_int_equal(code, ORL_ERR_IO);
    assert_true(access(part, F_OK) != 0);
    reader = fopen(path, "rb");
    assert_non_null(reader);
    assert_int_equal(fread(text, 1, sizeof text, reader), 10);
    assert_memory_equal(text, "the second", 10);
    fclose(reader);
    unlink(path);
    rmdir(folder);
}

#define EACH(test) cmocka_unit_test_setup_teardown(test, daemon_room_set_up, daemon_room_tear_down)
int main(void)
{
    static const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_files_are_whole_while_they_are_written),
        EACH(test_delete_job),
        EACH(test_delete_scene),
        EACH(test_delete_bsdf),
        EACH(test_delete_map),
        EACH(test_parts),
        EACH(test_orphans),
        EACH(test_uploads_that_fail_late),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
