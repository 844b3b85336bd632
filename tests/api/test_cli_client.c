/* The commands that talk to a daemon, against canned answers: what they send, show and keep. */
#include <pthread.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>
#include <jansson.h>
#include <microhttpd.h>

#include "support/cli.h"

enum { MAX_REQUESTS = 32, BODY_MAX = 1 << 16 };

/* One canned answer. Answers to the same request are given in turn, the last one for ever. */
struct canned {
    const char *request; /* "GET /v1/jobs/7" */
    unsigned status;
    const char *body;
};

struct request {
    char line[256];
    char body[BODY_MAX];
    size_t size;
};

struct fixture {
    struct MHD_Daemon *daemon;
    pthread_mutex_t lock;        /* what follows belongs to the daemon's thread while a run lasts */
    const struct canned *canned; /* ends with a NULL request */
    struct request *requests;    /* as they came */
    size_t n_requests;
    char url[64], folder[64];
    struct cli_result result;
};

/* ---- The canned daemon --------------------------------------------------------------------- */

static size_t times_asked(const struct fixture *f, const char *line)
{
    size_t count = 0;

    for (size_t i = 0; i < f->n_requests; i++)
        count += strcmp(f->requests[i].line, line) == 0;
    return count;
}

/* The answer for the request that was just counted. */
static const struct canned *find_answer(const struct fixture *f, const char *line)
{
    const struct canned *found = NULL;
    size_t turn = times_asked(f, line);

    for (const struct canned *c = f->canned; c->request && turn > 0; c++) {
        if (strcmp(c->request, line) == 0) {
            found = c;
            turn--;
        }
    }
    return found;
}

static enum MHD_Result answer_locked(struct fixture *f, struct MHD_Connection *connection,
                                     const char *url, const char *method, const char *data,
                                     size_t *data_size, void **context)
{
    struct request *request = *context;
    const struct canned *canned;
    struct MHD_Response *response;
    enum MHD_Result rc;

    if (!request) {
        if (f->n_requests == MAX_REQUESTS)
            return MHD_NO;
        request = *context = &f->requests[f->n_requests++];
        snprintf(request->line, sizeof request->line, "%s %s", method, url);
        return MHD_YES;
    }
    if (*data_size) {
        const size_t room = BODY_MAX - 1 - request->size;
        const size_t taken = *data_size < room ? *data_size : room;

        memcpy(request->body + request->size, data, taken);
        request->size += taken;
        *data_size = 0;
        return MHD_YES;
    }
    canned = find_answer(f, request->line);
    response = MHD_create_response_from_buffer(canned ? strlen(canned->body) : 0,
                                               (void *)(uintptr_t)(canned ? canned->body : ""),
                                               MHD_RESPMEM_MUST_COPY);
    rc = MHD_queue_response(connection, canned ? canned->status : 404, response);
    MHD_destroy_response(response);
    return rc;
}

static enum MHD_Result answer(void *arg, struct MHD_Connection *connection, const char *url,
                              const char *method, const char *version, const char *data,
                              size_t *data_size, void **context)
{
    struct fixture *f = arg;
    enum MHD_Result rc;

    (void)version;
    pthread_mutex_lock(&f->lock);
    rc = answer_locked(f, connection, url, method, data, data_size, context);
    pthread_mutex_unlock(&f->lock);
    return rc;
}

/* Runs the command; after it, what the daemon's thread wrote is this thread's to read. */
static void run_args(struct fixture *f, const struct canned *canned, const char *const *args)
{
    pthread_mutex_lock(&f->lock);
    f->canned = canned;
    pthread_mutex_unlock(&f->lock);
    cli_run(args, &f->result);
    pthread_mutex_lock(&f->lock);
    pthread_mutex_unlock(&f->lock);
}

static int set_up(void **state)
{
    struct fixture *f = calloc(1, sizeof *f);
    const union MHD_DaemonInfo *info;

    pthread_mutex_init(&f->lock, NULL);
    f->requests = calloc(MAX_REQUESTS, sizeof *f->requests);
    cli_make_folder(f->folder);
    f->daemon =
        MHD_start_daemon(MHD_USE_INTERNAL_POLLING_THREAD, 0, NULL, NULL, answer, f, MHD_OPTION_END);
    assert_non_null(f->daemon);
    info = MHD_get_daemon_info(f->daemon, MHD_DAEMON_INFO_BIND_PORT);
    assert_non_null(info);
    snprintf(f->url, sizeof f->url, "http://127.0.0.1:%u", (unsigned)info->port);
    *state = f;
    return 0;
}

