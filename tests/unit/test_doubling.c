/*
 * Twice the input costs every reader at most 2.3 times the instructions: each rule of the scene
 * grammar, each command, each kind of file (support/doubled.h). A loop of n within one of n would
 * cost 4 times. A quadratic part that is a sixth of the smaller input's cost fails.
 *
 * Instructions are counted by callgrind, which runs this program a second time. Counts are the
 * same on a busy machine and on a quiet one. They need no access to processor counters, which most
 * containers deny. By hand: test_doubling 8 [NAME] takes inputs 16 times as large.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "support/cli.h"
#include "support/doubled.h"

static const double most = 2.3;
static double scale = .5;
static const char *wanted; /* a part of the input's name, or NULL */

static const struct doubled *case_at(size_t i)
{
    if (i < doubled_n_scenes)
        return &doubled_scenes[i];
    i -= doubled_n_scenes;
    if (i < doubled_n_files)
        return &doubled_files[i];
    i -= doubled_n_files;
    if (i < doubled_n_models)
        return &doubled_models[i];
    i -= doubled_n_models;
    if (i < doubled_n_meshes)
        return &doubled_meshes[i];
    i -= doubled_n_meshes;
    return i < doubled_n_functions ? &doubled_functions[i] : NULL;
}

/* ---- The program under callgrind ------------------------------------------------------------- */

/* Callgrind counts the instructions of this function, by its name. */
__attribute__((noinline)) int count_reading(const struct doubled_input *input, char text[256]);
int count_reading(const struct doubled_input *input, char text[256])
{
    return doubled_read(input, text);
}

static size_t size_of(const struct doubled *one)
{
    return (size_t)(scale * (double)one->n) + 1;
}

/* Reads each size and twice that. A quarter is read before, so that one-time setup is not counted.
 */
static void read_all(void)
{
    char text[256];
    const struct doubled *one;
    for (size_t i = 0; (one = case_at(i)); i++)
        for (int times = 1; times <= 2 && (!wanted || strstr(one->name, wanted)); times++) {
            if (times == 1) {
                struct doubled_input little = doubled_make(one, size_of(one) / 4 + 1);
                doubled_read(&little, text);
                doubled_done(&little);
            }
            struct doubled_input input = doubled_make(one, size_of(one) * (size_t)times);
            const int code = count_reading(&input, text);
            printf("%zu %d %d %zu %s\n", i, times, code, input.size, text);
            doubled_done(&input);
        }
}

/* ---- The test -------------------------------------------------------------------------------- */

static char folder[64];

/* Returns the sum of one dump. */
static double instructions_of(int dump)
{
    char path[128], line[512];
    double count = -1;
    snprintf(path, sizeof path, "%s/counts.%d", folder, dump);
    FILE *file = fopen(path, "r");
    if (!file)
        fail_msg("callgrind left no %s", path);
    while (count < 0 && fgets(line, sizeof line, file))
        if (strncmp(line, "summary: ", 9) == 0 || strncmp(line, "totals: ", 8) == 0)
            count = strtod(strchr(line, ' '), NULL);
    fclose(file);
    unlink(path);
    return count;
}

static void run_callgrind(void)
{
    char command[1024], self[512];
    const ssize_t length = readlink("/proc/self/exe", self, sizeof self - 1);
    assert_true(length > 0);
    self[length] = '\0';
    snprintf(command, sizeof command,
             "valgrind -q --tool=callgrind --zero-before=count_reading --dump-after=count_reading "
             "--callgrind-out-file=%s/counts %s count %g %s >%s/list 2>%s/log",
             folder, self, scale, wanted ? wanted : "", folder, folder);
    if (system(command) != 0)
        fail_msg("callgrind has failed; is valgrind installed? `make deps-check` does that");
}

static bool is_sanitized(void)
{
#if defined __SANITIZE_ADDRESS__ || defined __SANITIZE_THREAD__
    return true;
#else
    return false;
#endif
}

static void test_doubling(void **state)
{
    if (is_sanitized()) /* valgrind cannot run sanitized programs */
        skip();
    char path[128], line[512];
    double count = 0, before;
    int failed = 0, dump = 0;
    (void)state;
    cli_make_folder(folder);
    run_callgrind();
    snprintf(path, sizeof path, "%s/list", folder);
    FILE *list = fopen(path, "r");
    assert_non_null(list);
    while (fgets(line, sizeof line, list)) {
        size_t i = 0, size = 0;
        int times = 0, code = 0;
        assert_int_equal(sscanf(line, "%zu %d %d %zu", &i, &times, &code, &size), 4);
        before = count;
        count = instructions_of(++dump);
        if (times == 1)
            continue;
        const double times_most = case_at(i)->most > 0 ? case_at(i)->most : most;
        const bool bad = !(count <= times_most * before);
        print_message("# %s%-28s %8zu bytes %12.0f instructions, %.2f times%s", bad ? "FAIL " : "",
                      case_at(i)->name, size, count, count / before,
                      code < 0 ? ", refused: " : "\n");
        if (code < 0)
            print_message("%s", strrchr(line, ' '));
        failed += bad;
    }
    fclose(list);
    cli_remove_folder(folder);
    assert_true(dump > 0);
    assert_int_equal(failed, 0);
}

int main(int argc, char **argv)
{
    static const struct CMUnitTest tests[] = {cmocka_unit_test(test_doubling)};
    const bool count = argc > 1 && strcmp(argv[1], "count") == 0;
    argv += count;
    argc -= count;
    scale = argc > 1 ? strtod(argv[1], NULL) : .5;
    wanted = argc > 2 ? argv[2] : NULL;
    if (!count)
        return cmocka_run_group_tests(tests, NULL, NULL);
    read_all();
    return 0;
}
