/* Uploads: accepted files, their ids, and refusals that leave nothing behind. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <math.h>
#include <netinet/in.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

#include "store/files/folders.h"
#include "store/files/scene_bundle.h"
#include "support/daemon.h"
#include "support/patience.h"

static int setup(void **state)
{
    static struct daemon daemon;
    static const char *const extra[] = {"--idle-timeout", "3", NULL};
    daemon_start(&daemon, extra);
    *state = &daemon;
    return 0;
}

/* ---- BSDFs ---------------------------------------------------------------------------------- */

/* A Klems matrix on a basis of two patches, which the file itself defines: enough to be valid. */
#define WINDOW_HEAD                                                                                \
    "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<WindowElement "                                  \
    "xmlns=\"http://windows.lbl.gov\">\n<Optical><Layer>\n<Material><Name>Test</Name>"             \
    "</Material>\n<DataDefinition><IncidentDataStructure>Columns</IncidentDataStructure>\n"        \
    "<AngleBasis><AngleBasisName>LBNL/Two</AngleBasisName>\n"                                      \
    "<AngleBasisBlock><Theta>0</Theta><nPhis>1</nPhis><ThetaBounds><LowerTheta>0</LowerTheta>"     \
    "<UpperTheta>45</UpperTheta></ThetaBounds></AngleBasisBlock>\n"                                \
    "<AngleBasisBlock><Theta>67.5</Theta><nPhis>1</nPhis><ThetaBounds><LowerTheta>45"              \
    "</LowerTheta><UpperTheta>90</UpperTheta></ThetaBounds></AngleBasisBlock>\n"                   \
    "</AngleBasis></DataDefinition>\n"                                                             \
    "<WavelengthData><Wavelength unit=\"Integral\">Visible</Wavelength>\n<WavelengthDataBlock>"    \
    "<WavelengthDataDirection>Transmission Front</WavelengthDataDirection>\n"                      \
    "<ColumnAngleBasis>LBNL/Two</ColumnAngleBasis><RowAngleBasis>LBNL/Two</RowAngleBasis>\n"

#define WINDOW_TAIL "</WavelengthDataBlock></WavelengthData></Layer></Optical></WindowElement>\n"

static const char bsdf_xml[] =
    WINDOW_HEAD "<ScatteringData>0.1, 0.1,\n0.1, 0.1,\n</ScatteringData>" WINDOW_TAIL;
static const char bsdf_truncated[] = WINDOW_HEAD "<ScatteringData>0.1, 0.1,";
static const char bsdf_nan[] =
    WINDOW_HEAD "<ScatteringData>0.1, nan,\n0.1, 0.1,\n</ScatteringData>" WINDOW_TAIL;

static void post_bsdf(struct daemon *daemon, const char *xml, struct reply *reply)
{
    daemon_request(daemon, "POST", "/v1/bsdfs?name=test.xml", "application/xml", xml, strlen(xml),
                   NULL, reply);
}

static void test_bsdf(void **state)
{
    struct reply reply;
    char sha[ORL_SHA_HEX], path[128], header[128];
    orl_sha256_hex(bsdf_xml, strlen(bsdf_xml), sha);
    post_bsdf(*state, bsdf_xml, &reply);
    if (reply.status != 201)
        fail_msg("%s", reply.body);
    assert_string_equal(reply_text(&reply, "id"), sha);
    assert_true(json_is_true(reply_at(&reply, "created")));
    assert_string_equal(reply_text(&reply, "summary.name"), "Test");
    assert_true(json_is_object(reply_at(&reply, "summary.components")));
    assert_string_equal(reply_text(&reply, "summary.check.verdict"), "note");
    reply_done(&reply);
    post_bsdf(*state, bsdf_xml, &reply);
    assert_int_equal(reply.status, 200);
    assert_true(json_is_false(reply_at(&reply, "created")));
    reply_done(&reply);
    snprintf(path, sizeof path, "/v1/bsdfs/%s", sha);
    daemon_get(*state, path, &reply);
    assert_int_equal(reply.status, 200);
    assert_true(reply_number(&reply, "bytes") == (double)strlen(bsdf_xml));
    assert_true(json_is_array(reply_at(&reply, "summary.check.hemispherical.back")));
    reply_done(&reply);
    snprintf(header, sizeof header, "If-None-Match: \"%s\"", sha);
    daemon_request(*state, "GET", path, NULL, NULL, 0, header, &reply);
    assert_int_equal(reply.status, 304);
    assert_int_equal(reply.size, 0);
    reply_done(&reply);
}

