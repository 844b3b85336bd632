/* The daemon as a service: messages to systemd, renewed certificates, jobs that run too long, and
 * removal of ended jobs beyond the limit. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <gnutls/gnutls.h>
#include <poll.h>
#include <pthread.h>
#include <signal.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include "support/certificate.h"
#include "support/daemon.h"
#include "support/patience.h"

/* ---- Messages to systemd -------------------------------------------------------------------- */

static void expect_said(int fd, const char *text)
{
    struct pollfd wait = {.fd = fd, .events = POLLIN};
    char said[64] = "";
    while (strcmp(said, text) != 0) {
        if (poll(&wait, 1, 120000) != 1)
            fail_msg("%s has not been said", text);
        const ssize_t n = recv(fd, said, sizeof said - 1, 0);
        assert_true(n > 0);
        said[n] = '\0';
    }
}

static void test_notify(void **state)
{
    struct daemon daemon;
    struct sockaddr_un address = {.sun_family = AF_UNIX};
    (void)state;
    snprintf(address.sun_path, sizeof address.sun_path, "/tmp/oriel-test-notify-%d", (int)getpid());
    const int fd = socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0);
    assert_true(fd >= 0);
    assert_int_equal(bind(fd, (const struct sockaddr *)&address, sizeof address), 0);
    setenv("NOTIFY_SOCKET", address.sun_path, 1);
    setenv("WATCHDOG_USEC", "3000000", 1);
    daemon_start(&daemon, NULL);
    unsetenv("NOTIFY_SOCKET");
    unsetenv("WATCHDOG_USEC");
    expect_said(fd, "READY=1");
    expect_said(fd, "WATCHDOG=1");
    daemon_remove(&daemon);
    expect_said(fd, "STOPPING=1");
    close(fd);
    unlink(address.sun_path);
}

/* ---- Certificates --------------------------------------------------------------------------- */

/* Returns the sum of the bytes of the certificate that the daemon shows to a new connection. */
static unsigned long shown_certificate(const struct daemon *daemon)
{
    gnutls_session_t session = NULL;
    gnutls_certificate_credentials_t credentials = NULL;
    unsigned count = 0;
    unsigned long sum = 0;
    const int fd = daemon_dial(daemon);
    assert_int_equal(gnutls_certificate_allocate_credentials(&credentials), 0);
    assert_int_equal(gnutls_init(&session, GNUTLS_CLIENT), 0);
    gnutls_set_default_priority(session);
    gnutls_credentials_set(session, GNUTLS_CRD_CERTIFICATE, credentials);
    gnutls_transport_set_int(session, fd);
    gnutls_handshake_set_timeout(session, 120000);
    int rc;
    do
        rc = gnutls_handshake(session);
    while (rc < 0 && !gnutls_error_is_fatal(rc));
    assert_int_equal(rc, 0);
    const gnutls_datum_t *chain = gnutls_certificate_get_peers(session, &count);
    assert_true(chain && count == 1);
    for (unsigned i = 0; i < chain->size; i++)
        sum = sum * 31 + chain->data[i];
    gnutls_deinit(session);
    gnutls_certificate_free_credentials(credentials);
    close(fd);
    return sum;
}

static bool is_logged(const struct daemon *daemon, const char *text)
{
    char command[200];
    snprintf(command, sizeof command, "grep -q '%s' %s.log", text, daemon->root);
    return system(command) == 0;
}

static void reload(const struct daemon *daemon, const char *text)
{
    assert_int_equal(kill(daemon->pid, SIGHUP), 0);
    for (double until = patience_until(); !is_logged(daemon, text) && patience_nap(until);)
        continue;
    assert_true(is_logged(daemon, text));
}

/* A reload affects only new connections; an invalid certificate, or one of another key, changes
 * nothing. */
