/*
 * BSDFs fitted to measurements through a real daemon: uploaded as files, fitted, named by a scene.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "support/cli.h"
#include "support/daemon.h"

static const char options[] = "\"basis\":\"klems_quarter\",\"name\":\"Paper\"";

struct bench {
    struct daemon daemon;
    char measured[65], scene[65];
};

/* Returns measurements of a sheet whose transmission scatters around the straight direction. */
static char *sheet(void)
{
    static const int incident[] = {0, 30, 60};
    char *text = NULL;
    size_t size = 0;
    FILE *out = open_memstream(&text, &size);
    assert_non_null(out);
    fputs("theta_in,phi_in,theta_out,phi_out,bsdf\n", out);
    for (int k = 0; k < 3; k++)
        for (int i = 0; i < 400; i++) {
            const double cosine = 1 - 0.98 * (i + 0.5) / 400, sine = sqrt(1 - cosine * cosine);
            const double turn = 2.39996 * i, in = incident[k] * M_PI / 180;
            const double along = -sin(in) * sine * cos(turn) + cos(in) * cosine;
            fprintf(out, "%d,0,%.3f,%.3f,%.6f\n", incident[k], 180 - acos(cosine) * 180 / M_PI,
                    fmod(turn * 180 / M_PI, 360), 0.05 + 0.4 * pow(fmax(along, 0), 12));
        }
    assert_int_equal(fclose(out), 0);
    return text;
}

static void upload(struct bench *b, const char *name, const char *text, long status,
                   struct reply *ret_reply)
{
    const struct upload_file file = {name, text, strlen(text), false};
    daemon_upload(&b->daemon, &file, 1, NULL, ret_reply);
    if (ret_reply->status != status)
        fail_msg("%s: %ld: %s", name, ret_reply->status, ret_reply->body);
}

