/*
 * Waits for a condition, limited by the clock. A number of polls would be no limit in time: naps
 * and polls take longer on a busy machine and shorter on a fast one. Use: for (double until =
 * patience_until(); !holds() && patience_nap(until);) continue; assert_true(holds());
 */
#ifndef ORL_TESTS_SUPPORT_PATIENCE_H
#define ORL_TESTS_SUPPORT_PATIENCE_H

#include <stdbool.h>
#include <time.h>

#include "process/limits.h"

static inline double patience_now_s(void)
{
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

/* Returns the time in seconds at which a wait that starts now fails: in two minutes, or in ten
 * under a sanitizer, which slows programs by a factor of ten and more. */
static inline double patience_until(void)
{
    return patience_now_s() + (ORL_SANITIZED ? 600 : 120);
}

/* Naps for 5 ms; returns false at once if that time has passed. */
static inline bool patience_nap(double until_s)
{
    if (patience_now_s() > until_s)
        return false;
    nanosleep(&(struct timespec){.tv_nsec = 5000000}, NULL);
    return true;
}

#endif
