/* Migrations: a fresh database, repeated, stepwise, interrupted, edited, and from a later version.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "process/embedded_files.h"
#include "store/database/db.h"
#include "store/rows/stored_jobs.h"
#include "store/rows/stored_maps.h"

static const struct orl_migration two[] = {
    {"0001_first.sql", "CREATE TABLE a (x INTEGER) STRICT; INSERT INTO a VALUES (1);"},
    {"0002_second.sql", "ALTER TABLE a ADD COLUMN y INTEGER; UPDATE a SET y = x + 1;"},
};

struct fixture {
    char path[64];
    struct orl_db db;
    struct orl_error err;
};

static int setup(void **state)
{
    struct fixture *f = calloc(1, sizeof *f);
    snprintf(f->path, sizeof f->path, "/tmp/oriel-test-XXXXXX");
    const int fd = mkstemp(f->path);
    if (fd < 0)
        return -1;
    close(fd);
    *state = f;
    return orl_db_open(&f->db, f->path, &f->err);
}

static int teardown(void **state)
{
    struct fixture *f = *state;
    char path[80];
    orl_db_close(&f->db);
    unlink(f->path);
    snprintf(path, sizeof path, "%s-wal", f->path);
    unlink(path);
    snprintf(path, sizeof path, "%s-shm", f->path);
    unlink(path);
    snprintf(path, sizeof path, "%s.before-0002", f->path);
    unlink(path);
    free(f);
    return 0;
}

static int64_t number(struct fixture *f, const char *sql)
{
    sqlite3_stmt *stmt = orl_db_prepare(&f->db, &f->err, sql, "");
    assert_non_null(stmt);
    assert_int_equal(sqlite3_step(stmt), SQLITE_ROW);
    const int64_t value = sqlite3_column_int64(stmt, 0);
    sqlite3_finalize(stmt);
    return value;
}

static void test_pragmas(void **state)
{
    struct fixture *f = *state;
    assert_int_equal(number(f, "PRAGMA foreign_keys"), 1);
    assert_int_equal(number(f, "PRAGMA synchronous"), 2);
    assert_int_equal(number(f, "SELECT count(*) FROM pragma_journal_mode WHERE "
                               "journal_mode = 'wal'"),
                     1);
}

static void test_fresh_and_again(void **state)
{
    struct fixture *f = *state;
    assert_int_equal(orl_db_migrate_embedded(&f->db, &f->err), 0);
    const int64_t applied = number(f, "SELECT count(*) FROM schema_migrations");
    assert_true(applied >= 1);
    assert_int_equal(orl_db_migrate_embedded(&f->db, &f->err), 0);
    assert_int_equal(number(f, "SELECT count(*) FROM schema_migrations"), applied);
    assert_int_equal(number(f, "SELECT count(*) FROM sqlite_schema WHERE type = 'table' AND name "
                               "IN ('scenes', 'scene_files', 'bsdfs', 'maps', 'jobs')"),
                     5);
}

static void test_stepwise_keeps_data(void **state)
{
    struct fixture *f = *state;
    assert_int_equal(orl_db_migrate(&f->db, two, 1, &f->err), 0);
    assert_int_equal(orl_db_exec(&f->db, "INSERT INTO a VALUES (41)", &f->err), 0);
    assert_int_equal(orl_db_migrate(&f->db, two, 2, &f->err), 0);
    assert_int_equal(number(f, "SELECT y FROM a WHERE x = 41"), 42);
}

/* A migration that fails halfway changes nothing, and can be applied once it is repaired. */
static int64_t columns_of_copy(const char *path, struct orl_error *err)
{
    struct orl_db db = {NULL};
    assert_int_equal(orl_db_open_existing(&db, path, err), 0);
    sqlite3_stmt *stmt =
        orl_db_prepare(&db, err, "SELECT count(*) FROM pragma_table_info('a')", "");
    assert_non_null(stmt);
    assert_int_equal(sqlite3_step(stmt), SQLITE_ROW);
    const int64_t count = sqlite3_column_int64(stmt, 0);
    sqlite3_finalize(stmt);
    orl_db_close(&db);
    return count;
}

/* A database with contents is copied before it changes, and again after a failed attempt; an empty
 * one is not. */
