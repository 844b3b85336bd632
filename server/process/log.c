#include "process/log.h"

#include <jansson.h>
#include <math.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "process/times.h"
#include "json/encode.h"

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

/* ---- Foreign text --------------------------------------------------------------------------- */

/* Returns the next character of UTF-8 text and advances. For an invalid byte, returns 0 and skips
 * that byte. */
static uint32_t next_character(const char **at)
{
    static const uint32_t least[] = {0, 0, 0x80, 0x800, 0x10000};
    const unsigned char *bytes = (const unsigned char *)*at;
    const size_t length = bytes[0] < 0x80   ? 1
                          : bytes[0] < 0xc0 ? 0
                          : bytes[0] < 0xe0 ? 2
                          : bytes[0] < 0xf0 ? 3
                          : bytes[0] < 0xf8 ? 4
                                            : 0;
    uint32_t code = length > 1 ? bytes[0] & (0x7fU >> length) : bytes[0];
    size_t i = 1;
    for (; i < length && (bytes[i] & 0xc0) == 0x80; i++)
        code = code << 6 | (bytes[i] & 0x3f);
    const bool good = length > 0 && i == length && code >= least[length] && code <= 0x10ffff &&
                      !(code >= 0xd800 && code <= 0xdfff);
    *at += good ? length : 1;
    return good ? code : 0;
}

/* Returns true for characters that can move a terminal's cursor, or the text around it: controls of
 * both sets (C0, C1), line and paragraph separators, and direction marks. */
static bool is_control(uint32_t code)
{
    return code < 0x20 || (code >= 0x7f && code < 0xa0) || (code >= 0x200e && code <= 0x200f) ||
           (code >= 0x2028 && code <= 0x202e) || (code >= 0x2066 && code <= 0x2069);
}

/* Replaces each such character, and each byte that is not UTF-8, by '?'. The text does not get
 * longer. */
static void clean_text(char *text)
{
    const char *from = text;
    char *to = text;
    while (*from) {
        const char *start = from;
        if (is_control(next_character(&from))) {
            *to++ = '?';
            continue;
        }
        while (start < from)
            *to++ = *start++;
    }
    *to = '\0';
}

/* ---- Lines ---------------------------------------------------------------------------------- */

/* A line being written; text that does not fit is dropped. */
struct line {
    char text[2048];
    size_t used;
};

static void append_text(struct line *line, const char *text)
{
    for (; *text && line->used + 2 < sizeof line->text; text++)
        line->text[line->used++] = *text;
    line->text[line->used] = '\0';
}

static void put_value(struct line *line, const char *value)
{
    const int quoted = *value == '\0' || strpbrk(value, " \"=\\\t\r\n") != NULL;
    if (quoted)
        append_text(line, "\"");
    for (; *value; value++) {
        const char c[3] = {*value, '\0', '\0'};
        if (*value == '"' || *value == '\\')
            append_text(line, "\\");
        append_text(line, c);
    }
    if (quoted)
        append_text(line, "\"");
}

static void write_pairs(const struct orl_log *log, const char *now, const char *level,
                        const char *event, const char *fields, va_list args)
{
    struct line line = {.used = 0};
    char number[64];
    append_text(&line, "time=");
    append_text(&line, now);
    append_text(&line, " level=");
    append_text(&line, level);
    append_text(&line, " event=");
    put_value(&line, event);
    for (; *fields; fields++) {
        append_text(&line, " ");
        append_text(&line, va_arg(args, const char *));
        append_text(&line, "=");
        if (*fields == 's') {
            const char *text = va_arg(args, const char *);
            char *own = text ? strdup(text) : NULL;
            if (own)
                clean_text(own);
            put_value(&line, own ? own : "-");
            free(own);
            continue;
        }
        if (*fields == 'i')
            snprintf(number, sizeof number, "%lld", (long long)va_arg(args, int64_t));
        else
            snprintf(number, sizeof number, "%.3f", va_arg(args, double));
        append_text(&line, number);
    }
    line.text[line.used++] = '\n';
    fwrite(line.text, 1, line.used, log->stream);
}

static json_t *text_to_json(const char *text)
{
    char *own = text ? strdup(text) : NULL;
    if (own)
        clean_text(own);
    json_t *value = json_string(own ? own : "-");
    free(own);
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
    char *text = orl_json_text(doc, JSON_COMPACT | JSON_REAL_PRECISION(12));
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
