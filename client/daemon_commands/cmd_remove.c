/* oriel remove job|scene|bsdf ID...: removes jobs or uploads. */
#include "options/command.h"

#include <stdbool.h>
#include <stdio.h>
#include <string.h>

#include <oriel/base/limits.h>

#include "http/http_client.h"
#include "http/json_get.h"
#include "output/report_error.h"

/* Returns the API path of a kind, such as "/v1/jobs" for "job", or NULL for others. */
static const char *folder_of(const char *what)
{
    static const struct {
        const char *what, *folder;
    } kinds[] = {{"job", "/v1/jobs"}, {"scene", "/v1/scenes"}, {"bsdf", "/v1/bsdfs"}};

    for (size_t i = 0; i < sizeof kinds / sizeof kinds[0]; i++)
        if (strcmp(kinds[i].what, what) == 0)
            return kinds[i].folder;
    return NULL;
}

/* Returns true if id may be an abbreviated job id. A daemon removes jobs only by whole ids. */
static bool is_begun(const char *id)
{
    const size_t length = strlen(id);

    return length >= 4 && length < 32 && strspn(id, "0123456789abcdef") == length;
}

/* Looks up the whole id of the job. */
static int complete_id(struct orl_http *http, const char *begun, char ret_id[64],
                       struct orl_error *err)
{
    char path[64];
    json_t *job = NULL;
    int rc;

    snprintf(path, sizeof path, "/v1/jobs/%.40s", begun);
    rc = orl_http_call(http, "GET", path, &job, err);
    if (rc == 0)
        snprintf(ret_id, 64, "%.63s", orl_json_text(job, "id"));
    json_decref(job);
    return rc;
}

static int remove_one(struct orl_http *http, const char *folder, const char *id,
                      struct orl_error *err)
{
    char escaped[512], path[600], whole[64];
    const bool begun = strcmp(folder, "/v1/jobs") == 0 && is_begun(id);
    int rc = begun ? complete_id(http, id, whole, err) : 0;

    if (rc == 0)
        rc = orl_http_escape(begun ? whole : id, escaped, sizeof escaped, err);
    if (rc)
        return rc;
    snprintf(path, sizeof path, "%s/%s", folder, escaped);
    rc = orl_http_call(http, "DELETE", path, NULL, err);
    if (rc)
        orl_error_at(err, NULL, 0, id);
    return rc;
}

int orl_cmd_remove(const struct orl_subcommand *self, int argc, char **argv)
{
    const char *server = NULL, *folder;
    const struct orl_option options[] = {ORL_OPTION_SERVER(&server)};
    struct orl_operands operands;
    struct orl_http http = {0};
    struct orl_error err = {0};
    int rc;

    if (!orl_options_parse(self, argc, argv, options, 1, 2, (int)ORL_LIMIT_SCENE_FILES, &operands,
                           &rc))
        return rc;
    folder = folder_of(operands.items[0]);
    if (!folder)
        return orl_usage_error(self, "\"%s\" is neither job, scene nor bsdf", operands.items[0]);
    rc = orl_http_open(&http, server, &err);
    for (int i = 1; i < operands.count && rc == 0; i++) {
        rc = remove_one(&http, folder, operands.items[i], &err);
        if (rc == 0)
            fprintf(stderr, "%s %s: removed\n", operands.items[0], operands.items[i]);
    }
    orl_http_close(&http);
    return rc ? orl_report_error(&err) : ORL_EXIT_OK;
}
