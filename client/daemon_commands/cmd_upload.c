/* Commands for the files that a daemon stores: oriel upload scene|bsdf FILE... uploads a scene or a
 * BSDF, oriel list scenes|bsdfs prints the uploads as a table, oriel remove job|scene|bsdf ID...
 * removes jobs or uploads. */
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <oriel/base/limits.h>
#include <sys/stat.h>

#include "daemon_commands/follow_job.h"
#include "distributed/atomic_files.h"
#include "http/http_client.h"
#include "http/json_get.h"
#include "http/upload_bundle.h"
#include "input/input_folders.h"
#include "options/command.h"
#include "output/reports.h"
#include "output/terminal.h"

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
    if (count > 0)
        return upload_files(http, folder, names, (size_t)count, list_only, err);
    int rc = orl_bundle_main_files(folder, &found, &n_found, err);
    if (rc == 0 && n_found == 0) {
        rc = orl_error_set(err, ORL_ERR_NOT_FOUND, "contains no .rad file");
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
        printf("%s\n", orl_get_text(reply, "id"));
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
            rc = orl_error_set(err, ORL_ERR_LIMIT, "too many main files are given");
    }
    return rc ? rc : post_and_print(http, path, file, "application/zip", err);
}

static int upload_scene(struct orl_http *http, char **names, int count, bool list_only,
                        struct orl_error *err)
{
    if (orl_is_folder(names[0]))
        return upload_folder(http, names[0], names + 1, count - 1, list_only, err);
    const bool model = orl_name_has_ending(names[0], ".hbjson");
    if (!model && !orl_name_has_ending(names[0], ".zip"))
        return upload_files(http, ".", names, (size_t)count, list_only, err);
    if (list_only)
        return orl_error_set(
            err, ORL_ERR_INVALID,
            "--list does not work for a zip or a Honeybee model, which are sent unchanged");
    if (model && count > 1)
        return orl_error_set(err, ORL_ERR_INVALID, "a Honeybee model takes no further files");
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
    struct orl_daemon_command daemon = {0};
    bool list_only = false;
    const struct orl_option options[] = {
        ORL_OPTION_SERVER(&daemon.server),
        {"list", 0, NULL, "only list the files that the upload of a scene would contain", NULL,
         &list_only},
    };
    bool scene, bsdf;
    int rc;
    if (!orl_options_parse(self, argc, argv, options, 2, 2, (int)ORL_LIMIT_SCENE_FILES,
                           &daemon.operands, &rc))
        return rc;
    scene = strcmp(daemon.operands.items[0], "scene") == 0;
    bsdf = strcmp(daemon.operands.items[0], "bsdf") == 0;
    if (!scene && !bsdf)
        return orl_usage_error(self, "\"%s\" is neither scene nor bsdf", daemon.operands.items[0]);
    if (bsdf && (daemon.operands.count > 2 || list_only))
        return orl_usage_error(self, "bsdf takes one file, and no --list");
    rc = orl_daemon_open(&daemon);
    if (rc == 0)
        rc = scene ? upload_scene(&daemon.http, daemon.operands.items + 1,
                                  daemon.operands.count - 1, list_only, &daemon.err)
                   : upload_bsdf(&daemon.http, daemon.operands.items[1], &daemon.err);
    return orl_daemon_end(&daemon, rc);
}

/* ---- oriel list ------------------------------------------------------------------------------ */

static void print_scenes(const json_t *scenes)
{
    const json_t *scene;
    size_t i;
    printf("%-64s  %10s  %5s  %9s  %s\n", "scene", "size", "jobs", "under way", "last used (UTC)");
    json_array_foreach(scenes, i, scene)
    {
        char size[32];
        orl_format_amount(orl_get_number(scene, "bytes", 0), "B", size, sizeof size);
        printf("%-64s  %10s  %5.0f  %9.0f  %.19s\n", orl_get_text(scene, "id"), size,
               orl_get_number(scene, "jobs", 0), orl_get_number(scene, "jobs_under_way", 0),
               orl_get_text(scene, "last_used"));
    }
}

