/* Stored data is verified and backed up while the daemon runs; a backup is a data folder. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#include "support/daemon.h"
#include "support/patience.h"

/* A daemon with a scene, a BSDF, and a job with results. */
struct fixture {
    struct daemon daemon;
    char scene[65], bsdf[65], job[80], result[100];
    char *bytes; /* bytes of the result */
    size_t size;
};

static const char *const quick_scrub[] = {"--scrub-rate", "1G", NULL};

static char *read_fixture(const char *path, size_t *ret_size)
{
    FILE *file = fopen(path, "r");
    assert_non_null(file);
    char *text = malloc(1 << 20);
    assert_non_null(text);
    *ret_size = fread(text, 1, 1 << 20, file);
    fclose(file);
    return text;
}

static void upload_bsdf(struct fixture *f, long status)
{
    struct reply reply;
    size_t size = 0;
    char *text = read_fixture("tests/fixtures/bsdf_klems41.xml", &size);
    daemon_request(&f->daemon, "POST", "/v1/bsdfs", "application/xml", text, size, NULL, &reply);
    assert_int_equal(reply.status, status);
    snprintf(f->bsdf, sizeof f->bsdf, "%s", reply_text(&reply, "id"));
    reply_done(&reply);
    free(text);
}

static int setup(void **state)
{
    struct fixture *f = calloc(1, sizeof *f);
    struct reply reply;
    assert_non_null(f);
    daemon_start(&f->daemon, NULL);
    daemon_upload_room(&f->daemon, f->scene);
    upload_bsdf(f, 201);
    daemon_submit(&f->daemon, f->scene, 20000, 1, "v", f->job);
    daemon_wait(&f->daemon, f->job, 60, &reply);
    assert_string_equal(reply_text(&reply, "state"), "succeeded");
    reply_done(&reply);
    snprintf(f->result, sizeof f->result, "%.80s/result", f->job);
    daemon_get(&f->daemon, f->result, &reply);
    assert_int_equal(reply.status, 200);
    f->bytes = reply.body;
    f->size = reply.size;
    reply.body = NULL;
    reply_done(&reply);
    *state = f;
    return 0;
}

static int teardown(void **state)
{
    struct fixture *f = *state;
    daemon_remove(&f->daemon);
    free(f->bytes);
    free(f);
    return 0;
}

