/* oriel fetch ID -o DIR: downloads result.json and the other files of a job, study or year.
 * oriel link ID FILE...: prints temporary addresses of result files that need no token. */
#include <stdio.h>
#include <string.h>

#include "daemon_commands/follow_job.h"
#include "distributed/atomic_files.h"
#include "http/http_client.h"
#include "http/json_get.h"
#include "options/command.h"
#include "output/reports.h"
#include "json/problem.h"

static const char result_name[] = "result.json";

/* Returns true if no part of the name is empty or begins with '.': a name from the network must
 * stay inside the folder. */
static bool is_plain_name(const char *name)
{
    for (const char *part = name;; part += strcspn(part, "/") + 1) {
        if (*part == '\0' || *part == '.' || *part == '/')
            return false;
        if (!strchr(part, '/'))
            return true;
    }
}

/* Creates the folders of the file's path. */
static int make_folders(const char *file, struct orl_error *err)
{
    char folder[4096];
    snprintf(folder, sizeof folder, "%.*s", (int)(strrchr(file, '/') - file), file);
    return orl_make_folder(folder, err);
}

static int fetch_file(struct orl_http *http, const char *id, const char *name, const char *folder,
                      struct orl_error *err)
{
    char escaped[1024], rest[1100], path[2048], file[4096];
    if (!is_plain_name(name))
        return orl_error_set(err, ORL_ERR_INVALID,
                             "the daemon lists a file \"%.100s\" outside the output folder", name);
    int rc = orl_http_escape(name, escaped, sizeof escaped, err);
    if (rc)
        return rc;
    snprintf(rest, sizeof rest, "/files/%s", escaped);
    rc = orl_job_path(id, rest, path, sizeof path, err);
    if (rc == 0)
        rc = orl_join_path(folder, name, file, sizeof file, err);
    if (rc == 0 && strchr(name, '/'))
        rc = make_folders(file, err);
    if (rc == 0)
        rc = orl_http_download(http, path, file, err);
    if (rc == 0)
        printf("%s\n", file);
    return rc;
}

static int fetch_result(struct orl_http *http, const char *id, const char *folder,
                        struct orl_error *err)
{
    char path[1024], file[4096];
    int rc = orl_job_path(id, "/result", path, sizeof path, err);
    if (rc == 0)
        rc = orl_join_path(folder, result_name, file, sizeof file, err);
    if (rc == 0)
        rc = orl_http_download(http, path, file, err);
    if (rc == 0)
        printf("%s\n", file);
    return rc;
}

/* Sets err to the reason why an ended job has no result, from its document, with a hint. */
static int explain_absence(const json_t *job, const char *id, struct orl_error *err)
{
    const json_t *problem = json_object_get(job, "error");
    struct orl_error why = {.code = ORL_ERR_INVALID};
    if (json_is_object(problem))
        orl_problem_to_error(problem, &why);
    *err = why;
    if (strcmp(orl_get_text(job, "state"), "cancelled") == 0)
        snprintf(err->message, sizeof err->message, "the job was cancelled");
    else
        snprintf(err->message, sizeof err->message, "the job failed%s%.480s",
                 why.message[0] ? ": " : "", why.message);
    orl_error_hint(err, "%.400s%ssee `oriel status %.64s`", why.hint, why.hint[0] ? "; " : "", id);
    return err->code;
}

/* Fetches all files that the job's document lists. If it lists none, requesting the result
 * reports the reason. */
static int fetch_all(struct orl_http *http, const char *id, const char *folder,
                     struct orl_error *err)
{
    char path[1024];
    json_t *job = NULL;
    const json_t *entry;
    size_t i;
    int rc = orl_job_path(id, "", path, sizeof path, err);
    if (rc == 0)
        rc = orl_http_call(http, "GET", path, &job, err);
    if (rc)
        return rc;
    json_array_foreach(json_object_get(job, "files"), i, entry)
    {
        const char *name = orl_get_text(entry, "name");
        rc = strcmp(name, result_name) != 0 ? fetch_file(http, id, name, folder, err) : 0;
        if (rc)
            break;
    }
    /* Last, so that the other files exist when result.json does. */
    if (rc == 0)
        rc = fetch_result(http, id, folder, err);
    if (rc && http->status == 409 && orl_job_has_ended(job) &&
        strcmp(orl_get_text(job, "state"), "succeeded") != 0)
        rc = explain_absence(job, id, err);
    json_decref(job);
    return rc;
}

int orl_cmd_fetch(const struct orl_subcommand *self, int argc, char **argv)
{
    struct orl_daemon_command daemon = {0};
    const char *folder = NULL;
    const struct orl_option options[] = {
        {"output", 'o', "DIR", "folder for the results", &folder, NULL},
        ORL_OPTION_SERVER(&daemon.server),
    };
    int rc;
    if (!orl_options_parse(self, argc, argv, options, 2, 1, 1, &daemon.operands, &rc))
        return rc;
    if (!folder)
        return orl_usage_error(self, "-o DIR is missing");
    rc = orl_daemon_open(&daemon);
    if (rc == 0)
        rc = orl_make_folder(folder, &daemon.err);
    if (rc == 0)
        rc = fetch_all(&daemon.http, daemon.operands.items[0], folder, &daemon.err);
    return orl_daemon_end(&daemon, rc);
}

/* ---- oriel link ------------------------------------------------------------------------------ */

enum { MOST_FILES = 100, MOST_SECONDS = 3600, USUAL_SECONDS = 300 };

static json_t *make_document(const struct orl_operands *operands, uint64_t seconds)
{
    json_t *files = json_array();
    for (int i = 1; i < operands->count && files; i++)
        json_array_append_new(files, json_string(operands->items[i]));
    return json_pack("{s:o, s:I}", "files", files, "seconds", (json_int_t)seconds);
}

static void print_links(const struct orl_http *http, const json_t *links)
{
    const json_t *link;
    size_t i;
    json_array_foreach(links, i, link)
    {
        printf("%s%s\n", http->base_url, orl_get_text(link, "url"));
    }
}

int orl_cmd_link(const struct orl_subcommand *self, int argc, char **argv)
{
    struct orl_daemon_command daemon = {0};
    const char *seconds_text = NULL;
    const struct orl_option options[] = {
        ORL_OPTION_SERVER(&daemon.server),
        {"seconds", 0, "N", "seconds until the addresses expire, up to 3600 (300)", &seconds_text,
         NULL},
    };
    uint64_t seconds = USUAL_SECONDS;
    json_t *reply = NULL;
    char path[1024];
    int rc;
    if (!orl_options_parse(self, argc, argv, options, 2, 2, 1 + MOST_FILES, &daemon.operands, &rc))
        return rc;
    if (seconds_text && !orl_parse_count(seconds_text, 1, MOST_SECONDS, &seconds))
        return orl_usage_error(self, "--seconds takes a number from 1 to %d, not \"%s\"",
                               MOST_SECONDS, seconds_text);
    json_t *body = make_document(&daemon.operands, seconds);
    rc = body ? orl_daemon_open(&daemon)
              : orl_error_set(&daemon.err, ORL_ERR_INVALID, "file names must be UTF-8");
    if (rc == 0)
        rc = orl_job_path(daemon.operands.items[0], "/links", path, sizeof path, &daemon.err);
    if (rc == 0)
        rc = orl_http_post_json(&daemon.http, path, body, &reply, &daemon.err);
    if (rc == 0)
        print_links(&daemon.http, json_object_get(reply, "links"));
    json_decref(reply);
    json_decref(body);
    return orl_daemon_end(&daemon, rc);
}
