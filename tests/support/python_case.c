#include "support/python_case.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

#include <cmocka.h>

void python_case_run(const struct python_fixture *f, const char *program, const char *name)
{
    char folder[] = "/tmp/oriel-test-XXXXXX", command[700];
    assert_non_null(mkdtemp(folder));
    snprintf(command, sizeof command,
             "READ_TOKEN='%s' PYTHONDONTWRITEBYTECODE=1 timeout 550 /usr/bin/python3 -W error "
             "%s %s %s %s '%s' '%s' >&2",
             f->read, program, name, f->daemon.url, folder, f->cert, f->submit);
    const int status = system(command);
    snprintf(command, sizeof command, "rm -r %s", folder);
    assert_int_equal(system(command), 0);
    if (status != 0)
        fail_msg("%s: status %d", name, status);
}

int python_fixture_start(void **state)
{
    static struct python_fixture f;
    daemon_start(&f.daemon, NULL);
    *state = &f;
    return 0;
}

int python_fixture_end(void **state)
{
    daemon_remove(&((struct python_fixture *)*state)->daemon);
    return 0;
}
