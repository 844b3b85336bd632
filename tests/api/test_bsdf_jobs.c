/* BSDF jobs of panels through a real daemon: bytes equal to the command's, a BSDF that scenes name,
 * restarts. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "support/cli.h"
#include "support/daemon.h"

static const char panel[] = "void plastic p 0 0 5 .5 .5 .5 0 0\n"
                            "p polygon slat 0 0 12 0 0 0 1 0 0 1 .7 -.7 0 .7 -.7\n";
static const char small[] = "\"basis\":\"klems_quarter\",\"paths\":256,\"name\":\"Slats\"";
/* Takes seconds on any machine. */
static const char some[] = "\"basis\":\"klems_quarter\",\"paths\":32768";
/* Takes hours. */
static const char endless[] = "\"basis\":\"tensor_tree_4\",\"paths\":16777216";

struct bench {
    struct daemon daemon;
    char scene[65];
};

static void upload(struct daemon *daemon, const char *text, const char *bsdfs, char ret_id[65])
{
    const struct upload_file file = {"panel.rad", text, strlen(text), false};
    struct reply reply;
    daemon_upload(daemon, &file, 1, bsdfs, &reply);
    if (reply.status != 201 && reply.status != 200)
        fail_msg("%ld: %s", reply.status, reply.body);
    snprintf(ret_id, 65, "%s", reply_text(&reply, "id"));
    reply_done(&reply);
}

static int set_up(void **state)
{
    struct bench *b = calloc(1, sizeof *b);
    daemon_start(&b->daemon, NULL);
    upload(&b->daemon, panel, NULL, b->scene);
    *state = b;
    return 0;
}

static int tear_down(void **state)
{
    struct bench *b = *state;
    daemon_remove(&b->daemon);
    free(b);
    return 0;
}

static void post(struct bench *b, const char *scene, const char *rest, struct reply *ret_reply)
{
    char text[512];
    snprintf(text, sizeof text, "{\"kind\":\"bsdf_make\",\"scene\":\"%s\",%s}", scene, rest);
    daemon_post_json(&b->daemon, "/v1/jobs", text, ret_reply);
}

static void submit(struct bench *b, const char *rest, char ret_path[80])
{
    struct reply reply;
    post(b, b->scene, rest, &reply);
    if (reply.status != 202)
        fail_msg("refused: %s", reply.body);
    assert_string_equal(reply_text(&reply, "kind"), "bsdf_make");
    snprintf(ret_path, 80, "%s", reply_text(&reply, "links.self"));
    reply_done(&reply);
}

static void expect_end(struct bench *b, const char *job, const char *state, int attempts,
                       struct reply *ret_reply)
{
    daemon_wait(&b->daemon, job, 240, ret_reply);
    if (strcmp(reply_text(ret_reply, "state"), state) != 0 ||
        reply_number(ret_reply, "attempts") != attempts)
        fail_msg("%s: %s", job, ret_reply->body);
}

/* ---- Results of a job ------------------------------------------------------------------------ */

static char *make_here(const char *folder, const char *const *options)
{
    static struct cli_result result;
    char in[96], out[96];
    const char *args[16] = {"bsdf", "make", in, "-o", out, "-j", "1"};
    size_t n = 7;
    snprintf(in, sizeof in, "%s/panel.rad", folder);
    snprintf(out, sizeof out, "%s/here.xml", folder);
    while (*options)
        args[n++] = *options++;
    cli_write_file(folder, "panel.rad", panel);
    cli_run(args, &result);
    if (result.exit_code != 0)
        fail_msg("%s", result.err);
    return cli_read_file(folder, "here.xml");
}

/* Compares results except the folder that the command was given. */
static void assert_same_data(const char *here, const char *there)
{
    const char *a = strstr(here, "<DataDefinition>"), *b = strstr(there, "<DataDefinition>");
    assert_non_null(a);
    assert_non_null(b);
    assert_string_equal(a, b);
}

static void get(struct bench *b, const char *job, const char *rest, struct reply *ret_reply)
{
    char path[160];
    snprintf(path, sizeof path, "%s%s", job, rest);
    daemon_get(&b->daemon, path, ret_reply);
    assert_int_equal(ret_reply->status, 200);
}

