/* Years through a real daemon: the command's bytes, mistakes by file and line, cancelling, restarts
 * that go on, results shared, memory. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "process/sanitized.h"
#include "support/cli.h"
#include "support/daemon.h"
#include "support/room.h"
#include "support/year.h"

static const char scene_text[] = ROOM_GREY ROOM_CLEAR ROOM_SHELL ROOM_PANE;

#define GRIDS                                                                                      \
    "\"grids\":[{\"name\":\"the desks\",\"sensors\":{\"file\":\"desks.pts\"}},"                    \
    "{\"sensors\":[[2,2,1.2,0,-1,0]]}],"
#define WISHES "\"targets\":[\"sDA300/50 of the desks >= 1 %\"],\"rules\":[\"EN 17037 minimum\"],"
#define YEAR "\"weather\":\"place.epw\",\"seed\":3,"

/* A daemon that has the room, with weather and sensors, good and bad. */
struct year_room {
    struct daemon daemon; /* first: as of struct daemon_room */
    char scene[65];
};

static char *read_text(const char *path, size_t *ret_size)
{
    FILE *file = fopen(path, "rb");
    if (!file)
        return NULL;
    fseek(file, 0, SEEK_END);
    *ret_size = (size_t)ftell(file);
    rewind(file);
    char *text = calloc(1, *ret_size + 1);
    assert_non_null(text);
    assert_int_equal(fread(text, 1, *ret_size, file), *ret_size);
    fclose(file);
    return text;
}

static void write_desks(char *text, size_t size)
{
    size_t at = 0;
    for (int i = 0; i < 24; i++)
        at += (size_t)snprintf(text + at, size - at, "%g %g 0.8 0 0 1\n", 0.5 + 0.5 * (i % 6),
                               0.5 + 0.75 * (double)(i / 6));
}

/* All hours of a year, made up. */
static char *make_weather(int units)
{
    static const int days[12] = {31, 28, 31, 30, 31, 30, 31, 31, 30, 31, 30, 31};
    static const struct year_site site = {47, 8, 1};
    enum { SIZE = 1 << 19 };
    char *text = calloc(1, SIZE), day[2048];
    assert_non_null(text);
    size_t at = (size_t)snprintf(text, SIZE,
                                 "place made_up\nlatitude 47\nlongitude -8\ntime_zone -15\n"
                                 "site_elevation 0\nweather_data_file_units %d\n",
                                 units);
    for (int month = 1; month <= 12; month++)
        for (int d = 1; d <= days[month - 1]; d++) {
            day[0] = '\0';
            year_day(&site, month, d, day, sizeof day);
            at += (size_t)snprintf(text + at, SIZE - at, "%s", day);
        }
    return text;
}

static int set_up(void **state)
{
    static struct year_room room;
    static char desks[2048];
    struct reply reply;
    size_t size;
    char *epw = read_text("tests/fixtures/weather.epw", &size), *whole = make_weather(1);
    char *other = make_weather(2);
    write_desks(desks, sizeof desks);
    const char *bad = "place x\nlatitude 1\nlongitude 1\ntime_zone 0\nsite_elevation 0\n"
                      "weather_data_file_units 1\n3 21 11.5 0 ?\n";
    const struct upload_file files[] = {
        {"room.rad", scene_text, strlen(scene_text), false},
        {"place.epw", epw, size, true},
        {"whole.wea", whole, strlen(whole), true},
        {"other.wea", other, strlen(other), true},
        {"desks.pts", desks, strlen(desks), true},
        {"bad.pts", "0 0 1 0 0 1\n0 0 x 0 0 1\n", 24, true},
        {"bad.wea", bad, strlen(bad), true},
        {"use.csv", "1\n0\n1\n", 6, true},
    };
    assert_non_null(epw);
    daemon_start(&room.daemon, NULL);
    daemon_upload(&room.daemon, files, sizeof files / sizeof *files, NULL, &reply);
    if (reply.status != 201)
        fail_msg("%s", reply.body);
    snprintf(room.scene, sizeof room.scene, "%s", reply_text(&reply, "id"));
    reply_done(&reply);
    free(epw);
    free(whole);
    free(other);
    *state = &room;
    return 0;
}

static int tear_down(void **state)
{
    daemon_remove(&((struct year_room *)*state)->daemon);
    return 0;
}

