/*
 * The log: one line of key=value pairs per event on stderr.
 *
 *     time=2024-03-22T11:30:00.123Z level=info event=request id=12 method=GET status=200 ms=0.4
 *
 * or, when json is set, an object with the same members:
 *
 *     {"time":"2024-03-22T11:30:00.123Z","level":"info","event":"request","id":12,...}
 *
 * Values with spaces or quotes are quoted; control characters, those of C1 and those that turn the
 * direction of text among them, and bytes that are no UTF-8 become question marks: what a client
 * sends can make no second line, and move no terminal's cursor. Events about a request have its id,
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
 * fields: one letter a value, each preceded by its key, ends the list by ending: 's' const char *
 * (NULL prints "-"), 'i' int64_t, 'd' double with three decimals.
 *     orl_log_event(log, ORL_LOG_INFO, "request", "is", "id", (int64_t)12, "path", path);
 */
void orl_log_event(const struct orl_log *log, enum orl_log_level level, const char *event,
                   const char *fields, ...);

/* Writes out what is gathered in the stream; an event from a warning on does so by itself. */
void orl_log_flush(const struct orl_log *log);

/* 0 and *ret_level for "debug", "info", "warn" or "error"; -1 otherwise. */
int orl_log_level_from_name(const char *name, enum orl_log_level *ret_level);

#endif
