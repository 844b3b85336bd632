/*
 * Clocks: wall time in milliseconds since 1970 for records, a steady clock for durations.
 */
#ifndef ORL_SERVER_PROCESS_TIMES_H
#define ORL_SERVER_PROCESS_TIMES_H

#include <stdint.h>

int64_t orl_time_now_ms(void);
double orl_time_steady_s(void);
int64_t orl_time_steady_ms(void);

enum { ORL_TIME_TEXT = 32 };
/* "2024-03-22T11:30:00.123Z" */
void orl_time_format(int64_t ms, char ret_text[ORL_TIME_TEXT]);

#endif