static void test_reload(void **state)
{
    struct daemon daemon;
    struct reply reply;
    char cert[80], key[80], other_cert[80], other_key[80];
    (void)state;
    daemon_start(&daemon, NULL);
    assert_int_equal(daemon_end(&daemon, SIGTERM), 0);
    snprintf(cert, sizeof cert, "%s/cert.pem", daemon.root);
    snprintf(key, sizeof key, "%s/key.pem", daemon.root);
    snprintf(other_cert, sizeof other_cert, "%s/other-cert.pem", daemon.root);
    snprintf(other_key, sizeof other_key, "%s/other-key.pem", daemon.root);
    certificate_make(cert, key);
    certificate_make(other_cert, other_key);
    const char *const extra[] = {"--tls-cert", cert, "--tls-key", key, NULL};
    daemon_restart(&daemon, extra);
    snprintf(daemon.ca, sizeof daemon.ca, "%s", cert);
    const unsigned long first = shown_certificate(&daemon);
    daemon_get(&daemon, "/healthz", &reply); /* over a connection that stays open */
    assert_int_equal(reply.status, 200);
    reply_done(&reply);
    assert_int_equal(rename(other_cert, cert), 0);
    reload(&daemon, "reload-failed"); /* the key is still the old one */
    assert_true(shown_certificate(&daemon) == first);
    assert_int_equal(rename(other_key, key), 0);
    reload(&daemon, "event=reloaded");
    assert_true(shown_certificate(&daemon) != first);
    daemon_get(&daemon, "/healthz", &reply);
    assert_int_equal(reply.status, 200);
    reply_done(&reply);
    daemon_remove(&daemon);
}

/* ---- Jobs ----------------------------------------------------------------------------------- */

/* The job fails with the reason; so does one that follows it, and the next job runs. */
static void test_job_timeout(void **state)
{
    static const char endless[] = "{\"scene\":\"%s\",\"technique\":\"backward\","
                                  "\"gather_samples\":1000000,\"sensors\":[%s[2,1,0.8,0,0,1]]}";
    static char sensors[6000], text[7000];
    const char *const extra[] = {"--job-timeout", "1", NULL};
    struct daemon daemon;
    struct reply reply;
    char scene[65], paths[2][80], quick[80];
    (void)state;
    for (int i = 0; i < 300; i++)
        strcat(sensors, "[2,1,0.8,0,0,1],");
    daemon_start(&daemon, extra);
    daemon_upload_room(&daemon, scene);
    snprintf(text, sizeof text, endless, scene, sensors);
    for (int i = 0; i < 2; i++) {
        daemon_post_json(&daemon, "/v1/jobs", text, &reply);
        assert_int_equal(reply.status, 202);
        snprintf(paths[i], sizeof paths[i], "%s", reply_text(&reply, "links.self"));
        reply_done(&reply);
    }
    daemon_submit(&daemon, scene, 1000, 1, NULL, quick);
    for (int i = 0; i < 2; i++) {
        daemon_wait(&daemon, paths[i], 30, &reply);
        assert_string_equal(reply_text(&reply, "state"), "failed");
        assert_string_equal(reply_text(&reply, "error.type"), "urn:oriel:error:limit");
        assert_non_null(strstr(reply_text(&reply, "error.detail"), "1 s"));
        reply_done(&reply);
    }
    daemon_wait(&daemon, quick, 30, &reply);
    assert_string_equal(reply_text(&reply, "state"), "succeeded");
    reply_done(&reply);
    daemon_remove(&daemon);
}

static size_t count_jobs(struct daemon *daemon)
{
    struct reply reply;
    daemon_get(daemon, "/v1/jobs", &reply);
    const size_t count = json_array_size(reply_at(&reply, "jobs"));
    reply_done(&reply);
    return count;
}

