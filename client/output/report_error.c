#include "output/report_error.h"

#include <stdio.h>
#include <string.h>

#include "options/command.h"
#include "json/problem.h"

int orl_report_reply_to_error(const char *body, size_t size, long status, struct orl_error *err)
{
    json_t *problem = size ? json_loadb(body, size, 0, NULL) : NULL;
    struct orl_error found = {0};

    if (json_is_object(problem))
        orl_problem_to_error(problem, &found);
    json_decref(problem);
    if (!found.message[0])
        return orl_error_set(err, status == 404 ? ORL_ERR_NOT_FOUND : ORL_ERR_INVALID,
                             "the daemon answered %ld and gave no reason", status);
    if (err)
        *err = found;
    return found.code;
}

int orl_report_error(const struct orl_error *err)
{
    char text[2 * ORL_ERROR_TEXT_MAX + 2 * ORL_ERROR_NAME_MAX + 64];

    orl_error_format(err, text, sizeof text);
    /* The line starts with the file, as compilers do, or else with the program's name. */
    fprintf(stderr, "%s%s\n", err->file[0] ? "" : "oriel: ", text);
    return ORL_EXIT_FAILED;
}

void orl_report_job_error(const json_t *job)
{
    const json_t *problem = json_object_get(job, "error");
    struct orl_error err;

    if (!json_is_object(problem))
        return;
    orl_problem_to_error(problem, &err);
    orl_report_error(&err);
}