static void test_bad_bsdfs(void **state)
{
    static const char *const bad[] = {bsdf_truncated, bsdf_nan, "", "plain text",
                                      "<?xml version=\"1.0\"?><!DOCTYPE a [<!ENTITY b \"c\">]>"
                                      "<WindowElement>&b;</WindowElement>"};
    const size_t before = daemon_count_files(*state, "blobs");
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        struct reply reply;
        post_bsdf(*state, bad[i], &reply);
        if (reply.status < 400 || reply.status > 499)
            fail_msg("bad BSDF %zu: %ld %s", i, reply.status, reply.body);
        assert_string_equal(reply_text(&reply, "file"), "test.xml");
        assert_true(reply_number(&reply, "line") >= 1);
        reply_done(&reply);
    }
    assert_int_equal(daemon_count_files(*state, "blobs"), before);
    daemon_expect_no_files(*state, "tmp");
}

/* ---- Scenes --------------------------------------------------------------------------------- */

static struct upload_file file_of(const char *name, const char *text)
{
    return (struct upload_file){name, text, strlen(text), false};
}

static void test_scene_and_its_id(void **state)
{
    const struct upload_file files[] = {file_of("b.rad", room_scene), file_of("a.rad", room_sky)};
    struct reply reply;
    struct orl_bundle bundle = {0};
    char sha[ORL_SHA_HEX], id[ORL_SHA_HEX], path[128];
    /* The id is the digest that the header describes for clients. */
    orl_sha256_hex(room_scene, strlen(room_scene), sha);
    orl_bundle_add(&bundle, "b.rad", false, "", 1, sha, false, NULL);
    orl_sha256_hex(room_sky, strlen(room_sky), sha);
    orl_bundle_add(&bundle, "a.rad", false, "", 1, sha, false, NULL);
    assert_int_equal(orl_bundle_id(&bundle, id, NULL), 0);
    orl_bundle_done(&bundle);

    daemon_upload(*state, files, 2, NULL, &reply);
    if (reply.status != 201)
        fail_msg("%s", reply.body);
    assert_string_equal(reply_text(&reply, "id"), id);
    assert_true(json_is_true(reply_at(&reply, "created")));
    assert_true(reply_number(&reply, "summary.surfaces") == 8);
    assert_true(reply_number(&reply, "summary.sources") >= 2);
    assert_true(reply_number(&reply, "summary.bounds.max.1") == 5);
    snprintf(path, sizeof path, "/v1/scenes/%s", id);
    assert_string_equal(reply_header(&reply, "Location"), path);
    reply_done(&reply);

    daemon_upload(*state, files, 2, NULL, &reply);
    assert_int_equal(reply.status, 200);
    assert_string_equal(reply_text(&reply, "id"), id);
    reply_done(&reply);
    daemon_request(*state, "HEAD", path, NULL, NULL, 0, NULL, &reply);
    assert_int_equal(reply.status, 200);
    reply_done(&reply);
}

/* The order of main files matters (modifiers come first); the form of the upload does not. */
static void test_same_scene_by_json(void **state)
{
    struct reply reply;
    char id[65];
    const struct upload_file files[] = {file_of("r.rad", room_scene), file_of("s.rad", room_sky)};
    daemon_upload(*state, files, 2, NULL, &reply);
    assert_true(reply.status == 201 || reply.status == 200);
    snprintf(id, sizeof id, "%s", reply_text(&reply, "id"));
    reply_done(&reply);
    json_t *doc = json_pack("{s:[{s:s, s:s}, {s:s, s:s}]}", "files", "name", "r.rad", "text",
                            room_scene, "name", "s.rad", "text", room_sky);
    char *text = json_dumps(doc, 0);
    daemon_post_json(*state, "/v1/scenes", text, &reply);
    assert_int_equal(reply.status, 200);
    assert_string_equal(reply_text(&reply, "id"), id);
    reply_done(&reply);
    free(text);
    json_decref(doc);
}

static const char with_bsdf[] = "void BSDF panel\n6 0 panel.xml 0 0 1 .\n0\n0\n"
                                "panel polygon p\n0\n0\n12 0 0 1  0 0 2  4 0 2  4 0 1\n";