/* The oldest ended jobs are removed with their results, except those not fetched yet. */
static void test_retention(void **state)
{
    enum { JOBS = 5, KEPT = 2 };
    const char *const extra[] = {"--keep-jobs", "2", NULL};
    struct daemon daemon;
    struct reply reply;
    char scene[65], paths[JOBS][80], result[100];
    (void)state;
    daemon_start(&daemon, extra);
    daemon_upload_room(&daemon, scene);
    for (int i = 0; i < JOBS; i++) {
        daemon_submit(&daemon, scene, 1000, i, NULL, paths[i]);
        daemon_wait(&daemon, paths[i], 30, &reply);
        reply_done(&reply);
        if (i == 1)
            continue; /* this one has not been fetched */
        snprintf(result, sizeof result, "%.80s/result", paths[i]);
        daemon_get(&daemon, result, &reply);
        assert_int_equal(reply.status, 200);
        reply_done(&reply);
    }
    for (double until = patience_until(); count_jobs(&daemon) > KEPT && patience_nap(until);)
        continue;
    assert_int_equal(count_jobs(&daemon), KEPT);
    daemon_get(&daemon, paths[1], &reply);
    assert_int_equal(reply.status, 200);
    reply_done(&reply);
    daemon_get(&daemon, paths[0], &reply);
    assert_int_equal(reply.status, 404);
    reply_done(&reply);
    daemon_get(&daemon, paths[JOBS - 1], &reply);
    assert_int_equal(reply.status, 200);
    reply_done(&reply);
    assert_int_equal(daemon_end(&daemon, SIGTERM), 0);
    daemon_restart(&daemon, NULL);
    assert_int_equal(count_jobs(&daemon), KEPT);
    daemon_remove(&daemon);
}

static atomic_bool storm_over;

struct storm {
    pid_t pid;
    int signum;
    pthread_t thread;
};

static void *send_signals(void *ctx)
{
    const struct storm *storm = ctx;
    while (!atomic_load(&storm_over))
        kill(storm->pid, storm->signum);
    return NULL;
}

static void start_storm(struct storm *storm, const struct daemon *daemon, int signum)
{
    storm->pid = daemon->pid;
    storm->signum = signum;
    atomic_store(&storm_over, false);
    assert_int_equal(pthread_create(&storm->thread, NULL, send_signals, storm), 0);
}

static void end_storm(struct storm *storm)
{
    atomic_store(&storm_over, true);
    pthread_join(storm->thread, NULL);
}

/* The daemon starts beside the signals, answers, and ends in order by SIGTERM. */
static void test_hangups_at_every_moment(void **state)
{
    struct daemon daemon;
    struct reply reply;
    struct storm storm;
    (void)state;
    daemon_start(&daemon, NULL);
    for (int i = 0; i < 5; i++) {
        start_storm(&storm, &daemon, SIGHUP);
        daemon_get(&daemon, "/healthz", &reply);
        const long status = reply.status;
        reply_done(&reply);
        const int ended = daemon_end(&daemon, SIGTERM);
        end_storm(&storm);
        assert_int_equal(status, 200);
        assert_int_equal(ended, 0);
        daemon_restart(&daemon, NULL);
    }
    daemon_remove(&daemon);
}

/* Signals that arrive until the process has ended do not prevent it from closing its files. */
static void test_stops_at_every_moment(void **state)
{
    static const int signals[] = {SIGTERM, SIGINT, SIGTERM};
    static const char *const kept[] = {"oriel.db-wal", "oriel.db-shm"};
    struct daemon daemon;
    struct storm storm;
    (void)state;
    daemon_start(&daemon, NULL);
    for (size_t i = 0; i < sizeof signals / sizeof *signals; i++) {
        start_storm(&storm, &daemon, signals[i]);
        const int ended = daemon_wait_end(&daemon);
        end_storm(&storm);
        assert_int_equal(ended, 0);
        for (size_t k = 0; k < sizeof kept / sizeof *kept; k++) {
            char path[96];
            snprintf(path, sizeof path, "%.64s/%s", daemon.root, kept[k]);
            assert_int_equal(access(path, F_OK), -1);
        }
        daemon_restart(&daemon, NULL);
    }
    daemon_remove(&daemon);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_notify),
        cmocka_unit_test(test_reload),
        cmocka_unit_test(test_hangups_at_every_moment),
        cmocka_unit_test(test_stops_at_every_moment),
        cmocka_unit_test(test_job_timeout),
        cmocka_unit_test(test_retention),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
