/* Memory: jobs and checks stay within the available memory; a job that does not fit now waits, one
 * that can never fit is refused with the reason. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#include "health/machine_memory.h"
#include "process/limits.h"
#include "store/files/folders.h"
#include "support/daemon.h"

/* ---- Available memory ------------------------------------------------------------------------ */

static void write_limit(const char *root, const char *path, const char *text)
{
    char full[256];
    snprintf(full, sizeof full, "%s/%s", root, path);
    for (char *at = full + strlen(root) + 1; (at = strchr(at, '/')); *at++ = '/') {
        *at = '\0';
        mkdir(full, 0700);
    }
    FILE *file = fopen(full, "w");
    assert_non_null(file);
    fputs(text, file);
    fclose(file);
}

/*
 * The limit is the least of the group's and those above it, for both versions of cgroups, or none.
 */
static void test_groups(void **state)
{
    char root[] = "/tmp/oriel-test-XXXXXX";
    (void)state;
    assert_non_null(mkdtemp(root));
    write_limit(root, "a/memory.max", "3000\n");
    write_limit(root, "a/b/memory.max", "max\n");
    write_limit(root, "a/b/c/memory.max", "5000\n");
    write_limit(root, "memory/memory.limit_in_bytes", "9223372036854771712\n");
    write_limit(root, "memory/old/memory.limit_in_bytes", "2000\n");
    assert_int_equal(orl_memory_cgroup_limit("0::/a/b/c\n", root), 3000);
    assert_int_equal(orl_memory_cgroup_limit("0::/a/b\n", root), 3000);
    assert_int_equal(orl_memory_cgroup_limit("0::/elsewhere\n", root), UINT64_MAX);
    assert_int_equal(orl_memory_cgroup_limit("7:cpu,memory:/old\n0::/a\n", root), 2000);
    assert_int_equal(orl_memory_cgroup_limit("7:memory:/\n5:cpu:/a\n", root), UINT64_MAX);
    assert_int_equal(orl_memory_cgroup_limit("", root), UINT64_MAX);
    write_limit(root, "memory.max", "1000\n"); /* as seen from inside a container */
    assert_int_equal(orl_memory_cgroup_limit("0::/\n", root), 1000);
    orl_remove_tree(root, NULL);
}

/* ---- Jobs ------------------------------------------------------------------------------------ */

static void restart_with(struct daemon_room *f, const char *const *extra)
{
    daemon_end(&f->daemon, SIGTERM);
    daemon_restart(&f->daemon, extra);
}

static void post_photons(struct daemon_room *f, long photons, int seed, struct reply *ret_reply)
{
    char text[256];
    snprintf(text, sizeof text,
             "{\"scene\":\"%s\",\"seed\":%d,\"technique\":\"gather\",\"sensors\":[[2,1,0.8,0,0,1]],"
             "\"photons\":{\"global\":%ld,\"caustic\":1}}",
             f->scene, seed, photons);
    daemon_post_json(&f->daemon, "/v1/jobs", text, ret_reply);
}

static void test_never(void **state)
{
    static const char *const little[] = {"--memory", "1G", NULL};
    struct daemon_room *f = *state;
    struct reply reply;
    if (ORL_SANITIZED)
        skip();
    restart_with(f, little);
    post_photons(f, 50000000, 1, &reply);
    assert_int_equal(reply.status, 413);
    assert_non_null(strstr(reply_text(&reply, "detail"), "2861 MiB of them for 50000001 photons"));
    assert_non_null(strstr(reply_text(&reply, "hint"), "--memory"));
    reply_done(&reply);
    daemon_get(&f->daemon, "/v1/limits", &reply);
    assert_true(reply_number(&reply, "memory_bytes") == (double)(1 << 30));
    reply_done(&reply);
}

/* A second job has a free slot, but not the memory; it runs when the first has ended. */
static void test_not_now(void **state)
{
    static const char *const two[] = {"--memory", "1G", "--jobs", "2", "--threads", "2", NULL};
    struct daemon_room *f = *state;
    char first[80], second[80], third[80];
    struct reply reply;
    if (ORL_SANITIZED)
        skip();
    restart_with(f, two);
    post_photons(f, 10000000, 1, &reply);
    assert_int_equal(reply.status, 202);
    snprintf(first, sizeof first, "%s", reply_text(&reply, "links.self"));
    reply_done(&reply);
    post_photons(f, 10000000, 2, &reply);
    snprintf(second, sizeof second, "%s", reply_text(&reply, "links.self"));
    reply_done(&reply);
    post_photons(f, 1000, 3, &reply); /* it does not overtake earlier jobs */
    snprintf(third, sizeof third, "%s", reply_text(&reply, "links.self"));
    reply_done(&reply);
    daemon_wait_running(&f->daemon, first, 0);
    daemon_get(&f->daemon, second, &reply);
    assert_string_equal(reply_text(&reply, "state"), "queued");
    reply_done(&reply);
    daemon_get(&f->daemon, third, &reply);
    assert_string_equal(reply_text(&reply, "state"), "queued");
    reply_done(&reply);
    daemon_cancel(&f->daemon, first, &reply);
    reply_done(&reply);
    daemon_wait_running(&f->daemon, second, 0);
    daemon_cancel(&f->daemon, second, &reply);
    reply_done(&reply);
    daemon_wait(&f->daemon, third, 60, &reply);
    assert_string_equal(reply_text(&reply, "state"), "succeeded");
    reply_done(&reply);
}

