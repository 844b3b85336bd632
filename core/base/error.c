#include <oriel/base/error.h>

#include <errno.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>

int orl_error_vset(struct orl_error *err, int code, const char *format, va_list args)
{
    if (err) {
        memset(err, 0, sizeof *err);
        err->code = code;
        vsnprintf(err->message, sizeof err->message, format, args);
    }
    return code;
}

int orl_error_set(struct orl_error *err, int code, const char *format, ...)
{
    va_list args;
    va_start(args, format);
    orl_error_vset(err, code, format, args);
    va_end(args);
    return code;
}

int orl_error_no_memory(struct orl_error *err)
{
    return orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
}

void orl_error_at(struct orl_error *err, const char *file, int line, const char *primitive)
{
    if (!err || err->code == ORL_ERR_CANCELLED) /* a cancellation has no place */
        return;
    if (file)
        snprintf(err->file, sizeof err->file, "%s", file);
    if (line > 0)
        err->line = line;
    if (primitive)
        snprintf(err->primitive, sizeof err->primitive, "%s", primitive);
}

void orl_error_hint(struct orl_error *err, const char *format, ...)
{
    va_list args;
    if (!err)
        return;
    va_start(args, format);
    vsnprintf(err->hint, sizeof err->hint, format, args);
    va_end(args);
}

int orl_error_refuse(struct orl_error *err, int code, const char *hint, const char *format, ...)
{
    va_list args;
    va_start(args, format);
    orl_error_vset(err, code, format, args);
    va_end(args);
    orl_error_hint(err, "%s", hint);
    return code;
}

int orl_err_of_errno(int why)
{
    if (why == ENOMEM)
        return ORL_ERR_NOMEM;
    return why == ENOSPC || why == EDQUOT ? ORL_ERR_FULL : ORL_ERR_IO;
}

const char *orl_err_name(int code)
{
    static const char *const names[] = {
        "ok",           "no-memory", "io",       "syntax",    "unsupported",
        "out-of-range", "not-found", "limit",    "corrupt",   "version",
        "cancelled",    "invalid",   "internal", "disk-full", "unlit",
    };
    const int index = -code;
    return index >= 0 && index < (int)(sizeof names / sizeof *names) ? names[index] : "unknown";
}

/* Returns true if the message already begins with the path, as errors in JSON documents do. */
static bool begins_with_place(const struct orl_error *err)
{
    const unsigned long length = strlen(err->primitive);
    return strncmp(err->message, err->primitive, length) == 0 && err->message[length] == ':';
}

void orl_error_format(const struct orl_error *err, char *ret_text, unsigned long size)
{
    const bool has_primitive = err->primitive[0] && !begins_with_place(err);
    char line[32] = "";
    if (err->line > 0)
        snprintf(line, sizeof line, ":%d", err->line);
    snprintf(ret_text, size, "%s%s%s%s%s%s%s%s%s", err->file, err->file[0] ? line : "",
             err->file[0] ? ": " : "", has_primitive ? err->primitive : "",
             has_primitive ? ": " : "", err->message, err->hint[0] ? " (" : "", err->hint,
             err->hint[0] ? ")" : "");
}
