/* oriel upload scene FILE... | scene FOLDER | scene FILE.zip | scene MODEL.hbjson | bsdf FILE:
 * uploads a scene or a BSDF. */
#include "options/command.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>

#include <oriel/base/limits.h>

#include "http/http_client.h"
#include "http/json_get.h"
#include "http/scene_digest.h"
#include "http/upload_bundle.h"
#include "output/report_error.h"

static int upload_files(struct orl_http *http, const char *folder, char **names, size_t count,
                        bool list_only, struct orl_error *err)
{
    struct orl_upload bundle = {0};
    char *id = NULL;
    int rc = orl_bundle_collect(folder, (const char *const *)names, count, &bundle, err);

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

/* Uploads a folder. Its main files are those named, or else guessed. */
static int upload_folder(struct orl_http *http, const char *folder, char **names, int count,
                         bool list_only, struct orl_error *err)
{
    char **found = NULL;
    size_t n_found = 0;
    int rc;

    if (count > 0)
        return upload_files(http, folder, names, (size_t)count, list_only, err);
    rc = orl_bundle_main_files(folder, &found, &n_found, err);
    if (rc == 0 && n_found == 0) {
        rc = orl_error_set(err, ORL_ERR_NOT_FOUND, "holds no .rad file");
        orl_error_at(err, folder, 0, NULL);
    }
    if (rc == 0)
        rc = upload_files(http, folder, found, n_found, list_only, err);
    orl_bundle_names_free(found, n_found);
    return rc;
}

static int post_and_print(struct orl_http *http, const char *path, const char *file,
                          const char *type, struct orl_error *err)
{
    json_t *reply = NULL;
    const int rc = orl_http_post_file(http, path, file, type, &reply, err);

    if (rc == 0)
        printf("%s\n", orl_json_text(reply, "id"));
    json_decref(reply);
    return rc;
}

/* Uploads a zip, which the daemon unpacks; main files may be named. */
static int upload_zip(struct orl_http *http, const char *file, char **names, int count,
                      struct orl_error *err)
{
    enum { ROOM = 8192 };
    char path[ROOM] = "/v1/scenes", name[1024];
    size_t length = strlen(path);
    int rc = 0;

    for (int i = 0; i < count && rc == 0; i++) {
        rc = orl_http_escape(names[i], name, sizeof name, err);
        if (rc == 0)
            length +=
                (size_t)snprintf(path + length, ROOM - length, "%smain=%s", i ? "&" : "?", name);
        if (rc == 0 && length >= ROOM)
            rc = orl_error_set(err, ORL_ERR_LIMIT, "too many main files are named");
    }
    return rc ? rc : post_and_print(http, path, file, "application/zip", err);
}

static bool is_folder(const char *path)
{
    struct stat info;

    return stat(path, &info) == 0 && S_ISDIR(info.st_mode);
}

static bool ends_with(const char *path, const char *ending)
{
    const size_t length = strlen(path), tail = strlen(ending);

    return length > tail && strcasecmp(path + length - tail, ending) == 0;
}

static int upload_scene(struct orl_http *http, char **names, int count, bool list_only,
                        struct orl_error *err)
{
    if (is_folder(names[0]))
        return upload_folder(http, names[0], names + 1, count - 1, list_only, err);
    const bool model = ends_with(names[0], ".hbjson");
    if (!model && !ends_with(names[0], ".zip"))
        return upload_files(http, ".", names, (size_t)count, list_only, err);
    if (list_only)
        return orl_error_set(err, ORL_ERR_INVALID, "what travels as it is is not listed");
    if (model && count > 1)
        return orl_error_set(err, ORL_ERR_INVALID, "a Honeybee model has no further files");
    if (model)
        return post_and_print(http, "/v1/scenes", names[0], "application/json", err);
    return upload_zip(http, names[0], names + 1, count - 1, err);
}

static int upload_bsdf(struct orl_http *http, const char *file, struct orl_error *err)
{
    const char *slash = strrchr(file, '/');
    char name[1024], path[1100], id[ORL_DIGEST_TEXT] = "";
    bool known = false;
    int rc = orl_http_escape(slash ? slash + 1 : file, name, sizeof name, err);

    if (rc)
        return rc;
    rc = orl_digest_file(file, id, err);
    snprintf(path, sizeof path, "/v1/bsdfs/%s", id);
    if (rc == 0)
        rc = orl_http_has(http, path, &known, err);
    if (rc)
        return rc;
    if (known) {
        printf("%s\n", id);
        return 0;
    }
    snprintf(path, sizeof path, "/v1/bsdfs?name=%s", name);
    return post_and_print(http, path, file, "application/xml", err);
}

int orl_cmd_upload(const struct orl_subcommand *self, int argc, char **argv)
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
