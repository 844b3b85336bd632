#include "support/storage.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>

#include <cmocka.h>
#include <sqlite3.h>
#include <stdio.h>
#include <string.h>

#include "support/daemon_metric.h"

void storage_expect(struct daemon *daemon, const char *method, const char *path, long status,
                    const char *type)
{
    struct reply reply;
    char urn[64];
    daemon_request(daemon, method, path, NULL, NULL, 0, NULL, &reply);
    if (reply.status != status)
        fail_msg("%s %s: %ld in place of %ld: %s", method, path, reply.status, status, reply.body);
    if (type) {
        snprintf(urn, sizeof urn, "urn:oriel:error:%s", type);
        assert_string_equal(reply_text(&reply, "type"), urn);
    }
    reply_done(&reply);
}

void storage_run_job(struct daemon *daemon, const char *scene, int seed, const char *view,
                     char ret_path[80])
{
    struct reply reply;
    daemon_submit(daemon, scene, STORAGE_PHOTONS, seed, view, ret_path);
    daemon_wait(daemon, ret_path, 60, &reply);
    assert_string_equal(reply_text(&reply, "state"), "succeeded");
    reply_done(&reply);
}

void storage_fetch(struct daemon *daemon, const char *job, long status)
{
    char path[300];
    snprintf(path, sizeof path, "%s/result", job);
    storage_expect(daemon, "GET", path, status, status == 410 ? "results-evicted" : NULL);
}

double storage_bytes_of(struct daemon *daemon, const char *kind)
{
    char name[64];
    snprintf(name, sizeof name, "oriel_storage_bytes{kind=\"%s\"}", kind);
    return daemon_metric(daemon, name);
}

double storage_bytes(struct daemon *daemon)
{
    return storage_bytes_of(daemon, "maps") + storage_bytes_of(daemon, "bsdfs") +
           storage_bytes_of(daemon, "results") + storage_bytes_of(daemon, "uploads");
}

size_t storage_count_maps(struct daemon *daemon)
{
    struct reply reply;
    daemon_get(daemon, "/v1/maps", &reply);
    const size_t count = json_array_size(reply_at(&reply, "maps"));
    reply_done(&reply);
    return count;
}

void storage_run_sql(const struct daemon *daemon, const char *sql)
{
    char path[96];
    sqlite3 *db = NULL;
    snprintf(path, sizeof path, "%s/oriel.db", daemon->root);
    assert_int_equal(sqlite3_open(path, &db), SQLITE_OK);
    sqlite3_busy_timeout(db, 5000);
    assert_int_equal(sqlite3_exec(db, sql, NULL, NULL, NULL), SQLITE_OK);
    sqlite3_close(db);
}
