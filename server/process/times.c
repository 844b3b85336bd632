#include "process/times.h"

#include <stdio.h>
#include <string.h>
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

double orl_time_steady_for(void *ctx)
{
    (void)ctx;
    return orl_time_steady_s();
}

int64_t orl_time_steady_ms(void)
{
    return (int64_t)(1000 * orl_time_steady_s());
}

void orl_time_format(int64_t ms, char ret_text[ORL_TIME_TEXT])
{
    const int64_t first_ms = -62167219200000, last_ms = 253402300799999; /* years of four digits */
    if (ms < first_ms)
        ms = first_ms;
    if (ms > last_ms)
        ms = last_ms;
    const int fraction = (int)((ms % 1000 + 1000) % 1000);
    const time_t seconds = (time_t)((ms - fraction) / 1000);
    struct tm utc = {0};
    gmtime_r(&seconds, &utc);
    snprintf(ret_text, ORL_TIME_TEXT, "%04d-%02d-%02dT%02d:%02d:%02d.%03dZ",
             (utc.tm_year + 1900) % 10000, (utc.tm_mon + 1) % 100, utc.tm_mday % 100,
             utc.tm_hour % 100, utc.tm_min % 100, utc.tm_sec % 100, fraction);
}

/* Returns true if text begins like the pattern, with any digit in place of each 0. *ret_rest is the
 * text after it. */
static bool is_like(const char *text, const char *pattern, const char **ret_rest)
{
    for (; *pattern; pattern++, text++)
        if (*pattern == '0' ? *text < '0' || *text > '9' : *text != *pattern)
            return false;
    *ret_rest = text;
    return true;
}

bool orl_time_parse(const char *text, int64_t *ret_ms)
{
    const char *rest = NULL;
    struct tm utc = {0};
    int fraction = 0;
    if (!is_like(text, "0000-00-00T00:00:00", &rest) ||
        strptime(text, "%Y-%m-%dT%H:%M:%S", &utc) != rest)
        return false;
    if (*rest == '.') {
        int scale = 100;
        for (rest++; *rest >= '0' && *rest <= '9'; rest++, scale /= 10)
            fraction += scale * (*rest - '0');
    }
    const struct tm given = utc;
    const int64_t seconds = timegm(&utc); /* makes the 30th of February March: compared below */
    *ret_ms = 1000 * seconds + fraction;
    return strcmp(rest, "Z") == 0 && seconds >= 0 && utc.tm_mon == given.tm_mon &&
           utc.tm_mday == given.tm_mday && given.tm_sec < 60;
}
