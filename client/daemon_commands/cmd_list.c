/* oriel list scenes|bsdfs: prints a daemon's uploads as a table. */
#include "options/command.h"

#include <stdio.h>
#include <string.h>

#include "http/http_client.h"
#include "http/json_get.h"
#include "output/progress.h"
#include "output/report_error.h"

static void print_scenes(const json_t *scenes)
{
    const json_t *scene;
    size_t i;

    printf("%-64s  %10s  %5s  %9s  %s\n", "scene", "size", "jobs", "under way", "last used (UTC)");
    json_array_foreach(scenes, i, scene)
    {
        char size[32];

        orl_format_amount(orl_json_number(scene, "bytes", 0), "B", size, sizeof size);
        printf("%-64s  %10s  %5.0f  %9.0f  %.19s\n", orl_json_text(scene, "id"), size,
               orl_json_number(scene, "jobs", 0), orl_json_number(scene, "jobs_under_way", 0),
               orl_json_text(scene, "last_used"));
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

        orl_format_amount(orl_json_number(bsdf, "bytes", 0), "B", size, sizeof size);
        printf("%-64s  %10s  %6zu  %s\n", orl_json_text(bsdf, "id"), size,
               json_array_size(json_object_get(bsdf, "scenes")), orl_json_text(bsdf, "name"));
    }
}

/* Prints all pages of the list. */
static int print_all(struct orl_http *http, const char *what, void (*print)(const json_t *items),
                     struct orl_error *err)
{
    char path[600];
    json_t *all = json_array();
    int rc = all ? 0 : orl_error_set(err, ORL_ERR_NOMEM, "out of memory");

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
    static const struct {
        const char *name;
        void (*print)(const json_t *items);
    } kinds[] = {{"scenes", print_scenes}, {"bsdfs", print_bsdfs}};
    const char *server = NULL;
    const struct orl_option options[] = {ORL_OPTION_SERVER(&server)};
    struct orl_operands operands;
    struct orl_http http = {0};
    struct orl_error err = {0};
    size_t kind = 0;
    int rc;

    if (!orl_options_parse(self, argc, argv, options, 1, 1, 1, &operands, &rc))
        return rc;
    while (kind < 2 && strcmp(kinds[kind].name, operands.items[0]) != 0)
        kind++;
    if (kind == 2)
        return orl_usage_error(self, "lists are of scenes or bsdfs, not of \"%s\"",
                               operands.items[0]);
    rc = orl_http_open(&http, server, &err);
    if (rc == 0)
        rc = print_all(&http, kinds[kind].name, kinds[kind].print, &err);
    orl_http_close(&http);
    return rc ? orl_report_error(&err) : ORL_EXIT_OK;
}