static void check_result(struct bench *b, const char *job)
{
    struct reply reply;
    get(b, job, "/result", &reply);
    assert_string_equal(reply_text(&reply, "kind"), "bsdf_make");
    assert_int_equal(json_array_size(reply_at(&reply, "directions")), 41);
    assert_true(reply_number(&reply, "diffuse.back.transmitted.value") > 0.1);
    assert_true(reply_number(&reply, "paths") == 2 * 41 * 256);
    assert_string_equal(reply_text(&reply, "bsdf.file"), "bsdf.xml");
    reply_done(&reply);
}

static void bytes_are_the_commands(void **state)
{
    struct bench *b = *state;
    static const char *const options[] = {"--basis", "klems_quarter", "--paths", "256",
                                          "--name",  "Slats",         NULL};
    struct reply reply;
    char job[80], folder[64], id[65];
    cli_make_folder(folder);
    char *here = make_here(folder, options);
    submit(b, small, job);
    expect_end(b, job, "succeeded", 1, &reply);
    assert_string_equal(reply_text(&reply, "name"), "Slats");
    assert_true(reply_number(&reply, "percent") == 100);
    assert_int_equal(json_array_size(reply_at(&reply, "links.files")), 2);
    assert_string_equal(reply_text(&reply, "maps.0.kind"), "made");
    assert_true(json_is_false(reply_at(&reply, "maps.0.cached")));
    snprintf(id, sizeof id, "%s", reply_text(&reply, "bsdf.id"));
    assert_non_null(strstr(reply_text(&reply, "links.bsdf"), id));
    reply_done(&reply);
    get(b, job, "/files/bsdf.xml", &reply);
    assert_same_data(here, reply.body);
    reply_done(&reply);
    check_result(b, job);
    cli_remove_folder(folder);
    free(here);
}

/* ---- A BSDF stored by the daemon ------------------------------------------------------------- */

static const char wall[] = "void BSDF slats 6 0 slats.xml 0 0 1 . 0 0\n"
                           "slats polygon pane 0 0 12 0 0 0 1 0 0 1 0 1 0 0 1\n";

static void scenes_name_it_at_once(void **state)
{
    struct bench *b = *state;
    struct reply reply;
    char job[80], path[96], id[65], names[128], scene[65];
    submit(b, small, job);
    expect_end(b, job, "succeeded", 1, &reply);
    snprintf(path, sizeof path, "%s", reply_text(&reply, "links.bsdf"));
    snprintf(id, sizeof id, "%s", reply_text(&reply, "bsdf.id"));
    reply_done(&reply);
    get(b, path, "", &reply);
    assert_string_equal(reply_text(&reply, "summary.kind"), "Klems Quarter");
    reply_done(&reply);
    snprintf(names, sizeof names, "{\"slats.xml\":\"%s\"}", id);
    upload(&b->daemon, wall, names, scene);
    /* The BSDF belongs to the daemon, not to the job. */
    daemon_request(&b->daemon, "DELETE", job, NULL, NULL, 0, NULL, &reply);
    assert_int_equal(reply.status, 204);
    reply_done(&reply);
    get(b, path, "", &reply);
    reply_done(&reply);
    daemon_request(&b->daemon, "DELETE", path, NULL, NULL, 0, NULL, &reply);
    assert_int_equal(reply.status, 409);
    reply_done(&reply);
}

/* An existing result is found for equal input, whatever its name. */
static void the_same_again_is_a_hit(void **state)
{
    struct bench *b = *state;
    struct reply reply;
    char job[80], id[65];
    submit(b, small, job);
    expect_end(b, job, "succeeded", 1, &reply);
    snprintf(id, sizeof id, "%s", reply_text(&reply, "bsdf.id"));
    reply_done(&reply);
    submit(b, "\"basis\":\"klems_quarter\",\"name\":\"Slats\",\"paths\":256,\"tags\":[\"x\"]", job);
    expect_end(b, job, "succeeded", 1, &reply);
    assert_true(json_is_true(reply_at(&reply, "maps.0.cached")));
    assert_string_equal(reply_text(&reply, "bsdf.id"), id);
    reply_done(&reply);
    check_result(b, job);
    submit(b, "\"basis\":\"klems_quarter\",\"name\":\"Slats\",\"paths\":256,\"seed\":2", job);
    expect_end(b, job, "succeeded", 1, &reply);
    assert_true(json_is_false(reply_at(&reply, "maps.0.cached")));
    reply_done(&reply);
}

