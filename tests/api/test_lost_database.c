/* Databases that were lost, replaced or restored: a start never removes the files that its database
 * does not know. */
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
#include <sys/wait.h>
#include <unistd.h>

#include "support/daemon.h"
#include "support/storage.h"

static const char *const set_aside[] = {"--orphans", "set-aside", NULL};

/* Runs a command with the data folder in $D. */
static void shell(const struct daemon *daemon, const char *command)
{
    char line[512];
    snprintf(line, sizeof line, "D=%s; %s", daemon->root, command);
    if (system(line) != 0)
        fail_msg("%s", line);
}

/* The files of a daemon with a scene and a job; the daemon has ended. */
struct files {
    size_t blobs, results, maps;
};
static struct files fill_folder(struct daemon_room *f, char ret_job[80])
{
    storage_run_job(&f->daemon, f->scene, 1, "v", ret_job);
    assert_int_equal(daemon_end(&f->daemon, SIGTERM), 0);
    return (struct files){daemon_count_files(&f->daemon, "blobs"),
                          daemon_count_files(&f->daemon, "results"),
                          daemon_count_files(&f->daemon, "maps")};
}

static void expect_files(const struct daemon *daemon, const struct files *wanted)
{
    assert_int_equal(daemon_count_files(daemon, "blobs"), wanted->blobs);
    assert_int_equal(daemon_count_files(daemon, "results"), wanted->results);
    assert_int_equal(daemon_count_files(daemon, "maps"), wanted->maps);
}

