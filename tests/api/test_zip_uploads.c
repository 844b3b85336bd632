/* Scenes uploaded as zips of their folders: equal to scenes uploaded by parts, and refusals. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <oriel/base/limits.h>

#include "support/daemon.h"
#include "support/zip.h"

static const char chair[] = "white sphere seat\n0\n0\n4 0 0 0 0.2\n";
static const char chairs[] =
    "!xform -t 1 1 1 objects/chair.rad\n!xform -t 2 1 1 \\\n ./spare.rad\n";

static void post_zip(struct daemon *daemon, const char *query, const struct zip_entry *entries,
                     size_t count, struct reply *ret_reply)
{
    size_t size;
    char path[128], *zip = zip_make(entries, count, &size);
    snprintf(path, sizeof path, "/v1/scenes%s", query);
    daemon_request(daemon, "POST", path, "application/zip", zip, size, NULL, ret_reply);
    free(zip);
}

static void expect_created(struct reply *reply, bool created, char ret_id[65])
{
    if (reply->status != (created ? 201 : 200))
        fail_msg("%ld %s", reply->status, reply->body);
    snprintf(ret_id, 65, "%s", reply_text(reply, "id"));
    reply_done(reply);
}

/* A folder with or without its name as prefix, in any order, with files that desktops add: one
 * scene. */
static void test_same_scene_as_by_parts(void **state)
{
    const struct upload_file files[] = {
        {"a_room.rad", room_scene, strlen(room_scene), false},
        {"chairs.rad", chairs, strlen(chairs), false},
        {"sky.rad", room_sky, strlen(room_sky), false},
        {"objects/chair.rad", chair, strlen(chair), true},
        {"spare.rad", chair, strlen(chair), true},
    };
    const struct zip_entry folder[] = {
        {.name = "office/", .mode = 040755},
        {.name = "office/sky.rad", .data = room_sky, .size = strlen(room_sky)},
        {.name = "__MACOSX/office/._sky.rad", .data = "\0\5", .size = 2},
        {.name = "office/.DS_Store", .data = "\0", .size = 1},
        {.name = "office/chairs.rad", .data = chairs, .size = strlen(chairs)},
        {.name = "office/objects/", .mode = 040755},
        {.name = "office/objects/chair.rad", .data = chair, .size = strlen(chair)},
        {.name = "office/spare.rad", .data = chair, .size = strlen(chair)},
        {.name = "office/a_room.rad", .data = room_scene, .size = strlen(room_scene)},
    };
    const struct zip_entry bare[] = {
        {.name = "./spare.rad", .data = chair, .size = strlen(chair)},
        {.name = "a_room.rad", .data = room_scene, .size = strlen(room_scene)},
        {.name = "objects/chair.rad", .data = chair, .size = strlen(chair)},
        {.name = "chairs.rad", .data = chairs, .size = strlen(chairs)},
        {.name = "sky.rad", .data = room_sky, .size = strlen(room_sky)},
    };
    struct reply reply;
    char by_zip[65], again[65], by_parts[65], within[65];
    post_zip(*state, "", folder, sizeof folder / sizeof *folder, &reply);
    expect_created(&reply, true, by_zip);
    post_zip(*state, "", bare, sizeof bare / sizeof *bare, &reply);
    expect_created(&reply, false, again);
    daemon_upload(*state, files, sizeof files / sizeof *files, NULL, &reply);
    expect_created(&reply, false, by_parts);
    size_t size;
    char *zip = zip_make(folder, sizeof folder / sizeof *folder, &size);
    const struct upload_file part = {"office.zip", zip, size, false};
    daemon_upload(*state, &part, 1, NULL, &reply);
    expect_created(&reply, false, within);
    free(zip);
    assert_string_equal(again, by_zip);
    assert_string_equal(by_parts, by_zip);
    assert_string_equal(within, by_zip);
}

/* Entry names in UTF-8, with its flag or without it, as from older programs. */
static void test_names_of_many_scripts(void **state)
{
    enum { IN_UTF8 = 1 << 11 };
    for (int flagged = 0; flagged < 2; flagged++) {
        const struct zip_entry entries[] = {
            {.name = "b\xc3\xbcro/\xe9\x83\xa8\xe5\xb1\x8b.rad",
             .data = room_scene,
             .size = strlen(room_scene),
             .flags = flagged ? IN_UTF8 : 0},
            {.name = "a.rad", .data = room_sky, .size = strlen(room_sky)}};
        struct reply reply;
        char id[65], path[80];
        post_zip(*state, "", entries, 2, &reply);
        expect_created(&reply, !flagged, id);
        snprintf(path, sizeof path, "/v1/scenes/%s", id);
        daemon_get(*state, path, &reply);
        assert_string_equal(reply_text(&reply, "summary.unread.0"), entries[0].name);
        reply_done(&reply);
    }
}

/* Without a scene file at the top, the scene is in the only folder that has some, as in a zip of a
 * nested folder; for several folders the answer asks for a choice. */