/* Cancelling a job that waits for memory releases the jobs behind it; the end of another job does
 * not. */
static void test_cancelled_while_it_waits(void **state)
{
    static const char endless[] = "{\"scene\":\"%s\",\"technique\":\"gather\",\"gather_samples\":"
                                  "16000000,\"sensors\":[[2,1,0.8,0,0,1]],\"photons\":{\"global\":"
                                  "10000000,\"caustic\":1}}";
    static const char *const two[] = {"--memory", "1G", "--jobs", "2", "--threads", "2", NULL};
    struct daemon_room *f = *state;
    char text[300], paths[3][80];
    struct reply reply;
    if (ORL_SANITIZED)
        skip();
    restart_with(f, two);
    snprintf(text, sizeof text, endless, f->scene);
    for (int i = 0; i < 3; i++) {
        if (i == 0)
            daemon_post_json(&f->daemon, "/v1/jobs", text, &reply);
        else
            post_photons(f, i == 1 ? 10000000 : 1000, 4 + i, &reply);
        assert_int_equal(reply.status, 202);
        snprintf(paths[i], sizeof paths[i], "%s", reply_text(&reply, "links.self"));
        reply_done(&reply);
    }
    daemon_wait_running(&f->daemon, paths[0], 0);
    daemon_cancel(&f->daemon, paths[1], &reply);
    reply_done(&reply);
    daemon_wait(&f->daemon, paths[2], 60, &reply);
    assert_string_equal(reply_text(&reply, "state"), "succeeded");
    reply_done(&reply);
    daemon_get(&f->daemon, paths[0], &reply);
    assert_string_equal(reply_text(&reply, "state"), "running");
    reply_done(&reply);
    daemon_cancel(&f->daemon, paths[0], &reply);
    reply_done(&reply);
}

/* Memory of a job is released when it has ended: its document, sensors and results. */
static void test_jobs_give_back(void **state)
{
    if (ORL_SANITIZED)
        skip();
    enum { SENSORS = 30000 };
    struct daemon_room *f = *state;
    char *text = malloc(SENSORS * 40 + 300), path[80];
    const double before_mb = daemon_memory_mb(&f->daemon, "VmRSS");
    struct reply reply;
    assert_non_null(text);
    size_t used = (size_t)sprintf(text,
                                  "{\"scene\":\"%s\",\"technique\":\"direct\",\"photons\":{"
                                  "\"global\":1000,\"caustic\":1},\"gather_samples\":1,"
                                  "\"sensors\":[",
                                  f->scene);
    for (int i = 0; i < SENSORS; i++)
        used += (size_t)sprintf(text + used, "%s[%.3f,%.3f,0.8,0,0,1]", i ? "," : "",
                                0.1 + 0.01 * (i % 300), 0.1 + 0.01 * (i / 300));
    strcpy(text + used, "]}");
    daemon_post_json(&f->daemon, "/v1/jobs", text, &reply);
    assert_int_equal(reply.status, 202);
    snprintf(path, sizeof path, "%s", reply_text(&reply, "links.self"));
    reply_done(&reply);
    free(text);
    daemon_wait(&f->daemon, path, 120, &reply);
    assert_string_equal(reply_text(&reply, "state"), "succeeded");
    reply_done(&reply);
    const double kept_mb = daemon_memory_mb(&f->daemon, "VmRSS") - before_mb;
    print_message("# a peak of %.0f MB, %.0f MB stay\n",
                  daemon_memory_mb(&f->daemon, "VmHWM") - before_mb, kept_mb);
    assert_true(kept_mb < 12.5);
}

/* ---- Checks ---------------------------------------------------------------------------------- */

/* A document of 5 MB takes 0.4 GB to parse: more than a check's first allowance, which is raised if
 * there is enough memory. */
static void test_larger_checks(void **state)
{
    if (ORL_SANITIZED)
        skip();
    enum { OBJECTS = 1600000 };
    static const char *const little[] = {"--memory", "300M", NULL};
    static const long statuses[2] = {422, 413};
    struct daemon_room *f = *state;
    struct reply reply;
    char *text = malloc(3 * OBJECTS + 2);
    assert_non_null(text);
    for (size_t i = 0; i < OBJECTS; i++)
        memcpy(text + 3 * i, i == 0 ? "[{}" : ",{}", 3);
    text[3 * OBJECTS] = ']';
    for (int i = 0; i < 2; i++) {
        daemon_request(&f->daemon, "POST", "/v1/jobs", "application/json", text, 3 * OBJECTS + 1,
                       NULL, &reply);
        assert_int_equal(reply.status, statuses[i]);
        assert_int_equal(strstr(reply_text(&reply, "detail"), "MiB of memory") != NULL, i);
        reply_done(&reply);
        restart_with(f, little);
    }
    free(text);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_groups),
        cmocka_unit_test_setup_teardown(test_never, daemon_room_set_up, daemon_room_tear_down),
        cmocka_unit_test_setup_teardown(test_not_now, daemon_room_set_up, daemon_room_tear_down),
        cmocka_unit_test_setup_teardown(test_cancelled_while_it_waits, daemon_room_set_up,
                                        daemon_room_tear_down),
        cmocka_unit_test_setup_teardown(test_jobs_give_back, daemon_room_set_up,
                                        daemon_room_tear_down),
        cmocka_unit_test_setup_teardown(test_larger_checks, daemon_room_set_up,
                                        daemon_room_tear_down),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