static int tear_down(void **state)
{
    struct fixture *f = *state;

    if (f->daemon)
        MHD_stop_daemon(f->daemon);
    cli_remove_folder(f->folder);
    free(f->requests);
    free(f);
    return 0;
}

static void assert_says(const char *text, const char *wanted)
{
    if (!strstr(text, wanted))
        fail_msg("expected \"%s\" in:\n%s", wanted, text);
}

/* Runs `oriel command operand [-o FOLDER] --server URL` (operand may be NULL). */
static void run(struct fixture *f, const struct canned *canned, const char *command,
                const char *operand, const char *output)
{
    const char *args[8] = {command};
    int n = 1;

    if (operand)
        args[n++] = operand;
    if (output) {
        args[n++] = "-o";
        args[n++] = output;
    }
    args[n++] = "--server";
    args[n++] = f->url;
    run_args(f, canned, args);
}

/* ---- Tests --------------------------------------------------------------------------------- */

static void test_wait_shows_progress_and_the_cache(void **state)
{
    static const struct canned canned[] = {
        {"GET /v1/jobs/7", 200, "{\"id\": \"7\", \"state\": \"queued\", \"percent\": 0}"},
        {"GET /v1/jobs/7", 200,
         "{\"id\": \"7\", \"state\": \"running\", \"stage\": \"render\", \"percent\": 40.2,"
         " \"eta_s\": 124.2, \"maps\": [{\"kind\": \"global\", \"cached\": true,"
         " \"stored\": 2000123, \"bytes\": 48000000, \"seconds\": 12.34}]}"},
        {"GET /v1/jobs/7", 200,
         "{\"id\": \"7\", \"state\": \"succeeded\", \"percent\": 100, \"maps\": ["
         " {\"kind\": \"global\", \"cached\": true, \"stored\": 2000123, \"bytes\": 48000000,"
         "  \"seconds\": 12.34}, {\"kind\": \"caustic\", \"cached\": false, \"stored\": 950,"
         "  \"bytes\": 22800, \"seconds\": 3}, {\"kind\": \"precomputed\", \"cached\": false,"
         "  \"stored\": 2000123, \"reused\": 500456, \"bytes\": 48000000, \"seconds\": 9}]}"},
        {NULL, 0, NULL}};
    struct fixture *f = *state;

    run(f, canned, "wait", "7", NULL);
    assert_int_equal(f->result.exit_code, 0);
    assert_says(f->result.err, "queued   ETA ?");
    assert_says(f->result.err, " 40 %  render   ETA 2:05");
    assert_says(f->result.err,
                "global map: found in the cache (2.0 M photons, 48.0 MB), 12.3 s saved");
    assert_says(f->result.err, "caustic map: built in 3.0 s (950 photons, 22.8 kB)");
    assert_says(f->result.err,
                "precomputed map: topped up from 500.5 k photons (2.0 M photons, 48.0 MB)");
    assert_says(f->result.err, "job 7: succeeded");
    assert_string_equal(f->result.out, "");
}

static void test_wait_fails_with_the_job(void **state)
{
    static const struct canned canned[] = {
        {"GET /v1/jobs/7", 200,
         "{\"id\": \"7\", \"state\": \"failed\", \"percent\": 10, \"error\": {\"type\":"
         " \"urn:oriel:error:range\", \"title\": \"Out of range\", \"detail\": \"not a number\","
         " \"file\": \"room.rad\", \"line\": 12, \"primitive\": \"polygon floor\","
         " \"hint\": \"mend the vertex\"}}"},
        {NULL, 0, NULL}};
    struct fixture *f = *state;

    run(f, canned, "wait", "7", NULL);
    assert_int_equal(f->result.exit_code, 1);
    assert_says(f->result.err, "room.rad:12: polygon floor: not a number (mend the vertex)\n");
    assert_says(f->result.err, "job 7: failed");
}