static void post(struct year_room *f, const char *rest, struct reply *ret_reply)
{
    const size_t size = strlen(rest) + 256;
    char *text = malloc(size);
    assert_non_null(text);
    snprintf(text, size, "{\"kind\":\"annual\",\"scene\":\"%s\",%s}", f->scene, rest);
    daemon_post_json(&f->daemon, "/v1/jobs", text, ret_reply);
    free(text);
}

static void submit(struct year_room *f, const char *rest, char ret_path[80])
{
    struct reply reply;
    post(f, rest, &reply);
    if (reply.status != 202)
        fail_msg("the year was refused: %s", reply.body);
    assert_string_equal(reply_text(&reply, "kind"), "annual");
    snprintf(ret_path, 80, "%s", reply_text(&reply, "links.self"));
    reply_done(&reply);
}

static void expect_state(struct year_room *f, const char *job, const char *state, int attempts,
                         struct reply *ret_reply)
{
    daemon_wait(&f->daemon, job, 240, ret_reply);
    if (strcmp(reply_text(ret_reply, "state"), state) != 0 ||
        reply_number(ret_reply, "attempts") != attempts)
        fail_msg("%s: %s", job, ret_reply->body);
}

static double metric(struct year_room *f, const char *name)
{
    struct reply reply;
    char line[80];
    daemon_get(&f->daemon, "/metrics", &reply);
    snprintf(line, sizeof line, "\n%s ", name);
    const char *at = strstr(reply.body, line);
    assert_non_null(at);
    const double value = strtod(at + strlen(line), NULL);
    reply_done(&reply);
    return value;
}

/* ---- The command's bytes --------------------------------------------------------------------- */

static const char document[] =
    "{\"kind\":\"annual\",\"title\":\"A "
    "room\",\"scene\":{\"files\":[\"room.rad\"]},\"samples\":64," YEAR GRIDS WISHES
    "\"accuracy\":{\"verdict\":\"sDA1000/40 of the desks >= 20 %\"},"
    "\"occupancy\":{\"from\":7,\"to\":19},\"formats\":[\"honeybee\",\"ill\"]}";

static void run_command(const char *const *args, struct cli_result *ret_result)
{
    cli_run(args, ret_result);
    if (ret_result->exit_code != 0)
        fail_msg("%s: %s", args[0], ret_result->err);
}

static json_t *load(const char *folder)
{
    char path[160];
    snprintf(path, sizeof path, "%s/result.json", folder);
    json_t *result = json_load_file(path, 0, NULL);
    assert_non_null(result);
    return result;
}

/* Of all files that the result names; and result.json itself but for times and threads, and what a
 * run found ready. */
static void assert_same_files(const char *a, const char *b, size_t least)
{
    json_t *one = load(a), *other = load(b);
    const json_t *names = json_object_get(one, "files"), *name;
    size_t i;
    assert_true(json_array_size(names) > least);
    json_array_foreach(names, i, name)
    {
        char first[256], second[256];
        size_t n, m;
        snprintf(first, sizeof first, "%s/%s", a, json_string_value(name));
        snprintf(second, sizeof second, "%s/%s", b, json_string_value(name));
        char *x = read_text(first, &n), *y = read_text(second, &m);
        if (!x || !y || n != m || memcmp(x, y, n) != 0)
            fail_msg("%s and %s differ", first, second);
        free(x);
        free(y);
    }
    static const char *const own[] = {"timings_s", "threads", "reuse", "rays"};
    for (size_t k = 0; k < 8; k++)
        json_object_del(k % 2 ? one : other, own[k / 2]);
    assert_true(json_equal(one, other));
    json_decref(one);
    json_decref(other);
}

static void check_status(struct year_room *f, const char *id)
{
    struct reply reply;
    char path[96];
    snprintf(path, sizeof path, "/v1/jobs/%s", id);
    daemon_get(&f->daemon, path, &reply);
    assert_string_equal(reply_text(&reply, "kind"), "annual");
    assert_true(reply_number(&reply, "percent") == 100);
    assert_non_null(strstr(reply_text(&reply, "warnings.1"), "not in the weather file"));
    assert_string_equal(reply_text(&reply, "annual.verdicts.0.rule"), "EN 17037 minimum");
    assert_non_null(strstr(reply_text(&reply, "annual.verdicts.3.target"), "sDA300/50"));
    assert_true(json_is_true(reply_at(&reply, "annual.accuracy.settled")));
    assert_true(reply_number(&reply, "timings_s.paths") > 0);
    assert_int_equal(json_array_size(reply_at(&reply, "files")),
                     json_array_size(reply_at(&reply, "links.files")));
    reply_done(&reply);
}

