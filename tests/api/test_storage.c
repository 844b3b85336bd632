/*
 * What the daemon keeps, through a real one: the byte budget and what goes for it, DELETE, parts
 * and tags of results, and what is found at start that belongs to nobody.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <signal.h>
#include <sqlite3.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include "process/config.h"
#include "store/folders.h"
#include "support/daemon.h"

enum { PHOTONS = 20000 };

/* ---- Helpers -------------------------------------------------------------------------------- */

static void expect(struct daemon *daemon, const char *method, const char *path, long status,
                   const char *type)
{
    struct reply reply;
    char urn[64];
    daemon_request(daemon, method, path, NULL, NULL, 0, NULL, &reply);
    if (reply.status != status)
        fail_msg("%s %s: %ld in place of %ld: %s", method, path, reply.status, status, reply.body);
    if (type) {
        snprintf(urn, sizeof urn, "urn:oriel:error:%s", type);
        assert_string_equal(reply_text(&reply, "type"), urn);
    }
    reply_done(&reply);
}

static void run_job(struct daemon *daemon, const char *scene, int seed, const char *view,
                    char ret_path[80])
{
    struct reply reply;
    daemon_submit(daemon, scene, PHOTONS, seed, view, ret_path);
    daemon_wait(daemon, ret_path, 60, &reply);
    assert_string_equal(reply_text(&reply, "state"), "succeeded");
    reply_done(&reply);
}

static void fetch(struct daemon *daemon, const char *job, long status)
{
    char path[300];
    snprintf(path, sizeof path, "%s/result", job);
    expect(daemon, "GET", path, status, status == 410 ? "results-evicted" : NULL);
}

static double metric(struct daemon *daemon, const char *name)
{
    struct reply reply;
    char line[96];
    snprintf(line, sizeof line, "\n%s ", name);
    daemon_get(daemon, "/metrics", &reply);
    const char *at = strstr(reply.body, line);
    if (!at)
        fail_msg("no %s in the metrics", name);
    const double value = strtod(at + strlen(line), NULL);
    reply_done(&reply);
    return value;
}

static double bytes_of(struct daemon *daemon, const char *kind)
{
    char name[64];
    snprintf(name, sizeof name, "oriel_storage_bytes{kind=\"%s\"}", kind);
    return metric(daemon, name);
}

static double bytes_kept(struct daemon *daemon)
{
    return bytes_of(daemon, "maps") + bytes_of(daemon, "bsdfs") + bytes_of(daemon, "results") +
           bytes_of(daemon, "uploads");
}

static size_t count_maps(struct daemon *daemon)
{
    struct reply reply;
    daemon_get(daemon, "/v1/maps", &reply);
    const size_t count = json_array_size(reply_at(&reply, "maps"));
    reply_done(&reply);
    return count;
}

static void restart_with_budget(struct daemon *daemon, double budget)
{
    char size[32];
    const char *const extra[] = {"--storage-budget", size, NULL};
    snprintf(size, sizeof size, "%.0f", budget);
    assert_int_equal(daemon_end(daemon, SIGTERM), 0);
    daemon_restart(daemon, extra);
}

/* A file below the data folder, as a crash might leave it. */
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

/* ---- The budget ----------------------------------------------------------------------------- */