static void test_problems_read_like_compilers(void **state)
{
    static const struct canned canned[] = {
        {"GET /v1/jobs/9", 404, "{\"title\": \"Not found\", \"detail\": \"there is no job 9\"}"},
        {"GET /v1/jobs", 500, "<html>oops</html>"},
        {"GET /v1/maps", 200, "this is no JSON"},
        {NULL, 0, NULL}};
    struct fixture *f = *state;

    run(f, canned, "status", "9", NULL);
    assert_int_equal(f->result.exit_code, 1);
    assert_string_equal(f->result.err, "oriel: there is no job 9\n");
    run(f, canned, "status", NULL, NULL);
    assert_int_equal(f->result.exit_code, 1);
    assert_says(f->result.err, "the daemon answered 500 and gave no reason");
    run(f, canned, "maps", NULL, NULL);
    assert_int_equal(f->result.exit_code, 1);
    assert_says(f->result.err, "not JSON");
    /* Ids are data: they cannot reach another resource. */
    run(f, canned, "status", "../maps", NULL);
    assert_int_equal(f->result.exit_code, 1);
    assert_int_equal(times_asked(f, "GET /v1/maps"), 1);
}

static void test_status_is_a_table(void **state)
{
    static const struct canned canned[] = {
        {"GET /v1/jobs", 200,
         "{\"jobs\": ["
         "{\"id\": \"0123456789abcdef0123456789abcdef\", \"name\": \"B\u00fcro mit sehr langem "
         "Namen, "
         "2. Stock\", \"tags\": [\"x\"], \"kind\": \"render\", \"state\": \"running\", "
         "\"percent\": 42.04,"
         " \"eta_s\": 124.2, \"error\": 0.031, \"created\": \"2024-03-22T11:30:00.123Z\"},"
         "{\"id\": \"fedcba9876543210fedcba9876543210\", \"name\": null, \"tags\": [\"x\", \"y\"],"
         " \"kind\": \"study\", \"state\": \"queued\", \"percent\": null, \"eta_s\": null, "
         "\"error\": null,"
         " \"queue_position\": 2, \"created\": \"2024-03-22T11:31:00.123Z\"}], \"more\": false}"},
        {"GET /v1/jobs/fedcba98", 200, "{\"id\": \"fedcba9876543210fedcba9876543210\"}"},
        {"DELETE /v1/jobs/fedcba9876543210fedcba9876543210", 204, ""},
        {NULL, 0, NULL}};
    struct fixture *f = *state;

    run_args(f, canned, (const char *const[]){"status", "--tag", "x y", "--server", f->url, NULL});
    assert_int_equal(f->result.exit_code, 0);
    assert_says(f->result.out, "01234567  B\xc3\xbcro mit sehr langem Nam  render  running       "
                               "42.0 %         2:05    3.1 %  2024-03-22T11:30:00\n");
    assert_says(f->result.out, "fedcba98  x,y                       study   queued          "
                               "       2. in line           2024-03-22T11:31:00\n");
    /* What it shows is enough to remove one by. */
    run_args(f, canned,
             (const char *const[]){"remove", "job", "fedcba98", "--server", f->url, NULL});
    assert_int_equal(f->result.exit_code, 0);
    assert_int_equal(times_asked(f, "DELETE /v1/jobs/fedcba9876543210fedcba9876543210"), 1);
}

static void test_no_daemon_is_said_so(void **state)
{
    struct fixture *f = *state;

    MHD_stop_daemon(f->daemon);
    f->daemon = NULL;
    run(f, NULL, "maps", NULL, NULL);
    assert_int_equal(f->result.exit_code, 1);
    assert_says(f->result.err, "no answer from http://127.0.0.1:");
    assert_says(f->result.err, "`orield`");
}

static void test_maps_table_adds_up(void **state)
{
    static const struct canned canned[] = {
        {"GET /v1/maps", 200,
         "{\"maps\": [{\"kind\": \"global\", \"key\": \"0123456789abcdef\", \"emitted\": 31000000,"
         " \"stored\": 2000000, \"bytes\": 48000000, \"seconds\": 10.5, \"hits\": 4, \"created\":"
         " \"2020-01-02T03:04:05Z\", \"in_use\": true}]}"},
        {NULL, 0, NULL}};
    struct fixture *f = *state;

    run(f, canned, "maps", NULL, NULL);
    assert_int_equal(f->result.exit_code, 0);
    assert_says(f->result.out, "0123456789ab ");
    assert_says(f->result.out, "31.0 M");
    assert_says(f->result.out, " d  in use\n");
    assert_says(f->result.out, "1 maps, 48.0 MB; found ready, they saved 42 s");
}

