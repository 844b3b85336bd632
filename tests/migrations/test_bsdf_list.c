/* The list of BSDFs: it includes the contents of older databases, follows every insertion and
 * removal, and a page takes the same time for any number of scenes. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "process/embedded_files.h"
#include "store/database/db.h"
#include "store/rows/scenes.h"

struct fixture {
    struct orl_db db;
    struct orl_error err;
};

static int setup(void **state)
{
    struct fixture *f = calloc(1, sizeof *f);
    *state = f;
    return f ? orl_db_open(&f->db, ":memory:", &f->err) : -1;
}

static int teardown(void **state)
{
    struct fixture *f = *state;
    orl_db_close(&f->db);
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

static void run_sql(struct fixture *f, const char *format, ...)
    __attribute__((format(printf, 2, 3)));
static void run_sql(struct fixture *f, const char *format, ...)
{
    char sql[512];
    va_list args;
    va_start(args, format);
    vsnprintf(sql, sizeof sql, format, args);
    va_end(args);
    if (orl_db_exec(&f->db, sql, &f->err) < 0)
        fail_msg("%s: %s", sql, f->err.message);
}

/* Adds scene number `scene` with these blobs as files; the name of every third file is not .xml. */
static void add_scene(struct fixture *f, int scene, const int *blobs, int count, int now_ms)
{
    run_sql(
        f,
        "INSERT INTO scenes (id, created_ms, bytes, summary) VALUES (printf('%%064x', %d), %d, 9, "
        "'{}')",
        scene, now_ms);
    for (int i = 0; i < count; i++)
        run_sql(f,
                "INSERT INTO scene_files VALUES (printf('%%064x', %d), %d, 'f%d%s', 1, "
                "printf('%%064x', %d), 7)",
                scene, i, i, i % 3 == 2 ? ".dat" : ".xml", blobs[i]);
}

static void add_own(struct fixture *f, int blob, int now_ms)
{
    run_sql(f, "INSERT OR IGNORE INTO bsdfs VALUES (printf('%%064x', %d), %d, 'own', 7, '{}')",
            blob, now_ms);
}

/* Returns the number of differences between the list and all tables that it derives from, in
 * either direction. */
static int64_t faults(struct fixture *f)
{
    return number(
        f,
        "WITH wanted AS (SELECT id, name AS least, name AS most, 1 AS own, (SELECT "
        "count(DISTINCT scene) FROM scene_files WHERE blob = b.id) AS scenes FROM bsdfs b UNION "
        "ALL SELECT blob, min(name), max(name), 0, (SELECT count(DISTINCT scene) FROM scene_files "
        "WHERE blob = f.blob) FROM scene_files f WHERE resource = 1 AND name LIKE '%.xml' AND blob "
        "NOT IN (SELECT id FROM bsdfs) GROUP BY blob) SELECT (SELECT count(*) FROM wanted w WHERE "
        "NOT EXISTS (SELECT 1 FROM listed_bsdfs l WHERE l.id = w.id AND l.own = w.own AND l.scenes "
        "= w.scenes AND l.name BETWEEN w.least AND w.most)) + (SELECT count(*) FROM listed_bsdfs "
        "WHERE id NOT IN (SELECT id FROM wanted)) + (SELECT count(*) FROM listed_bsdfs l WHERE "
        "last_used_ms < coalesce((SELECT max(s.last_used_ms) FROM scene_files f JOIN scenes s ON "
        "s.id = f.scene WHERE f.blob = l.id), created_ms))");
}

/* A database from before the list: its scenes and BSDFs are listed. */
static void test_older_databases(void **state)
{
    struct fixture *f = *state;
    struct orl_migration list[12];
    size_t n = 0;
    for (size_t i = 0; i < orl_embedded_file_count() && n < 12; i++) {
        const struct orl_embedded_file file = orl_embedded_file_at(i);
        if (strncmp(file.name, "migrations/", 11) == 0)
            list[n++] = (struct orl_migration){file.name + 11, file.text};
    }
    assert_int_equal(orl_db_migrate(&f->db, list, n, &f->err), 0);
    add_scene(f, 1, (const int[]){10, 11, 12, 10}, 4, 5);
    add_scene(f, 2, (const int[]){10, 13}, 2, 6);
    add_own(f, 13, 8);
    add_own(f, 14, 9);
    assert_int_equal(orl_db_migrate_embedded(&f->db, &f->err), 0);
    assert_int_equal(number(f, "SELECT count(*) FROM listed_bsdfs"), 4);
    assert_int_equal(faults(f), 0);
    assert_int_equal(number(f, "SELECT last_used_ms FROM listed_bsdfs WHERE scenes = 2"), 6);
    assert_int_equal(number(f, "SELECT created_ms FROM listed_bsdfs WHERE scenes = 2"), 5);
}

