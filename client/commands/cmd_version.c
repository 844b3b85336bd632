/* oriel version: prints the version. */
#include "options/command.h"

#include <stdio.h>

#include <oriel/base/version.h>

int orl_cmd_version(const struct orl_subcommand *self, int argc, char **argv)
{
    struct orl_operands operands;
    int code;

    if (!orl_options_parse(self, argc, argv, NULL, 0, 0, 0, &operands, &code))
        return code;
    printf("oriel %s\n", ORL_VERSION);
    return ORL_EXIT_OK;
}