static void test_copy_before(void **state)
{
    struct fixture *f = *state;
    char copy[100];
    snprintf(copy, sizeof copy, "%s.before-0002", f->path);
    assert_int_equal(orl_db_migrate(&f->db, two, 1, &f->err), 0);
    assert_int_not_equal(access(copy, F_OK), 0);
    for (int i = 0; i < 2; i++) {
        const struct orl_migration broken[] = {two[0], {"0002_broken.sql", "no sql"}};
        assert_int_not_equal(orl_db_migrate(&f->db, broken, 2, &f->err), 0);
    }
    assert_int_equal(orl_db_migrate(&f->db, two, 2, &f->err), 0);
    assert_int_equal(number(f, "SELECT count(*) FROM pragma_table_info('a')"), 2);
    assert_int_equal(columns_of_copy(copy, &f->err), 1);
    assert_int_equal(orl_db_migrate(&f->db, two, 2, &f->err), 0);
    assert_int_equal(unlink(copy), 0);
    assert_int_equal(orl_db_migrate(&f->db, two, 2, &f->err), 0);
    assert_int_not_equal(access(copy, F_OK), 0);
}

/* A migrations table that lacks rows is refused with a remedy, and the backup of an earlier
 * migration is kept. */
static void test_lost_rows_are_refused(void **state)
{
    static const struct {
        const char *sql, *says;
        int code;
    } losses[] = {
        {"DELETE FROM schema_migrations", "list of migrations (schema_migrations) is empty",
         ORL_ERR_CORRUPT},
        {"DROP TABLE schema_migrations", "list of migrations (schema_migrations) is empty",
         ORL_ERR_CORRUPT},
        {"DELETE FROM schema_migrations WHERE version = 1", "lacks number 1", ORL_ERR_CORRUPT},
        {"DELETE FROM schema_migrations WHERE version = 2", "duplicate column name", ORL_ERR_IO},
    };
    struct fixture *f = *state;
    char copy[100];
    snprintf(copy, sizeof copy, "%s.before-0002", f->path);
    assert_int_equal(orl_db_migrate(&f->db, two, 1, &f->err), 0);
    assert_int_equal(orl_db_migrate(&f->db, two, 2, &f->err), 0);
    for (size_t i = 0; i < sizeof losses / sizeof *losses; i++) {
        assert_int_equal(orl_db_begin(&f->db, &f->err), 0);
        assert_int_equal(orl_db_exec(&f->db, losses[i].sql, &f->err), 0);
        assert_int_equal(orl_db_end(&f->db, 0, &f->err), 0);
        assert_int_equal(orl_db_migrate(&f->db, two, 2, &f->err), losses[i].code);
        assert_non_null(strstr(f->err.message, losses[i].says));
        assert_non_null(strstr(f->err.hint, "put back oriel.db"));
        assert_int_equal(columns_of_copy(copy, &f->err), 1);
        assert_int_equal(orl_db_exec(&f->db,
                                     "DROP TABLE IF EXISTS a; DROP TABLE IF EXISTS "
                                     "schema_migrations",
                                     &f->err),
                         0);
        assert_int_equal(orl_db_migrate(&f->db, two, 2, &f->err), 0);
    }
}

static void test_failure_is_atomic(void **state)
{
    struct fixture *f = *state;
    struct orl_migration list[2] = {two[0],
                                    {"0002_bad.sql", "CREATE TABLE b (x INTEGER) STRICT; "
                                                     "INSERT INTO nowhere VALUES (1);"}};
    assert_int_equal(orl_db_migrate(&f->db, list, 2, &f->err), ORL_ERR_IO);
    assert_string_equal(f->err.file, "0002_bad.sql");
    assert_int_equal(number(f, "SELECT count(*) FROM schema_migrations"), 1);
    assert_int_equal(number(f, "SELECT count(*) FROM sqlite_schema WHERE name = 'b'"), 0);
    assert_int_equal(orl_db_migrate(&f->db, two, 2, &f->err), 0);
}

static void test_later_version_is_refused(void **state)
{
    struct fixture *f = *state;
    assert_int_equal(orl_db_migrate(&f->db, two, 2, &f->err), 0);
    assert_int_equal(orl_db_migrate(&f->db, two, 1, &f->err), ORL_ERR_VERSION);
    assert_non_null(strstr(f->err.message, "later version"));
    assert_int_equal(number(f, "SELECT y FROM a"), 2);
}