static void test_fetch_keeps_images_and_result(void **state)
{
    static const struct canned canned[] = {
        {"GET /v1/jobs/7/result", 200, "{\"state\": \"succeeded\"}"},
        {"GET /v1/jobs/7", 200,
         "{\"state\": \"succeeded\", \"files\": [{\"name\": \"result.json\", \"bytes\": 22},"
         " {\"name\": \"desk.hdr\", \"bytes\": 11}, {\"name\": \"desk.png\", \"bytes\": 3}]}"},
        {"GET /v1/jobs/7/files/desk.hdr", 200, "#?RADIANCE\n"},
        {"GET /v1/jobs/7/files/desk.png", 200, "PNG"},
        {NULL, 0, NULL}};
    struct fixture *f = *state;
    char *hdr, *result;

    run(f, canned, "fetch", "7", f->folder);
    assert_int_equal(f->result.exit_code, 0);
    hdr = cli_read_file(f->folder, "desk.hdr");
    result = cli_read_file(f->folder, "result.json");
    assert_string_equal(hdr, "#?RADIANCE\n");
    assert_string_equal(result, canned[0].body);
    free(hdr);
    free(result);
}

static void test_fetch_keeps_nothing_that_failed(void **state)
{
    static const struct canned unfinished[] = {
        {"GET /v1/jobs/7", 200, "{\"state\": \"running\"}"},
        {"GET /v1/jobs/7/result", 409, "{\"detail\": \"the job still runs\"}"},
        {NULL, 0, NULL}};
    static const struct canned missing[] = {
        {"GET /v1/jobs/8", 200, "{\"files\": [{\"name\": \"gone.hdr\"}]}"},
        {"GET /v1/jobs/8/result", 200, "{}"},
        {"GET /v1/jobs/8/files/gone.hdr", 404, "{\"detail\": \"there is no gone.hdr\"}"},
        {NULL, 0, NULL}};
    static const struct canned hostile[] = {
        {"GET /v1/jobs/9", 200, "{\"files\": [{\"name\": \"../evil.hdr\"}]}"},
        {"GET /v1/jobs/9/result", 200, "{}"},
        {NULL, 0, NULL}};
    struct fixture *f = *state;
    char inside[96];

    snprintf(inside, sizeof inside, "%s/in", f->folder);
    run(f, unfinished, "fetch", "7", inside);
    assert_int_equal(f->result.exit_code, 1);
    assert_says(f->result.err, "the job still runs");
    run(f, missing, "fetch", "8", inside);
    assert_int_equal(f->result.exit_code, 1);
    run(f, hostile, "fetch", "9", inside);
    assert_int_equal(f->result.exit_code, 1);
    assert_says(f->result.err, "leave the output folder");
    assert_null(cli_read_file(inside, "result.json"));
    assert_null(cli_read_file(inside, "gone.hdr"));
    assert_null(cli_read_file(inside, "gone.hdr.part"));
    assert_null(cli_read_file(f->folder, "evil.hdr"));
}

static void test_cancel(void **state)
{
    static const struct canned canned[] = {
        {"POST /v1/jobs/7/cancel", 202, "{\"state\": \"running\", \"cancelling\": true}"},
        {"GET /v1/jobs/7", 200, "{\"state\": \"running\", \"cancelling\": true}"},
        {"GET /v1/jobs/7", 200, "{\"state\": \"cancelled\"}"},
        {NULL, 0, NULL}};
    struct fixture *f = *state;

    run(f, canned, "cancel", "7", NULL);
    assert_int_equal(f->result.exit_code, 0);
    assert_int_equal(times_asked(f, "GET /v1/jobs/7"), 2);
    assert_says(f->result.err, "job 7: cancelling");
    assert_says(f->result.err, "job 7: cancelled");
    assert_int_equal(times_asked(f, "POST /v1/jobs/7/cancel"), 1);
}

#define SCENE_ID "0123456789abcdef0123456789abcdef0123456789abcdef0123456789abcdef"