/* Of three jobs that were fetched the budget leaves the one used last, its map included. */
static void test_longest_unused_goes_first(void **state)
{
    struct daemon_room *f = *state;
    char jobs[3][80], file[300];
    struct reply reply;
    for (int i = 0; i < 3; i++)
        run_job(&f->daemon, f->scene, i + 1, "v", jobs[i]);
    fetch(&f->daemon, jobs[1], 200);
    fetch(&f->daemon, jobs[2], 200);
    fetch(&f->daemon, jobs[0], 200);
    const double uploads = bytes_of(&f->daemon, "uploads"), kept = bytes_kept(&f->daemon);
    const size_t maps = count_maps(&f->daemon);
    assert_true(maps >= 3);
    /* Room for a third of maps and results. */
    restart_with_budget(&f->daemon, uploads + (kept - uploads) / 3);
    assert_true(bytes_kept(&f->daemon) <= uploads + (kept - uploads) / 3);
    assert_true(bytes_of(&f->daemon, "uploads") == uploads);
    fetch(&f->daemon, jobs[0], 200);
    assert_int_equal(count_maps(&f->daemon) < maps, true);
    daemon_get(&f->daemon, jobs[1], &reply);
    assert_string_equal(reply_text(&reply, "state"), "succeeded");
    const bool gone = *reply_text(&reply, "evicted");
    assert_true(gone == !*reply_text(&reply, "links.result"));
    reply_done(&reply);
    fetch(&f->daemon, jobs[1], gone ? 410 : 200);
    /* All that may go: the next start has room for uploads alone. */
    restart_with_budget(&f->daemon, uploads);
    for (int i = 0; i < 3; i++) {
        fetch(&f->daemon, jobs[i], 410);
        snprintf(file, sizeof file, "%s/files/v.hdr", jobs[i]);
        expect(&f->daemon, "GET", file, 410, "results-evicted");
        snprintf(file, sizeof file, "%s/files/w.hdr", jobs[i]);
        expect(&f->daemon, "GET", file, 404, "no-such-resource");
    }
    assert_int_equal(count_maps(&f->daemon), 0);
    assert_int_equal(daemon_count_files(&f->daemon, "maps"), 0);
    assert_int_equal(daemon_count_files(&f->daemon, "results"), 0);
}

/* Results that nobody has asked for stay, and what is new is refused. */
static void test_full(void **state)
{
    static const char bsdf[] = "<WindowElement/>";
    static const char ball[] = "void plastic x 0 0 5 .5 .5 .5 0 0\nx sphere s 0 0 4 0 0 0 1\n";
    struct daemon_room *f = *state;
    struct reply reply;
    char job[80], text[512];
    run_job(&f->daemon, f->scene, 1, "v", job);
    restart_with_budget(&f->daemon,
                        bytes_of(&f->daemon, "uploads") + bytes_of(&f->daemon, "results"));
    assert_int_equal(count_maps(&f->daemon), 0);
    snprintf(text, sizeof text,
             "{\"kind\":\"render\",\"scene\":\"%s\",\"technique\":\"backward\","
             "\"gather_samples\":16,\"sensors\":[[2,1,0.8,0,0,1]]}",
             f->scene);
    daemon_post_json(&f->daemon, "/v1/jobs", text, &reply);
    assert_int_equal(reply.status, 507);
    assert_string_equal(reply_text(&reply, "type"), "urn:oriel:error:storage-full");
    assert_non_null(reply_header(&reply, "Retry-After"));
    reply_done(&reply);
    daemon_request(&f->daemon, "POST", "/v1/bsdfs", "application/xml", bsdf, strlen(bsdf), NULL,
                   &reply);
    assert_int_equal(reply.status, 507);
    reply_done(&reply);
    const struct upload_file other = {"ball.rad", ball, strlen(ball), false};
    daemon_upload(&f->daemon, &other, 1, NULL, &reply);
    assert_int_equal(reply.status, 507);
    reply_done(&reply);
    assert_int_equal(daemon_count_files(&f->daemon, "tmp"), 0);
    /* What was accepted before is here, and once it has been fetched makes room. */
    fetch(&f->daemon, job, 200);
    daemon_post_json(&f->daemon, "/v1/jobs", text, &reply);
    assert_int_equal(reply.status, 202);
    reply_done(&reply);
    fetch(&f->daemon, job, 410);
}

