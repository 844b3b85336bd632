#include "json/problem.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "json/encode.h"

/* Maps errors to HTTP statuses; the only such table. */
static const struct {
    int code, status;
    const char *title;
} problems[] = {
    {ORL_ERR_NOMEM, 503, "The server is out of memory"},
    {ORL_ERR_IO, 500, "The server could not read or write a file"},
    {ORL_ERR_FULL, 507, "The disk is full"},
    {ORL_ERR_SYNTAX, 400, "The text does not parse"},
    {ORL_ERR_UNSUPPORTED, 422, "Oriel does not simulate this"},
    {ORL_ERR_RANGE, 422, "A value is out of range"},
    {ORL_ERR_NOT_FOUND, 422, "A file or name that the request refers to is missing"},
    {ORL_ERR_LIMIT, 413, "A limit is exceeded"},
    {ORL_ERR_CORRUPT, 500, "A stored file is damaged"},
    {ORL_ERR_VERSION, 500, "A stored file has another format version"},
    {ORL_ERR_CANCELLED, 409, "The job was cancelled"},
    {ORL_ERR_INVALID, 422, "The request contradicts itself or the format"},
    {ORL_ERR_UNLIT, 422, "No light reaches what the job asks for"},
    {ORL_ERR_INTERNAL, 500, "An internal error"},
};

static size_t find_problem(int code)
{
    size_t last = sizeof problems / sizeof *problems - 1;
    for (size_t i = 0; i < last; i++)
        if (problems[i].code == code)
            return i;
    return last; /* an unknown code is an internal error */
}

int orl_problem_status(int code)
{
    return problems[find_problem(code)].status;
}

static int set_text(json_t *object, const char *key, const char *text)
{
    return *text ? json_object_set_new(object, key, orl_json_from_text(text)) : 0;
}

json_t *orl_problem_from_error(const struct orl_error *err, int *ret_status)
{
    const size_t row = find_problem(err->code);
    char type[64];
    snprintf(type, sizeof type, "urn:oriel:error:%s", orl_err_name(problems[row].code));
    json_t *problem = json_pack("{s:s, s:s, s:i}", "type", type, "title", problems[row].title,
                                "status", problems[row].status);
    if (!problem)
        return NULL;
    int rc = set_text(problem, "detail", err->message);
    rc |= set_text(problem, "file", err->file);
    if (err->line > 0)
        rc |= json_object_set_new(problem, "line", json_integer(err->line));
    rc |= set_text(problem, "primitive", err->primitive);
    rc |= set_text(problem, "hint", err->hint);
    if (rc) {
        json_decref(problem);
        return NULL;
    }
    if (ret_status)
        *ret_status = problems[row].status;
    return problem;
}

json_t *orl_problem_new(int status, const char *type, const char *title, const char *detail, ...)
{
    char text[ORL_ERROR_TEXT_MAX], urn[96];
    va_list args;
    va_start(args, detail);
    vsnprintf(text, sizeof text, detail, args);
    va_end(args);
    snprintf(urn, sizeof urn, "urn:oriel:error:%s", type);
    json_t *problem = json_pack("{s:s, s:s, s:i}", "type", urn, "title", title, "status", status);
    return orl_json_checked(
        problem, problem && json_object_set_new(problem, "detail", orl_json_from_text(text)));
}

static void get_text(const json_t *problem, const char *key, char *ret_text, size_t size)
{
    const char *text = json_string_value(json_object_get(problem, key));
    snprintf(ret_text, size, "%s", text ? text : "");
}

static int code_of_type(const char *type)
{
    static const char prefix[] = "urn:oriel:error:";
    if (strncmp(type, prefix, sizeof prefix - 1) == 0)
        for (size_t i = 0; i < sizeof problems / sizeof *problems; i++)
            if (strcmp(type + sizeof prefix - 1, orl_err_name(problems[i].code)) == 0)
                return problems[i].code;
    return ORL_ERR_INVALID;
}

void orl_problem_to_error(const json_t *problem, struct orl_error *ret_err)
{
    char type[96];
    memset(ret_err, 0, sizeof *ret_err);
    get_text(problem, "type", type, sizeof type);
    ret_err->code = code_of_type(type);
    get_text(problem, "detail", ret_err->message, sizeof ret_err->message);
    if (!ret_err->message[0])
        get_text(problem, "title", ret_err->message, sizeof ret_err->message);
    get_text(problem, "file", ret_err->file, sizeof ret_err->file);
    get_text(problem, "primitive", ret_err->primitive, sizeof ret_err->primitive);
    get_text(problem, "hint", ret_err->hint, sizeof ret_err->hint);
    ret_err->line = (int)json_integer_value(json_object_get(problem, "line"));
}
