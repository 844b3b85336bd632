#include "process/times.h"

#include <stdio.h>
#include <time.h>

int64_t orl_time_now_ms(void)
{
    struct timespec now;
    clock_gettime(CLOCK_REALTIME, &now);
    return (int64_t)now.tv_sec * 1000 + now.tv_nsec / 1000000;
}

double orl_time_steady_s(void)
{
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

int64_t orl_time_steady_ms(void)
{
    return (int64_t)(1000 * orl_time_steady_s());
}

void orl_time_format(int64_t ms, char ret_text[ORL_TIME_TEXT])
{
    const time_t seconds = (time_t)(ms / 1000);
    struct tm utc;
    char text[24];
    gmtime_r(&seconds, &utc);
    strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%S", &utc);
    snprintf(ret_text, ORL_TIME_TEXT, "%s.%03dZ", text, (int)(ms % 1000));
}