static const struct request *find_request(const struct fixture *f, const char *line)
{
    for (size_t i = 0; i < f->n_requests; i++)
        if (strcmp(f->requests[i].line, line) == 0)
            return &f->requests[i];
    fail_msg("no request \"%s\"", line);
    return NULL;
}

static void test_submit_sends_scene_references_and_sensors(void **state)
{
    static const struct canned canned[] = {
        {"POST /v1/scenes", 201, "{\"id\": \"" SCENE_ID "\"}"},
        {"POST /v1/jobs", 202, "{\"id\": \"42\", \"state\": \"queued\"}"},
        {NULL, 0, NULL}};
    struct fixture *f = *state;
    const char *upload, *main_part, *other_part;
    char path[96];
    json_t *job, *wanted = json_loads("[[1, 2, 3, 0, 0, 1], [1.5, 2, 3, 0, 0, -1]]", 0, NULL);

    cli_write_file(f->folder, "room.rad",
                   "void glow g\n0\n0\n4 1 1 1 0\n"
                   "g source sky\n0\n0\n4 0 0 1 180\n"
                   "void plastic p\n0\n0\n5 .5 .5 .5 0 0\n"
                   "!xform -t 0 0 1 chair.rad\n");
    cli_write_file(f->folder, "chair.rad", "p polygon seat\n0\n0\n9 0 0 0 1 0 0 0 1 0\n");
    cli_write_file(f->folder, "unused.rad", "");
    cli_write_file(f->folder, "sensors.txt", "# two\n1 2 3 0 0 1\n\n  1.5 2 3 0 0 -1 # down\n");
    cli_write_file(f->folder, "job.json",
                   "{\"kind\": \"render\", \"seed\": 5, \"scene\": {\"files\":"
                   " [\"room.rad\"]}, \"sensors\": {\"file\": \"sensors.txt\"}}");
    snprintf(path, sizeof path, "%s/job.json", f->folder);
    run(f, canned, "submit", path, NULL);
    assert_string_equal(f->result.out, "42\n");
    assert_int_equal(f->result.exit_code, 0);
    upload = find_request(f, "POST /v1/scenes")->body;
    main_part = strstr(upload, "name=\"file\"; filename=\"room.rad\"");
    other_part = strstr(upload, "name=\"resource\"; filename=\"chair.rad\"");
    assert_true(main_part && other_part && main_part < other_part);
    assert_null(strstr(upload, "unused.rad"));
    job = json_loads(find_request(f, "POST /v1/jobs")->body, 0, NULL);
    assert_string_equal(json_string_value(json_object_get(job, "scene")), SCENE_ID);
    assert_int_equal(json_integer_value(json_object_get(job, "seed")), 5);
    assert_int_equal(json_array_size(json_object_get(job, "sensors")), 2);
    for (size_t i = 0; i < 12; i++)
        assert_true(json_number_value(json_array_get(
                        json_array_get(json_object_get(job, "sensors"), i / 6), i % 6)) ==
                    json_number_value(json_array_get(json_array_get(wanted, i / 6), i % 6)));
    json_decref(job);
    json_decref(wanted);
}

static void test_submit_finds_mistakes_before_sending(void **state)
{
    static const struct canned nothing[] = {{NULL, 0, NULL}};
    static const struct {
        const char *room, *sensors, *says;
    } cases[] = {
        {"void plastic p\n0\n0\n5 .5 .5\n", "1 2 3 0 0 1\n", "room.rad:"},
        {"void glow g\n0\n0\n4 1 1 1 0\n", "1 2 3 0 0 1\n1 2 3 0 0 one\n", "sensors.txt:2:"},
    };
    struct fixture *f = *state;
    char path[96], climbing[160];

    snprintf(path, sizeof path, "%s/job.json", f->folder);
    cli_write_file(f->folder, "job.json",
                   "{\"kind\": \"render\", \"scene\": {\"files\":"
                   " [\"room.rad\"]}, \"sensors\": {\"file\": \"sensors.txt\"}}");
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        cli_write_file(f->folder, "room.rad", cases[i].room);
        cli_write_file(f->folder, "sensors.txt", cases[i].sensors);
        run(f, nothing, "submit", path, NULL);
        assert_int_equal(f->result.exit_code, 1);
        assert_says(f->result.err, cases[i].says);
        assert_string_equal(f->result.out, "");
        assert_int_equal(f->n_requests, 0);
    }
    /* A reference out of the folder works for `oriel run`, but no upload can carry it. */
    snprintf(climbing, sizeof climbing,
             "void plastic p\n0\n0\n5 .5 .5 .5 0 0\n!xform ../%s/a.rad\n",
             strrchr(f->folder, '/') + 1);
    cli_write_file(f->folder, "room.rad", climbing);
    cli_write_file(f->folder, "a.rad", "p sphere s\n0\n0\n4 0 0 0 1\n");
    cli_write_file(f->folder, "sensors.txt", "1 2 3 0 0 1\n");
    run(f, nothing, "submit", path, NULL);
    assert_int_equal(f->result.exit_code, 1);
    assert_says(f->result.err, "lies outside the scene's folder");
    assert_int_equal(f->n_requests, 0);
}

