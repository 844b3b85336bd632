/*
 * The log: one line of key=value pairs per event on stderr.
 *
 *     time=2024-03-22T11:30:00.123Z level=info event=request id=12 method=GET status=200 ms=0.4
 *
 * or, when json is set, an object with these members:
 *
 *     {"time":"2024-03-22T11:30:00.123Z","level":"info","event":"request","id":12,...}
 *
 * Values with spaces or quotes are quoted. Control characters (including C1, and those that change
 * the direction of text) and bytes that are not UTF-8 become question marks. So text from a client
 * can neither start a second line nor move a terminal's cursor. Events about a request have its id,
 * and those about a job its id as job; the request that submits a job has both. Threads: the loop
 * thread only.
 */
#ifndef ORL_SERVER_PROCESS_LOG_H
#define ORL_SERVER_PROCESS_LOG_H

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

enum orl_log_level { ORL_LOG_DEBUG, ORL_LOG_INFO, ORL_LOG_WARN, ORL_LOG_ERROR };

struct orl_log {
    FILE *stream; /* NULL: silent */
    enum orl_log_level level;
    bool json;
};

/*
 * Logs an event. fields has one letter for each value: 's' const char * (NULL prints "-"), 'i'
 * int64_t, 'd' double with three decimals. Each value follows its key.
 *     orl_log_event(log, ORL_LOG_INFO, "request", "is", "id", (int64_t)12, "path", path);
 */
void orl_log_event(const struct orl_log *log, enum orl_log_level level, const char *event,
                   const char *fields, ...);

/* Writes out buffered lines; events of level warn and above are written out at once. */
void orl_log_flush(const struct orl_log *log);

/* Returns 0 and *ret_level for "debug", "info", "warn" or "error"; -1 otherwise. */
int orl_log_level_from_name(const char *name, enum orl_log_level *ret_level);

#endif