/* The list stays right while scenes and BSDFs are added, used and removed in any order. */
static void test_comings_and_goings(void **state)
{
    enum { STEPS = 600, SCENES = 12, BLOBS = 9 };
    struct fixture *f = *state;
    uint32_t random = 1;
    assert_int_equal(orl_db_migrate_embedded(&f->db, &f->err), 0);
    for (int step = 1; step <= STEPS; step++) {
        random = random * 1664525u + 1013904223u;
        const int scene = (int)(random >> 8) % SCENES, blob = (int)(random >> 16) % BLOBS;
        const int blobs[] = {blob, (blob + scene) % BLOBS, (blob + 2) % BLOBS, blob};
        char sql[96];
        snprintf(sql, sizeof sql, "SELECT count(*) FROM scenes WHERE id = printf('%%064x', %d)",
                 scene);
        const bool there = number(f, sql) > 0;
        if ((random >> 28) < 2)
            add_own(f, blob, step);
        else if ((random >> 28) < 4)
            run_sql(
                f,
                "DELETE FROM bsdfs WHERE id = printf('%%064x', %d) AND NOT EXISTS (SELECT 1 FROM "
                "scene_files WHERE blob = bsdfs.id)",
                blob);
        else if ((random >> 28) < 7 && there)
            run_sql(f, "UPDATE scenes SET last_used_ms = %d WHERE id = printf('%%064x', %d)", step,
                    scene);
        else if (there)
            run_sql(f, "DELETE FROM scenes WHERE id = printf('%%064x', %d)", scene);
        else
            add_scene(f, scene, blobs, 1 + (int)(random >> 4) % 4, step);
        if (faults(f) != 0)
            fail_msg("step %d: the list differs from what there is", step);
    }
    assert_true(number(f, "SELECT count(*) FROM listed_bsdfs") > 0);
}

static int count_step(void *ctx)
{
    ++*(uint64_t *)ctx;
    return 0;
}

static int see(void *ctx, const struct orl_listed_bsdf *bsdf)
{
    ++*(size_t *)ctx;
    assert_true(bsdf->n_scenes > 0 && strlen(bsdf->scenes) >= ORL_SHA_HEX - 1);
    return 0;
}

struct steps {
    uint64_t page, of_scene, one;
};

/* Counts SQLite's virtual machine steps for a page of fifty, for a scene's BSDFs, and for one
 * BSDF. */
static struct steps count_steps(struct fixture *f)
{
    struct orl_list_position place = {.created_ms = INT64_MAX};
    struct orl_scene_bsdf bsdf;
    struct steps steps = {0};
    size_t seen = 0;
    char id[ORL_SHA_HEX];
    bool found = false;
    sqlite3_progress_handler(f->db.handle, 1, count_step, &steps.page);
    assert_int_equal(orl_bsdf_rows(&f->db, &place, NULL, 50, see, &seen, &f->err), 0);
    assert_int_equal(seen, 50);
    snprintf(id, sizeof id, "%064x", 60);
    sqlite3_progress_handler(f->db.handle, 1, count_step, &steps.of_scene);
    assert_int_equal(orl_bsdf_rows(&f->db, &place, id, 50, see, &seen, &f->err), 0);
    assert_int_equal(seen, 52);
    snprintf(id, sizeof id, "%064x", 1000060);
    sqlite3_progress_handler(f->db.handle, 1, count_step, &steps.one);
    assert_int_equal(orl_scene_bsdf_find(&f->db, id, &bsdf, &found, &f->err), 0);
    assert_true(found && strcmp(bsdf.name, "f0.xml") == 0);
    sqlite3_progress_handler(f->db.handle, 0, NULL, NULL);
    return steps;
}

/* Each scene has a BSDF of its own, and one that all scenes share. */
static void test_two_thousand_scenes(void **state)
{
    enum { FEW = 100, MANY = 2000, OWN = 1000000 };
    struct fixture *f = *state;
    struct steps few = {0};
    assert_int_equal(orl_db_migrate_embedded(&f->db, &f->err), 0);
    for (int i = 0; i < MANY; i++) {
        if (i == FEW)
            few = count_steps(f);
        add_scene(f, i, (const int[]){OWN + i, OWN - 1}, 2, 10 + i);
    }
    const struct steps many = count_steps(f);
    print_message("page %llu -> %llu, of a scene %llu -> %llu, one %llu -> %llu steps\n",
                  (unsigned long long)few.page, (unsigned long long)many.page,
                  (unsigned long long)few.of_scene, (unsigned long long)many.of_scene,
                  (unsigned long long)few.one, (unsigned long long)many.one);
    assert_true(10 * many.page < 11 * few.page + 500);
    assert_true(10 * many.of_scene < 11 * few.of_scene + 500);
    assert_true(10 * many.one < 11 * few.one + 500);
    assert_int_equal(number(f, "SELECT max(scenes) FROM listed_bsdfs"), MANY);
}

#define EACH(test) cmocka_unit_test_setup_teardown(test, setup, teardown)
int main(void)
{
    const struct CMUnitTest tests[] = {
        EACH(test_older_databases),
        EACH(test_comings_and_goings),
        EACH(test_two_thousand_scenes),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