static void test_upload_bsdf_sends_the_bytes(void **state)
{
    static const struct canned canned[] = {{"POST /v1/bsdfs", 201, "{\"id\": \"" SCENE_ID "\"}"},
                                           {NULL, 0, NULL}};
    struct fixture *f = *state;
    char path[96];
    const char *const args[] = {"upload", "bsdf", path, "--server", f->url, NULL};

    cli_write_file(f->folder, "shade.xml", "<WindowElement/>");
    snprintf(path, sizeof path, "%s/shade.xml", f->folder);
    run_args(f, canned, args);
    assert_int_equal(f->result.exit_code, 0);
    assert_string_equal(f->result.out, SCENE_ID "\n");
    assert_string_equal(find_request(f, "POST /v1/bsdfs")->body, "<WindowElement/>");
}

static void test_upload_folder_finds_its_scene(void **state)
{
    static const struct canned canned[] = {{"POST /v1/scenes", 201, "{\"id\": \"" SCENE_ID "\"}"},
                                           {NULL, 0, NULL}};
    struct fixture *f = *state;
    const char *const args[] = {"upload", "scene", f->folder, "--server", f->url, NULL};
    const char *const list[] = {"upload", "scene", f->folder, "--list", NULL};

    cli_write_file(f->folder, "materials.rad", "void plastic p\n0\n0\n5 .5 .5 .5 0 0\n");
    cli_write_file(f->folder, "room.rad",
                   "!xform -t 1 1 1 \\\n ./chair.rad\np sphere t\n0\n0\n4 9 0 0 1\n");
    cli_write_file(f->folder, "chair.rad", "p sphere s\n0\n0\n4 0 0 0 1\n");
    cli_write_file(f->folder, "notes.txt", "not of the scene\n");
    run_args(f, canned, list);
    assert_int_equal(f->result.exit_code, 0);
    assert_string_equal(f->result.out,
                        "scene    materials.rad\nscene    room.rad\nresource chair.rad\n");
    run_args(f, canned, args);
    assert_int_equal(f->result.exit_code, 0);
    assert_string_equal(f->result.out, SCENE_ID "\n");
    assert_null(strstr(find_request(f, "POST /v1/scenes")->body, "notes.txt"));
}

static void test_upload_zip_sends_the_bytes(void **state)
{
    static const struct canned canned[] = {{"POST /v1/scenes", 201, "{\"id\": \"" SCENE_ID "\"}"},
                                           {NULL, 0, NULL}};
    struct fixture *f = *state;
    char path[96];
    const char *const args[] = {"upload", "scene",    path,   "b c.rad",
                                "a.rad",  "--server", f->url, NULL};

    cli_write_file(f->folder, "scene.zip", "PK");
    snprintf(path, sizeof path, "%s/scene.zip", f->folder);
    run_args(f, canned, args);
    assert_int_equal(f->result.exit_code, 0);
    assert_string_equal(f->result.out, SCENE_ID "\n");
    assert_string_equal(find_request(f, canned[0].request)->body, "PK");
}

#define BSDF_ID "18e347bfe032de96295acd358db2bd332ea8daab610bb2aa87a9eb7d21f4215b"
#define KNOWN_ID "5ba274fae42b925d7861240f35514e6583ede8c7090a3af09a298630fecceba3"