static void test_edited_migration_is_refused(void **state)
{
    struct fixture *f = *state;
    struct orl_migration edited[2] = {two[0], two[1]};
    edited[0].sql = "CREATE TABLE a (x INTEGER, z TEXT) STRICT;";
    assert_int_equal(orl_db_migrate(&f->db, two, 2, &f->err), 0);
    assert_int_equal(orl_db_migrate(&f->db, edited, 2, &f->err), ORL_ERR_CORRUPT);
}

static void test_gap_is_refused(void **state)
{
    struct fixture *f = *state;
    assert_int_equal(orl_db_migrate(&f->db, &two[1], 1, &f->err), ORL_ERR_INTERNAL);
}

/* The schema enforces the constraints that the code promises. */
static void test_schema_refuses_nonsense(void **state)
{
    struct fixture *f = *state;
    static const char *const bad[] = {
        "INSERT INTO scenes VALUES ('short', 1, 1, '{}', 1)",
        "INSERT INTO tokens VALUES ('n', '0123456789abcdef', "
        "'0123456789abcdef0123456789abcdef0123456789abcdef0123456789abcdef', 'all', 1)",
        "INSERT INTO tokens VALUES ('n', '0123456789abcdef', 'the secret itself', 'read', 1)",
        "INSERT INTO jobs (id, scene, document, state, created_ms) VALUES ('j', "
        "'0123456789abcdef0123456789abcdef0123456789abcdef0123456789abcdef', "
        "'0123456789abcdef0123456789abcdef0123456789abcdef0123456789abcdef', 'queued', 1)",
        "INSERT INTO maps VALUES ('global', 'k', 1, 1, 1, 1.0, 0, 0.0, 1, 1, NULL, 0)",
        "INSERT INTO maps VALUES ('global', "
        "'0123456789abcdef0123456789abcdef0123456789abcdef0123456789abcdef', 1, 1, 1, 1.0, 0, 0.0, "
        "1, 1, 'short', 0)",
        "INSERT INTO scenes VALUES "
        "('0123456789abcdef0123456789abcdef0123456789abcdef0123456789abcdef', 1, 1, '{}', 1); "
        "INSERT "
        "INTO jobs (id, scene, document, state, created_ms, priority) VALUES ('j', "
        "'0123456789abcdef0123456789abcdef0123456789abcdef0123456789abcdef', "
        "'0123456789abcdef0123456789abcdef0123456789abcdef0123456789abcdef', 'queued', 1, 10)",
    };
    assert_int_equal(orl_db_migrate_embedded(&f->db, &f->err), 0);
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++)
        assert_int_equal(orl_db_exec(&f->db, bad[i], &f->err), ORL_ERR_IO);
}

static int only_map(void *ctx, const struct orl_stored_map *map)
{
    struct orl_stored_map *only = ctx;
    assert_string_equal(only->info.key, "");
    *only = *map;
    return 0;
}

/* Maps from before map families existed stay, without a family. */
static void test_families_come_to_old_maps(void **state)
{
    struct fixture *f = *state;
    struct orl_stored_map only = {.hits = 0};
    const char *sql = orl_embedded_file_find("migrations/0001_initial.sql");
    assert_non_null(sql);
    const struct orl_migration first = {"0001_initial.sql", sql};
    assert_int_equal(orl_db_migrate(&f->db, &first, 1, &f->err), 0);
    assert_int_equal(orl_db_exec(&f->db,
                                 "INSERT INTO maps VALUES ('global', '0123456789abcdef0123456789"
                                 "abcdef0123456789abcdef0123456789abcdef', 7, 5, 1, 1.5, 2, 3.0, "
                                 "1, 1)",
                                 &f->err),
                     0);
    assert_int_equal(orl_db_migrate_embedded(&f->db, &f->err), 0);
    assert_int_equal(orl_map_rows(&f->db, only_map, &only, &f->err), 0);
    assert_int_equal(only.info.stored, 5);
    assert_int_equal(only.hits, 2);
    assert_string_equal(only.info.family, "");
    assert_int_equal(only.info.target, 0);
    memset(only.info.family, 'c', 64);
    only.info.target = 5000000000;
    assert_int_equal(orl_map_row_put(&f->db, &only, &f->err), 0);
    struct orl_stored_map again = {.hits = 0};
    assert_int_equal(orl_map_rows(&f->db, only_map, &again, &f->err), 0);
    assert_string_equal(again.info.family, only.info.family);
    assert_true(again.info.target == 5000000000);
}