/* Jobs are accepted as long as there is room for what all that wait are to leave. */
static void test_queue_of_results(void **state)
{
    struct daemon_room *f = *state;
    struct reply reply;
    char text[640], blocker[80];
    size_t accepted = 0;
    restart_with_budget(&f->daemon, bytes_of(&f->daemon, "uploads") + 300000);
    daemon_submit(&f->daemon, f->scene, 50000000, 1, NULL, blocker);
    for (long status = 202; status == 202 && accepted < 20; accepted += status == 202) {
        /* Each expects a view of 80x60 pixels: some 67 kB. */
        snprintf(text, sizeof text,
                 "{\"scene\":\"%s\",\"technique\":\"backward\",\"pixel_samples\":1,\"seed\":%zu,"
                 "\"views\":[{\"name\":\"v\",\"view\":\"-vp 2 2 1\",\"width\":80,\"height\":60}]}",
                 f->scene, accepted);
        daemon_post_json(&f->daemon, "/v1/jobs", text, &reply);
        status = reply.status;
        assert_true(status == 202 || status == 507);
        reply_done(&reply);
    }
    assert_int_equal(accepted, 3);
    /* Over a restart they still count; cancelled, they do not. */
    restart_with_budget(&f->daemon, bytes_of(&f->daemon, "uploads") + 300000);
    daemon_post_json(&f->daemon, "/v1/jobs", text, &reply);
    assert_int_equal(reply.status, 507);
    reply_done(&reply);
    char last[80];
    daemon_get(&f->daemon, "/v1/jobs?state=queued", &reply);
    snprintf(last, sizeof last, "%s", reply_text(&reply, "jobs.0.links.self"));
    reply_done(&reply);
    daemon_cancel(&f->daemon, last, &reply);
    reply_done(&reply);
    daemon_post_json(&f->daemon, "/v1/jobs", text, &reply);
    assert_int_equal(reply.status, 202);
    reply_done(&reply);
    daemon_cancel(&f->daemon, blocker, &reply);
    reply_done(&reply);
}

/* What could never be kept takes nothing else away. */
static void test_too_large(void **state)
{
    struct daemon_room *f = *state;
    struct reply reply;
    char job[80];
    enum { LARGE = 1 << 22 };
    run_job(&f->daemon, f->scene, 1, NULL, job);
    fetch(&f->daemon, job, 200);
    restart_with_budget(&f->daemon, bytes_kept(&f->daemon) + 100);
    const size_t maps = count_maps(&f->daemon);
    char *text = malloc(LARGE);
    assert_non_null(text);
    memset(text, '\n', LARGE);
    memcpy(text, room_scene, strlen(room_scene));
    const struct upload_file file = {"large.rad", text, LARGE, false};
    daemon_upload(&f->daemon, &file, 1, NULL, &reply);
    assert_int_equal(reply.status, 507);
    reply_done(&reply);
    free(text);
    assert_true(maps > 0 && count_maps(&f->daemon) == maps);
    /* Asking about results is not asking for them. */
    char other[80], path[96];
    run_job(&f->daemon, f->scene, 2, NULL, other);
    snprintf(path, sizeof path, "%.80s/result", other);
    expect(&f->daemon, "HEAD", path, 200, NULL);
    fetch(&f->daemon, other, 200);
}

static void test_sizes(void **state)
{
    static const struct {
        char text[32];
        uint64_t bytes; /* 0: refused */
    } cases[] = {{"1", 1},
                 {"500000", 500000},
                 {"64K", 64 << 10},
                 {"500M", 500 << 20},
                 {"20G", 20ULL << 30},
                 {"3T", 3ULL << 40},
                 {"0", 0},
                 {"-1", 0},
                 {"", 0},
                 {"G", 0},
                 {"5X", 0},
                 {"5GB", 0},
                 {"9000000T", 0},
                 {"99999999999999999999", 0}};
    (void)state;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char program[] = "orield", name[] = "--storage-budget", text[32];
        char *argv[] = {program, name, text, NULL};
        struct orl_config config;
        struct orl_error err;
        enum orl_config_action action;
        memcpy(text, cases[i].text, sizeof text);
        const int rc = orl_config_parse(3, argv, &config, &action, &err);
        assert_int_equal(rc, cases[i].bytes ? 0 : ORL_ERR_INVALID);
        if (rc == 0)
            assert_true(config.storage_bytes == cases[i].bytes);
    }
}

static void test_shelf_sizes(void **state)
{
    static const struct {
        char text[32];
        int rc;
        uint64_t bytes;
    } cases[] = {
        {"0", 0, 0}, {"64M", 0, 64 << 20}, {"", ORL_ERR_INVALID, 0}, {"-1", ORL_ERR_INVALID, 0}};
    (void)state;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char program[] = "orield", name[] = "--shelf", text[32];
        char *argv[] = {program, name, text, NULL};
        struct orl_config config = {.shelf_bytes = 0};
        struct orl_error err;
        enum orl_config_action action;
        memcpy(text, cases[i].text, sizeof text);
        assert_int_equal(orl_config_parse(3, argv, &config, &action, &err), cases[i].rc);
        assert_true(config.shelf_bytes == cases[i].bytes);
    }
}

