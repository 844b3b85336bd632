/* Jobs in parts, each a separate process: equal results; and parts with wrong or missing data. */
#include <dirent.h>
#include <setjmp.h>
#include <signal.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cmocka.h>

#include "support/parted.h"
#include "support/patience.h"

static int count_entries(const char *folder)
{
    DIR *entries = opendir(folder);
    int n = 0;
    for (const struct dirent *entry; entries && (entry = readdir(entries)) != NULL;)
        n += entry->d_name[0] != '.';
    if (entries)
        closedir(entries);
    return n;
}

static const char *const in_parts[] = {"--parts", "3", NULL}, *const in_one[] = {"--parts", "1",
                                                                                 NULL};

static void assert_nothing_is_left(const struct cli_desk *f)
{
    char path[160];
    snprintf(path, sizeof path, "%s/parts/parts", f->folder);
    assert_int_equal(access(path, F_OK), -1);
}

static void test_a_render(void **state)
{
    parted_compare(*state, parted_render, in_parts);
    assert_nothing_is_left(*state);
    parted_compare(*state, parted_render, in_one);
}

static void test_skies(void **state)
{
    parted_compare(*state, parted_skies, in_parts);
}

static void test_rounds(void **state)
{
    parted_compare(*state, parted_goal, in_parts);
}

static void test_a_year(void **state)
{
    parted_compare(*state, parted_annual, in_parts);
    assert_non_null(strstr(((struct cli_desk *)*state)->result.err,
                           "the standard error is above 25 % of the illuminance in "));
    parted_compare(*state, parted_annual, in_one);
}

static void test_a_study(void **state)
{
    parted_compare(*state, parted_study, in_parts);
    assert_nothing_is_left(*state);
}

static void make_bsdf(struct cli_desk *f, const char *document, const char *file, bool parts)
{
    char path[160], to[160];
    snprintf(path, sizeof path, "%s/%s", f->folder, document);
    snprintf(to, sizeof to, "%s/%s", f->folder, file);
    const char *const args[] = {"bsdf", "make", path, "-o", to, "-j", "1", parts ? "--parts" : NULL,
                                "3",    NULL};
    cli_run(args, &f->result);
    if (f->result.exit_code != 0)
        fail_msg("%s", f->result.err);
    assert_true(parts == (strstr(f->result.err, "parts: ") != NULL));
}

static void compare_bsdfs(struct cli_desk *f, const char *document)
{
    make_bsdf(f, document, "whole.xml", false);
    make_bsdf(f, document, "parts.xml", true);
    char *whole = cli_read_file(f->folder, "whole.xml");
    char *parts = cli_read_file(f->folder, "parts.xml");
    assert_true(strlen(whole) > 1000);
    assert_string_equal(whole, parts);
    free(whole);
    free(parts);
}

static void test_bsdfs(void **state)
{
    struct cli_desk *f = *state;
    char path[160];
    compare_bsdfs(f, parted_panel);
    compare_bsdfs(f, parted_tree);
    compare_bsdfs(f, parted_colors);
    snprintf(path, sizeof path, "%s/parts", f->folder);
    assert_int_equal(access(path, F_OK), -1);
}

/* After a kill the finished tasks are reused. */
static void test_pieces_serve_again(void **state)
{
    struct cli_desk *f = *state;
    char path[160], to[160], store[160];
    snprintf(path, sizeof path, "%s/%s", f->folder, parted_skies);
    snprintf(to, sizeof to, "%s/parts", f->folder);
    snprintf(store, sizeof store, "%s/parts/parts/store", f->folder);
    static const char *const in_five[] = {"--parts", "5", NULL};
    const char *const args[] = {"run", path, "-o", to, "--threads", "1", "--parts", "5", NULL};
    struct cli_child child = cli_start(args);
    for (double until = patience_until(); count_entries(store) < 3 && patience_nap(until);)
        continue;
    assert_true(count_entries(store) >= 3);
    kill(child.pid, SIGKILL);
    cli_finish(&child, &f->result);
    assert_int_equal(f->result.exit_code, -1);
    parted_run(f, parted_skies, "parts", in_five);
    assert_null(strstr(f->result.err, "of an earlier run: 0"));
    parted_run(f, parted_skies, "whole", NULL);
    parted_assert_same(f, "whole", "parts");
}

/* Returns the name of a finished part, "" if there is none. */
static void find_done(const char *folder, char ret_stem[128])
{
    DIR *entries = opendir(folder);
    *ret_stem = '\0';
    for (const struct dirent *entry; entries && (entry = readdir(entries)) != NULL;) {
        const char *ending = strstr(entry->d_name, ".done");
        if (ending && strcmp(ending, ".done") == 0) /* excludes one that is still being written */
            snprintf(ret_stem, 128, "%.*s", (int)(ending - entry->d_name), entry->d_name);
    }
    if (entries)
        closedir(entries);
}