/* Runs the command; returns its status and its output. */
static int run_orield(const char *arguments, const char *folder, char *ret_said, size_t size)
{
    char command[600];
    const char *build = getenv("ORIEL_BUILD");
    snprintf(command, sizeof command, "timeout 60 %s/orield %s --data %s 2>&1",
             build ? build : "build", arguments, folder);
    FILE *pipe = popen(command, "r");
    assert_non_null(pipe);
    ret_said[fread(ret_said, 1, size - 1, pipe)] = '\0';
    const int status = pclose(pipe);
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

/*
 * One byte of each kind of file is changed: each file is named, and repairable ones are repaired.
 */
static void damage(const struct fixture *f, const char *pattern)
{
    char command[500];
    snprintf(command, sizeof command,
             "for file in %s/%s; do printf '\\377' | "
             "dd of=$file bs=1 seek=$(($(stat -c %%s $file) - 9)) conv=notrunc status=none; done",
             f->daemon.root, pattern);
    assert_int_equal(system(command), 0);
}

static void test_damage_is_found(void **state)
{
    struct fixture *f = *state;
    char said[8000], blob[80], name[64];
    assert_int_equal(run_orield("scrub", f->daemon.root, said, sizeof said), 0);
    assert_non_null(strstr(said, ", 0 damaged"));
    snprintf(blob, sizeof blob, "blobs/%.2s/%s", f->bsdf, f->bsdf);
    damage(f, blob);
    damage(f, "maps/*.opm");
    snprintf(name, sizeof name, "results/%.32s/v.hdr", strrchr(f->job, '/') + 1);
    damage(f, name);
    assert_int_equal(run_orield("scrub", f->daemon.root, said, sizeof said), 1);
    if (!strstr(said, blob) || !strstr(said, name) || !strstr(said, "maps/global-") ||
        strstr(said, ", 0 damaged"))
        fail_msg("%s", said);
    upload_bsdf(f, 200);
    assert_int_equal(run_orield("scrub", f->daemon.root, said, sizeof said), 1);
    assert_null(strstr(said, blob));
    /* A missing file. */
    char path[200];
    snprintf(path, sizeof path, "%s/%s", f->daemon.root, blob);
    assert_int_equal(unlink(path), 0);
    assert_int_equal(run_orield("scrub", f->daemon.root, said, sizeof said), 1);
    assert_non_null(strstr(said, blob));
    upload_bsdf(f, 200);
}

/* The daemon scrubs by itself, logs, and drops damaged maps. */
static void test_daemon_scrubs(void **state)
{
    struct fixture *f = *state;
    struct reply reply;
    char blob[80];
    size_t maps = 1;
    snprintf(blob, sizeof blob, "blobs/%.2s/%s", f->bsdf, f->bsdf);
    assert_int_equal(daemon_end(&f->daemon, SIGTERM), 0);
    damage(f, blob);
    damage(f, "maps/*.opm");
    daemon_restart(&f->daemon, quick_scrub);
    for (double until = patience_until(); maps > 0 && patience_nap(until);) {
        daemon_get(&f->daemon, "/v1/maps", &reply);
        maps = json_array_size(reply_at(&reply, "maps"));
        reply_done(&reply);
    }
    assert_int_equal(maps, 0);
    char command[300];
    snprintf(command, sizeof command, "grep -q 'event=damaged path=%s' %s.log", blob,
             f->daemon.root);
    assert_int_equal(system(command), 0);
}

static void check_restored(struct fixture *f, struct daemon *copy)
{
    struct reply reply;
    char path[100], again[80];
    snprintf(path, sizeof path, "/v1/scenes/%s", f->scene);
    daemon_get(copy, path, &reply);
    assert_int_equal(reply.status, 200);
    reply_done(&reply);
    snprintf(path, sizeof path, "/v1/bsdfs/%s", f->bsdf);
    daemon_get(copy, path, &reply);
    assert_int_equal(reply.status, 200);
    reply_done(&reply);
    daemon_get(copy, f->result, &reply);
    assert_int_equal(reply.status, 200);
    assert_int_equal(reply.size, f->size);
    assert_memory_equal(reply.body, f->bytes, f->size);
    reply_done(&reply);
    daemon_submit(copy, f->scene, 1000, 3, NULL, again);
    daemon_wait(copy, again, 60, &reply);
    assert_string_equal(reply_text(&reply, "state"), "succeeded");
    reply_done(&reply);
}

/* Backup while a job runs and another waits; both continue in the copy. */
static void test_backup(void **state)
{
    struct fixture *f = *state;
    struct daemon copy = {0};
    struct reply reply;
    char said[4000], arguments[120], running[80], waiting[80];
    daemon_submit(&f->daemon, f->scene, 30000000, 5, NULL, running);
    daemon_wait_running(&f->daemon, running, 0);
    daemon_submit(&f->daemon, f->scene, 1000, 6, NULL, waiting);
    snprintf(copy.root, sizeof copy.root, "%.50s-copy", f->daemon.root);
    snprintf(arguments, sizeof arguments, "backup %s", copy.root);
    if (run_orield(arguments, f->daemon.root, said, sizeof said) != 0)
        fail_msg("%s", said);
    assert_int_equal(run_orield(arguments, f->daemon.root, said, sizeof said), 1); /* it exists */
    assert_int_equal(run_orield("scrub", copy.root, said, sizeof said), 0);
    daemon_cancel(&f->daemon, running, &reply);
    reply_done(&reply);
    daemon_restart(&copy, NULL);
    daemon_cancel(&copy, running, &reply);
    assert_true(reply.status == 200 || reply.status == 202);
    reply_done(&reply);
    daemon_wait(&copy, waiting, 60, &reply);
    assert_string_equal(reply_text(&reply, "state"), "succeeded");
    reply_done(&reply);
    check_restored(f, &copy);
    daemon_remove(&copy);
}

/* Damaged files are left out: the command reports them, and the copy has no row that refers to
 * them. */
static void test_backup_of_damage(void **state)
{
    struct fixture *f = *state;
    struct daemon copy = {0};
    struct reply reply;
    char said[4000], arguments[120], blob[80], path[100];
    snprintf(blob, sizeof blob, "blobs/%.2s/%s", f->bsdf, f->bsdf);
    damage(f, blob);
    damage(f, "results/*/v.hdr");
    snprintf(copy.root, sizeof copy.root, "%.50s-copy", f->daemon.root);
    snprintf(arguments, sizeof arguments, "backup %s", copy.root);
    assert_int_equal(run_orield(arguments, f->daemon.root, said, sizeof said), 1);
    assert_non_null(strstr(said, blob));
    assert_non_null(strstr(said, "2 damaged"));
    assert_int_equal(run_orield("scrub", copy.root, said, sizeof said), 0);
    daemon_restart(&copy, NULL);
    snprintf(path, sizeof path, "/v1/bsdfs/%s", f->bsdf);
    daemon_get(&copy, path, &reply);
    assert_int_equal(reply.status, 404);
    reply_done(&reply);
    daemon_get(&copy, f->result, &reply);
    assert_int_equal(reply.status, 410);
    reply_done(&reply);
    daemon_remove(&copy);
}

#define EACH(test) cmocka_unit_test_setup_teardown(test, setup, teardown)
int main(void)
{
    const struct CMUnitTest tests[] = {
        EACH(test_damage_is_found),
        EACH(test_daemon_scrubs),
        EACH(test_backup),
        EACH(test_backup_of_damage),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