/* ---- Ends ------------------------------------------------------------------------------------ */

static void what_is_no_panel_is_refused(void **state)
{
    static const char *const documents[] = {
        "\"basis\":\"klems\"",
        "\"basis\":\"klems_full\",\"resolution\":64",
        "\"paths\":1",
        "\"accuracy\":0.1,\"paths_most\":16",
        "\"cell\":{\"x\":[1,0],\"y\":[0,1]}",
        "\"sensors\":[]",
        "\"basis\":\"tensor_tree_4\",\"resolution\":48",
    };
    struct bench *b = *state;
    struct reply reply;
    char lit[65];
    for (size_t i = 0; i < sizeof documents / sizeof *documents; i++) {
        post(b, b->scene, documents[i], &reply);
        if (reply.status != 400 && reply.status != 413 && reply.status != 422)
            fail_msg("%s: %ld", documents[i], reply.status);
        reply_done(&reply);
    }
    upload(&b->daemon, "void glow g 0 0 4 1 1 1 0\ng source sky 0 0 4 0 0 1 180\n", NULL, lit);
    post(b, lit, small, &reply);
    assert_int_equal(reply.status, 422);
    assert_non_null(strstr(reply_text(&reply, "detail"), "a panel cannot contain"));
    reply_done(&reply);
}

static void it_is_followed_and_cancelled(void **state)
{
    struct bench *b = *state;
    struct reply reply;
    char job[80];
    submit(b, endless, job);
    daemon_wait_running(&b->daemon, job, -1);
    daemon_cancel(&b->daemon, job, &reply);
    assert_int_equal(reply.status, 202);
    reply_done(&reply);
    expect_end(b, job, "cancelled", 1, &reply);
    reply_done(&reply);
    daemon_expect_no_files(&b->daemon, "tmp");
    submit(b, "\"basis\":\"klems_full\",\"paths\":16384", job);
    daemon_wait_running(&b->daemon, job, 3);
    get(b, job, "", &reply);
    assert_string_equal(reply_text(&reply, "stage"), "render");
    assert_true(reply_number(&reply, "eta_s") > 0);
    reply_done(&reply);
    daemon_cancel(&b->daemon, job, &reply);
    reply_done(&reply);
}

/* A killed daemon computes it again: the bytes are those of an uninterrupted run. */
static void a_kill_changes_nothing(void **state)
{
    struct bench *b = *state;
    static const char *const options[] = {"--basis", "klems_quarter", "--paths", "32768", NULL};
    struct reply reply;
    char job[80], folder[64];
    cli_make_folder(folder);
    char *here = make_here(folder, options);
    submit(b, some, job);
    daemon_wait_running(&b->daemon, job, 1);
    assert_int_equal(daemon_end(&b->daemon, SIGKILL), -1);
    daemon_restart(&b->daemon, NULL);
    expect_end(b, job, "succeeded", 2, &reply);
    reply_done(&reply);
    get(b, job, "/files/bsdf.xml", &reply);
    assert_same_data(here, reply.body);
    reply_done(&reply);
    daemon_expect_no_files(&b->daemon, "tmp");
    cli_remove_folder(folder);
    free(here);
}

int main(void)
{
    static const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(bytes_are_the_commands, set_up, tear_down),
        cmocka_unit_test_setup_teardown(scenes_name_it_at_once, set_up, tear_down),
        cmocka_unit_test_setup_teardown(the_same_again_is_a_hit, set_up, tear_down),
        cmocka_unit_test_setup_teardown(what_is_no_panel_is_refused, set_up, tear_down),
        cmocka_unit_test_setup_teardown(it_is_followed_and_cancelled, set_up, tear_down),
        cmocka_unit_test_setup_teardown(a_kill_changes_nothing, set_up, tear_down),
    };
    return cmocka_run_group_tests_name("bsdf jobs", tests, NULL, NULL);
}