/* A part that was ended between its last task and its end mark finds all tasks. */
static void test_a_part_is_done_twice(void **state)
{
    struct cli_desk *f = *state;
    char path[160], to[160], folder[160], stem[128] = "", part[400], done[400];
    snprintf(path, sizeof path, "%s/%s", f->folder, parted_skies);
    snprintf(to, sizeof to, "%s/parts", f->folder);
    snprintf(folder, sizeof folder, "%s/parts/parts", f->folder);
    /* With this many parts others remain when the first is done. */
    const char *const args[] = {"run", path, "-o", to, "--threads", "1", "--parts", "5", NULL};
    struct cli_child child = cli_start(args);
    for (double until = patience_until(); !*stem && patience_nap(until);)
        find_done(folder, stem);
    assert_true(*stem);
    kill(child.pid, SIGKILL);
    cli_finish(&child, &f->result);
    snprintf(part, sizeof part, "%s/%s.json", folder, stem);
    snprintf(done, sizeof done, "%s/%s.done", folder, stem);
    assert_int_equal(unlink(done), 0);
    const char *const again[] = {"part", part, NULL};
    cli_run(again, &f->result);
    if (f->result.exit_code != 0)
        fail_msg("%s", f->result.err);
    assert_int_equal(access(done, F_OK), 0);
}

static void assert_part_refused(struct cli_desk *f, const char *part, const char *says)
{
    char path[200];
    snprintf(path, sizeof path, "%s/wave1-0.json", f->output);
    cli_write_file(f->output, "wave1-0.json", part);
    const char *const args[] = {"part", path, NULL};
    cli_run(args, &f->result);
    assert_int_equal(f->result.exit_code, 1);
    if (!strstr(f->result.err, says))
        fail_msg("\"%s\" is not in: %s", says, f->result.err);
    char *error = cli_read_file(f->output, "wave1-0.error");
    assert_non_null(error);
    assert_non_null(strstr(error, "\"detail\""));
    free(error);
    assert_null(cli_read_file(f->output, "wave1-0.done"));
}

/* Writes a folder as `oriel run --parts` does: the room, and its digest. */
static void test_parts_that_do_not_fit(void **state)
{
    static const char piece[] = "{\"job\": \"%s\", \"threads\": 1, \"pieces\": [{\"kind\": "
                                "\"view\", \"key\": \"00\"}]}";
    struct cli_desk *f = *state;
    char part[400], files[160];
    assert_int_equal(mkdir(f->output, 0700), 0);
    cli_write_file(f->output, "job.json", "{\"scene\": {\"files\": [\"room.rad\"]}}");
    cli_write_file(f->output, "files.json",
                   "{\"room.rad\": \"e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b8"
                   "55\"}");
    snprintf(part, sizeof part, piece, "00");
    assert_part_refused(f, part, "room.rad");
    snprintf(files, sizeof files, "%s/files", f->output);
    assert_int_equal(mkdir(files, 0700), 0);
    cli_write_file(files, "room.rad", "# not what the digest says\n");
    assert_part_refused(f, part, "has changed since the job began");
    cli_write_file(files, "room.rad", "");
    assert_part_refused(f, part, "to another job");
    assert_part_refused(f, "{\"job\": \"00\", \"threads\": 0}", "threads");
    assert_part_refused(f, "{", "wave1-0.json");
}

static void assert_usage(struct cli_desk *f, const char *const *args, const char *says)
{
    cli_run(args, &f->result);
    assert_int_equal(f->result.exit_code, 2);
    if (!strstr(f->result.err, says))
        fail_msg("\"%s\" is not in: %s", says, f->result.err);
}

static void test_command_lines(void **state)
{
    struct cli_desk *f = *state;
    const char *const none[] = {"run", f->document, "-o", f->output, "--parts", "0", NULL};
    const char *const alone[] = {"run", f->document, "-o", f->output, "--sbatch", "-p x", NULL};
    const char *const no_part[] = {"part", "wave", NULL};
    assert_usage(f, none, "--parts takes a number");
    assert_usage(f, alone, "--sbatch requires --slurm");
    assert_usage(f, no_part, "must end in .json");
    cli_write_file(
        f->folder, "late.json",
        "{\"scene\": {\"files\": [\"room.rad\", \"sky.rad\"]}, \"accuracy\": {\"deadline_s\": 5},"
        " \"sensors\": {\"file\": \"desks.pts\"}}");
    char late[160];
    snprintf(late, sizeof late, "%s/late.json", f->folder);
    const char *const deadline[] = {"run", late, "-o", f->output, "--parts", "2", NULL};
    cli_run(deadline, &f->result);
    assert_int_equal(f->result.exit_code, 1);
    assert_non_null(strstr(f->result.err, "deadline"));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(test_a_render, parted_set_up, cli_desk_tear_down),
        cmocka_unit_test_setup_teardown(test_skies, parted_set_up, cli_desk_tear_down),
        cmocka_unit_test_setup_teardown(test_rounds, parted_set_up, cli_desk_tear_down),
        cmocka_unit_test_setup_teardown(test_a_year, parted_set_up, cli_desk_tear_down),
        cmocka_unit_test_setup_teardown(test_a_study, parted_set_up, cli_desk_tear_down),
        cmocka_unit_test_setup_teardown(test_bsdfs, parted_set_up, cli_desk_tear_down),
        cmocka_unit_test_setup_teardown(test_pieces_serve_again, parted_set_up, cli_desk_tear_down),
        cmocka_unit_test_setup_teardown(test_a_part_is_done_twice, parted_set_up,
                                        cli_desk_tear_down),
        cmocka_unit_test_setup_teardown(test_parts_that_do_not_fit, parted_set_up,
                                        cli_desk_tear_down),
        cmocka_unit_test_setup_teardown(test_command_lines, parted_set_up, cli_desk_tear_down),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
