#include "support/parted_daemon.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cmocka.h>

#include "support/cluster.h"

int parted_daemon_set_up(void **state)
{
    struct parted_daemon *f = calloc(1, sizeof *f);
    void *desk = NULL;
    assert_non_null(f);
    const int code = parted_set_up(&desk);
    f->desk = desk;
    snprintf(f->shared, sizeof f->shared, "%s/shared", f->desk->folder);
    /* A long limit, so that slow machines (as under ThreadSanitizer) refuse no check or plan. */
    const char *const options[] = {
        "--runner", "slurm",     "--shared", f->shared,         "--least", "0", "--parts",
        "4",        "--threads", "1",        "--check-timeout", "600",     NULL};
    memcpy(f->options, options, sizeof options);
    daemon_start(&f->daemon, f->options);
    setenv("ORIEL_URL", f->daemon.url, 1);
    *state = f;
    return code;
}

int parted_daemon_tear_down(void **state)
{
    struct parted_daemon *f = *state;
    void *desk = f->desk;
    daemon_remove(&f->daemon);
    cli_desk_tear_down(&desk);
    free(f);
    return 0;
}

static void run_oriel(struct parted_daemon *f, const char *const *args)
{
    cli_run(args, &f->desk->result);
    if (f->desk->result.exit_code != 0)
        fail_msg("oriel %s: %s", args[0], f->desk->result.err);
}

void parted_submit(struct parted_daemon *f, const char *document, char ret_path[80])
{
    char path[160], id[40] = "";
    snprintf(path, sizeof path, "%s/%s", f->desk->folder, document);
    const char *const args[] = {"submit", path, NULL};
    run_oriel(f, args);
    assert_int_equal(sscanf(f->desk->result.out, "%36s", id), 1);
    snprintf(ret_path, 80, "/v1/jobs/%s", id);
}

void parted_fetch(struct parted_daemon *f, const char *path, const char *output)
{
    char to[160];
    snprintf(to, sizeof to, "%s/%s", f->desk->folder, output);
    const char *const args[] = {"fetch", path + strlen("/v1/jobs/"), "-o", to, NULL};
    run_oriel(f, args);
}

static void wait_for(struct parted_daemon *f, const char *path, bool resumed)
{
    struct reply reply;
    daemon_wait(&f->daemon, path, 240, &reply);
    if (strcmp(reply_text(&reply, "state"), "succeeded") != 0)
        fail_msg("%s", reply.body);
    assert_string_equal(reply_text(&reply, "runner.name"), "slurm");
    if (!resumed && !(reply_number(&reply, "runner.parts.done") > 1))
        fail_msg("%s",
                 strstr(reply.body, "\"runner\":")); /* the check above ensures that it exists */
    assert_true(reply_number(&reply, "runner.parts.waiting") == 0);
    reply_done(&reply);
}

void parted_wait(struct parted_daemon *f, const char *path)
{
    wait_for(f, path, false);
}

void parted_wait_resumed(struct parted_daemon *f, const char *path)
{
    wait_for(f, path, true);
}

void parted_assert_cleared(const struct parted_daemon *f)
{
    assert_int_equal(rmdir(f->shared), 0);
    assert_int_equal(mkdir(f->shared, 0700), 0);
}

/* Runs the document on a separate daemon, and fetches the result into "local". */
static void run_alone(struct parted_daemon *f, const char *document)
{
    static const char *const alone[] = {"--threads", "1", NULL};
    struct daemon other;
    struct reply reply;
    char path[80];
    daemon_start(&other, alone);
    setenv("ORIEL_URL", other.url, 1);
    parted_submit(f, document, path);
    daemon_wait(&other, path, 240, &reply);
    assert_string_equal(reply_text(&reply, "state"), "succeeded");
    reply_done(&reply);
    parted_fetch(f, path, "local");
    daemon_remove(&other);
    setenv("ORIEL_URL", f->daemon.url, 1);
}

/* Each document runs only once per test program; its result is stored. */
void parted_compare_fetched(struct parted_daemon *f, const char *document)
{
    char kept[160], command[512];
    snprintf(kept, sizeof kept, "%s/kept-%s", cluster_folder(), document);
    if (access(kept, F_OK) == 0) {
        snprintf(command, sizeof command, "cp -r %s %s/local", kept, f->desk->folder);
    } else {
        run_alone(f, document);
        snprintf(command, sizeof command, "cp -r %s/local %s", f->desk->folder, kept);
    }
    cluster_command(command);
    parted_assert_same(f->desk, "local", "slurm");
}

void parted_compare_daemons(struct parted_daemon *f, const char *document, const char *path)
{
    parted_fetch(f, path, "slurm");
    parted_assert_cleared(f);
    parted_compare_fetched(f, document);
}

void parted_restart(struct parted_daemon *f)
{
    daemon_restart(&f->daemon, f->options);
    setenv("ORIEL_URL", f->daemon.url, 1);
}