/* Applies the first `count` migrations that the daemon embeds. */
static void migrate_up_to(struct fixture *f, size_t count)
{
    struct orl_migration list[16];
    size_t n = 0;
    for (size_t i = 0; i < orl_embedded_file_count(); i++) {
        const struct orl_embedded_file file = orl_embedded_file_at(i);
        if (strncmp(file.name, "migrations/", 11) == 0 && n < count && n < 16)
            list[n++] = (struct orl_migration){file.name + 11, file.text};
    }
    assert_int_equal(n, count);
    assert_int_equal(orl_db_migrate(&f->db, list, n, &f->err), 0);
}

#define SCENE "aaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaa"

/* Jobs from before the storage budget keep their files, and their sizes are recorded. */
static void test_old_jobs_are_measured(void **state)
{
    struct fixture *f = *state;
    migrate_up_to(f, 7);
    const char *sql =
        "INSERT INTO scenes VALUES ('" SCENE "', 1, 1, '{}');"
        "INSERT INTO jobs (seq, id, kind, scene, document, state, attempts, created_ms, started_ms,"
        " finished_ms, outcome, problem, priority, client, request_key, identity) VALUES"
        "(3, 'a', 'study', '" SCENE "', '" SCENE "', 'succeeded', 2, 11, 12, 13,"
        " '{\"files\":[{\"name\":\"x\",\"bytes\":30},{\"name\":\"y\",\"bytes\":12}]}', NULL, 7,"
        " 'name:c', 'k', 'i'),"
        "(5, 'b', 'render', '" SCENE "', '" SCENE "', 'succeeded', 1, 11, 12, 13, 'no json', NULL,"
        " 5, '', NULL, ''),"
        "(8, 'c', 'render', '" SCENE "', '" SCENE "', 'queued', 0, 11, NULL, NULL, NULL, NULL, 5,"
        " '', NULL, '')";
    assert_int_equal(orl_db_exec(&f->db, sql, &f->err), 0);
    assert_int_equal(orl_db_migrate_embedded(&f->db, &f->err), 0);
    assert_int_equal(number(f, "SELECT result_bytes FROM jobs WHERE id = 'a'"), 42);
    assert_int_equal(number(f, "SELECT sum(result_bytes) FROM jobs WHERE id > 'a'"), 0);
    assert_int_equal(number(f, "SELECT count(*) FROM jobs WHERE seq = 3 AND kind = 'study' AND "
                               "attempts = 2 AND created_ms = 11 AND started_ms = 12 AND "
                               "finished_ms = 13 AND priority = 7 AND client = 'name:c' AND "
                               "request_key = 'k' AND identity = 'i' AND evicted_ms IS NULL"),
                     1);
    /* The order of arrival continues. */
    assert_int_equal(orl_db_exec(&f->db,
                                 "INSERT INTO jobs (id, scene, document, state, created_ms) VALUES "
                                 "('d', '" SCENE "', '" SCENE "', 'queued', 1)",
                                 &f->err),
                     0);
    assert_int_equal(number(f, "SELECT seq FROM jobs WHERE id = 'd'"), 9);
}

/* A scene cannot be removed while a job waits for it, but can after its jobs have ended. */
static void test_scenes_can_go(void **state)
{
    struct fixture *f = *state;
    assert_int_equal(orl_db_migrate_embedded(&f->db, &f->err), 0);
    assert_int_equal(orl_db_exec(&f->db,
                                 "INSERT INTO scenes VALUES ('" SCENE "', 1, 1, '{}', 1);"
                                 "INSERT INTO scene_files VALUES ('" SCENE "', 0, 'n', 0, '" SCENE
                                 "', 1);"
                                 "INSERT INTO bsdfs VALUES ('" SCENE "', 1, 'n', 1, '{}');"
                                 "INSERT INTO jobs (id, scene, document, state, created_ms) VALUES "
                                 "('j', '" SCENE "', '" SCENE "', 'running', 1)",
                                 &f->err),
                     0);
    assert_int_equal(orl_db_exec(&f->db, "DELETE FROM scenes", &f->err), ORL_ERR_IO);
    assert_int_equal(orl_db_exec(&f->db, "DELETE FROM bsdfs", &f->err), ORL_ERR_IO);
    assert_int_equal(orl_db_exec(&f->db, "UPDATE jobs SET state = 'failed'", &f->err), 0);
    assert_int_equal(orl_db_exec(&f->db, "DELETE FROM scenes; DELETE FROM bsdfs", &f->err), 0);
    assert_int_equal(number(f, "SELECT count(*) FROM scene_files"), 0);
    assert_int_equal(number(f, "SELECT count(*) FROM jobs"), 1);
}

