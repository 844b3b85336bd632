/*
 * Cases of a Python program against a daemon, each in a separate Python process with a folder of
 * its own. The interpreter is Debian's, which has the packages that the tests need.
 */
#ifndef ORL_TESTS_SUPPORT_PYTHON_CASE_H
#define ORL_TESTS_SUPPORT_PYTHON_CASE_H

#include "support/daemon.h"

struct python_fixture {
    struct daemon daemon;
    char cert[80], submit[100], read[100]; /* empty: the daemon has no tokens */
};

/* Runs the case of that name. Fails the test if its exit status is not 0. */
void python_case_run(const struct python_fixture *f, const char *program, const char *name);

/* Set-up and tear-down of a group of tests: the state is a struct python_fixture. */
int python_fixture_start(void **state);
int python_fixture_end(void **state);

/* Defines test_NAME, which runs the case NAME of the program. */
#define PYTHON_CASE(program, name)                                                                 \
    static void test_##name(void **state)                                                          \
    {                                                                                              \
        python_case_run(*state, program, #name);                                                   \
    }

#endif
