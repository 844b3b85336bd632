/*
 * Clocks: wall time in milliseconds since 1970 for records, a monotonic ("steady") clock for
 * durations.
 */
#ifndef ORL_SERVER_PROCESS_TIMES_H
#define ORL_SERVER_PROCESS_TIMES_H

#include <stdbool.h>
#include <stdint.h>

int64_t orl_time_now_ms(void);
double orl_time_steady_s(void);
/* Returns the same time, as a callback. */
double orl_time_steady_for(void *ctx);
int64_t orl_time_steady_ms(void);

enum { ORL_TIME_TEXT = 32 };
/* Writes "2024-03-22T11:30:00.123Z", for the years 0000 to 9999; other times are clamped. */
void orl_time_format(int64_t ms, char ret_text[ORL_TIME_TEXT]);
/* Reads such a time, with or without its fraction, in UTC ("Z"), from 1970 to 9999. Returns false
 * if it is invalid. */
bool orl_time_parse(const char *text, int64_t *ret_ms);

#endif