static void print_bsdfs(const json_t *bsdfs)
{
    const json_t *bsdf;
    size_t i;
    printf("%-64s  %10s  %6s  %s\n", "BSDF", "size", "scenes", "name");
    json_array_foreach(bsdfs, i, bsdf)
    {
        char size[32];
        orl_format_amount(orl_get_number(bsdf, "bytes", 0), "B", size, sizeof size);
        printf("%-64s  %10s  %6zu  %s\n", orl_get_text(bsdf, "id"), size,
               json_array_size(json_object_get(bsdf, "scenes")), orl_get_text(bsdf, "name"));
    }
}

/* Prints all pages of the list. */
static int print_all(struct orl_http *http, const char *what, void (*print)(const json_t *items),
                     struct orl_error *err)
{
    char path[600];
    json_t *all = json_array();
    int rc = all ? 0 : orl_error_no_memory(err);
    snprintf(path, sizeof path, "/v1/%s?limit=1000", what);
    while (rc == 0 && *path) {
        json_t *reply = NULL;
        rc = orl_http_call(http, "GET", path, &reply, err);
        if (rc == 0 && json_array_extend(all, json_object_get(reply, what)))
            rc = orl_error_set(err, ORL_ERR_SYNTAX, "the daemon's reply lists no %s", what);
        orl_http_next_page(http, path, sizeof path);
        json_decref(reply);
    }
    if (rc == 0)
        print(all);
    json_decref(all);
    return rc;
}

int orl_cmd_list(const struct orl_subcommand *self, int argc, char **argv)
{
    struct orl_daemon_command daemon = {0};
    static const struct {
        const char *name;
        void (*print)(const json_t *items);
    } kinds[] = {{"scenes", print_scenes}, {"bsdfs", print_bsdfs}};
    const struct orl_option options[] = {ORL_OPTION_SERVER(&daemon.server)};
    size_t kind = 0;
    int rc;
    if (!orl_options_parse(self, argc, argv, options, 1, 1, 1, &daemon.operands, &rc))
        return rc;
    while (kind < 2 && strcmp(kinds[kind].name, daemon.operands.items[0]) != 0)
        kind++;
    if (kind == 2)
        return orl_usage_error(self, "only scenes or bsdfs can be listed, not \"%s\"",
                               daemon.operands.items[0]);
    rc = orl_daemon_open(&daemon);
    if (rc == 0)
        rc = print_all(&daemon.http, kinds[kind].name, kinds[kind].print, &daemon.err);
    return orl_daemon_end(&daemon, rc);
}

/* ---- oriel remove ---------------------------------------------------------------------------- */

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
    snprintf(path, sizeof path, "/v1/jobs/%.40s", begun);
    int rc = orl_http_call(http, "GET", path, &job, err);
    if (rc == 0)
        snprintf(ret_id, 64, "%.63s", orl_get_text(job, "id"));
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
    struct orl_daemon_command daemon = {0};
    const char *folder;
    const struct orl_option options[] = {ORL_OPTION_SERVER(&daemon.server)};
    int rc;
    if (!orl_options_parse(self, argc, argv, options, 1, 2, (int)ORL_LIMIT_SCENE_FILES,
                           &daemon.operands, &rc))
        return rc;
    folder = folder_of(daemon.operands.items[0]);
    if (!folder)
        return orl_usage_error(self, "\"%s\" is neither job, scene nor bsdf",
                               daemon.operands.items[0]);
    rc = orl_daemon_open(&daemon);
    for (int i = 1; i < daemon.operands.count && rc == 0; i++) {
        rc = remove_one(&daemon.http, folder, daemon.operands.items[i], &daemon.err);
        if (rc == 0)
            fprintf(stderr, "%s %s: removed\n", daemon.operands.items[0], daemon.operands.items[i]);
    }
    return orl_daemon_end(&daemon, rc);
}