static void test_bytes_are_the_commands(void **state)
{
    struct year_room *f = *state;
    static struct cli_result result;
    static char desks[2048];
    char folder[64], path[96], here[96], there[96], id[80];
    size_t size;
    char *weather = read_text("tests/fixtures/weather.epw", &size);
    write_desks(desks, sizeof desks);
    cli_make_folder(folder);
    cli_write_file(folder, "room.rad", scene_text);
    cli_write_file(folder, "place.epw", weather);
    cli_write_file(folder, "desks.pts", desks);
    cli_write_file(folder, "year.json", document);
    snprintf(path, sizeof path, "%s/year.json", folder);
    snprintf(here, sizeof here, "%s/here", folder);
    snprintf(there, sizeof there, "%s/there", folder);
    const char *const annual[] = {"annual", path, "-o", here, "-j", "1", NULL};
    const char *const send[] = {"submit", path, "--wait", "--server", f->daemon.url, NULL};
    run_command(annual, &result);
    run_command(send, &result);
    assert_non_null(strstr(result.err, "warning: 8713 steps of the year are not in the weather"));
    assert_non_null(strstr(result.err, ": sDA1000/40 of the desks >= 20 %: "));
    assert_non_null(strstr(result.err, "EN 17037 minimum (all grids)\n"));
    snprintf(id, sizeof id, "%.*s", (int)strcspn(result.out, "\n"), result.out);
    const char *const fetch[] = {"fetch", id, "-o", there, "--server", f->daemon.url, NULL};
    run_command(fetch, &result);
    assert_same_files(here, there, 60);
    const char *const verify[] = {"verify", there, "--files", folder, NULL};
    run_command(verify, &result);
    assert_non_null(strstr(result.out, "the same: "));
    check_status(f, id);
    const char *const status[] = {"status", id, "--server", f->daemon.url, NULL};
    run_command(status, &result);
    assert_non_null(strstr(result.out, "kind     annual\n"));
    assert_non_null(strstr(result.out, " sDA300/50 of the desks >= 1 % (the desks)\n"));
    cli_remove_folder(folder);
    free(weather);
}

/* Files of a shade's state, and what these refer to, travel with the scene; the daemon's year is
 * the command's, and can be repeated. */
static void test_shades_travel(void **state)
{
    static const char text[] =
        "{\"kind\": \"annual\", \"scene\": {\"files\": [\"room.rad\"]}, \"weather\": \"place.epw\","
        " \"samples\": 32, \"sensors\": [[2, 1, 0.8, 0, 0, 1]], \"targets\": [\"DF >= 1 %\"],"
        " \"shades\": [{\"name\": \"south\", \"states\": [{\"name\": \"open\"},"
        " {\"name\": \"down\", \"files\": [\"down.rad\"]}], \"control\": {\"by\": \"LM-83\"}}]}";
    struct year_room *f = *state;
    static struct cli_result result;
    char folder[64], path[128], here[96], there[96], id[80];
    size_t size;
    char *weather = read_text("tests/fixtures/weather.epw", &size);
    cli_make_folder(folder);
    cli_write_file(folder, "room.rad", scene_text);
    cli_write_file(folder, "place.epw", weather);
    cli_write_file(folder, "down.rad", "!xform -t 0 -.1 0 slat.rad\n");
    cli_write_file(folder, "slat.rad", "w polygon slat 0 0 12 1 0 1 3 0 1 3 0 2 1 0 2\n");
    cli_write_file(folder, "year.json", text);
    snprintf(path, sizeof path, "%s/year.json", folder);
    snprintf(here, sizeof here, "%s/here", folder);
    snprintf(there, sizeof there, "%s/there", folder);
    const char *const annual[] = {"annual", path, "-o", here, "-j", "1", NULL};
    const char *const send[] = {"submit", path, "--wait", "--server", f->daemon.url, NULL};
    run_command(annual, &result);
    run_command(send, &result);
    snprintf(id, sizeof id, "%.*s", (int)strcspn(result.out, "\n"), result.out);
    const char *const fetch[] = {"fetch", id, "-o", there, "--server", f->daemon.url, NULL};
    run_command(fetch, &result);
    assert_same_files(here, there, 5);
    snprintf(path, sizeof path, "%s/hours.csv", here);
    char *hours = read_text(path, &size);
    assert_non_null(strstr(hours, ",\"shades of south\"\n"));
    assert_non_null(strstr(hours, ",\"open\"\n"));
    assert_non_null(strstr(hours, ",\"down\"\n"));
    free(hours);
    const char *const verify[] = {"verify", there, "--files", folder, NULL};
    run_command(verify, &result);
    assert_non_null(strstr(result.out, "the same: "));
    cli_remove_folder(folder);
    free(weather);
}

