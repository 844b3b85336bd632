/* The Python package with Honeybee models, results, settings and commands: the cases of
 * python_package.py. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "support/python_case.h"

#define PROGRAM "tests/api/python_package.py"

PYTHON_CASE(PROGRAM, old_python)
PYTHON_CASE(PROGRAM, models)
PYTHON_CASE(PROGRAM, folders)
PYTHON_CASE(PROGRAM, years)
PYTHON_CASE(PROGRAM, kinds)
PYTHON_CASE(PROGRAM, tables)
PYTHON_CASE(PROGRAM, broken)
PYTHON_CASE(PROGRAM, restarts)
PYTHON_CASE(PROGRAM, followed)
PYTHON_CASE(PROGRAM, interrupts)
PYTHON_CASE(PROGRAM, hints)
PYTHON_CASE(PROGRAM, named_servers)
PYTHON_CASE(PROGRAM, commands)
PYTHON_CASE(PROGRAM, readme)
PYTHON_CASE(PROGRAM, wheel)

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_old_python), cmocka_unit_test(test_models),
        cmocka_unit_test(test_folders),    cmocka_unit_test(test_years),
        cmocka_unit_test(test_kinds),      cmocka_unit_test(test_tables),
        cmocka_unit_test(test_broken),     cmocka_unit_test(test_restarts),
        cmocka_unit_test(test_followed),   cmocka_unit_test(test_interrupts),
        cmocka_unit_test(test_hints),      cmocka_unit_test(test_named_servers),
        cmocka_unit_test(test_commands),   cmocka_unit_test(test_readme),
        cmocka_unit_test(test_wheel),
    };
    return cmocka_run_group_tests(tests, python_fixture_start, python_fixture_end);
}