/* Older scenes take the time of their last use from their jobs; each new job updates it. */
static void test_last_use_of_scenes(void **state)
{
    struct fixture *f = *state;
    struct orl_migration first[9];
    static const char *const names[9] = {
        "0001_initial.sql",        "0002_job_kinds.sql", "0003_map_families.sql",
        "0004_job_queue.sql",      "0005_tokens.sql",    "0006_idempotency_keys.sql",
        "0007_job_identities.sql", "0008_storage.sql",   "0009_job_memory.sql"};
    for (size_t i = 0; i < 9; i++) {
        char path[80];
        snprintf(path, sizeof path, "migrations/%s", names[i]);
        first[i] = (struct orl_migration){names[i], orl_embedded_file_find(path)};
        assert_non_null(first[i].sql);
    }
    assert_int_equal(orl_db_migrate(&f->db, first, 9, &f->err), 0);
    assert_int_equal(orl_db_exec(&f->db,
                                 "INSERT INTO scenes VALUES ('" SCENE "', 5, 1, '{}');"
                                 "INSERT INTO jobs (id, scene, document, state, created_ms) VALUES "
                                 "('j', '" SCENE "', '" SCENE "', 'failed', 7)",
                                 &f->err),
                     0);
    assert_int_equal(orl_db_migrate_embedded(&f->db, &f->err), 0);
    assert_int_equal(number(f, "SELECT last_used_ms FROM scenes"), 7);
    assert_int_equal(number(f, "SELECT count(*) FROM jobs WHERE name IS NULL AND tags IS NULL"), 1);
    assert_int_equal(orl_db_exec(&f->db,
                                 "INSERT INTO jobs (id, scene, document, state, created_ms) VALUES "
                                 "('k', '" SCENE "', '" SCENE "', 'queued', 9)",
                                 &f->err),
                     0);
    assert_int_equal(number(f, "SELECT last_used_ms FROM scenes"), 9);
}

/* Older jobs belong to the token of their client's name, if that token is at least as old. */
static void test_old_jobs_have_owners(void **state)
{
    struct fixture *f = *state;
    migrate_up_to(f, 14);
#define HASH "'0123456789abcdef0123456789abcdef0123456789abcdef0123456789abcdef'"
    const char *sql =
        "INSERT INTO tokens VALUES ('ann', '00000000000000aa', " HASH ", 'submit', 5),"
        "('bob', '00000000000000bb', " HASH ", 'submit', 20);"
        "INSERT INTO scenes VALUES ('" SCENE "', 1, 1, '{}', 1);"
        "INSERT INTO jobs (id, scene, document, state, created_ms, finished_ms, client) VALUES "
        "('a', '" SCENE "', '" SCENE "', 'succeeded', 10, 13, 'token:ann'),"
        "('b', '" SCENE "', '" SCENE "', 'failed', 10, 14, 'token:bob'),"
        "('c', '" SCENE "', '" SCENE "', 'queued', 10, NULL, 'name:ann')";
    assert_int_equal(orl_db_exec(&f->db, sql, &f->err), 0);
    assert_int_equal(orl_db_migrate_embedded(&f->db, &f->err), 0);
    assert_int_equal(number(f, "SELECT count(*) FROM jobs WHERE id = 'a' AND owner = "
                               "'00000000000000aa' AND retained_ms = 13"),
                     1);
    assert_int_equal(number(f, "SELECT count(*) FROM jobs WHERE id = 'b' AND owner = '' AND "
                               "retained_ms = 14"),
                     1);
    assert_int_equal(number(f, "SELECT count(*) FROM jobs WHERE id = 'c' AND owner = '' AND "
                               "retained_ms IS NULL"),
                     1);
}