/* The daemon is asked first, by the digest of what would be sent. */
static void test_upload_skips_what_is_known(void **state)
{
    static const struct canned canned[] = {{"HEAD /v1/bsdfs/" BSDF_ID, 200, ""},
                                           {"HEAD /v1/scenes/" KNOWN_ID, 200, ""},
                                           {NULL, 0, NULL}};
    struct fixture *f = *state;
    char path[96];
    const char *const bsdf[] = {"upload", "bsdf", path, "--server", f->url, NULL};
    const char *const scene[] = {"upload", "scene", f->folder, "--server", f->url, NULL};

    cli_write_file(f->folder, "shade.xml", "<WindowElement/>");
    snprintf(path, sizeof path, "%s/shade.xml", f->folder);
    run_args(f, canned, bsdf);
    assert_int_equal(f->result.exit_code, 0);
    assert_string_equal(f->result.out, BSDF_ID "\n");
    cli_write_file(f->folder, "m.rad",
                   "void plastic p\n0\n0\n5 .5 .5 .5 0 0\n!xform ./chair.rad\n");
    cli_write_file(f->folder, "chair.rad", "p sphere s\n0\n0\n4 0 0 0 1\n");
    run_args(f, canned, scene);
    assert_int_equal(f->result.exit_code, 0);
    assert_string_equal(f->result.out, KNOWN_ID "\n");
    assert_says(f->result.err, "already known");
    assert_int_equal(f->n_requests, 2);
}

static void test_removal(void **state)
{
    static const struct canned canned[] = {
        {"DELETE /v1/jobs/7", 204, ""},
        {"DELETE /v1/jobs/8", 409, "{\"title\": \"In use\", \"detail\": \"it runs\"}"},
        {"DELETE /v1/scenes/a", 204, ""},
        {"DELETE /v1/scenes/b", 204, ""},
        {"GET /v1/maps", 200,
         "{\"maps\": [{\"kind\": \"bsdf\", \"key\": \"01ab\"}, {\"kind\": \"global\", \"key\":"
         " \"01cd\"}]}"},
        {"DELETE /v1/maps/global/01cd", 204, ""},
        {NULL, 0, NULL}};
    struct fixture *f = *state;
    const char *const scenes[] = {"remove", "scene", "a", "b", "--server", f->url, NULL};
    const char *const jobs[] = {"remove", "job", "7", "8", "--server", f->url, NULL};
    const char *const others[] = {"remove", "map", "x", NULL};
    const char *const one[] = {"maps", "--remove", "01c", "--server", f->url, NULL};
    const char *const two[] = {"maps", "--remove", "01", "--server", f->url, NULL};

    run_args(f, canned, scenes);
    assert_int_equal(f->result.exit_code, 0);
    run_args(f, canned, jobs);
    assert_int_equal(f->result.exit_code, 1);
    assert_says(f->result.err, "job 7: removed");
    assert_says(f->result.err, "8: it runs");
    run_args(f, canned, others);
    assert_int_equal(f->result.exit_code, 2);
    run_args(f, canned, one);
    assert_int_equal(f->result.exit_code, 0);
    assert_int_equal(times_asked(f, "DELETE /v1/maps/global/01cd"), 1);
    run_args(f, canned, two);
    assert_int_equal(f->result.exit_code, 1);
    assert_says(f->result.err, "more than one map");
}

#define TEST(name) cmocka_unit_test_setup_teardown(name, set_up, tear_down)

int main(void)
{
    const struct CMUnitTest tests[] = {
        TEST(test_wait_shows_progress_and_the_cache),
        TEST(test_wait_fails_with_the_job),
        TEST(test_problems_read_like_compilers),
        TEST(test_status_is_a_table),
        TEST(test_no_daemon_is_said_so),
        TEST(test_maps_table_adds_up),
        TEST(test_fetch_keeps_images_and_result),
        TEST(test_fetch_keeps_nothing_that_failed),
        TEST(test_cancel),
        TEST(test_submit_sends_scene_references_and_sensors),
        TEST(test_submit_finds_mistakes_before_sending),
        TEST(test_upload_bsdf_sends_the_bytes),
        TEST(test_upload_folder_finds_its_scene),
        TEST(test_upload_zip_sends_the_bytes),
        TEST(test_upload_skips_what_is_known),
        TEST(test_removal),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
