#include "log.h"

#include <jansson.h>
#include <math.h>
#include <stdarg.h>
#include <stdlib.h>
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

static void write_pairs(const struct orl_log *log, const char *now, const char *level,
                        const char *event, const char *fields, va_list args)
{
    struct line line = {.used = 0};
    char number[64];
    put(&line, "time=");
    put(&line, now);
    put(&line, " level=");
    put(&line, level);
    put(&line, " event=");
    put_value(&line, event);
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
    line.text[line.used++] = '\n';
    fwrite(line.text, 1, line.used, log->stream);
}

/* Bytes that are no UTF-8 become question marks. */
static json_t *text_to_json(const char *text)
{
    json_t *value = json_string(text ? text : "-");
    if (value || !text)
        return value;
    char *clean = strdup(text);
    for (char *c = clean; c && *c; c++)
        if (*c & 0x80)
            *c = '?';
    value = clean ? json_string(clean) : NULL;
    free(clean);
    return value;
}

static void write_object(const struct orl_log *log, const char *now, const char *level,
                         const char *event, const char *fields, va_list args)
{
    json_t *doc = json_pack("{s:s, s:s, s:s}", "time", now, "level", level, "event", event);
    for (; *fields; fields++) {
        const char *key = va_arg(args, const char *);
        json_t *value = NULL;
        if (*fields == 's')
            value = text_to_json(va_arg(args, const char *));
        else if (*fields == 'i')
            value = json_integer((json_int_t)va_arg(args, int64_t));
        else
            value = json_real(round(1000 * va_arg(args, double)) / 1000);
        json_object_set_new(doc, key, value);
    }
    char *text = doc ? json_dumps(doc, JSON_COMPACT | JSON_REAL_PRECISION(12)) : NULL;
    if (text)
        fprintf(log->stream, "%s\n", text);
    free(text);
    json_decref(doc);
}

void orl_log_event(const struct orl_log *log, enum orl_log_level level, const char *event,
                   const char *fields, ...)
{
    char now[ORL_TIME_TEXT];
    va_list args;
    if (!log->stream || level < log->level)
        return;
    orl_time_format(orl_time_now_ms(), now);
    va_start(args, fields);
    (log->json ? write_object : write_pairs)(log, now, level_names[level], event, fields, args);
    va_end(args);
    if (level >= ORL_LOG_WARN)
        fflush(log->stream);
}

void orl_log_flush(const struct orl_log *log)
{
    if (log->stream)
        fflush(log->stream);
}
