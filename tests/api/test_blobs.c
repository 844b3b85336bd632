/*
 * Lifetime of blobs: those that a row names or a request claims stay, whatever the order of events.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

#include "store/files/blobs.h"
#include "store/rows/scenes.h"
#include "support/data_folder.h"

struct fixture {
    struct data_folder data;
    struct orl_wal_sync *wal_sync;
    struct orl_blobs *blobs;
    char sha[ORL_SHA_HEX]; /* digest of "ten bytes." */
    struct orl_error err;
};

/* Replaces the C library's fsync: counts synced folders. */
static int folders_synced;
int fsync(int fd)
{
    struct stat st;
    if (fstat(fd, &st) == 0 && S_ISDIR(st.st_mode))
        folders_synced++;
    return (int)syscall(SYS_fsync, fd);
}

static void on_quiet(void *ctx)
{
    (void)ctx;
}

static int open_blobs(struct fixture *f)
{
    uv_loop_t *loop = uv_default_loop();
    char path[ORL_PATH_MAX];
    orl_folders_path(&f->data.folders, path, "oriel.db");
    int rc = orl_db_serve(&f->data.db, &f->err);
    if (rc == 0)
        rc = orl_wal_sync_open(loop, &f->data.db, path, on_quiet, NULL, &f->wal_sync, &f->err);
    return rc ? rc
              : orl_blobs_open(loop, &f->data.folders, &f->data.db, f->wal_sync, &f->blobs,
                               &f->err);
}

/* Runs all pending disk operations. */
static void wait_for_syncs(const struct fixture *f)
{
    while (!orl_wal_sync_is_idle(f->wal_sync))
        uv_run(uv_default_loop(), UV_RUN_ONCE);
}

static void close_all(struct fixture *f)
{
    wait_for_syncs(f);
    orl_wal_sync_stop(f->wal_sync);
    uv_run(uv_default_loop(), UV_RUN_DEFAULT);
    orl_blobs_close(f->blobs);
    f->blobs = NULL;
    orl_wal_sync_free(f->wal_sync);
    f->wal_sync = NULL;
    data_folder_close(&f->data);
}

static int open_all(struct fixture *f)
{
    const int rc = data_folder_open(&f->data, &f->err);
    return rc ? rc : open_blobs(f);
}

static int setup(void **state)
{
    struct fixture *f = calloc(1, sizeof *f);
    orl_sha256_hex("ten bytes.", 10, f->sha);
    *state = f;
    return data_folder_make(&f->data, &f->err) || open_blobs(f) ? -1 : 0;
}

static int teardown(void **state)
{
    struct fixture *f = *state;
    close_all(f);
    data_folder_remove(&f->data);
    free(f);
    return 0;
}

/* Stores the bytes as an upload does on the pool. */
static void store_blob(struct fixture *f)
{
    char path[ORL_PATH_MAX];
    orl_folders_temporary(&f->data.folders, path);
    assert_int_equal(orl_write_file(path, "ten bytes.", 10, &f->err), 0);
    assert_int_equal(orl_blob_store(&f->data.folders, path, f->sha, &f->err), 0);
}

static void name_it(struct fixture *f)
{
    bool created = false;
    assert_int_equal(orl_bsdf_insert(&f->data.db, f->sha, "b", 10, "{}", &created, &f->err), 0);
}

static void unname(struct fixture *f)
{
    bool removed = false;
    assert_int_equal(orl_bsdf_drop(&f->data.db, f->sha, &removed, &f->err), 0);
    assert_true(removed);
    orl_blobs_remove_unused(f->blobs, f->sha);
}

static void claim(struct fixture *f)
{
    assert_int_equal(orl_blobs_claim(f->blobs, f->sha, &f->err), 0);
}

static void expect(const struct fixture *f, bool there, uint64_t bytes)
{
    assert_int_equal(orl_blob_exists(&f->data.folders, f->sha), there);
    assert_int_equal(orl_blobs_bytes(f->blobs), bytes);
}

static void test_upload_and_removal(void **state)
{
    struct fixture *f = *state;
    claim(f);
    store_blob(f);
    name_it(f);
    orl_blobs_release(f->blobs, f->sha);
    expect(f, true, 10);
    close_all(f);
    assert_int_equal(open_all(f), 0);
    expect(f, true, 10);
    unname(f);
    expect(f, true, 10); /* a power cut might restore its row */
    wait_for_syncs(f);
    expect(f, false, 0);
}