/* Files in folders have slashes in their names, which the links spell out; nothing else is there.
 */
static void test_files_in_folders(void **state)
{
    struct year_room *f = *state;
    struct reply job, reply;
    char path[80], at[200];
    submit(f, "\"samples\":16,\"formats\":[\"honeybee\"]," YEAR "\"sensors\":[[2,2,1,0,0,1]]",
           path);
    expect_state(f, path, "succeeded", 1, &job);
    assert_non_null(strstr(reply_text(&job, "links.files.3"), "/files/results%2Fgrids_info.json"));
    daemon_get(&f->daemon, reply_text(&job, "links.files.3"), &reply);
    assert_int_equal(reply.status, 200);
    assert_string_equal(reply_header(&reply, "Content-Type"), "application/json");
    reply_done(&reply);
    static const char *const names[] = {"results/grids_info.json", "results",
                                        "results//grids_info.json"};
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        snprintf(at, sizeof at, "%s/files/%s", path, names[i]);
        daemon_get(&f->daemon, at, &reply);
        assert_true((i == 0) == (reply.status == 200));
        reply_done(&reply);
    }
    reply_done(&job);
}

/* ---- What others use again --------------------------------------------------------------------
 */

static void fetch_result(struct year_room *f, const char *rest, struct reply *ret_reply)
{
    struct reply job;
    char path[80], at[96];
    submit(f, rest, path);
    expect_state(f, path, "succeeded", 1, &job);
    reply_done(&job);
    snprintf(at, sizeof at, "%s/result", path);
    daemon_get(&f->daemon, at, ret_reply);
    assert_int_equal(ret_reply->status, 200);
}

/* Of what was uploaded those files are inputs that the year was made from, though the scene was
 * loaded by the job before. */
static void check_inputs(const struct reply *result, const char *weather)
{
    assert_int_equal(json_array_size(reply_at(result, "provenance.inputs")), 3);
    assert_string_equal(reply_text(result, "provenance.inputs.0.name"), "desks.pts");
    const int at = strcmp(weather, "room.rad") < 0 ? 1 : 2;
    assert_string_equal(
        reply_text(result, at == 1 ? "provenance.inputs.1.name" : "provenance.inputs.2.name"),
        weather);
    assert_string_equal(
        reply_text(result, at == 1 ? "provenance.inputs.2.name" : "provenance.inputs.1.name"),
        "room.rad");
    assert_string_equal(reply_text(result, "provenance.document.scene.files.0"), "room.rad");
}

static void test_another_weather_casts_no_ray(void **state)
{
    struct year_room *f = *state;
    struct reply first, other, maps;
    fetch_result(f, GRIDS "\"weather\":\"whole.wea\",\"samples\":16", &first);
    fetch_result(f, GRIDS "\"weather\":\"other.wea\",\"samples\":16", &other);
    check_inputs(&first, "whole.wea");
    check_inputs(&other, "other.wea");
    assert_true(reply_number(&first, "rays") > 0);
    assert_true(reply_number(&other, "rays") == 0);
    assert_true(reply_number(&first, "reuse.paths.made") == 1);
    assert_true(reply_number(&other, "reuse.paths.found") == 1);
    assert_true(reply_number(&other, "reuse.sun.found") == 1);
    assert_true(reply_number(&other, "reuse.map.made") == 0);
    assert_true(reply_number(&other, "reuse.rays_saved") == reply_number(&first, "rays"));
    assert_true(reply_number(&first, "grids.0.figures.2.value") !=
                reply_number(&other, "grids.0.figures.2.value"));
    reply_done(&first);
    reply_done(&other);
    /* They can be looked at and removed as maps can; then they are made again. */
    daemon_get(&f->daemon, "/v1/maps", &maps);
    assert_int_equal(json_array_size(reply_at(&maps, "maps")), 4);
    for (int i = 0; i < 4; i++) {
        char member[32], path[128];
        struct reply reply;
        snprintf(member, sizeof member, "maps.%d.kind", i);
        assert_string_equal(reply_text(&maps, member), "annual");
        snprintf(member, sizeof member, "maps.%d.key", i);
        snprintf(path, sizeof path, "/v1/maps/annual/%s", reply_text(&maps, member));
        daemon_request(&f->daemon, "DELETE", path, NULL, NULL, 0, NULL, &reply);
        assert_int_equal(reply.status, 204);
        reply_done(&reply);
    }
    reply_done(&maps);
    fetch_result(f, GRIDS "\"weather\":\"other.wea\",\"samples\":16,\"title\":\"again\"", &other);
    assert_true(reply_number(&other, "rays") > 0);
    reply_done(&other);
}