static void test_scene_in_a_folder(void **state)
{
    static const char hut[] = "void plastic grey\n0\n0\n5 0.4 0.4 0.4 0 0\n"
                              "grey sphere hut\n0\n0\n4 1 1 1 0.4\n!xform -t 1 0 0 ./part.rad\n";
    static const char part[] = "grey sphere part\n0\n0\n4 1 1 1 0.1\n";
    const struct zip_entry one[] = {
        ZIP_TEXT("readme.txt", "a hut"), ZIP_TEXT("model/scene/hut.rad", hut),
        ZIP_TEXT("model/scene/part.rad", part), ZIP_TEXT("model/scene/old/hut.rad", part)};
    const struct zip_entry two[] = {ZIP_TEXT("readme.txt", "two huts"), ZIP_TEXT("a/hut.rad", hut),
                                    ZIP_TEXT("b/hut.rad", hut)};
    struct reply reply;
    post_zip(*state, "", one, 4, &reply);
    if (reply.status != 201)
        fail_msg("%s", reply.body);
    assert_true(reply_number(&reply, "summary.surfaces") == 2);
    reply_done(&reply);
    post_zip(*state, "", two, 3, &reply);
    assert_int_equal(reply.status, 422);
    assert_non_null(strstr(reply_text(&reply, "detail"), "a/hut.rad, b/hut.rad"));
    assert_non_null(strstr(reply_text(&reply, "hint"), "name the main files with main"));
    reply_done(&reply);
    post_zip(*state, "", two, 1, &reply);
    assert_int_equal(reply.status, 422);
    assert_non_null(strstr(reply_text(&reply, "detail"), "readme.txt"));
    reply_done(&reply);
}

/* Materials are read first, whatever their names; the answer and errors list the files read. */
static void test_order_of_reading(void **state)
{
    static const char grey[] = "void plastic grey\n0\n0\n5 0.4 0.4 0.4 0 0\n";
    static const char ball[] = "grey sphere ball\n0\n0\n4 1 1 1 0.4\n";
    static const char wrong[] = "wood sphere ball\n0\n0\n4 1 1 1 0.4\n";
    static const char job[] = "{\"scene\": {\"files\": [\"materials.rad\", \"ball.rad\"]}}";
    const struct zip_entry sound[] = {ZIP_TEXT("ball.rad", ball), ZIP_TEXT("materials.rad", grey),
                                      ZIP_TEXT("other.rad", grey), ZIP_TEXT("job.json", job)};
    const struct zip_entry unsound[] = {ZIP_TEXT("ball.rad", wrong), ZIP_TEXT("m.rad", grey)};
    struct reply reply;
    post_zip(*state, "", sound, 4, &reply);
    assert_int_equal(reply.status, 201);
    assert_string_equal(reply_text(&reply, "summary.main.0"), "materials.rad");
    assert_string_equal(reply_text(&reply, "summary.main.1"), "ball.rad");
    assert_string_equal(reply_text(&reply, "summary.unread.0"), "other.rad");
    reply_done(&reply);
    post_zip(*state, "", unsound, 2, &reply);
    assert_true(reply.status >= 400);
    assert_non_null(strstr(reply_text(&reply, "hint"), "in this order: ball.rad, m.rad"));
    reply_done(&reply);
}

/* A client can set another order than that of the names. */
static void test_main_files(void **state)
{
    static const struct zip_entry entries[] = {
        ZIP_TEXT("a.rad", "white sphere s\n0\n0\n4 2 2 1 0.1\n"),
        ZIP_TEXT("z.txt", "void plastic white\n0\n0\n"
                          "5 0.7 0.7 0.7 0 0\n")};
    const struct upload_file files[] = {
        {"z.txt", entries[1].data, entries[1].size, false},
        {"a.rad", entries[0].data, entries[0].size, false},
    };
    struct reply reply;
    char by_zip[65], by_parts[65];
    post_zip(*state, "", entries, 2, &reply);
    assert_int_equal(reply.status, 422);
    assert_string_equal(reply_text(&reply, "file"), "a.rad");
    reply_done(&reply);
    post_zip(*state, "?main=z.txt&main=b.rad", entries, 2, &reply);
    assert_int_equal(reply.status, 422);
    assert_string_equal(reply_text(&reply, "primitive"), "main");
    reply_done(&reply);
    post_zip(*state, "?main=z.txt&main=a.rad", entries, 2, &reply);
    expect_created(&reply, true, by_zip);
    daemon_upload(*state, files, 2, NULL, &reply);
    expect_created(&reply, false, by_parts);
    assert_string_equal(by_parts, by_zip);
}

static void expect_refusal(struct daemon *daemon, const char *what, long status, const char *file,
                           struct reply *reply)
{
    if (reply->status != status || strcmp(reply_text(reply, "file"), file) != 0 ||
        strlen(reply_text(reply, "detail")) == 0)
        fail_msg("%s: %ld %s", what, reply->status, reply->body);
    reply_done(reply);
    daemon_expect_no_files(daemon, "tmp");
}