static int last_row(void *ctx, const struct orl_job_row *row)
{
    struct orl_job_row *last = ctx;
    assert_string_equal(row->problem, "{\"a\":1}");
    assert_string_equal(row->name, "n");
    assert_string_equal(row->tags, "[\"t\"]");
    *last = *row;
    return 0;
}

static void test_job_rows_round_trip(void **state)
{
    struct fixture *f = *state;
    struct orl_job_row row = {.id = "job-1",
                              .state = ORL_JOB_QUEUED,
                              .created_ms = 11,
                              .priority = 7,
                              .client = "name:x",
                              .owner = "0123456789abcdef",
                              .identity = "i",
                              .name = "n",
                              .tags = "[\"t\"]"},
                       last;
    memset(&last, 0, sizeof last);
    memset(row.scene, 'a', 64);
    memset(row.document, 'b', 64);
    assert_int_equal(orl_db_migrate_embedded(&f->db, &f->err), 0);
    char sql[256];
    snprintf(sql, sizeof sql, "INSERT INTO scenes VALUES ('%s', 1, 1, '{}', 1)", row.scene);
    assert_int_equal(orl_db_exec(&f->db, sql, &f->err), 0);
    assert_int_equal(orl_job_row_insert(&f->db, &row, "key", &row.seq, &f->err), 0);
    char id[ORL_JOB_ID];
    assert_int_equal(
        orl_job_row_by_key(&f->db, "name:x", "0123456789abcdef", "key", 10, id, &f->err), 0);
    assert_string_equal(id, "job-1");
    assert_int_equal(
        orl_job_row_by_key(&f->db, "name:x", "0123456789abcdef", "key", 11, id, &f->err), 0);
    assert_string_equal(id, "");
    assert_int_equal(
        orl_job_row_by_key(&f->db, "name:y", "0123456789abcdef", "key", 10, id, &f->err), 0);
    assert_string_equal(id, "");
    assert_int_equal(orl_job_row_by_key(&f->db, "name:x", "", "key", 10, id, &f->err), 0);
    assert_string_equal(id, "");
    row.state = ORL_JOB_FAILED;
    row.attempts = 2;
    row.finished_ms = 13;
    row.retained_ms = 12;
    row.problem = "{\"a\":1}";
    row.result_bytes = 5000000000;
    row.fetched_ms = 17;
    row.evicted_ms = 19;
    assert_int_equal(orl_job_row_update(&f->db, &row, &f->err), 0);
    assert_int_equal(orl_job_rows(&f->db, last_row, &last, &f->err), 0);
    assert_string_equal(last.id, "job-1");
    assert_int_equal(last.state, ORL_JOB_FAILED);
    assert_int_equal(last.attempts, 2);
    assert_int_equal(last.priority, 7);
    assert_string_equal(last.client, "name:x");
    assert_string_equal(last.identity, "i");
    assert_int_equal(last.started_ms, 0);
    assert_int_equal(last.finished_ms, 13);
    assert_int_equal(last.retained_ms, 12);
    assert_string_equal(last.owner, "0123456789abcdef");
    assert_null(last.outcome);
    assert_true(last.result_bytes == 5000000000);
    assert_int_equal(last.fetched_ms, 17);
    assert_int_equal(last.evicted_ms, 19);
    assert_int_equal(orl_job_row_drop(&f->db, row.seq, &f->err), 0);
    assert_int_equal(number(f, "SELECT count(*) FROM jobs"), 0);
}

#define EACH(test) cmocka_unit_test_setup_teardown(test, setup, teardown)
int main(void)
{
    const struct CMUnitTest tests[] = {
        EACH(test_pragmas),
        EACH(test_fresh_and_again),
        EACH(test_stepwise_keeps_data),
        EACH(test_copy_before),
        EACH(test_failure_is_atomic),
        EACH(test_lost_rows_are_refused),
        EACH(test_old_jobs_have_owners),
        EACH(test_later_version_is_refused),
        EACH(test_edited_migration_is_refused),
        EACH(test_gap_is_refused),
        EACH(test_schema_refuses_nonsense),
        EACH(test_families_come_to_old_maps),
        EACH(test_old_jobs_are_measured),
        EACH(test_scenes_can_go),
        EACH(test_last_use_of_scenes),
        EACH(test_job_rows_round_trip),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
