#include "support/daemon_metric.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>

#include <cmocka.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

double daemon_metric(struct daemon *daemon, const char *name)
{
    struct reply reply;
    char line[96];
    snprintf(line, sizeof line, "\n%s ", name);
    daemon_get(daemon, "/metrics", &reply);
    const char *at = strstr(reply.body, line);
    if (!at)
        fail_msg("no %s in the metrics", name);
    const double value = strtod(at + strlen(line), NULL);
    reply_done(&reply);
    return value;
}