static void test_entries_refused(void **state)
{
    static const struct {
        const char *what;
        struct zip_entry entry;
        long status;
        const char *file;
    } cases[] = {
        {"climbing", ZIP_TEXT("../up.rad", "#\n"), 422, "../up.rad"},
        {"climbing within", ZIP_TEXT("a/../../up.rad", "#\n"), 422, "a/../../up.rad"},
        {"absolute", ZIP_TEXT("/etc/passwd", "#\n"), 422, "/etc/passwd"},
        {"a climbing folder", {.name = "../", .data = "", .mode = 040755}, 422, ".."},
        {"a link",
         {.name = "l.rad", .data = "/etc/passwd", .size = 11, .mode = 0120777},
         422,
         "l.rad"},
        {"a device", {.name = "d.rad", .data = "", .mode = 020666}, 422, "d.rad"},
        {"a socket", {.name = "s.rad", .data = "", .mode = 0140666}, 422, "s.rad"},
        {"encrypted",
         {.name = "e.rad", .data = "0123456789abcdef", .size = 16, .flags = 1},
         422,
         "e.rad"},
        {"bzip2", {.name = "b.rad", .data = "BZh9", .size = 4, .method = 12}, 422, "b.rad"},
        {"PPMd", {.name = "p.rad", .data = "\0\0\0\0", .size = 4, .method = 98}, 422, "p.rad"},
        {"not UTF-8", ZIP_TEXT("\xff.rad", "#\n"), 422, "?.rad"},
        {"a control character", ZIP_TEXT("b\a.rad", "#\n"), 422, "b?.rad"},
        {"damaged", {.name = "c.rad", .data = "#\n", .size = 2, .damage = 1}, 400, "c.rad"},
        {"twice", ZIP_TEXT("first.rad", "#\n"), 422, "first.rad"},
        {"empty", ZIP_TEXT("first2.rad", ""), 400, "first2.rad"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        const struct zip_entry entries[] = {ZIP_TEXT("first.rad", "#\n"), cases[i].entry};
        struct reply reply;
        post_zip(*state, "", entries, 2, &reply);
        expect_refusal(*state, cases[i].what, cases[i].status, cases[i].file, &reply);
    }
}

static void post_bytes(struct daemon *daemon, const char *bytes, size_t size, const char *what,
                       long status, const char *file)
{
    struct reply reply;
    daemon_request(daemon, "POST", "/v1/scenes", "application/zip", bytes, size, NULL, &reply);
    expect_refusal(daemon, what, status, file, &reply);
}

static void test_archives_refused(void **state)
{
    static const struct zip_entry plain[] = {ZIP_TEXT("a.rad", "# twelve byt\n"),
                                             ZIP_TEXT("b.txt", "nothing\n")};
    struct daemon *daemon = *state;
    size_t size;
    char *zip = zip_make(plain, 2, &size);
    post_bytes(daemon, "", 0, "nothing", 400, "");
    post_bytes(daemon, "PK is all", 9, "no zip", 400, "");
    post_bytes(daemon, zip, size / 2, "half a zip", 400, "");
    zip[0] = 'Q';
    post_bytes(daemon, zip, size, "a damaged header", 400, "");
    free(zip);
    zip = zip_make(plain + 1, 1, &size);
    post_bytes(daemon, zip, size, "no scene file", 422, "");
    free(zip);
    zip = zip_make(NULL, 0, &size);
    post_bytes(daemon, zip, size, "an empty zip", 400, "");
    free(zip);
}

static void test_bombs_refused(void **state)
{
    enum { MANY = 5000 };
    static char names[MANY][16];
    struct zip_entry *entries = calloc(MANY, sizeof *entries);
    size_t size;
    assert_non_null(entries);
    for (int i = 0; i < MANY; i++) {
        snprintf(names[i], sizeof names[i], "%d.rad", i);
        entries[i] = (struct zip_entry){.name = names[i], .data = "#\n", .size = 2};
    }
    char *zip = zip_make(entries, MANY, &size);
    post_bytes(*state, zip, size, "5000 entries", 413, "");
    free(zip);
    zip = zip_make(entries, ORL_LIMIT_SCENE_FILES + 1, &size);
    post_bytes(*state, zip, size, "a file too many", 413, "");
    free(zip);
    free(entries);
    zip = zip_make_bomb("zeros.rad", 200U << 20, &size);
    assert_true(size < 1U << 20);
    post_bytes(*state, zip, size, "a thousand to one", 413, "zeros.rad");
    free(zip);
    daemon_expect_no_files(*state, "tmp");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_same_scene_as_by_parts), cmocka_unit_test(test_main_files),
        cmocka_unit_test(test_scene_in_a_folder),      cmocka_unit_test(test_order_of_reading),
        cmocka_unit_test(test_names_of_many_scripts),  cmocka_unit_test(test_entries_refused),
        cmocka_unit_test(test_archives_refused),       cmocka_unit_test(test_bombs_refused),
    };
    return cmocka_run_group_tests(tests, daemon_set_up, daemon_tear_down);
}
