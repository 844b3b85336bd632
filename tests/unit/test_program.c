/* The digest of the running program: equal for copies of its file, different with other libraries.
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
#include <time.h>
#include <unistd.h>

#include "runner/checkpoints.h"

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define PRELOADS 0 /* sanitizers must be preloaded first */
#else
#define PRELOADS 1
#endif

/* Runs the file and returns the digest it prints, with an additional library or NULL. */
static void read_digest(const char *path, const char *library, char ret_digest[ORL_SHA_HEX])
{
    char command[1024];
    snprintf(command, sizeof command, "LD_PRELOAD='%s' '%s' digest", library ? library : "", path);
    FILE *pipe = popen(command, "r"); /* NOLINT(cert-env33-c): a test's own file */
    assert_non_null(pipe);
    ret_digest[0] = '\0';
    assert_non_null(fgets(ret_digest, ORL_SHA_HEX, pipe));
    pclose(pipe);
    assert_int_equal(strlen(ret_digest), ORL_SHA_HEX - 1);
}

static void copy_self(const char *path)
{
    char buffer[1 << 16];
    FILE *from = fopen("/proc/self/exe", "rb"), *to = fopen(path, "wb");
    size_t n = 0;
    assert_true(from && to);
    while ((n = fread(buffer, 1, sizeof buffer, from)) > 0)
        assert_int_equal(fwrite(buffer, 1, n, to), n);
    fclose(from);
    assert_int_equal(fclose(to), 0);
    assert_int_equal(chmod(path, 0700), 0);
}

static void test_program(void **state)
{
    (void)state;
    char folder[] = "/tmp/oriel-program-XXXXXX", path[64], other[64];
    char here[ORL_SHA_HEX], there[ORL_SHA_HEX], with[ORL_SHA_HEX];
    assert_non_null(mkdtemp(folder));
    snprintf(path, sizeof path, "%s/one", folder);
    snprintf(other, sizeof other, "%s/two", folder);
    copy_self(path);
    read_digest(path, NULL, here);
    /* A copy in another place, with another time. */
    copy_self(other);
    assert_int_equal(utimensat(0, other, (const struct timespec[2]){{1, 0}, {1, 0}}, 0), 0);
    read_digest(other, NULL, there);
    assert_string_equal(here, there);
    if (PRELOADS) {
        read_digest(path, "libutil.so.1", with);
        assert_string_not_equal(here, with);
    }
    unlink(path);
    unlink(other);
    rmdir(folder);
}

int main(int argc, char **argv)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_program)};
    if (argc == 2 && strcmp(argv[1], "digest") == 0) {
        char digest[ORL_SHA_HEX];
        orl_program_digest(digest);
        puts(digest);
        return 0;
    }
    return cmocka_run_group_tests(tests, NULL, NULL);
}