static void test_budget_is_told(void **state)
{
    struct daemon_room *f = *state;
    struct reply reply;
    restart_with_budget(&f->daemon, 123456789);
    daemon_get(&f->daemon, "/v1/limits", &reply);
    assert_true(reply_number(&reply, "storage_bytes") == 123456789);
    reply_done(&reply);
    assert_true(metric(&f->daemon, "oriel_storage_budget_bytes") == 123456789);
}

/* ---- DELETE --------------------------------------------------------------------------------- */

static void test_delete_job(void **state)
{
    struct daemon_room *f = *state;
    struct reply reply;
    char done[80], running[80], waiting[80], path[300];
    run_job(&f->daemon, f->scene, 1, "v", done);
    const size_t blobs = daemon_count_files(&f->daemon, "blobs");
    expect(&f->daemon, "DELETE", done, 204, NULL);
    expect(&f->daemon, "DELETE", done, 404, "no-such-resource");
    expect(&f->daemon, "GET", done, 404, "no-such-resource");
    snprintf(path, sizeof path, "%s/result", done);
    expect(&f->daemon, "GET", path, 404, "no-such-resource");
    assert_int_equal(daemon_count_files(&f->daemon, "results"), 0);
    assert_int_equal(daemon_count_files(&f->daemon, "blobs"), blobs - 1);
    assert_true(bytes_of(&f->daemon, "results") == 0);
    daemon_submit(&f->daemon, f->scene, 50000000, 2, NULL, running);
    daemon_wait_running(&f->daemon, running, 0);
    daemon_submit(&f->daemon, f->scene, 50000000, 3, NULL, waiting);
    expect(&f->daemon, "DELETE", running, 409, "in-use");
    expect(&f->daemon, "DELETE", waiting, 409, "in-use");
    daemon_cancel(&f->daemon, waiting, &reply);
    reply_done(&reply);
    daemon_cancel(&f->daemon, running, &reply);
    reply_done(&reply);
    daemon_wait(&f->daemon, running, 10, &reply);
    reply_done(&reply);
    expect(&f->daemon, "DELETE", waiting, 204, NULL);
    expect(&f->daemon, "DELETE", running, 204, NULL);
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
    run_job(&f->daemon, f->scene, 1, NULL, done);
    daemon_submit(&f->daemon, f->scene, 50000000, 2, NULL, running);
    expect(&f->daemon, "DELETE", scene, 409, "in-use");
    daemon_cancel(&f->daemon, running, &reply);
    reply_done(&reply);
    daemon_wait(&f->daemon, running, 10, &reply);
    reply_done(&reply);
    expect(&f->daemon, "DELETE", scene, 204, NULL);
    expect(&f->daemon, "DELETE", scene, 404, "no-such-resource");
    expect(&f->daemon, "HEAD", scene, 404, NULL);
    assert_int_equal(daemon_count_files(&f->daemon, "blobs"), 2); /* the jobs' documents */
    /* The job that used it lives on, over a restart too; a new one is told what is missing. */
    assert_int_equal(daemon_end(&f->daemon, SIGTERM), 0);
    daemon_restart(&f->daemon, NULL);
    fetch(&f->daemon, done, 200);
    char again[65];
    daemon_upload_room(&f->daemon, again);
    assert_string_equal(again, f->scene);
    run_job(&f->daemon, f->scene, 3, NULL, done);
}

static void test_delete_bsdf(void **state)
{
    struct daemon_room *f = *state;
    expect(&f->daemon, "DELETE",
           "/v1/bsdfs/0123456789abcdef0123456789abcdef0123456789abcdef0123456789abcdef", 404,
           "no-such-resource");
}

static void test_delete_map(void **state)
{
    struct daemon_room *f = *state;
    struct reply reply;
    char job[80], path[128];
    run_job(&f->daemon, f->scene, 1, NULL, job);
    daemon_get(&f->daemon, "/v1/maps", &reply);
    const size_t count = json_array_size(reply_at(&reply, "maps"));
    snprintf(path, sizeof path, "/v1/maps/%s/%s", reply_text(&reply, "maps.0.kind"),
             reply_text(&reply, "maps.0.key"));
    assert_true(count > 0);
    reply_done(&reply);
    expect(&f->daemon, "DELETE", path, 204, NULL);
    expect(&f->daemon, "DELETE", path, 404, "no-such-resource");
    expect(&f->daemon, "DELETE", "/v1/maps/global/0123", 404, "no-such-resource");
    assert_int_equal(count_maps(&f->daemon), count - 1);
    assert_int_equal(daemon_count_files(&f->daemon, "maps"), count - 1);
    /* It is made anew. */
    char again[80];
    daemon_submit(&f->daemon, f->scene, PHOTONS, 1, "v", again);
    daemon_wait(&f->daemon, again, 60, &reply);
    assert_string_equal(reply_text(&reply, "state"), "succeeded");
    reply_done(&reply);
    assert_int_equal(count_maps(&f->daemon), count);
}