static void test_bsdf_by_id(void **state)
{
    struct reply reply;
    char bsdfs[128], id[65], first[65];
    const struct upload_file alone[] = {file_of("a.rad", with_bsdf)};
    const struct upload_file both[] = {file_of("a.rad", with_bsdf), file_of("panel.xml", bsdf_xml)};
    post_bsdf(*state, bsdf_xml, &reply);
    snprintf(id, sizeof id, "%s", reply_text(&reply, "id"));
    reply_done(&reply);
    snprintf(bsdfs, sizeof bsdfs, "{\"panel.xml\": \"%s\"}", id);
    daemon_upload(*state, alone, 1, bsdfs, &reply);
    if (reply.status != 201)
        fail_msg("%s", reply.body);
    assert_true(reply_number(&reply, "summary.bsdfs") == 1);
    assert_string_equal(reply_text(&reply, "summary.referenced.0"), "panel.xml");
    snprintf(first, sizeof first, "%s", reply_text(&reply, "id"));
    reply_done(&reply);
    /* Uploaded together, it is the same scene. */
    daemon_upload(*state, both, 2, NULL, &reply);
    assert_int_equal(reply.status, 200);
    assert_string_equal(reply_text(&reply, "id"), first);
    reply_done(&reply);
    snprintf(bsdfs, sizeof bsdfs, "{\"panel.xml\": \"%064d\"}", 7);
    daemon_upload(*state, alone, 1, bsdfs, &reply);
    assert_int_equal(reply.status, 422);
    assert_string_equal(reply_text(&reply, "primitive"), "bsdfs.panel.xml");
    reply_done(&reply);
}

/* Invalid scenes: the second file's text (the first is valid), and the text that the problem must
 * contain. */
static const struct {
    const char *what, *text;
    long status;
    int line; /* 0: any */
    const char *primitive;
} bad_scenes[] = {
    {"a count that is not a number", "white polygon p\nzero\n0\n9 0 0 0 1 0 0 0 1 0\n", 400, 0,
     "polygon p"},
    {"too few numbers", "white polygon p\n0\n0\n9 0 0 0 1 0 0\n", 400, 0, "polygon p"},
    {"a NaN", "white polygon p\n0\n0\n9 0 0 0 nan 0 0 0 1 0\n", 0, 0, "polygon p"},
    {"an infinite number", "white sphere s\n0\n0\n4 0 0 0 1e999\n", 0, 0, "sphere s"},
    {"a missing BSDF file",
     "void BSDF b\n6 0 absent.xml 0 0 1 .\n0\n0\nb polygon p\n0\n0\n9 0 0 0 1 0 0 0 1 0\n", 422, 0,
     "BSDF b"},
    {"an unknown primitive", "\n\nwhite teapot t\n0\n0\n0\n", 400, 3, "teapot t"},
    {"one that is not simulated",
     "\nvoid BRTDfunc d\n10 0 0 0 Px Px Px 0 0 0 .\n0\n9 0 0 0 0 0 0 0 0 0\nd sphere s 0 0 4 0 0 0 "
     "1\n",
     422, 2, "BRTDfunc d"},
    {"an unknown modifier", "nobody polygon p\n0\n0\n9 0 0 0 1 0 0 0 1 0\n", 0, 1, "polygon p"},
    {"a program to run", "!rm -rf /\n", 422, 1, ""},
    {"a file outside", "!xform ../../etc/passwd\n", 0, 1, ""},
};

static void test_bad_scenes_leave_nothing(void **state)
{
    const size_t blobs = daemon_count_files(*state, "blobs");
    for (size_t i = 0; i < sizeof bad_scenes / sizeof *bad_scenes; i++) {
        struct reply reply;
        const struct upload_file files[] = {file_of("room.rad", room_scene),
                                            file_of("bad.rad", bad_scenes[i].text)};
        daemon_upload(*state, files, 2, NULL, &reply);
        if (reply.status < 400 || reply.status > 499 ||
            (bad_scenes[i].status && reply.status != bad_scenes[i].status) ||
            strcmp(reply_text(&reply, "file"), "bad.rad") != 0 ||
            !(reply_number(&reply, "line") >= 1) ||
            (bad_scenes[i].line && reply_number(&reply, "line") != bad_scenes[i].line) ||
            !strstr(reply_text(&reply, "primitive"), bad_scenes[i].primitive))
            fail_msg("%s: %ld %s", bad_scenes[i].what, reply.status, reply.body);
        reply_done(&reply);
    }
    assert_int_equal(daemon_count_files(*state, "blobs"), blobs);
    daemon_expect_no_files(*state, "tmp");
}

