#include "support/scratch.h"

#include <stdio.h>

#include "support/cli.h"

static char folder[64];

int scratch_set_up(void **state)
{
    (void)state;
    cli_make_folder(folder);
    return 0;
}

int scratch_tear_down(void **state)
{
    (void)state;
    cli_remove_folder(folder);
    return 0;
}

const char *scratch_path(const char *name)
{
    static char paths[4][256];
    static unsigned turn;
    char *path = paths[turn++ % 4];
    snprintf(path, sizeof paths[0], "%s%s%s", folder, *name ? "/" : "", name);
    return path;
}
