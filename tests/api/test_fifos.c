/*
 * FIFOs in place of stored files, without a process at their other end: a plain open() would block
 * for ever. Readers, daemon and command report an error and continue. A block would end by alarm().
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <errno.h>
#include <fcntl.h>
#include <ftw.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include <oriel/base/files.h>

#include "base/io/checked_file.h"
#include "base/io/out_file.h"
#include "http/connection/connections.h"
#include "photon/map/map.h"
#include "run/cache/word_file.h"
#include "store/files/folders.h"
#include "support/cli.h"
#include "support/storage.h"

enum { PATIENCE_S = 60 };

static int set_up(void **state)
{
    static char folder[64];
    cli_make_folder(folder);
    *state = folder;
    alarm(PATIENCE_S);
    return 0;
}

static int tear_down(void **state)
{
    alarm(0);
    cli_remove_folder(*state);
    return 0;
}

static const char *make_fifo(const char *folder, const char *name)
{
    static char path[128];
    snprintf(path, sizeof path, "%s/%s", folder, name);
    assert_int_equal(mkfifo(path, 0600), 0);
    return path;
}

/* ---- Functions that open --------------------------------------------------------------------- */

static void test_open(void **state)
{
    const char *fifo = make_fifo(*state, "fifo");
    static const int flags[] = {O_RDONLY,
                                O_WRONLY,
                                O_RDWR,
                                O_WRONLY | O_CREAT | O_TRUNC,
                                O_RDWR | O_CREAT,
                                O_WRONLY | O_CREAT | O_APPEND,
                                O_RDONLY | O_NOFOLLOW};
    for (size_t i = 0; i < sizeof flags / sizeof *flags; i++) {
        errno = 0;
        assert_int_equal(orl_open_regular(fifo, flags[i]), -1);
        assert_int_equal(errno, ORL_OPEN_NOT_REGULAR);
    }
    for (const char *mode = "rwa"; *mode; mode++)
        assert_null(orl_fopen_regular(fifo, *mode));
    assert_int_equal(orl_open_regular(*state, O_RDONLY), -1);
    assert_int_equal(errno, ORL_OPEN_NOT_REGULAR);
    assert_null(orl_fopen_device(fifo));
    assert_int_equal(errno, ENXIO);
    const int reader = open(fifo, O_RDONLY | O_NONBLOCK);
    FILE *stream = orl_fopen_device(fifo);
    assert_non_null(stream);
    assert_int_equal(fcntl(fileno(stream), F_GETFL) & O_NONBLOCK, 0);
    fclose(stream);
    close(reader);
}

static void test_readers(void **state)
{
    const char *fifo = make_fifo(*state, "fifo");
    const struct orl_files files = orl_files_from_folder(*state);
    const struct orl_checked_file_kind kind = {.magic = "ORIELXX", .what = "thing"};
    const unsigned char content[ORL_CHECKED_FILE_CONTENT] = {0};
    struct orl_photon_map *map;
    struct orl_word_file_info file_info;
    struct orl_checked_file sealed;
    struct orl_tls tls = {0};
    struct orl_file file;
    struct orl_error err;
    assert_int_equal(files.open(files.ctx, "fifo", &file, &err), ORL_ERR_IO);
    assert_non_null(strstr(err.message, "not a regular file"));
    assert_true(orl_photon_map_open(fifo, true, &map, &err) < 0);
    assert_non_null(strstr(err.message, "not a regular file"));
    assert_true(orl_checked_file_open(&kind, fifo, content, &sealed, &err) < 0);
    assert_true(orl_word_file_describe(fifo, &file_info, &err) < 0);
    assert_true(orl_map_file(fifo, &file, &err) < 0);
    assert_true(orl_tls_load(&tls, fifo, fifo, 0, &err) < 0);
    assert_true(orl_sync_path(fifo, &err) < 0);
}

static void test_writers(void **state)
{
    const char *folder = *state;
    const struct orl_checked_file_kind kind = {.magic = "ORIELXX", .what = "thing"};
    struct orl_checked_writer sealed;
    struct orl_word_file_info file_info = {0};
    struct orl_out_file file;
    struct orl_error err;
    char path[128];
    make_fifo(folder, "out.part");
    snprintf(path, sizeof path, "%s/out", folder);
    assert_true(orl_out_open(&file, path, &err) < 0);
    snprintf(path, sizeof path, "%s/out.part", folder);
    assert_true(orl_out_open(&file, path, &err) < 0);
    assert_true(orl_checked_writer_begin(&sealed, &kind, path, &err) < 0);
    assert_true(orl_word_file_write(path, &file_info, "1234", 4, &err) < 0);
}

/* ---- The command ----------------------------------------------------------------------------- */

static void test_command(void **state)
{
    static const char job[] = "{\"kind\":\"render\",\"scene\":{\"files\":[\"fifo\"]},"
                              "\"sensors\":[[0,0,0,0,0,1]]}";
    char document[128], output[128];
    struct cli_result *result = calloc(1, sizeof *result);
    const char *fifo = make_fifo(*state, "fifo");
    assert_non_null(result);
    cli_write_file(*state, "job.json", job);
    snprintf(document, sizeof document, "%s/job.json", (char *)*state);
    snprintf(output, sizeof output, "%s/out", (char *)*state);
    const char *const lines[][8] = {
        {"run", document, "-o", output, NULL},
        {"run", fifo, "-o", output, NULL},
        {"plan", document, NULL},
        {"annual", fifo, "-o", output, NULL},
        {"study", fifo, "-o", output, NULL},
        {"bsdf", "check", fifo, NULL},
        {"bsdf", "fit", fifo, "-o", output, NULL},
        {"bsdf", "make", fifo, "-o", output, NULL},
        {"bsdf", "convert", fifo, "-o", output, NULL},
        {"glare", fifo, NULL},
        {"verify", fifo, NULL},
        {"part", fifo, NULL},
        {"upload", "scene", fifo, NULL},
        {"submit", fifo, NULL},
    };
    for (size_t i = 0; i < sizeof lines / sizeof *lines; i++) {
        cli_run(lines[i], result);
        if (result->exit_code != 1 && result->exit_code != 2)
            fail_msg("%s: %d", lines[i][0], result->exit_code);
    }
    free(result);
}

