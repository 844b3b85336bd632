/* Ownership of jobs: tokens cancel and remove their own jobs, and no other token can use their
 * keys. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "support/daemon.h"

static const char *const with_tokens[] = {"--tokens", "always", NULL};

struct fixture {
    struct daemon daemon;
    char scene[65], before[80]; /* before: a job from the time without tokens */
    char ann[128], bob[128], admin[128];
};

/* Runs `orield token ...`; returns its first line. */
static void token(const struct daemon *daemon, const char *arguments, char ret_line[128])
{
    char command[400];
    const char *build = getenv("ORIEL_BUILD");
    snprintf(command, sizeof command, "%s/orield token %s --data %s", build ? build : "build",
             arguments, daemon->root);
    FILE *pipe = popen(command, "r");
    assert_non_null(pipe);
    ret_line[0] = '\0';
    if (!fgets(ret_line, 128, pipe))
        ret_line[0] = '\0';
    assert_int_equal(pclose(pipe), 0);
    ret_line[strcspn(ret_line, "\n")] = '\0';
}

static void make_token(const struct daemon *daemon, const char *name, const char *scope,
                       char ret_header[128])
{
    char arguments[100], line[128];
    snprintf(arguments, sizeof arguments, "add %s --scope %s", name, scope);
    token(daemon, arguments, line);
    snprintf(ret_header, 128, "Authorization: Bearer %.90s", line);
}

static int set_up(void **state)
{
    static struct fixture f;
    memset(&f, 0, sizeof f);
    daemon_start(&f.daemon, NULL);
    daemon_upload_room(&f.daemon, f.scene);
    daemon_submit(&f.daemon, f.scene, 100000000, 9, NULL, f.before);
    assert_int_equal(daemon_end(&f.daemon, SIGTERM), 0);
    make_token(&f.daemon, "ann", "submit", f.ann);
    make_token(&f.daemon, "bob", "submit", f.bob);
    make_token(&f.daemon, "root", "admin", f.admin);
    daemon_restart(&f.daemon, with_tokens);
    *state = &f;
    return 0;
}

static int tear_down(void **state)
{
    struct fixture *f = *state;
    daemon_remove(&f->daemon);
    return 0;
}

static void submit(struct fixture *f, const char *who, const char *key, char ret_path[80])
{
    char body[300], header[300];
    struct reply reply;
    const int size = snprintf(body, sizeof body,
                              "{\"scene\":\"%s\",\"photons\":{\"global\":100000000},"
                              "\"sensors\":[[2,1,0.8,0,0,1]]}",
                              f->scene);
    snprintf(header, sizeof header, "%s%s%s", who, key ? "\r\nIdempotency-Key: " : "",
             key ? key : "");
    daemon_request(&f->daemon, "POST", "/v1/jobs", "application/json", body, (size_t)size, header,
                   &reply);
    if (reply.status != 202)
        fail_msg("%ld %s", reply.status, reply.body);
    snprintf(ret_path, 80, "%s", reply_text(&reply, "links.self"));
    reply_done(&reply);
}

static void expect(struct fixture *f, const char *who, const char *method, const char *path,
                   long status)
{
    struct reply reply;
    daemon_request(&f->daemon, method, path, NULL, "", 0, who, &reply);
    if (reply.status != status)
        fail_msg("%s %s by %s: %ld in place of %ld: %s", method, path, who, reply.status, status,
                 reply.body);
    if (status == 403) {
        assert_string_equal(reply_text(&reply, "type"), "urn:oriel:error:insufficient-scope");
        assert_non_null(strstr(reply_header(&reply, "WWW-Authenticate"), "scope=\"admin\""));
    }
    reply_done(&reply);
}

static void expect_owner_alone(struct fixture *f, const char *job, const char *owner,
                               const char *other)
{
    char cancel[100];
    struct reply reply;
    snprintf(cancel, sizeof cancel, "%s/cancel", job);
    expect(f, other, "POST", cancel, 403);
    snprintf(cancel, sizeof cancel, "%.14s/cancel", job); /* by the first digits of its id */
    expect(f, other, "POST", cancel, 403);
    daemon_request(&f->daemon, "GET", job, NULL, NULL, 0, other, &reply);
    assert_int_equal(reply.status, 200); /* may be read */
    assert_string_not_equal(reply_text(&reply, "state"), "cancelled");
    reply_done(&reply);
    snprintf(cancel, sizeof cancel, "%s/cancel", job);
    daemon_request(&f->daemon, "POST", cancel, NULL, "", 0, owner, &reply);
    assert_true(reply.status == 200 || reply.status == 202);
    reply_done(&reply);
    for (bool ended = false; !ended;) {
        daemon_request(&f->daemon, "GET", job, NULL, NULL, 0, owner, &reply);
        ended = strcmp(reply_text(&reply, "state"), "cancelled") == 0;
        reply_done(&reply);
    }
    expect(f, other, "DELETE", job, 403);
    expect(f, owner, "DELETE", job, 204);
}

static void test_own_jobs_alone(void **state)
{
    struct fixture *f = *state;
    char job[80];
    submit(f, f->ann, NULL, job);
    expect_owner_alone(f, job, f->ann, f->bob);
    submit(f, f->ann, NULL, job);
    expect_owner_alone(f, job, f->admin, f->bob);
    expect_owner_alone(f, f->before, f->admin, f->ann); /* without an owner */
}

/* A job that shares the computation of another token's ends for itself only. */
static void test_shared_computation(void **state)
{
    struct fixture *f = *state;
    char first[80], second[80];
    submit(f, f->ann, NULL, first);
    submit(f, f->bob, NULL, second);
    expect_owner_alone(f, first, f->ann, f->bob);
    expect_owner_alone(f, second, f->bob, f->ann);
}

/* A new token of the same name has no access to the keys and jobs of the first; the first token
 * has, also after a restart. */
static void test_keys_of_a_removed_token(void **state)
{
    struct fixture *f = *state;
    char first[80], again[80], other[80], line[128], second[128];
    submit(f, f->ann, "night", first);
    submit(f, f->ann, "night", again);
    assert_string_equal(first, again);
    assert_int_equal(daemon_end(&f->daemon, SIGTERM), 0);
    daemon_restart(&f->daemon, with_tokens);
    submit(f, f->ann, "night", again);
    assert_string_equal(first, again);
    token(&f->daemon, "remove ann", line);
    make_token(&f->daemon, "ann", "submit", second);
    submit(f, second, "night", other);
    assert_string_not_equal(first, other);
    expect_owner_alone(f, first, f->admin, second);
    expect_owner_alone(f, other, second, f->bob);
}

#define EACH(test) cmocka_unit_test_setup_teardown(test, set_up, tear_down)
int main(void)
{
    const struct CMUnitTest tests[] = {
        EACH(test_own_jobs_alone),
        EACH(test_shared_computation),
        EACH(test_keys_of_a_removed_token),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