/* ---- Tags and parts ------------------------------------------------------------------------- */

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
        size_t first, count; /* from the end when count goes with first 0 of -N */
    } cases[] = {{"bytes=0-9", 206, 0, 10},    {"bytes=5-5", 206, 5, 1},
                 {"bytes=2-3,5-6", 200, 0, 0}, {"lines=1-2", 200, 0, 0},
                 {"bytes=9-2", 200, 0, 0},     {"bytes=99999999-", 416, 0, 0},
                 {"bytes=-0", 416, 0, 0},      {"bytes=99999999999999999999-", 416, 0, 0},
                 {"bytes=x", 200, 0, 0},       {"bytes=-", 200, 0, 0}};
    struct daemon_room *f = *state;
    struct reply whole, part;
    char job[80], path[300], header[160], sha[ORL_SHA_HEX];
    run_job(&f->daemon, f->scene, 1, "v", job);
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

/* ---- Orphans -------------------------------------------------------------------------------- */

/* What a crash may leave goes at the next start, and nothing else does. */
static void test_orphans(void **state)
{
    static const char sha[] = "abcdef0123456789abcdef0123456789abcdef0123456789abcdef0123456789";
    struct daemon_room *f = *state;
    struct reply reply;
    char done[80], cancelled[80], folder[300], map[96];
    run_job(&f->daemon, f->scene, 1, "v", done);
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
    assert_int_equal(daemon_count_files(&f->daemon, "partial"), 0);
    assert_int_equal(daemon_count_files(&f->daemon, "tmp"), 0);
    fetch(&f->daemon, done, 200);
}

/* Runs SQL on the daemon's database, beside the daemon. */
static void run_sql(const struct daemon *daemon, const char *sql)
{
    char path[96];
    sqlite3 *db = NULL;
    snprintf(path, sizeof path, "%s/oriel.db", daemon->root);
    assert_int_equal(sqlite3_open(path, &db), SQLITE_OK);
    sqlite3_busy_timeout(db, 5000);
    assert_int_equal(sqlite3_exec(db, sql, NULL, NULL, NULL), SQLITE_OK);
    sqlite3_close(db);
}

/* What fails at its last step, the row, leaves no file, not even until the next start. */
static void test_uploads_that_fail_late(void **state)
{
    static const char ball[] = "void plastic x 0 0 5 .5 .5 .5 0 0\nx sphere s 0 0 4 0 0 0 1\n";
    struct daemon_room *f = *state;
    struct reply reply;
    char text[512];
    const size_t blobs = daemon_count_files(&f->daemon, "blobs");
    run_sql(&f->daemon,
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
    run_sql(&f->daemon, "DROP TRIGGER a; DROP TRIGGER b;");
    daemon_upload(&f->daemon, &file, 1, NULL, &reply);
    assert_int_equal(reply.status, 201);
    reply_done(&reply);
    daemon_post_json(&f->daemon, "/v1/jobs", text, &reply);
    assert_int_equal(reply.status, 202);
    reply_done(&reply);
    assert_int_equal(daemon_count_files(&f->daemon, "blobs"), blobs + 2);
}

/* ---- Files that change under their readers --------------------------------------------------- */

/* Whoever has it open goes on reading what it was; and a write that fails leaves that in place. */
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
        EACH(test_longest_unused_goes_first),
        EACH(test_full),
        EACH(test_queue_of_results),
        EACH(test_too_large),
        cmocka_unit_test(test_files_are_whole_while_they_are_written),
        cmocka_unit_test(test_sizes),
        cmocka_unit_test(test_shelf_sizes),
        EACH(test_budget_is_told),
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
