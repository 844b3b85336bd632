#include "support/daemon_metric.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>

#include <cmocka.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "support/patience.h"

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

void daemon_metric_wait(struct daemon *daemon, const char *name, double least)
{
    double value = daemon_metric(daemon, name);
    for (double until = patience_until(); value < least && patience_nap(until);)
        value = daemon_metric(daemon, name);
    if (value < least)
        fail_msg("%s is %g after two minutes, not %g", name, value, least);
}