/* ---- Mistakes -------------------------------------------------------------------------------- */

static const struct {
    const char *rest, *member, *file;
    int line;
    long status;
} refusals[] = {
    {GRIDS "\"seed\":3", "weather", "", 0, 422},
    {YEAR "\"samples\":64", "grids", "", 0, 422},
    {YEAR GRIDS "\"sensors\":[[0,0,0,0,0,1]]", "grids", "", 0, 422},
    {YEAR GRIDS "\"sample\":64", "sample", "", 0, 422},
    {YEAR "\"grids\":[{\"sensors\":[]}]", "grids[0].sensors", "", 0, 422},
    {YEAR "\"sensors\":[]", "sensors", "", 0, 422},
    {YEAR "\"sensors\":[[0,0,1e300,0,0,1]]", "", "", 0, 422},
    {YEAR "\"grids\":[{\"sensors\":{\"file\":\"none.pts\"}}]", "grids[0].sensors.file", "", 0, 422},
    {YEAR "\"sensors\":{\"file\":\"none.pts\"}", "sensors.file", "", 0, 422},
    {YEAR "\"grids\":[{\"sensors\":{\"file\":\"bad.pts\"}}]", "", "bad.pts", 2, 400},
    {GRIDS "\"weather\":\"none.epw\"", "weather", "", 0, 422},
    {GRIDS "\"weather\":\"bad.wea\"", "", "bad.wea", 7, 400},
    {GRIDS "\"weather\":\"desks.pts\"", "", "desks.pts", 1, 400},
    {YEAR GRIDS "\"occupancy\":{\"file\":\"none.csv\"}", "occupancy.file", "", 0, 422},
    {YEAR GRIDS "\"occupancy\":{\"file\":\"use.csv\"}", "", "use.csv", 0, 422},
    {YEAR GRIDS "\"targets\":[\"sDA300/50 of the moon >= 50 %\"]", "", "", 0, 422},
    {YEAR GRIDS "\"targets\":[\"lots of light\"]", "targets[0]", "", 0, 400},
    {YEAR GRIDS "\"accuracy\":{\"verdict\":\"sDA of the moon >= 1 %\"}", "", "", 0, 422},
    {YEAR GRIDS "\"metrics\":[\"DA300\",\"DA300\"]", "metrics", "", 0, 422},
    {YEAR GRIDS "\"rules\":[\"none\"]", "rules[0]", "", 0, 422},
    {YEAR GRIDS "\"formats\":[\"hdr\"]", "formats[0]", "", 0, 422},
    {YEAR GRIDS "\"views\":[]", "views", "", 0, 422},
};

static void test_mistakes_are_named(void **state)
{
    struct year_room *f = *state;
    struct reply reply;
    for (size_t i = 0; i < sizeof refusals / sizeof *refusals; i++) {
        post(f, refusals[i].rest, &reply);
        const double line = reply_at(&reply, "line") ? reply_number(&reply, "line") : 0;
        if (reply.status != refusals[i].status || line != refusals[i].line ||
            strcmp(reply_text(&reply, "primitive"), refusals[i].member) != 0 ||
            strcmp(reply_text(&reply, "file"), refusals[i].file) != 0)
            fail_msg("%s: %ld, %s", refusals[i].rest, reply.status, reply.body);
        reply_done(&reply);
    }
}