/* The bytes are uploaded again before the removal of the first upload is durable. */
static void test_upload_after_removal(void **state)
{
    struct fixture *f = *state;
    claim(f);
    store_blob(f);
    name_it(f);
    orl_blobs_release(f->blobs, f->sha);
    unname(f);
    claim(f);
    store_blob(f);
    wait_for_syncs(f);
    expect(f, true, 10);
    name_it(f);
    orl_blobs_release(f->blobs, f->sha);
    wait_for_syncs(f);
    expect(f, true, 10);
    unname(f);
    claim(f); /* once more, without success */
    orl_blobs_release(f->blobs, f->sha);
    wait_for_syncs(f);
    expect(f, false, 0);
}

/* The upload's row could not be written. */
static void test_failed_upload(void **state)
{
    struct fixture *f = *state;
    claim(f);
    store_blob(f);
    orl_blobs_release(f->blobs, f->sha);
    expect(f, false, 0);
    claim(f); /* its file could not be written either */
    orl_blobs_release(f->blobs, f->sha);
    expect(f, false, 0);
}

/* Two uploads have the same bytes, and one fails. */
static void test_two_uploads(void **state)
{
    struct fixture *f = *state;
    claim(f);
    claim(f);
    store_blob(f);
    store_blob(f);
    orl_blobs_release(f->blobs, f->sha);
    expect(f, true, 0);
    name_it(f);
    orl_blobs_release(f->blobs, f->sha);
    expect(f, true, 10);
}

/* An upload that finds existing bytes syncs their folders, too: the upload that wrote them may not
 * yet have synced that of the blob and the one above. */
static void test_upload_beside_another(void **state)
{
    struct fixture *f = *state;
    claim(f);
    folders_synced = 0;
    store_blob(f);
    assert_int_equal(folders_synced, 2);
    folders_synced = 0;
    store_blob(f);
    assert_int_equal(folders_synced, 2);
    orl_blobs_release(f->blobs, f->sha);
}

/* An upload finds existing bytes just before the row that named them is removed. */
static void test_removal_during_upload(void **state)
{
    struct fixture *f = *state;
    claim(f);
    store_blob(f);
    name_it(f);
    orl_blobs_release(f->blobs, f->sha);
    claim(f);
    unname(f);
    expect(f, true, 10);
    name_it(f);
    orl_blobs_release(f->blobs, f->sha);
    expect(f, true, 10);
    claim(f);
    unname(f);
    orl_blobs_release(f->blobs, f->sha); /* a claim that failed, too */
    wait_for_syncs(f);
    expect(f, false, 0);
}

/* A plan reads a scene's files: they stay until it has finished, even if the scene is removed. */
static void test_files_that_are_read(void **state)
{
    struct fixture *f = *state;
    struct orl_blob_claims claims = {0};
    struct orl_bundle files = {0};
    claim(f);
    store_blob(f);
    name_it(f);
    orl_blobs_release(f->blobs, f->sha);
    assert_int_equal(orl_bundle_add(&files, "b.xml", true, "b", 10, f->sha, false, &f->err), 0);
    assert_int_equal(orl_blobs_claim_files(f->blobs, &files, &claims, &f->err), 0);
    orl_bundle_done(&files);
    unname(f);
    wait_for_syncs(f);
    expect(f, true, 10);
    orl_blobs_release_files(&claims);
    wait_for_syncs(f);
    expect(f, false, 0);
    orl_blobs_release_files(&claims); /* no files are claimed */
}

static void test_orphans_go_at_start(void **state)
{
    struct fixture *f = *state;
    store_blob(f);
    close_all(f);
    assert_int_equal(open_all(f), 0);
    expect(f, false, 0);
}

#define EACH(test) cmocka_unit_test_setup_teardown(test, setup, teardown)
int main(void)
{
    const struct CMUnitTest tests[] = {
        EACH(test_upload_and_removal),    EACH(test_failed_upload),
        EACH(test_two_uploads),           EACH(test_removal_during_upload),
        EACH(test_orphans_go_at_start),   EACH(test_files_that_are_read),
        EACH(test_upload_beside_another), EACH(test_upload_after_removal),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
