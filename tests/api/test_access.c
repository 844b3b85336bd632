/* Access control: tokens and their scopes, TLS, and configurations that are refused at start. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <ctype.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>

#include "handlers/handlers.h"
#include "support/certificate.h"
#include "support/daemon.h"

struct fixture {
    struct daemon daemon;
    char cert[80], key[80];
    char read[128], submit[128]; /* Authorization headers */
    char scene[65];
};

/* Runs `orield ARGUMENTS`; returns its exit status, and its output on either stream. */
static int run_orield(const char *arguments, char *ret_said, size_t size)
{
    char command[600];
    const char *build = getenv("ORIEL_BUILD");
    snprintf(command, sizeof command, "timeout 120 %s/orield %s 2>&1", build ? build : "build",
             arguments);
    FILE *pipe = popen(command, "r");
    assert_non_null(pipe);
    const size_t n = fread(ret_said, 1, size - 1, pipe);
    ret_said[n] = '\0';
    const int status = pclose(pipe);
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

static void token(const struct daemon *daemon, const char *arguments, char *ret_said, size_t size)
{
    char line[300];
    snprintf(line, sizeof line, "token %s --data %s", arguments, daemon->root);
    if (run_orield(line, ret_said, size) != 0)
        fail_msg("orield %s: %s", line, ret_said);
    ret_said[strcspn(ret_said, "\n")] = '\0';
}

static void make_token(const struct daemon *daemon, const char *name, const char *scope,
                       char ret_header[128])
{
    char arguments[128], said[256];
    snprintf(arguments, sizeof arguments, "add %s --scope %s", name, scope);
    token(daemon, arguments, said, sizeof said);
    assert_int_equal(strncmp(said, "oriel_", 6), 0);
    snprintf(ret_header, 128, "Authorization: Bearer %.90s", said);
}

/* Uploads the room without tokens; then restarts on the same folder with tokens and HTTPS. */
static int setup(void **state)
{
    static struct fixture f;
    daemon_start(&f.daemon, NULL);
    daemon_upload_room(&f.daemon, f.scene);
    make_token(&f.daemon, "dashboard", "read", f.read); /* while the daemon runs */
    assert_int_equal(daemon_end(&f.daemon, SIGTERM), 0);
    make_token(&f.daemon, "design.tool", "submit", f.submit);
    snprintf(f.cert, sizeof f.cert, "%s/cert.pem", f.daemon.root);
    snprintf(f.key, sizeof f.key, "%s/key.pem", f.daemon.root);
    certificate_make(f.cert, f.key);
    const char *const extra[] = {"--listen",  "0.0.0.0:0", "--tls-cert", f.cert,
                                 "--tls-key", f.key,       NULL};
    daemon_restart(&f.daemon, extra);
    snprintf(f.daemon.ca, sizeof f.daemon.ca, "%s", f.cert);
    *state = &f;
    return 0;
}

static int teardown(void **state)
{
    daemon_remove(&((struct fixture *)*state)->daemon);
    return 0;
}

/* Expects a problem of that type, and a challenge that contains `part`. */
static void expect(struct fixture *f, const char *method, const char *path, const char *body,
                   const char *header, long status, const char *type, const char *part)
{
    struct reply reply;
    char wanted[80];
    daemon_request(&f->daemon, method, path, body ? "application/json" : NULL, body,
                   body ? strlen(body) : 0, header, &reply);
    snprintf(wanted, sizeof wanted, "urn:oriel:error:%s", type ? type : "");
    if (reply.status != status || (type && strcmp(reply_text(&reply, "type"), wanted) != 0))
        fail_msg("%s %s (%s): %ld %s", method, path, header ? header : "no token", reply.status,
                 reply.body);
    if (part) {
        const char *challenge = reply_header(&reply, "WWW-Authenticate");
        assert_non_null(challenge);
        assert_int_equal(strncmp(challenge, "Bearer realm=\"oriel\"", 20), 0);
        assert_non_null(strstr(challenge, part));
    }
    reply_done(&reply);
}

static void test_without_a_token(void **state)
{
    struct fixture *f = *state;
    static const char *const open[] = {"/", "/healthz", "/readyz", "/openapi.yaml"};
    static const char *const closed[] = {"/v1/jobs", "/v1/limits", "/v1/maps", "/v1/jobs/0123"};
    assert_int_equal(strncmp(f->daemon.url, "https://0.0.0.0:", 16), 0);
    for (size_t i = 0; i < sizeof open / sizeof *open; i++)
        expect(f, "GET", open[i], NULL, NULL, 200, NULL, NULL);
    for (size_t i = 0; i < sizeof closed / sizeof *closed; i++)
        expect(f, "GET", closed[i], NULL, NULL, 401, "unauthorized", "realm");
    expect(f, "POST", "/v1/jobs", "{}", NULL, 401, "unauthorized", "realm");
    expect(f, "POST", "/v1/scenes", "{}", NULL, 401, "unauthorized", "realm");
}

static void test_wrong_tokens(void **state)
{
    struct fixture *f = *state;
    char wrong[256];
    static const char *const others[] = {
        "Authorization: Bearer ",
        "Authorization: Bearer x",
        "Authorization: Bearer oriel_0123456789abcdef_AAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAA",
        "Authorization: Bearer oriel_'; DROP TABLE tokens--",
        "Authorization: Basic YTpi",
    };
    for (size_t i = 0; i < sizeof others / sizeof *others; i++)
        expect(f, "GET", "/v1/jobs", NULL, others[i], 401, "unauthorized", "realm");
    /* Changes the first or the last character of the secret, or adds one. */
    snprintf(wrong, sizeof wrong, "%s", f->read);
    char *last = wrong + strlen(wrong) - 1;
    *last = *last == 'A' ? 'B' : 'A';
    expect(f, "GET", "/v1/jobs", NULL, wrong, 401, "unauthorized", "invalid_token");
    snprintf(wrong, sizeof wrong, "%s", f->read);
    char *first = strchr(strstr(wrong, "oriel_") + 6, '_') + 1;
    *first = *first == 'A' ? 'B' : 'A';
    expect(f, "GET", "/v1/jobs", NULL, wrong, 401, "unauthorized", "invalid_token");
    snprintf(wrong, sizeof wrong, "%sA", f->read);
    expect(f, "GET", "/v1/jobs", NULL, wrong, 401, "unauthorized", "invalid_token");
}

static void test_scopes(void **state)
{
    struct fixture *f = *state;
    char job[300];
    snprintf(job, sizeof job,
             "{\"kind\":\"render\",\"scene\":\"%s\",\"technique\":\"backward\","
             "\"gather_samples\":16,\"sensors\":[[2,1,0.8,0,0,1]]}",
             f->scene);
    expect(f, "GET", "/v1/jobs", NULL, f->read, 200, NULL, NULL);
    expect(f, "POST", "/v1/jobs", job, f->read, 403, "insufficient-scope", "scope=\"submit\"");
    expect(f, "DELETE", "/v1/jobs/0123", NULL, f->read, 403, "insufficient-scope", "submit");
    expect(f, "POST", "/v1/scenes", "{}", f->read, 403, "insufficient-scope", "submit");
    expect(f, "POST", "/v1/jobs", job, f->submit, 202, NULL, NULL);
    expect(f, "GET", "/v1/jobs", NULL, f->submit, 200, NULL, NULL);
}

static size_t count_jobs(struct fixture *f)
{
    struct reply reply;
    daemon_request(&f->daemon, "GET", "/v1/jobs?limit=1000", NULL, NULL, 0, f->read, &reply);
    assert_int_equal(reply.status, 200);
    const size_t count = json_array_size(reply_at(&reply, "jobs"));
    reply_done(&reply);
    return count;
}

/* Without a token, with a read-only token, and with a good one over plain HTTP no job is created;
 * with a good one over TLS a job is. */
static void test_jobs_that_are_refused(void **state)
{
    struct fixture *f = *state;
    char job[300], command[600];
    const size_t before = count_jobs(f);
    snprintf(job, sizeof job, "{\"scene\":\"%s\",\"sensors\":[[2,1,0.8,0,0,1]]}", f->scene);
    expect(f, "POST", "/v1/jobs", job, NULL, 401, "unauthorized", "realm");
    expect(f, "POST", "/v1/jobs", job, f->read, 403, "insufficient-scope", "scope=\"submit\"");
    snprintf(
        command, sizeof command,
        "! curl -s -m 10 -H '%s' -H 'Content-Type: application/json' -d '%s' http://%s/v1/jobs",
        f->submit, job, f->daemon.url + 8);
    assert_int_equal(system(command), 0);
    assert_int_equal(count_jobs(f), before);
    expect(f, "POST", "/v1/jobs", job, f->submit, 202, NULL, NULL);
    assert_int_equal(count_jobs(f), before + 1);
}

/* Checks one operation of the contract: it is open, or requires the stated scope. */
static void check_operation(struct fixture *f, const char *path, const char *verb,
                            const char *scope)
{
    const bool open = !*scope, reads = strcmp(scope, "read") == 0;
    const bool submits = strcmp(scope, "submit") == 0;
    struct reply reply;
    if (strcmp(path, "/v1/events") == 0) /* it has no end */
        verb = "HEAD";
    assert_true(open || reads || submits || strcmp(scope, "admin") == 0);
    daemon_request(&f->daemon, verb, path, NULL, NULL, 0, NULL, &reply);
    if ((reply.status == 401) == open)
        fail_msg("%s %s of scope '%s' without a token: %ld", verb, path, scope, reply.status);
    reply_done(&reply);
    daemon_request(&f->daemon, verb, path, NULL, NULL, 0, f->read, &reply);
    if ((reply.status == 403) == (open || reads) || reply.status == 401)
        fail_msg("%s %s of scope '%s' with a token to read: %ld", verb, path, scope, reply.status);
    reply_done(&reply);
    daemon_request(&f->daemon, verb, path, NULL, NULL, 0, f->submit, &reply);
    if ((reply.status == 403) == (open || reads || submits) || reply.status == 401)
        fail_msg("%s %s of scope '%s' with a token to submit: %ld", verb, path, scope,
                 reply.status);
    reply_done(&reply);
}

/* Converts "  /v1/jobs/{id}:" to a path with 0 for each parameter. */
static void path_of(const char *line, char ret_path[128])
{
    snprintf(ret_path, 128, "%.*s", (int)strlen(line) - 3, line + 2);
    for (char *brace; (brace = strchr(ret_path, '{'));) {
        const char *end = strchr(brace, '}');
        assert_non_null(end);
        *brace = '0';
        memmove(brace + 1, end + 1, strlen(end));
    }
}

/* Every operation requires the scope that the contract states, and none if it is open. */
static void test_contract_states_scopes(void **state)
{
    struct fixture *f = *state;
    struct reply contract;
    char path[128] = "", verb[16] = "", scope[16] = "", *save = NULL;
    size_t operations = 0;
    daemon_get(&f->daemon, "/openapi.yaml", &contract);
    for (char *line = strtok_r(contract.body, "\n", &save); line;
         line = strtok_r(NULL, "\n", &save)) {
        if (strncmp(line, "components:", 11) == 0)
            break;
        if (sscanf(line, "      x-scope: %15s", scope) == 1)
            continue;
        if (strcmp(line, "      responses:") == 0 && *verb) {
            check_operation(f, path, verb, scope);
            operations++;
            *verb = *scope = '\0';
        } else if (strncmp(line, "    ", 4) == 0 && line[4] != ' ') {
            snprintf(verb, sizeof verb, "%.*s", (int)strcspn(line + 4, ":"), line + 4);
            for (char *c = verb; *c; c++)
                *c = (char)toupper((unsigned char)*c);
        } else if (strncmp(line, "  /", 3) == 0) {
            path_of(line, path);
        }
    }
    assert_int_equal(operations, orl_routes.count);
    reply_done(&contract);
}

static void test_removed_at_once(void **state)
{
    struct fixture *f = *state;
    char header[128], said[4000];
    make_token(&f->daemon, "visitor", "admin", header);
    expect(f, "GET", "/v1/jobs", NULL, header, 200, NULL, NULL);
    token(&f->daemon, "remove visitor", said, sizeof said);
    expect(f, "GET", "/v1/jobs", NULL, header, 401, "unauthorized", "invalid_token");
    char line[300];
    snprintf(line, sizeof line, "token list --data %s", f->daemon.root);
    assert_int_equal(run_orield(line, said, sizeof said), 0);
    assert_non_null(strstr(said, "dashboard"));
    assert_null(strstr(said, "visitor"));
    /* No file in the folder contains a secret. */
    snprintf(line, sizeof line, "! grep -rqF -e '%s' %s", strrchr(f->read, ' ') + 24,
             f->daemon.root);
    assert_int_equal(system(line), 0);
}

static void test_token_command_line(void **state)
{
    struct fixture *f = *state;
    static const struct {
        const char *arguments;
        int status;
    } cases[] = {{"--help", 0},
                 {"", 2},
                 {"add", 2},
                 {"add x --scope all", 2},
                 {"add dashboard", 1},
                 {"add 'a b'", 1},
                 {"remove", 2},
                 {"remove nobody", 1},
                 {"list x", 2},
                 {"add x --what 1", 2},
                 {"list --scope read", 2}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char line[200], said[4000];
        snprintf(line, sizeof line, "token %s %s %s", cases[i].arguments,
                 cases[i].status == 1 ? "--data" : "", cases[i].status == 1 ? f->daemon.root : "");
        const int status = run_orield(line, said, sizeof said);
        if (status != cases[i].status)
            fail_msg("orield %s ended with %d: %s", line, status, said);
    }
}

/* The command sends $ORIEL_TOKEN, and its error message names the problem without it. */
static void test_command_sends_its_token(void **state)
{
    struct fixture *f = *state;
    const char *build = getenv("ORIEL_BUILD");
    char command[500];
    snprintf(command, sizeof command, "ORIEL_CA=%s ORIEL_TOKEN=%s %s/oriel maps --server %s >&2",
             f->cert, strrchr(f->read, ' ') + 1, build ? build : "build", f->daemon.url);
    assert_int_equal(system(command), 0);
    snprintf(command, sizeof command,
             "ORIEL_CA=%s %s/oriel maps --server %s 2>&1 | grep -q 'access token'", f->cert,
             build ? build : "build", f->daemon.url);
    assert_int_equal(system(command), 0);
}

/* Plain HTTP to the TLS port gets no answer. */
static void test_plain_http_gets_nothing(void **state)
{
    struct fixture *f = *state;
    char command[200];
    snprintf(command, sizeof command, "! curl -s -m 10 http://%s/healthz", f->daemon.url + 8);
    assert_int_equal(system(command), 0);
    /* TLS 1.1 gets no answer either. */
    snprintf(command, sizeof command, "! curl -sk -m 10 --tls-max 1.1 https://%s/healthz",
             f->daemon.url + 8);
    assert_int_equal(system(command), 0);
}

/* An unsafe configuration does not start, and the message gives the reason. */
static void test_refused_at_start(void **state)
{
    struct fixture *f = *state;
    char data[] = "/tmp/oriel-test-XXXXXX", line[400], said[4000];
    assert_non_null(mkdtemp(data));
    static const struct {
        const char *arguments, *says;
        int status;
    } cases[] = {
        {"--listen 0.0.0.0:0", "plain HTTP", 2},
        {"--listen [::]:0", "plain HTTP", 2},
        {"--listen 192.0.2.1:80 --tokens always", "plain HTTP", 2},
        {"--tls-cert x", "or neither", 2},
        {"--tokens sometimes", "public or always", 2},
        {"--tokens always", "no access tokens yet", 1},
        {"--tls-cert /nowhere --tls-key /nowhere", "/nowhere", 1},
        {"--tls-cert README.md --tls-key README.md", "key", 1},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        snprintf(line, sizeof line, "--data %s --port 0 %s", data, cases[i].arguments);
        const int status = run_orield(line, said, sizeof said);
        if (status != cases[i].status || !strstr(said, cases[i].says))
            fail_msg("orield %s ended with %d: %s", line, status, said);
    }
    /* TLS alone does not permit a public address. */
    snprintf(line, sizeof line, "--data %s --listen 0.0.0.0:0 --tls-cert %s --tls-key %s", data,
             f->cert, f->key);
    assert_int_equal(run_orield(line, said, sizeof said), 1);
    assert_non_null(strstr(said, "no access tokens yet"));
    chmod(f->key, 0644);
    snprintf(line, sizeof line, "--data %s --port 0 --tls-cert %s --tls-key %s", data, f->cert,
             f->key);
    assert_int_equal(run_orield(line, said, sizeof said), 1);
    assert_non_null(strstr(said, "everyone on this machine can read"));
    chmod(f->key, 0600);
    snprintf(line, sizeof line, "rm -r %s", data);
    assert_int_equal(system(line), 0);
}

/* Behind a proxy: loopback, any Host, and tokens are still required. One address has only its
 * share. */
static void test_behind_a_proxy(void **state)
{
    struct fixture *f = *state;
    struct reply reply;
    const char *const extra[] = {"--tokens", "always", NULL};
    assert_int_equal(daemon_end(&f->daemon, SIGTERM), 0);
    daemon_restart(&f->daemon, extra);
    assert_int_equal(strncmp(f->daemon.url, "http://127.0.0.1:", 17), 0);
    expect(f, "GET", "/v1/jobs", NULL, NULL, 401, "unauthorized", "realm");
    expect(f, "GET", "/v1/jobs", NULL, f->read, 200, NULL, NULL);
    daemon_request(&f->daemon, "GET", "/healthz", NULL, NULL, 0, "Host: oriel.example", &reply);
    assert_int_equal(reply.status, 200);
    reply_done(&reply);
}

static void test_folder_is_private(void **state)
{
    struct fixture *f = *state;
    char path[96];
    struct stat st;
    snprintf(path, sizeof path, "%s/oriel.db", f->daemon.root);
    assert_int_equal(stat(path, &st), 0);
    assert_int_equal(st.st_mode & 0077, 0);
    snprintf(path, sizeof path, "%s/results", f->daemon.root);
    assert_int_equal(stat(path, &st), 0);
    assert_int_equal(st.st_mode & 0077, 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_without_a_token),
        cmocka_unit_test(test_wrong_tokens),
        cmocka_unit_test(test_scopes),
        cmocka_unit_test(test_jobs_that_are_refused),
        cmocka_unit_test(test_contract_states_scopes),
        cmocka_unit_test(test_removed_at_once),
        cmocka_unit_test(test_token_command_line),
        cmocka_unit_test(test_command_sends_its_token),
        cmocka_unit_test(test_plain_http_gets_nothing),
        cmocka_unit_test(test_refused_at_start),
        cmocka_unit_test(test_behind_a_proxy),
        cmocka_unit_test(test_folder_is_private),
    };
    return cmocka_run_group_tests(tests, setup, teardown);
}
