/* One figure of a daemon's metrics. Fails the running test where there is none of that name. */
#ifndef ORL_TESTS_SUPPORT_DAEMON_METRIC_H
#define ORL_TESTS_SUPPORT_DAEMON_METRIC_H

#include "support/daemon.h"

/* name: with its labels, if it has any. */
double daemon_metric(struct daemon *daemon, const char *name);

/* Waits until the figure is at least that; fails the running test after two minutes. */
void daemon_metric_wait(struct daemon *daemon, const char *name, double least);

#endif
