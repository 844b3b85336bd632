/* Annual jobs through a real daemon: bytes equal to the command's, files in folders, and caches. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "support/cli.h"
#include "support/year_room.h"

#define WISHES "\"targets\":[\"sDA300/50 of the desks >= 1 %\"],\"rules\":[\"EN 17037 minimum\"],"

/* ---- Bytes equal to the command's ------------------------------------------------------------ */

static const char document[] =
    "{\"kind\":\"annual\",\"title\":\"A "
    "room\",\"scene\":{\"files\":[\"room.rad\"]},\"samples\":64," YEAR_ROOM_SEEDED YEAR_ROOM_GRIDS
        WISHES "\"accuracy\":{\"verdict\":\"sDA1000/40 of the desks >= 20 %\"},"
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

/* Asserts that all files named by the result are equal, and result.json except times, threads and
 * cache hits. */
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
        char *x = year_room_read(first, &n), *y = year_room_read(second, &m);
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
    assert_true(reply_number(&reply, "annual.verdicts.3.value") >= 0);
    assert_true(reply_number(&reply, "annual.verdicts.3.interval_95.1") >=
                reply_number(&reply, "annual.verdicts.3.value"));
    assert_true(json_is_null(reply_at(&reply, "annual.verdicts.0.value")));
    /* After both, the result of each target of the rule. */
    assert_string_equal(reply_text(&reply, "annual.verdicts.4.rule"), "EN 17037 minimum");
    assert_string_equal(reply_text(&reply, "annual.verdicts.4.unit"), "%");
    assert_true(reply_number(&reply, "annual.verdicts.4.value") >= 0);
    assert_true(json_is_true(reply_at(&reply, "annual.accuracy.settled")));
    assert_true(reply_number(&reply, "timings_s.paths") > 0);
    assert_int_equal(json_array_size(reply_at(&reply, "files")),
                     json_array_size(reply_at(&reply, "links.files")));
    reply_done(&reply);
}

/* Asserts the verdicts as the command prints them: all lines but the last, which is the result's
 * path. */
static void assert_has_lines(const char *text, const char *lines)
{
    int count = 0;
    for (const char *at = lines, *end; (end = strchr(at, '\n')) && end[1]; at = end + 1, count++) {
        char line[512];
        snprintf(line, sizeof line, "\n%.*s", (int)(end + 1 - at), at);
        if (!strstr(text, line))
            fail_msg("no line \"%s\" in:\n%s", line + 1, text);
    }
    assert_true(count > 6);
}

static void test_bytes_are_the_commands(void **state)
{
    struct year_room *f = *state;
    static struct cli_result result;
    static char desks[2048];
    char folder[64], path[96], here[96], there[96], id[80];
    size_t size;
    char *weather = year_room_read("tests/fixtures/weather.epw", &size);
    year_room_desks(desks, sizeof desks);
    cli_make_folder(folder);
    cli_write_file(folder, "room.rad", year_room_scene);
    cli_write_file(folder, "place.epw", weather);
    cli_write_file(folder, "desks.pts", desks);
    cli_write_file(folder, "year.json", document);
    snprintf(path, sizeof path, "%s/year.json", folder);
    snprintf(here, sizeof here, "%s/here", folder);
    snprintf(there, sizeof there, "%s/there", folder);
    const char *const annual[] = {"annual", path, "-o", here, "-j", "1", NULL};
    const char *const send[] = {"submit", path, "--wait", "--server", f->daemon.url, NULL};
    run_command(annual, &result);
    char *const lines = strdup(result.out);
    assert_non_null(lines);
    run_command(send, &result);
    assert_has_lines(result.err, lines);
    assert_non_null(strstr(result.err, "warning: 8713 steps of the year are not in the weather"));
    assert_non_null(strstr(result.err, ": sDA1000/40 of the desks >= 20 %: "));
    assert_non_null(strstr(result.err, "EN 17037 minimum (all grids): the weather file has "));
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
    assert_has_lines(result.out, lines);
    free(lines);
    cli_remove_folder(folder);
    free(weather);
}

/* Files of a shade's state, and files that these refer to, are sent with the scene. The daemon's
 * year equals the command's, and is repeatable. */
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
    char *weather = year_room_read("tests/fixtures/weather.epw", &size);
    cli_make_folder(folder);
    cli_write_file(folder, "room.rad", year_room_scene);
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
    char *hours = year_room_read(path, &size);
    assert_non_null(strstr(hours, ",\"standard error of grid1\",\"shades of south\"\n"));
    assert_non_null(strstr(hours, ",\"open\"\n"));
    assert_non_null(strstr(hours, ",\"down\"\n"));
    free(hours);
    const char *const verify[] = {"verify", there, "--files", folder, NULL};
    run_command(verify, &result);
    assert_non_null(strstr(result.out, "the same: "));
    cli_remove_folder(folder);
    free(weather);
}

/* Files in folders have slashes in their names, which the links escape; no other file exists. */
static void test_files_in_folders(void **state)
{
    struct year_room *f = *state;
    struct reply job, reply;
    char path[80], at[200];
    year_room_submit(f,
                     "\"samples\":16,\"formats\":[\"honeybee\"]," YEAR_ROOM_SEEDED
                     "\"sensors\":[[2,2,1,0,0,1]]",
                     path);
    year_room_expect(f, path, "succeeded", 1, &job);
    assert_non_null(strstr(reply_text(&job, "links.files.3"), "/files/results%2Fgrids_info.json"));
    assert_non_null(strstr(reply_text(&job, "warnings.3"), "the standard error is above 25 % of "));
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

/* ---- Caches ---------------------------------------------------------------------------------- */

static void fetch_result(struct year_room *f, const char *rest, struct reply *ret_reply)
{
    struct reply job;
    char path[80], at[96];
    year_room_submit(f, rest, path);
    year_room_expect(f, path, "succeeded", 1, &job);
    reply_done(&job);
    snprintf(at, sizeof at, "%s/result", path);
    daemon_get(&f->daemon, at, ret_reply);
    assert_int_equal(ret_reply->status, 200);
}

/* The inputs are the uploaded files that the year used, though an earlier job loaded the scene. */
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
    fetch_result(f, YEAR_ROOM_GRIDS "\"weather\":\"whole.wea\",\"samples\":16", &first);
    fetch_result(f, YEAR_ROOM_GRIDS "\"weather\":\"other.wea\",\"samples\":16", &other);
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
    /* Cached data can be listed and removed as maps can; then it is computed again. */
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
    fetch_result(f, YEAR_ROOM_GRIDS "\"weather\":\"other.wea\",\"samples\":16,\"title\":\"again\"",
                 &other);
    assert_true(reply_number(&other, "rays") > 0);
    reply_done(&other);
}

#define EACH(test) cmocka_unit_test_setup_teardown(test, year_room_set_up, year_room_tear_down)
int main(void)
{
    const struct CMUnitTest tests[] = {EACH(test_bytes_are_the_commands), EACH(test_shades_travel),
                                       EACH(test_files_in_folders),
                                       EACH(test_another_weather_casts_no_ray)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