/* The error of a truncated BSDF has its own name and line. */
static void test_bad_bsdf_in_scene(void **state)
{
    struct reply reply;
    const struct upload_file files[] = {file_of("a.rad", with_bsdf),
                                        file_of("panel.xml", bsdf_truncated)};
    const size_t blobs = daemon_count_files(*state, "blobs");
    daemon_upload(*state, files, 2, NULL, &reply);
    assert_int_equal(reply.status, 400);
    assert_string_equal(reply_text(&reply, "file"), "panel.xml");
    assert_true(reply_number(&reply, "line") > 1);
    reply_done(&reply);
    assert_int_equal(daemon_count_files(*state, "blobs"), blobs);
}

static void test_empty_and_missing_files(void **state)
{
    struct reply reply;
    const struct upload_file empty[] = {file_of("room.rad", room_scene), file_of("e.rad", "")};
    daemon_upload(*state, empty, 2, NULL, &reply);
    assert_int_equal(reply.status, 400);
    assert_string_equal(reply_text(&reply, "file"), "e.rad");
    assert_true(reply_number(&reply, "line") == 1);
    reply_done(&reply);
    const struct upload_file only_resources[] = {file_of("a.xml", bsdf_xml)};
    daemon_upload(*state, only_resources, 1, NULL, &reply);
    assert_int_equal(reply.status, 422);
    reply_done(&reply);
    daemon_upload(*state, empty, 0, "{}", &reply);
    assert_int_equal(reply.status, 422);
    reply_done(&reply);
}

static void test_names_are_checked(void **state)
{
    static const char *const names[] = {"../up.rad", "/etc/passwd", "a/../b.rad",   "./a.rad",
                                        "a//b.rad",  "a\\b.rad",    "bell\x07.rad", "\xff.rad"};
    struct orl_error err;
    char longest[300];
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        assert_int_equal(orl_bundle_check_name(names[i], &err), ORL_ERR_INVALID);
        struct reply reply;
        const struct upload_file files[] = {file_of(names[i], room_scene)};
        if (i >= 5)
            continue; /* libcurl would escape these in a form */
        daemon_upload(*state, files, 1, NULL, &reply);
        assert_int_equal(reply.status, 422);
        assert_true(strlen(reply_text(&reply, "file")) > 0);
        reply_done(&reply);
    }
    memset(longest, 'x', sizeof longest);
    longest[256] = '\0';
    assert_int_equal(orl_bundle_check_name(longest, &err), ORL_ERR_INVALID);
    longest[255] = '\0';
    assert_int_equal(orl_bundle_check_name(longest, &err), 0);
    assert_int_equal(orl_bundle_check_name("", &err), ORL_ERR_INVALID);
    assert_int_equal(orl_bundle_check_name("model/bsdf/Stor\xc3\xa4.xml", &err), 0);
    const struct upload_file twice[] = {file_of("a.rad", room_scene), file_of("a.rad", room_sky)};
    struct reply reply;
    daemon_upload(*state, twice, 2, NULL, &reply);
    assert_int_equal(reply.status, 422);
    reply_done(&reply);
}

static void test_bad_json_uploads(void **state)
{
    static const struct {
        const char *text, *path;
    } bad[] = {
        {"{}", "files"},
        {"{\"files\":[{\"name\":\"a.rad\"}]}", "files[0]"},
        {"{\"files\":[{\"name\":\"a.rad\",\"text\":\"x\",\"base64\":\"eA==\"}]}", "files[0]"},
        {"{\"files\":[{\"name\":\"a.rad\",\"base64\":\"*\"}]}", "files[0]"},
        {"{\"files\":[{\"name\":7,\"text\":\"x\"}]}", "files[0].name"},
        {"{\"files\":[{\"name\":\"a.rad\",\"text\":\"x\",\"mode\":1}]}", "files[0].mode"},
        {"{\"files\":[{\"name\":\"a.rad\",\"text\":\"#\"}],\"bsdfs\":{\"p.xml\":\"1\"}}",
         "bsdfs.p.xml"},
        {"{\"file\":[]}", "file"},
    };
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        struct reply reply;
        daemon_post_json(*state, "/v1/scenes", bad[i].text, &reply);
        if (reply.status != 422 || strcmp(reply_text(&reply, "primitive"), bad[i].path) != 0)
            fail_msg("%s: %ld %s", bad[i].text, reply.status, reply.body);
        reply_done(&reply);
    }
    daemon_expect_no_files(*state, "tmp");
}

#define PART(headers, body) "--XX\r\nContent-Disposition: form-data" headers "\r\n\r\n" body "\r\n"