/* A map is drawn of every metric of every grid: so many and no more. */
static void test_pictures_are_bounded(void **state)
{
    enum { GRIDS_OF_ONE = 410, METRICS = 10 };
    struct year_room *f = *state;
    struct reply reply;
    char *text = malloc(GRIDS_OF_ONE * 40 + 200);
    assert_non_null(text);
    size_t at = (size_t)sprintf(text, YEAR "\"grids\":[");
    for (int i = 0; i < GRIDS_OF_ONE; i++)
        at += (size_t)sprintf(text + at, "%s{\"sensors\":[[2,2,1,0,0,1]]}", i ? "," : "");
    sprintf(text + at, "]");
    post(f, text, &reply);
    assert_int_equal(reply.status, 413);
    assert_string_equal(reply_text(&reply, "primitive"), "grids");
    assert_non_null(strstr(reply_text(&reply, "detail"), "4100 pictures"));
    reply_done(&reply);
    daemon_get(&f->daemon, "/v1/limits", &reply);
    assert_true(reply_number(&reply, "pictures") == 4096 && reply_number(&reply, "grids") == 4096);
    reply_done(&reply);
    free(text);
}

/* What is kept of every hour of every sensor is counted once sensors and hours are. */
static void test_memory_is_foreseen(void **state)
{
    static const char *const little[] = {"--memory", "1G", NULL};
    enum { SENSORS = 40000 };
    struct year_room *f = *state;
    struct reply reply;
    if (ORL_SANITIZED)
        skip();
    char *text = malloc(SENSORS * 16 + 200);
    assert_non_null(text);
    daemon_end(&f->daemon, SIGTERM);
    daemon_restart(&f->daemon, little);
    size_t at = (size_t)sprintf(text, "\"weather\":\"whole.wea\",\"sensors\":[");
    for (int i = 0; i < SENSORS; i++)
        at += (size_t)sprintf(text + at, "%s[2,2,1,0,0,1]", i ? "," : "");
    sprintf(text + at, "]");
    post(f, text, &reply);
    assert_int_equal(reply.status, 413);
    assert_non_null(strstr(reply_text(&reply, "detail"), "for 210240000 hours of sensors"));
    reply_done(&reply);
    free(text);
}

static void test_a_sky_of_its_own_is_refused(void **state)
{
    static const char weather[] = "place x\nlatitude 1\nlongitude 1\ntime_zone 0\n"
                                  "site_elevation 0\nweather_data_file_units 1\n"
                                  "3 21 11.5 800 100\n";
    struct year_room *f = *state;
    struct reply reply;
    char id[65], text[512];
    const struct upload_file files[] = {{"room.rad", room_scene, strlen(room_scene), false},
                                        {"sky.rad", room_sky, strlen(room_sky), false},
                                        {"place.wea", weather, strlen(weather), true}};
    daemon_upload(&f->daemon, files, 3, NULL, &reply);
    assert_int_equal(reply.status, 201);
    snprintf(id, sizeof id, "%s", reply_text(&reply, "id"));
    reply_done(&reply);
    snprintf(text, sizeof text,
             "{\"kind\":\"annual\",\"scene\":\"%s\",\"weather\":\"place.wea\","
             "\"sensors\":[[2,2,1,0,0,1]]}",
             id);
    daemon_post_json(&f->daemon, "/v1/jobs", text, &reply);
    assert_int_equal(reply.status, 422);
    assert_string_equal(reply_text(&reply, "primitive"), "scene");
    assert_non_null(strstr(reply_text(&reply, "detail"), " distant sources"));
    reply_done(&reply);
}

/* What only the run finds out fails the job, and says why. */
static void test_what_a_year_does_not_follow(void **state)
{
    static const char lens[] = ROOM_GREY ROOM_CLEAR ROOM_SHELL ROOM_PANE
        "void dielectric d 0 0 5 1 1 1 1.5 0\nd sphere lens 0 0 4 2 1 1.5 .3\n";
    static const char weather[] = "place x\nlatitude 47\nlongitude -8\ntime_zone -15\n"
                                  "site_elevation 0\nweather_data_file_units 1\n"
                                  "3 21 11.5 800 100\n";
    struct year_room *f = *state;
    struct reply reply;
    char text[512];
    const struct upload_file files[] = {{"room.rad", lens, strlen(lens), false},
                                        {"place.wea", weather, strlen(weather), true}};
    daemon_upload(&f->daemon, files, 2, NULL, &reply);
    assert_int_equal(reply.status, 201);
    snprintf(text, sizeof text,
             "{\"kind\":\"annual\",\"scene\":\"%s\",\"weather\":\"place.wea\","
             "\"sensors\":[[2,2,1,0,0,1]]}",
             reply_text(&reply, "id"));
    reply_done(&reply);
    daemon_post_json(&f->daemon, "/v1/jobs", text, &reply);
    assert_int_equal(reply.status, 202);
    snprintf(text, sizeof text, "%s", reply_text(&reply, "links.self"));
    reply_done(&reply);
    expect_state(f, text, "failed", 1, &reply);
    assert_non_null(strstr(reply_text(&reply, "error.detail"), "lens"));
    reply_done(&reply);
    assert_int_equal(daemon_count_files(&f->daemon, "partial"), 0);
}

