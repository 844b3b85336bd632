/* Versions, manuals, completion, installation and the files for containers: the cases of
 * packaging.py, each in a Python process and a folder of its own. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <stdio.h>
#include <stdlib.h>

#include "support/cli.h"

static void run_case(const char *name)
{
    const char *build = getenv("ORIEL_BUILD");
    char folder[64], command[400];
    cli_make_folder(folder);
    snprintf(
        command, sizeof command,
        "PYTHONDONTWRITEBYTECODE=1 /usr/bin/python3 -W error tests/api/packaging.py %s %s %s >&2",
        name, build ? build : "build", folder);
    const int status = system(command);
    cli_remove_folder(folder);
    if (status != 0)
        fail_msg("%s: status %d", name, status);
}

#define CASE(name)                                                                                 \
    static void test_##name(void **state)                                                          \
    {                                                                                              \
        (void)state;                                                                               \
        run_case(#name);                                                                           \
    }
CASE(version)
CASE(one_version)
CASE(manuals)
CASE(bash_options)
CASE(bash_values)
CASE(bash_files)
CASE(zsh)
CASE(install)
CASE(install_elsewhere)
CASE(image_root)
CASE(image_packages)
CASE(compose)
CASE(apparmor)

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_version),
        cmocka_unit_test(test_one_version),
        cmocka_unit_test(test_manuals),
        cmocka_unit_test(test_bash_options),
        cmocka_unit_test(test_bash_values),
        cmocka_unit_test(test_bash_files),
        cmocka_unit_test(test_zsh),
        cmocka_unit_test(test_install),
        cmocka_unit_test(test_install_elsewhere),
        cmocka_unit_test(test_image_root),
        cmocka_unit_test(test_image_packages),
        cmocka_unit_test(test_compose),
        cmocka_unit_test(test_apparmor),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