/* Runs the program to its end, with output to a file; returns its status. */
static int run_program(const struct daemon *daemon, const char *arguments)
{
    const char *build = getenv("ORIEL_BUILD");
    char line[512];
    snprintf(line, sizeof line, "timeout 120 %s/orield %s --data %s > %s.said 2>&1",
             build ? build : "build", arguments, daemon->root, daemon->root);
    const int status = system(line);
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

static void expect_said(const struct daemon *daemon, const char *text)
{
    char line[512];
    snprintf(line, sizeof line, "grep -qF -- '%s' %s.said || { cat %s.said; false; }", text,
             daemon->root, daemon->root);
    if (system(line) != 0)
        fail_msg("it does not say: %s", text);
}

static void forget_said(const struct daemon *daemon)
{
    char path[96];
    snprintf(path, sizeof path, "%s.said", daemon->root);
    unlink(path);
}

static void expect_refusal(struct daemon *daemon, const char *text)
{
    assert_int_equal(run_program(daemon, "--port 0"), 1);
    expect_said(daemon, text);
    expect_said(daemon, "--orphans set-aside");
    /* The token command, which would create a database, refuses as well. */
    assert_int_equal(run_program(daemon, "token list"), 1);
    expect_said(daemon, text);
    forget_said(daemon);
}

/* The database is missing, or an empty file or an empty database replaces it. The start is refused
 * and changes nothing; the option moves all files aside; moving them back undoes that. */
static void lose_database(struct daemon_room *f, const char *how)
{
    char job[80];
    const struct files before = fill_folder(f, job), none = {0};
    shell(&f->daemon, "cp $D/oriel.db $D/saved");
    shell(&f->daemon, how);
    expect_refusal(&f->daemon, "its database oriel.db is missing or empty");
    expect_files(&f->daemon, &before);

    daemon_restart(&f->daemon, set_aside);
    storage_expect(&f->daemon, "GET", job, 404, "no-such-resource");
    expect_files(&f->daemon, &none);
    assert_int_equal(daemon_end(&f->daemon, SIGTERM), 0);
    assert_true(daemon_count_files(&f->daemon, "orphans") >=
                before.blobs + before.results + before.maps);

    shell(&f->daemon, "cp -r $D/orphans/*/blobs $D/orphans/*/results $D/orphans/*/maps $D; "
                      "mv $D/saved $D/oriel.db; rm -f $D/oriel.id");
    daemon_restart(&f->daemon, NULL);
    expect_files(&f->daemon, &before);
    storage_fetch(&f->daemon, job, 200);
}

static void test_missing_database(void **state)
{
    lose_database(*state, "rm $D/oriel.db");
}

static void test_empty_file(void **state)
{
    lose_database(*state, "truncate -s 0 $D/oriel.db");
}

static void test_database_without_tables(void **state)
{
    lose_database(*state, "rm $D/oriel.db; /usr/bin/python3 -c \"import sqlite3, sys; "
                          "d = sqlite3.connect(sys.argv[1]); d.execute('PRAGMA user_version = 1'); "
                          "d.commit()\" $D/oriel.db");
}

/* A new folder starts normally, even if a token was made first. */
static void test_new_folder(void **state)
{
    struct daemon *daemon = &((struct daemon_room *)*state)->daemon;
    assert_int_equal(daemon_end(daemon, SIGTERM), 0);
    shell(daemon, "rm -r $D; mkdir $D");
    assert_int_equal(run_program(daemon, "token add somebody"), 0);
    forget_said(daemon);
    daemon_restart(daemon, NULL);
    daemon_expect_no_files(daemon, "orphans");
}

/* Another folder's database is refused; with the adopt option it treats this folder's files as
 * unknown. */
static void test_another_folders_database(void **state)
{
    struct daemon_room *f = *state;
    struct daemon other;
    char job[80], command[160];
    const struct files before = fill_folder(f, job), none = {0};
    daemon_start(&other, NULL);
    assert_int_equal(daemon_end(&other, SIGTERM), 0);
    snprintf(command, sizeof command, "cp %s/oriel.db $D/oriel.db", other.root);
    shell(&f->daemon, command);
    daemon_remove(&other);
    expect_refusal(&f->daemon, "does not belong to the data folder");
    expect_files(&f->daemon, &before);
    daemon_restart(&f->daemon, set_aside);
    expect_files(&f->daemon, &none);
    assert_int_equal(daemon_count_files(&f->daemon, "orphans"),
                     before.blobs + before.results + before.maps);
    assert_int_equal(daemon_end(&f->daemon, SIGTERM), 0);
    daemon_restart(&f->daemon, NULL); /* now this folder's own */
}

/* An older copy of the database is accepted, and files newer than the copy are moved aside. */
static void test_older_backup(void **state)
{
    struct daemon_room *f = *state;
    char first[80], second[80];
    const struct files before = fill_folder(f, first);
    shell(&f->daemon, "cp $D/oriel.db $D/saved");
    daemon_restart(&f->daemon, NULL);
    storage_run_job(&f->daemon, f->scene, 2, "w", second);
    assert_int_equal(daemon_end(&f->daemon, SIGTERM), 0);
    shell(&f->daemon, "mv $D/saved $D/oriel.db");
    daemon_restart(&f->daemon, NULL);
    expect_files(&f->daemon, &before);
    storage_fetch(&f->daemon, first, 200);
    storage_expect(&f->daemon, "GET", second, 404, "no-such-resource");
    char command[200];
    snprintf(command, sizeof command, "test -s $D/orphans/*/results%s/w.hdr", strrchr(second, '/'));
    shell(&f->daemon, command);
    shell(&f->daemon, "grep -q 'event=orphans-set-aside' $D.log");
}

/* A job that is running in the older copy is run again, and its earlier results stay. */
static void test_results_of_a_job_under_way(void **state)
{
    struct daemon_room *f = *state;
    struct reply reply;
    char job[80];
    fill_folder(f, job);
    storage_run_sql(&f->daemon,
                    "UPDATE jobs SET state = 'running', outcome = NULL, finished_ms = NULL");
    daemon_restart(&f->daemon, NULL);
    daemon_wait(&f->daemon, job, 60, &reply);
    assert_string_equal(reply_text(&reply, "state"), "succeeded");
    reply_done(&reply);
    shell(&f->daemon, "test -s $D/orphans/*/results/*/v.hdr");
}

static size_t orphans_after_start(struct daemon *daemon, const char *keep_days)
{
    const char *const keep[] = {"--keep-orphans", keep_days, NULL};
    daemon_restart(daemon, keep);
    const size_t left = daemon_count_files(daemon, "orphans");
    assert_int_equal(daemon_end(daemon, SIGTERM), 0);
    return left;
}

/* Orphans age by the retention clock, not the wall clock: with --keep-orphans 0 they go at the next
 * start, and after a jump of the wall clock they stay. */
static void test_removal_of_orphans(void **state)
{
    struct daemon_room *f = *state;
    char job[80];
    fill_folder(f, job);
    storage_run_sql(&f->daemon, "DELETE FROM jobs");
    assert_true(orphans_after_start(&f->daemon, "0") > 0); /* moved aside by this start */
    storage_run_sql(&f->daemon, "UPDATE data_folder SET wall_ms = wall_ms - 90 * 86400000");
    assert_true(orphans_after_start(&f->daemon, "30") > 0); /* wall clock: +90 days */
    storage_run_sql(&f->daemon, "UPDATE data_folder SET retained_ms = retained_ms + 31 * 86400000");
    assert_int_equal(orphans_after_start(&f->daemon, "30"), 0);
}

/* Missing files are logged, their rows stay, and uploading a file again restores it. */
static void test_missing_files(void **state)
{
    struct daemon_room *f = *state;
    struct reply reply;
    char job[80], scene[65], path[160];
    fill_folder(f, job);
    shell(&f->daemon, "mkdir $D/away; mv $D/blobs/* $D/results/* $D/away");
    daemon_restart(&f->daemon, NULL);
    shell(&f->daemon, "grep -q 'event=files-missing count=4' $D.log");
    snprintf(path, sizeof path, "%s/files/v.hdr", job);
    daemon_get(&f->daemon, path, &reply);
    assert_int_equal(reply.status, 500);
    assert_string_equal(reply_text(&reply, "type"), "urn:oriel:error:io");
    assert_non_null(strstr(reply_text(&reply, "detail"), "No such file"));
    reply_done(&reply);
    daemon_upload_room(&f->daemon, scene);
    assert_string_equal(scene, f->scene);
    storage_run_job(&f->daemon, scene, 3, NULL, path);
    storage_expect(&f->daemon, "DELETE", job, 204, NULL);
}

/* Expects a refused start with that message; then restores the saved database. */
static void expect_refused_start(struct daemon_room *f, const char *said,
                                 const struct files *before)
{
    assert_int_equal(run_program(&f->daemon, "--port 0"), 1);
    expect_said(&f->daemon, said);
    expect_said(&f->daemon, "put back oriel.db from a backup");
    forget_said(&f->daemon);
    expect_files(&f->daemon, before);
    shell(&f->daemon, "rm -f $D/oriel.db-*; cp $D/saved $D/oriel.db");
}

/* A start that fails on a damaged database names the file and a remedy, and leaves all files. */
static void damage_database(struct daemon_room *f, const char *how, const char *said)
{
    char job[80];
    const struct files before = fill_folder(f, job);
    shell(&f->daemon, how);
    assert_int_equal(run_program(&f->daemon, "--port 0"), 1);
    expect_said(&f->daemon, said);
    expect_said(&f->daemon, "from a backup");
    forget_said(&f->daemon);
    expect_files(&f->daemon, &before);
}

static void test_truncated_database(void **state)
{
    damage_database(*state, "truncate -s 10000 $D/oriel.db", "oriel.db is damaged");
}

static void test_no_database(void **state)
{
    damage_database(*state, "yes | head -c 50000 > $D/oriel.db", "oriel.db is damaged");
}

static void test_lost_id(void **state)
{
    struct daemon_room *f = *state;
    storage_run_sql(&f->daemon, "DELETE FROM data_folder");
    damage_database(f, "true", "has lost its id");
}

/* Every table, dropped by another program, and a column. */
static void test_dropped_table(void **state)
{
    static const char *const tables[] = {"scenes", "jobs", "scene_files", "tokens", "maps"};
    struct daemon_room *f = *state;
    char job[80], sql[160], said[80];
    const struct files before = fill_folder(f, job);
    shell(&f->daemon, "cp $D/oriel.db $D/saved");
    for (size_t i = 0; i < sizeof tables / sizeof *tables; i++) {
        snprintf(sql, sizeof sql, "PRAGMA foreign_keys = OFF; DROP TABLE %s", tables[i]);
        storage_run_sql(&f->daemon, sql);
        snprintf(said, sizeof said, "oriel.db lacks the table %s", tables[i]);
        expect_refused_start(f, said, &before);
    }
    storage_run_sql(&f->daemon, "ALTER TABLE jobs RENAME COLUMN state TO other");
    expect_refused_start(f, "oriel.db lacks the column state of its table jobs", &before);
    daemon_restart(&f->daemon, NULL);
    storage_fetch(&f->daemon, job, 200);
}

#define EACH(test) cmocka_unit_test_setup_teardown(test, daemon_room_set_up, daemon_room_tear_down)
int main(void)
{
    const struct CMUnitTest tests[] = {
        EACH(test_missing_database),
        EACH(test_empty_file),
        EACH(test_database_without_tables),
        EACH(test_new_folder),
        EACH(test_another_folders_database),
        EACH(test_older_backup),
        EACH(test_results_of_a_job_under_way),
        EACH(test_removal_of_orphans),
        EACH(test_missing_files),
        EACH(test_truncated_database),
        EACH(test_no_database),
        EACH(test_lost_id),
        EACH(test_dropped_table),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
