/* Uploads are parsed in child processes: faults end the child, and the daemon continues. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <curl/curl.h>
#include <dirent.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include "checks/child/child_checks.h"
#include "process/limits.h"
#include "support/daemon.h"
#include "support/daemon_metric.h"
#include "support/patience.h"

/* ---- Processes ------------------------------------------------------------------------------- */

/* Returns 0 for a stopped process. */
static pid_t parent_of(pid_t pid)
{
    char path[64], text[512] = "";
    snprintf(path, sizeof path, "/proc/%d/stat", (int)pid);
    FILE *stat = fopen(path, "r");
    if (!stat)
        return 0;
    const size_t n = fread(text, 1, sizeof text - 1, stat);
    fclose(stat);
    const char *behind = n > 0 ? strrchr(text, ')') : NULL;
    /* ") S 123": its state, and its parent. */
    return behind && strlen(behind) > 4 && behind[2] != 'T' ? (pid_t)strtol(behind + 4, NULL, 10)
                                                            : 0;
}

/* Returns a checking process, a child of the fork server, which is the daemon's child. 0: none
 * exists, apart from stopped ones. */
static pid_t find_check(const struct daemon *daemon)
{
    DIR *processes = opendir("/proc");
    pid_t found = 0;
    assert_non_null(processes);
    for (const struct dirent *entry; !found && (entry = readdir(processes));) {
        const pid_t pid = (pid_t)strtol(entry->d_name, NULL, 10);
        const pid_t parent = pid > 0 ? parent_of(pid) : 0;
        if (parent > 1 && parent_of(parent) == daemon->pid)
            found = pid;
    }
    closedir(processes);
    return found;
}

/* Waits until a check exists, or until none does. */
static pid_t await_check(const struct daemon *daemon, bool there)
{
    pid_t found = find_check(daemon);
    for (double until = patience_until(); (found != 0) != there && patience_nap(until);)
        found = find_check(daemon);
    assert_int_equal(found != 0, there);
    return found;
}

static void expect_gone(pid_t pid)
{
    for (double until = patience_until(); kill(pid, 0) == 0 && patience_nap(until);)
        continue;
    assert_int_equal(kill(pid, 0), -1);
}

/* Waits for a check, and stops its process. */
static pid_t hold_check(const struct daemon *daemon)
{
    const pid_t found = await_check(daemon, true);
    kill(found, SIGSTOP);
    for (double until = patience_until(); find_check(daemon) == found && patience_nap(until);)
        continue;
    return found;
}

/* ---- Uploads --------------------------------------------------------------------------------- */

/* Bomb: that many spheres, 40 copies of each line. */
struct bomb {
    char scene[300], part[40 * 40];
    struct upload_file files[2];
};

static void make_bomb(struct bomb *bomb, int lines, int copies)
{
    int used = snprintf(bomb->scene, sizeof bomb->scene, "void plastic grey 0 0 5 .5 .5 .5 0 0\n");
    for (int i = 0; i < lines; i++)
        used += snprintf(bomb->scene + used, sizeof bomb->scene - (size_t)used,
                         "!xform -a %d -t %d 0 1 part.rad\n", copies, i);
    used = 0;
    for (int i = 0; i < 40; i++)
        used += snprintf(bomb->part + used, sizeof bomb->part - (size_t)used,
                         "grey sphere s%d 0 0 4 %d 0 0 .1\n", i, i);
    bomb->files[0] = (struct upload_file){"scene.rad", bomb->scene, strlen(bomb->scene), false};
    bomb->files[1] = (struct upload_file){"part.rad", bomb->part, strlen(bomb->part), true};
}

static pid_t upload_beside(const struct daemon *daemon, const struct bomb *bomb, long status)
{
    const pid_t pid = fork();
    assert_true(pid >= 0);
    if (pid > 0)
        return pid;
    struct daemon own = *daemon;
    struct reply reply;
    own.curl = curl_easy_init(); /* a separate connection */
    daemon_upload(&own, bomb->files, 2, NULL, &reply);
    const bool said = status != 422 || strstr(reply_text(&reply, "detail"), "crashed");
    _exit(reply.status == status && said ? 0 : 1);
}

static void expect_uploaded(pid_t client)
{
    int status;
    assert_int_equal(waitpid(client, &status, 0), client);
    assert_true(WIFEXITED(status) && WEXITSTATUS(status) == 0);
}