/* ---- Long ones ------------------------------------------------------------------------------- */

#define PATHS "1024"
enum { MANY = 640, BLOCK = 64 };

/* Ten blocks of sensors. */
static char *make_long(const char *more)
{
    char *text = malloc(MANY * 40 + 400);
    assert_non_null(text);
    size_t at = (size_t)sprintf(text,
                                "\"weather\":\"place.epw\",\"samples\":" PATHS ",%s"
                                "\"sensors\":[",
                                more);
    for (int i = 0; i < MANY; i++)
        at += (size_t)sprintf(text + at, "%s[%.3f,%.3f,0.8,0,0,1]", i ? "," : "",
                              0.2 + 0.1 * (i % 32), 0.3 + 0.2 * (i / 32));
    sprintf(text + at, "]");
    return text;
}

/* Until so many blocks are kept. */
static void wait_for_blocks(struct year_room *f, size_t blocks)
{
    for (int polls = 0; polls < 12000; polls++) {
        /* The key; of each block its rows and a note that they are whole; rows of the next. */
        if (daemon_count_files(&f->daemon, "partial") >= 2 * blocks + 2)
            return;
        nanosleep(&(struct timespec){0, 10000000}, NULL);
    }
    fail_msg("no %zu blocks in two minutes", blocks);
}

static void test_progress_and_cancelling(void **state)
{
    struct year_room *f = *state;
    struct reply reply;
    char job[80], *text = make_long("");
    submit(f, text, job);
    wait_for_blocks(f, 2);
    daemon_get(&f->daemon, job, &reply);
    assert_string_equal(reply_text(&reply, "state"), "running");
    assert_string_equal(reply_text(&reply, "stage"), "render");
    assert_true(reply_number(&reply, "stage_percent") >= 10);
    assert_true(reply_number(&reply, "percent") > 5 && reply_number(&reply, "percent") < 96);
    assert_true(reply_number(&reply, "eta_s") > 0);
    assert_true(json_is_null(reply_at(&reply, "annual.accuracy")));
    assert_true(json_is_array(reply_at(&reply, "warnings")));
    reply_done(&reply);
    daemon_cancel(&f->daemon, job, &reply);
    assert_int_equal(reply.status, 202);
    reply_done(&reply);
    expect_state(f, job, "cancelled", 1, &reply);
    assert_true(!reply_at(&reply, "links.result"));
    reply_done(&reply);
    assert_int_equal(daemon_count_files(&f->daemon, "partial"), 0);
    free(text);
}

/* The digests of a job's files, result.json left out, in a new array. */
static json_t *digests(struct year_room *f, const char *job)
{
    struct reply reply;
    json_t *list = json_array();
    const json_t *entry;
    size_t i;
    daemon_get(&f->daemon, job, &reply);
    json_array_foreach(reply_at(&reply, "files"), i, entry)
    {
        if (i > 0)
            json_array_append(list, json_object_get(entry, "sha256"));
    }
    reply_done(&reply);
    assert_true(json_array_size(list) > 20);
    return list;
}

/* The first that a poll sees of the rows: what was kept is not done again. */
static double first_percent(struct year_room *f, const char *job)
{
    struct reply reply;
    for (int polls = 0; polls < 20000; polls++) {
        daemon_get(&f->daemon, job, &reply);
        const bool runs = strcmp(reply_text(&reply, "stage"), "render") == 0;
        const bool ended = strcmp(reply_text(&reply, "state"), "succeeded") == 0;
        const double percent = ended ? 100 : reply_number(&reply, "stage_percent");
        reply_done(&reply);
        if ((runs && percent > 0) || ended)
            return percent;
        nanosleep(&(struct timespec){0, 2000000}, NULL);
    }
    return 0;
}