static int set_up(void **state)
{
    struct bench *b = calloc(1, sizeof *b);
    struct reply reply;
    char *text = sheet();
    daemon_start(&b->daemon, NULL);
    upload(b, "sheet.csv", text, 201, &reply);
    snprintf(b->measured, 65, "%s", reply_text(&reply, "id"));
    assert_true(reply_number(&reply, "summary.measurements.rows") == 1200);
    assert_true(reply_number(&reply, "summary.measurements.incident_directions") == 3);
    assert_string_equal(reply_text(&reply, "summary.main.0"), "sheet.csv");
    reply_done(&reply);
    upload(b, "p.rad", "void plastic p 0 0 5 .5 .5 .5 0 0\np sphere s 0 0 4 0 0 0 1\n", 201,
           &reply);
    snprintf(b->scene, 65, "%s", reply_text(&reply, "id"));
    reply_done(&reply);
    free(text);
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

static void post(struct bench *b, const char *kind, const char *member, const char *id,
                 const char *rest, struct reply *ret_reply)
{
    char text[512];
    snprintf(text, sizeof text, "{\"kind\":\"%s\",\"%s\":\"%s\",%s}", kind, member, id, rest);
    daemon_post_json(&b->daemon, "/v1/jobs", text, ret_reply);
}

static void fit(struct bench *b, const char *rest, char ret_path[80], struct reply *ret_reply)
{
    post(b, "bsdf_fit", "measurements", b->measured, rest, ret_reply);
    if (ret_reply->status != 202)
        fail_msg("refused: %s", ret_reply->body);
    snprintf(ret_path, 80, "%s", reply_text(ret_reply, "links.self"));
    reply_done(ret_reply);
    daemon_wait(&b->daemon, ret_path, 240, ret_reply);
    if (strcmp(reply_text(ret_reply, "state"), "succeeded") != 0)
        fail_msg("%s", ret_reply->body);
}

static void get(struct bench *b, const char *job, const char *rest, struct reply *ret_reply)
{
    char path[160];
    snprintf(path, sizeof path, "%s%s", job, rest);
    daemon_get(&b->daemon, path, ret_reply);
    assert_int_equal(ret_reply->status, 200);
}

static char *fit_here(const char *folder)
{
    static struct cli_result result;
    char in[96], out[96], *text = sheet();
    const char *const args[] = {"bsdf",    "fit",           in,       "-o",    out,
                                "--basis", "klems_quarter", "--name", "Paper", NULL};
    snprintf(in, sizeof in, "%s/sheet.csv", folder);
    snprintf(out, sizeof out, "%s/here.xml", folder);
    cli_write_file(folder, "sheet.csv", text);
    free(text);
    cli_run(args, &result);
    if (result.exit_code != 0)
        fail_msg("%s", result.err);
    return cli_read_file(folder, "here.xml");
}

/* The values equal the command's and are in the result; a scene can name the BSDF at once. */
static void a_scene_names_what_was_measured(void **state)
{
    static const char wall[] = "void BSDF paper 6 0 paper.xml 0 0 1 . 0 0\n"
                               "paper polygon pane 0 0 12 0 0 0 1 0 0 1 0 1 0 0 1\n";
    struct bench *b = *state;
    struct reply reply;
    char job[80], folder[64], names[128];
    cli_make_folder(folder);
    char *here = fit_here(folder);
    fit(b, options, job, &reply);
    assert_true(json_is_false(reply_at(&reply, "maps.0.cached")));
    assert_true(reply_number(&reply, "maps.0.emitted") == 1200);
    snprintf(names, sizeof names, "{\"paper.xml\":\"%s\"}", reply_text(&reply, "bsdf.id"));
    reply_done(&reply);
    get(b, job, "/files/bsdf.xml", &reply);
    assert_string_equal(strstr(here, "<DataDefinition>"), strstr(reply.body, "<DataDefinition>"));
    reply_done(&reply);
    get(b, job, "/result", &reply);
    assert_string_equal(reply_text(&reply, "kind"), "bsdf_fit");
    assert_int_equal(json_array_size(reply_at(&reply, "scans")), 3);
    assert_true(reply_number(&reply, "components.transmission_front.diffuse.value") > 0.2);
    assert_true(json_is_null(reply_at(&reply, "components.reflection_back")));
    reply_done(&reply);
    const struct upload_file file = {"wall.rad", wall, strlen(wall), false};
    daemon_upload(&b->daemon, &file, 1, names, &reply);
    assert_int_equal(reply.status, 201);
    reply_done(&reply);
    cli_remove_folder(folder);
    free(here);
}

/* The result is also found after a restart of the daemon. */
static void the_same_again_is_a_hit(void **state)
{
    struct bench *b = *state;
    struct reply reply;
    char job[80], id[65];
    fit(b, options, job, &reply);
    snprintf(id, sizeof id, "%s", reply_text(&reply, "bsdf.id"));
    reply_done(&reply);
    assert_int_equal(daemon_end(&b->daemon, SIGKILL), -1);
    daemon_restart(&b->daemon, NULL);
    fit(b, "\"name\":\"Paper\",\"basis\":\"klems_quarter\",\"tags\":[\"x\"]", job, &reply);
    assert_true(json_is_true(reply_at(&reply, "maps.0.cached")));
    assert_string_equal(reply_text(&reply, "bsdf.id"), id);
    reply_done(&reply);
    get(b, job, "/result", &reply);
    assert_int_equal(json_array_size(reply_at(&reply, "scans")), 3);
    reply_done(&reply);
    fit(b, "\"name\":\"Paper\",\"basis\":\"klems_half\"", job, &reply);
    assert_true(json_is_false(reply_at(&reply, "maps.0.cached")));
    reply_done(&reply);
}

static void expect_refusal(struct bench *b, const char *kind, const char *member, const char *id,
                           const char *rest, const char *words)
{
    struct reply reply;
    post(b, kind, member, id, rest, &reply);
    if (reply.status != 422 || !strstr(reply.body, words))
        fail_msg("%s of %s: %ld: %s", kind, member, reply.status, reply.body);
    reply_done(&reply);
}

static void measurements_are_no_scene(void **state)
{
    struct bench *b = *state;
    struct reply reply;
    const char *const sensors = "\"sensors\":[[1,1,1,0,0,1]]";
    expect_refusal(b, "render", "scene", b->measured, sensors, "this is the id of measurements");
    expect_refusal(b, "bsdf_make", "scene", b->measured, "\"seed\":1",
                   "this is the id of measurements");
    expect_refusal(b, "bsdf_fit", "measurements", b->scene, options, "this is the id of a scene");
    upload(b, "bad.txt", "#format: theta phi BSDF\n#incident_angle 30 0\n120 0 0.1\n120 10 dark\n",
           400, &reply);
    assert_string_equal(reply_text(&reply, "file"), "bad.txt");
    assert_true(reply_number(&reply, "line") == 4);
    reply_done(&reply);
}

int main(void)
{
    static const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(a_scene_names_what_was_measured, set_up, tear_down),
        cmocka_unit_test_setup_teardown(the_same_again_is_a_hit, set_up, tear_down),
        cmocka_unit_test_setup_teardown(measurements_are_no_scene, set_up, tear_down),
    };
    return cmocka_run_group_tests_name("fit jobs", tests, NULL, NULL);
}
