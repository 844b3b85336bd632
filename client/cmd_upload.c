/* oriel upload scene FILE... | bsdf FILE */
#include "command.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <oriel/limits.h>

#include "bundle.h"
#include "http.h"
#include "json_get.h"
#include "report.h"

static int upload_scene(struct orl_http *http, char **names, int count, bool list_only,
                        struct orl_error *err)
{
    struct orl_bundle bundle = {0};
    char *id = NULL;
    int rc = orl_bundle_collect(".", (const char *const *)names, (size_t)count, &bundle, err);

    if (rc == 0 && list_only)
        for (size_t i = 0; i < bundle.n_parts; i++)
            printf("%-8s %s\n", bundle.parts[i].resource ? "resource" : "scene",
                   bundle.parts[i].name);
    else if (rc == 0)
        rc = orl_bundle_upload(&bundle, http, &id, err);
    if (id)
        printf("%s\n", id);
    free(id);
    orl_bundle_done(&bundle);
    return rc;
}

static int upload_bsdf(struct orl_http *http, const char *file, struct orl_error *err)
{
    const char *slash = strrchr(file, '/');
    char name[1024], path[1100];
    json_t *reply = NULL;
    int rc = orl_http_escape(slash ? slash + 1 : file, name, sizeof name, err);

    if (rc)
        return rc;
    snprintf(path, sizeof path, "/v1/bsdfs?name=%s", name);
    rc = orl_http_post_file(http, path, file, &reply, err);
    if (rc == 0)
        printf("%s\n", orl_json_text(reply, "id"));
    json_decref(reply);
    return rc;
}

int orl_cmd_upload(const struct orl_command *self, int argc, char **argv)
{
    const char *server = NULL;
    bool list_only = false;
    const struct orl_option options[] = {
        ORL_OPTION_SERVER(&server),
        {.name = "list",
         .help = "only say which files a scene's upload would carry",
         .flag = &list_only},
    };
    struct orl_operands operands;
    struct orl_http http = {0};
    struct orl_error err = {0};
    bool scene, bsdf;
    int rc;

    if (!orl_options_parse(self, argc, argv, options, 2, 2, (int)ORL_LIMIT_SCENE_FILES, &operands,
                           &rc))
        return rc;
    scene = strcmp(operands.items[0], "scene") == 0;
    bsdf = strcmp(operands.items[0], "bsdf") == 0;
    if (!scene && !bsdf)
        return orl_usage_error(self, "\"%s\" is neither scene nor bsdf", operands.items[0]);
    if (bsdf && (operands.count > 2 || list_only))
        return orl_usage_error(self, "bsdf takes one file, and no --list");
    rc = orl_http_open(&http, server, &err);
    if (rc == 0)
        rc = scene ? upload_scene(&http, operands.items + 1, operands.count - 1, list_only, &err)
                   : upload_bsdf(&http, operands.items[1], &err);
    orl_http_close(&http);
    return rc ? orl_report_error(&err) : ORL_EXIT_OK;
}
