/* Reads one value of a daemon's metrics. Fails the running test if no metric has that name. */
#ifndef ORL_TESTS_SUPPORT_DAEMON_METRIC_H
#define ORL_TESTS_SUPPORT_DAEMON_METRIC_H

#include "support/daemon.h"

/* name: includes the labels, if any. */
double daemon_metric(struct daemon *daemon, const char *name);

/* Waits until the value is at least `least`; fails the running test after two minutes. */
void daemon_metric_wait(struct daemon *daemon, const char *name, double least);

#endif