/* 400 000 surfaces are checked, and the daemon itself has grown little. */
static void test_memory_is_a_childs(void **state)
{
    struct daemon *daemon = *state;
    struct bomb bomb;
    struct reply reply;
    const double before_mb = daemon_memory_mb(daemon, "VmRSS");
    make_bomb(&bomb, 1, 10000);
    daemon_upload(daemon, bomb.files, 2, NULL, &reply);
    assert_int_equal(reply.status, 201);
    reply_done(&reply);
    const double peak_mb = daemon_memory_mb(daemon, "VmHWM") - before_mb;
    print_message("# a peak of %.0f MB\n", peak_mb);
    assert_true(peak_mb < (ORL_SANITIZED ? 150 : 50));
}

/* The error states the memory limit; the next upload works as before. */
static void test_memory_is_bounded(void **state)
{
    static const char *const little[] = {"--check-memory", "96M", NULL};
    struct daemon daemon;
    struct bomb bomb;
    struct reply reply;
    char id[65];
    (void)state;
    if (ORL_SANITIZED)
        skip();
    daemon_start(&daemon, little);
    make_bomb(&bomb, 1, 50000);
    daemon_upload(&daemon, bomb.files, 2, NULL, &reply);
    assert_int_equal(reply.status, 413);
    assert_non_null(strstr(reply_text(&reply, "detail"), "more than 96 MiB of memory"));
    assert_non_null(strstr(reply_text(&reply, "hint"), "--check-memory"));
    reply_done(&reply);
    daemon_upload_room(&daemon, id);
    daemon_remove(&daemon);
}

/* A fault in our code ends only the child; nothing of the upload is stored. */
static void test_a_child_dies(void **state)
{
    struct daemon *daemon = *state;
    struct bomb bomb;
    char id[65];
    make_bomb(&bomb, 2, 50000);
    const pid_t client = upload_beside(daemon, &bomb, 422);
    kill(await_check(daemon, true), SIGSEGV);
    expect_uploaded(client);
    daemon_expect_no_files(daemon, "tmp");
    daemon_expect_no_files(daemon, "blobs");
    daemon_upload_room(daemon, id);
}

/* A check ends when its client hangs up. */
static void test_hanging_up_ends_the_check(void **state)
{
    struct daemon *daemon = *state;
    struct bomb bomb;
    char text[8192], head[256];
    make_bomb(&bomb, 2, 50000);
    const int size = snprintf(text, sizeof text,
                              "--bb\r\nContent-Disposition: form-data; name=\"f\"; "
                              "filename=\"scene.rad\"\r\n\r\n%s\r\n--bb\r\nContent-Disposition: "
                              "form-data; name=\"resource\"; filename=\"part.rad\"\r\n\r\n%s\r\n"
                              "--bb--\r\n",
                              bomb.scene, bomb.part);
    const int n = snprintf(head, sizeof head,
                           "POST /v1/scenes HTTP/1.1\r\nHost: localhost\r\nContent-Type: "
                           "multipart/form-data; boundary=bb\r\nContent-Length: %d\r\n\r\n",
                           size);
    const int fd = daemon_dial(daemon);
    assert_int_equal(send(fd, head, (size_t)n, 0), n);
    assert_int_equal(send(fd, text, (size_t)size, 0), size);
    await_check(daemon, true);
    close(fd);
    await_check(daemon, false);
    daemon_expect_no_files(daemon, "tmp");
}

/* Stopping the daemon does not wait for checks. */
static void test_children_end_with_the_daemon(void **state)
{
    struct daemon daemon;
    struct bomb bomb;
    (void)state;
    daemon_start(&daemon, NULL);
    make_bomb(&bomb, 2, 50000);
    const pid_t client = upload_beside(&daemon, &bomb, 422);
    const pid_t check = await_check(&daemon, true);
    kill(client, SIGSTOP);
    daemon_end(&daemon, SIGKILL);
    expect_gone(check);
    kill(client, SIGKILL);
    waitpid(client, NULL, 0);
    daemon_restart(&daemon, NULL);
    daemon_remove(&daemon);
}

/* ---- Scheduling ------------------------------------------------------------------------------ */