/* ---- The daemon ------------------------------------------------------------------------------ */

static int replace_one(const char *path, const struct stat *st, int type, struct FTW *ftw)
{
    (void)st, (void)ftw;
    return type == FTW_F && (unlink(path) != 0 || mkfifo(path, 0600) != 0) ? -1 : 0;
}

/* Replaces every file below a folder of the data folder. */
static void replace_files(const struct daemon *daemon, const char *folder)
{
    char path[128];
    snprintf(path, sizeof path, "%s/%s", daemon->root, folder);
    assert_int_equal(nftw(path, replace_one, 8, FTW_PHYS), 0);
}

static void expect_error(struct daemon *daemon, const char *path)
{
    struct reply reply;
    daemon_get(daemon, path, &reply);
    assert_in_range(reply.status, 400, 599);
    reply_done(&reply);
}

static int daemon_up(void **state)
{
    alarm(PATIENCE_S);
    return daemon_room_set_up(state);
}

static int daemon_down(void **state)
{
    alarm(0);
    return daemon_room_tear_down(state);
}

static void test_daemon(void **state)
{
    struct daemon_room *f = *state;
    struct reply reply;
    char done[80], next[80], path[128];
    storage_run_job(&f->daemon, f->scene, 1, "v", done);
    /* A map that is a FIFO is built again. */
    replace_files(&f->daemon, "maps");
    assert_int_equal(daemon_end(&f->daemon, SIGTERM), 0);
    daemon_restart(&f->daemon, NULL);
    daemon_submit(&f->daemon, f->scene, STORAGE_PHOTONS, 1, "w", next);
    daemon_wait(&f->daemon, next, PATIENCE_S, &reply);
    if (strcmp(reply_text(&reply, "state"), "succeeded") != 0)
        fail_msg("%s", reply.body);
    reply_done(&reply);
    replace_files(&f->daemon, "results");
    replace_files(&f->daemon, "blobs");
    snprintf(path, sizeof path, "%s/result", done);
    expect_error(&f->daemon, path);
    snprintf(path, sizeof path, "%s/files/v.hdr", done);
    expect_error(&f->daemon, path);
    snprintf(path, sizeof path, "%s/document", done);
    expect_error(&f->daemon, path);
    /* The scene's files are blobs. */
    assert_int_equal(daemon_end(&f->daemon, SIGTERM), 0);
    daemon_restart(&f->daemon, (const char *const[]){"--shelf", "0", NULL});
    snprintf(path, sizeof path,
             "{\"kind\":\"render\",\"scene\":\"%s\",\"seed\":7,\"sensors\":[[2,2,1,0,0,1]]}",
             f->scene);
    daemon_post_json(&f->daemon, "/v1/jobs", path, &reply);
    if (reply.status < 300) {
        snprintf(next, sizeof next, "%s", reply_text(&reply, "links.self"));
        reply_done(&reply);
        daemon_wait(&f->daemon, next, PATIENCE_S, &reply);
        assert_string_equal(reply_text(&reply, "state"), "failed");
    }
    reply_done(&reply);
    daemon_get(&f->daemon, "/healthz", &reply);
    assert_int_equal(reply.status, 200);
    reply_done(&reply);
}

/* `orield scrub` and `orield backup` report the files as damaged. */
static void test_store_commands(void **state)
{
    struct daemon_room *f = *state;
    struct cli_result *result = calloc(1, sizeof *result);
    char job[80], copy[80];
    assert_non_null(result);
    storage_run_job(&f->daemon, f->scene, 1, NULL, job);
    assert_int_equal(daemon_end(&f->daemon, SIGTERM), 0);
    replace_files(&f->daemon, "results");
    replace_files(&f->daemon, "maps");
    snprintf(copy, sizeof copy, "%s-copy", f->daemon.root);
    const char *const lines[][6] = {{"scrub", "--data", f->daemon.root, NULL},
                                    {"backup", copy, "--data", f->daemon.root, NULL}};
    for (int i = 0; i < 2; i++) {
        struct cli_child child = cli_start_program("orield", lines[i]);
        cli_finish(&child, result);
        assert_int_not_equal(result->exit_code, -1);
        print_message("# %s: %d %s\n", lines[i][0], result->exit_code, result->err);
    }
    cli_remove_folder(copy);
    free(result);
    daemon_restart(&f->daemon, NULL);
}

int main(void)
{
    static const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(test_open, set_up, tear_down),
        cmocka_unit_test_setup_teardown(test_readers, set_up, tear_down),
        cmocka_unit_test_setup_teardown(test_writers, set_up, tear_down),
        cmocka_unit_test_setup_teardown(test_command, set_up, tear_down),
        cmocka_unit_test_setup_teardown(test_daemon, daemon_up, daemon_down),
        cmocka_unit_test_setup_teardown(test_store_commands, daemon_up, daemon_down),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