static void test_goes_on_after_a_kill(void **state)
{
    struct year_room *f = *state;
    struct reply reply;
    char job[80], again[80], *text = make_long("");
    submit(f, text, job);
    wait_for_blocks(f, 3);
    assert_int_equal(daemon_end(&f->daemon, SIGKILL), -1);
    daemon_restart(&f->daemon, NULL);
    assert_true(first_percent(f, job) >= 100.0 * 3 * BLOCK / MANY);
    wait_for_blocks(f, 5);
    assert_int_equal(daemon_end(&f->daemon, SIGTERM), 0); /* in good order, which is no attempt */
    daemon_restart(&f->daemon, NULL);
    assert_true(first_percent(f, job) >= 100.0 * 5 * BLOCK / MANY);
    expect_state(f, job, "succeeded", 2, &reply);
    reply_done(&reply);
    assert_int_equal(daemon_count_files(&f->daemon, "partial"), 0);
    /* The same in one go. */
    submit(f, text, again);
    expect_state(f, again, "succeeded", 1, &reply);
    reply_done(&reply);
    json_t *torn = digests(f, job), *whole = digests(f, again);
    assert_true(json_equal(torn, whole));
    json_decref(torn);
    json_decref(whole);
    free(text);
}

/* ---- What jobs share ------------------------------------------------------------------------- */

static void test_jobs_share_the_scene(void **state)
{
    struct year_room *f = *state;
    struct reply reply;
    char job[80];
    for (int i = 0; i < 2; i++) {
        char text[256];
        snprintf(text, sizeof text,
                 "\"weather\":\"place.epw\",\"samples\":16,\"seed\":%d,"
                 "\"sensors\":[[2,2,1,0,0,1]]",
                 i);
        submit(f, text, job);
        expect_state(f, job, "succeeded", 1, &reply);
        reply_done(&reply);
        assert_true(metric(f, "oriel_shelf_scenes") == 1);
        /* Once more for the plans, of each. */
        assert_true(metric(f, "oriel_shelf_scene_hits_total") == 1 + 2 * i);
    }
}

/* Two that ask for the same are computed once, and each has all files, in folders too. */
static void test_equal_jobs_are_one(void **state)
{
    static const char same[] =
        "\"samples\":16,\"formats\":[\"honeybee\"]," YEAR "\"sensors\":[[2,2,1,0,0,1]]";
    struct year_room *f = *state;
    struct reply reply;
    char blocker[80], jobs[2][80], path[200], *text = make_long("");
    submit(f, text, blocker);
    for (int i = 0; i < 2; i++)
        submit(f, same, jobs[i]);
    daemon_cancel(&f->daemon, blocker, &reply);
    reply_done(&reply);
    for (int i = 0; i < 2; i++) {
        expect_state(f, jobs[i], "succeeded", 1, &reply);
        reply_done(&reply);
        snprintf(path, sizeof path, "%s/files/results%%2Fmetrics%%2Fda%%2Fgrid1.da", jobs[i]);
        daemon_get(&f->daemon, path, &reply);
        assert_int_equal(reply.status, 200);
        reply_done(&reply);
        daemon_request(&f->daemon, "DELETE", jobs[i], NULL, NULL, 0, NULL, &reply);
        assert_int_equal(reply.status, 204);
        reply_done(&reply);
    }
    free(text);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(test_bytes_are_the_commands, set_up, tear_down),
        cmocka_unit_test_setup_teardown(test_shades_travel, set_up, tear_down),
        cmocka_unit_test_setup_teardown(test_files_in_folders, set_up, tear_down),
        cmocka_unit_test_setup_teardown(test_another_weather_casts_no_ray, set_up, tear_down),
        cmocka_unit_test_setup_teardown(test_mistakes_are_named, set_up, tear_down),
        cmocka_unit_test_setup_teardown(test_pictures_are_bounded, set_up, tear_down),
        cmocka_unit_test_setup_teardown(test_memory_is_foreseen, set_up, tear_down),
        cmocka_unit_test_setup_teardown(test_a_sky_of_its_own_is_refused, set_up, tear_down),
        cmocka_unit_test_setup_teardown(test_what_a_year_does_not_follow, set_up, tear_down),
        cmocka_unit_test_setup_teardown(test_progress_and_cancelling, set_up, tear_down),
        cmocka_unit_test_setup_teardown(test_goes_on_after_a_kill, set_up, tear_down),
        cmocka_unit_test_setup_teardown(test_jobs_share_the_scene, set_up, tear_down),
        cmocka_unit_test_setup_teardown(test_equal_jobs_are_one, set_up, tear_down),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