/* Expects that a room is accepted before any check of the others ends or is given up: all those
 * clients still wait for their answers. */
static void expect_room_is_taken(struct daemon *daemon, const pid_t *clients, int count)
{
    const struct upload_file room = {"room.rad", room_scene, strlen(room_scene), false};
    struct reply reply;
    daemon_upload(daemon, &room, 1, NULL, &reply);
    assert_int_equal(reply.status, 201);
    for (int i = 0; i < count; i++)
        assert_int_equal(waitpid(clients[i], NULL, WNOHANG), 0);
    print_message("# taken after %.2f s\n", reply.seconds);
    reply_done(&reply);
}

/* One of the checks that occupy every process yields, and is repeated later. */
static void test_long_checks_yield(void **state)
{
    static const char *const patient[] = {"--check-timeout", "600", NULL};
    enum { BOMBS = 3 };
    struct daemon daemon;
    struct bomb bombs[BOMBS];
    pid_t clients[BOMBS], checks[BOMBS];
    (void)state;
    daemon_start(&daemon, patient);
    for (int i = 0; i < BOMBS; i++) {
        make_bomb(&bombs[i], 1, (ORL_SANITIZED ? 4000 : 10000) + i);
        clients[i] = upload_beside(&daemon, &bombs[i], 201);
        checks[i] = hold_check(&daemon);
    }
    expect_room_is_taken(&daemon, clients, BOMBS);
    expect_gone(checks[BOMBS - 1]); /* the last one started */
    for (int i = 0; i < BOMBS - 1; i++)
        kill(checks[i], SIGCONT);
    for (int i = 0; i < BOMBS; i++)
        expect_uploaded(clients[i]);
    daemon_remove(&daemon);
}

/* A check with the largest possible memory leaves some for others. */
static void test_large_checks_leave_room(void **state)
{
    static const char *const little[] = {"--memory", "600M", "--check-timeout", "600", NULL};
    const double first = 256 << 20;
    struct daemon daemon;
    struct bomb bomb;
    (void)state;
    if (ORL_SANITIZED)
        skip();
    daemon_start(&daemon, little);
    make_bomb(&bomb, 2, 50000);
    const pid_t client = upload_beside(&daemon, &bomb, 413);
    daemon_metric_wait(&daemon, "oriel_memory_checks_bytes", first + 1);
    const pid_t check = hold_check(&daemon);
    expect_room_is_taken(&daemon, &client, 1);
    kill(check, SIGCONT);
    expect_uploaded(client);
    daemon_remove(&daemon);
}

/* ---- Confinement ----------------------------------------------------------------------------- */

static int try_everything(void)
{
    const struct orl_sandbox_limits bounds = {64 << 20, 10};
    char *const arguments[] = {(char[]){"/bin/true"}, NULL};
    int failed = 0;
    if (orl_sandbox_enter(&bounds, NULL))
        return 100;
    failed += socket(AF_INET, SOCK_STREAM, 0) < 0;
    failed += fopen("/etc/passwd", "r") == NULL;
    failed += fork() < 0;
    failed += kill(getppid(), 0) != 0;
    failed += execv("/bin/true", arguments) != 0;
    void *much = malloc(256 << 20), *little = malloc(1 << 20);
    failed += much == NULL;
    failed += little != NULL;
    free(much);
    free(little);
    return failed;
}

static void test_confinement(void **state)
{
    int status;
    (void)state;
    if (ORL_SANITIZED)
        skip();
    const pid_t pid = fork();
    if (pid == 0)
        _exit(try_everything());
    assert_int_equal(waitpid(pid, &status, 0), pid);
    assert_true(WIFEXITED(status));
    assert_int_equal(WEXITSTATUS(status), 7);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_confinement),
        cmocka_unit_test_setup_teardown(test_memory_is_a_childs, daemon_set_up, daemon_tear_down),
        cmocka_unit_test(test_memory_is_bounded),
        cmocka_unit_test_setup_teardown(test_a_child_dies, daemon_set_up, daemon_tear_down),
        cmocka_unit_test_setup_teardown(test_hanging_up_ends_the_check, daemon_set_up,
                                        daemon_tear_down),
        cmocka_unit_test(test_children_end_with_the_daemon),
        cmocka_unit_test(test_long_checks_yield),
        cmocka_unit_test(test_large_checks_leave_room),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