static void test_malformed_multipart(void **state)
{
    static const struct {
        const char *body;
        long status;
    } bad[] = {
        {"", 422},
        {"--XX--\r\n", 422},
        {PART("; name=\"file\"; filename=\"a.rad\"", "#"), 400}, /* no end */
        {"--XX\r\nContent-Disposition: form-data; name=\"file\"; filename=\"a.rad\"\r\n", 400},
        {PART("; name=\"file\"; filename=\"\"", "#") "--XX--\r\n", 422},
        {PART("; name=\"other\"", "text") "--XX--\r\n", 422},
        {PART("; name=\"bsdfs\"", "{\"a\":")
             PART("; name=\"file\"; filename=\"a.rad\"", "#") "--XX--\r\n",
         400},
        {PART("; name=\"bsdfs\"", "[]")
             PART("; name=\"file\"; filename=\"a.rad\"", "#") "--XX--\r\n",
         422},
    };
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        struct reply reply;
        daemon_request(*state, "POST", "/v1/scenes", "multipart/form-data; boundary=XX",
                       bad[i].body, strlen(bad[i].body), NULL, &reply);
        if (reply.status != bad[i].status)
            fail_msg("case %zu: %ld %s", i, reply.status, reply.body);
        reply_done(&reply);
    }
    daemon_expect_no_files(*state, "tmp");
}

static bool tmp_is_empty_soon(struct daemon *daemon)
{
    for (double until = patience_until(); daemon_count_files(daemon, "tmp") > 0;)
        if (!patience_nap(until))
            return false;
    return true;
}

/*
 * A client announces a large body, sends some, and hangs up: the bytes are removed, at the latest
 * after the idle timeout.
 */
static void test_broken_off_upload(void **state)
{
    enum { SENT = 3 << 20 };
    static char zeros[SENT];
    struct daemon *daemon = *state;
    const int fd = daemon_dial(daemon);
    const char head[] = "POST /v1/bsdfs HTTP/1.1\r\nHost: localhost\r\n"
                        "Content-Length: 100000000\r\n\r\n";
    assert_int_equal(send(fd, head, sizeof head - 1, MSG_NOSIGNAL), sizeof head - 1);
    for (size_t sent = 0; sent < SENT;) {
        const ssize_t n = send(fd, zeros + sent, SENT - sent, MSG_NOSIGNAL);
        assert_true(n > 0);
        sent += (size_t)n;
    }
    close(fd);
    assert_true(tmp_is_empty_soon(daemon));
    struct reply reply;
    daemon_get(daemon, "/healthz", &reply);
    assert_int_equal(reply.status, 200);
    reply_done(&reply);
}

/* Larger than the daemon's buffer, so that it passes through the disk; expects equal bytes. */
static void test_large_upload(void **state)
{
    enum { LINES = 400000 };
    static const char line[] = "# twelve byt\n";
    const size_t head = strlen(room_scene), size = head + LINES * (sizeof line - 1);
    char *text = malloc(size), sha[ORL_SHA_HEX], path[ORL_PATH_MAX];
    struct reply reply;
    assert_non_null(text);
    memcpy(text, room_scene, head);
    for (size_t i = 0; i < LINES; i++)
        memcpy(text + head + i * (sizeof line - 1), line, sizeof line - 1);
    const struct upload_file files[] = {{"big.rad", text, size, false},
                                        file_of("sky.rad", room_sky)};
    daemon_upload(*state, files, 2, NULL, &reply);
    if (reply.status != 201)
        fail_msg("%s", reply.body);
    reply_done(&reply);
    orl_sha256_hex(text, size, sha);
    const struct daemon *daemon = *state;
    snprintf(path, sizeof path, "%s/blobs/%.2s/%s", daemon->root, sha, sha);
    struct orl_file file;
    assert_int_equal(orl_map_file(path, &file, NULL), 0);
    assert_int_equal(file.size, size);
    assert_memory_equal(file.data, text, size);
    orl_unmap_file(&file);
    free(text);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_bsdf),
        cmocka_unit_test(test_bad_bsdfs),
        cmocka_unit_test(test_scene_and_its_id),
        cmocka_unit_test(test_same_scene_by_json),
        cmocka_unit_test(test_bsdf_by_id),
        cmocka_unit_test(test_bad_scenes_leave_nothing),
        cmocka_unit_test(test_bad_bsdf_in_scene),
        cmocka_unit_test(test_empty_and_missing_files),
        cmocka_unit_test(test_names_are_checked),
        cmocka_unit_test(test_bad_json_uploads),
        cmocka_unit_test(test_malformed_multipart),
        cmocka_unit_test(test_broken_off_upload),
        cmocka_unit_test(test_large_upload),
    };
    return cmocka_run_group_tests(tests, setup, daemon_tear_down);
}
