#include "log.h"

#include <stdarg.h>
#include <string.h>

#include "times.h"

static const char *const level_names[] = {"debug", "info", "warn", "error"};

int orl_log_level_from_name(const char *name, enum orl_log_level *ret_level)
{
    for (int i = 0; i <= ORL_LOG_ERROR; i++)
        if (strcmp(level_names[i], name) == 0) {
            *ret_level = (enum orl_log_level)i;
            return 0;
        }
    return -1;
}

/* Appends to a line under way; what does not fit is dropped. */
struct line {
    char text[2048];
    size_t used;
};

static void put(struct line *line, const char *text)
{
    for (; *text && line->used + 2 < sizeof line->text; text++)
        line->text[line->used++] = *text;
    line->text[line->used] = '\0';
}

static void put_value(struct line *line, const char *value)
{
    const int quoted = *value == '\0' || strpbrk(value, " \"=\\\t\r\n") != NULL;
    if (quoted)
        put(line, "\"");
    for (; *value; value++) {
        const char c[3] = {*value, '\0', '\0'};
        if (*value == '"' || *value == '\\')
            put(line, "\\");
        put(line, (unsigned char)*value < 32 || *value == 127 ? "?" : c);
    }
    if (quoted)
        put(line, "\"");
}

void orl_log_event(const struct orl_log *log, enum orl_log_level level, const char *event,
                   const char *fields, ...)
{
    struct line line = {.used = 0};
    char number[64], now[ORL_TIME_TEXT];
    if (!log->stream || level < log->level)
        return;
    orl_time_format(orl_time_now_ms(), now);
    put(&line, "time=");
    put(&line, now);
    put(&line, " level=");
    put(&line, level_names[level]);
    put(&line, " event=");
    put_value(&line, event);
    va_list args;
    va_start(args, fields);
    for (; *fields; fields++) {
        put(&line, " ");
        put(&line, va_arg(args, const char *));
        put(&line, "=");
        if (*fields == 's') {
            const char *text = va_arg(args, const char *);
            put_value(&line, text ? text : "-");
            continue;
        }
        if (*fields == 'i')
            snprintf(number, sizeof number, "%lld", (long long)va_arg(args, int64_t));
        else
            snprintf(number, sizeof number, "%.3f", va_arg(args, double));
        put(&line, number);
    }
    va_end(args);
    line.text[line.used++] = '\n';
    fwrite(line.text, 1, line.used, log->stream);
    fflush(log->stream);
}
