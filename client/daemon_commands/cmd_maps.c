/* oriel maps: prints the daemon's photon maps and loaded BSDFs as a table, or removes one. */
#include "options/command.h"

#include <stdio.h>
#include <string.h>
#include <time.h>

#include "daemon_commands/follow_job.h"
#include "http/http_client.h"
#include "http/json_get.h"
#include "output/reports.h"
#include "output/terminal.h"

/* Formats the age of a time such as "2026-11-22T05:01:02Z" as "3 h"; "-" if it is no such time. */
static void format_age(const char *when, char *text, size_t size)
{
    struct tm then = {0};
    if (!strptime(when, "%Y-%m-%dT%H:%M:%S", &then)) {
        snprintf(text, size, "-");
        return;
    }
    double age_s = difftime(time(NULL), timegm(&then));
    if (age_s < 60)
        snprintf(text, size, "%.0f s", age_s > 0 ? age_s : 0);
    else if (age_s < 3600)
        snprintf(text, size, "%.0f min", age_s / 60);
    else if (age_s < 86400)
        snprintf(text, size, "%.0f h", age_s / 3600);
    else
        snprintf(text, size, "%.0f d", age_s / 86400);
}

static void print_maps(const json_t *maps)
{
    const json_t *map;
    size_t i;
    double saved_s = 0, bytes = 0;
    char span[32], total[32];
    printf("%-11s %-12s %9s %9s %10s %9s %5s %9s %7s %7s\n", "kind", "key", "emitted", "stored",
           "size", "built in", "hits", "saved", "age", "unused");
    json_array_foreach(maps, i, map)
    {
        const double seconds = orl_get_number(map, "seconds", 0);
        const double hits = orl_get_number(map, "hits", 0);
        const double saved = orl_get_number(map, "seconds_saved", hits * seconds);
        char emitted[32], stored[32], size[32], age[32], unused[32];
        orl_format_amount(orl_get_number(map, "emitted", 0), "", emitted, sizeof emitted);
        orl_format_amount(orl_get_number(map, "stored", 0), "", stored, sizeof stored);
        orl_format_amount(orl_get_number(map, "bytes", 0), "B", size, sizeof size);
        format_age(orl_get_text(map, "created"), age, sizeof age);
        format_age(orl_get_text(map, "last_used"), unused, sizeof unused);
        if (json_is_true(json_object_get(map, "in_use")))
            snprintf(unused, sizeof unused, "in use");
        printf("%-11s %-12.12s %9s %9s %10s %7.1f s %5.0f %7.1f s %7s %7s\n",
               orl_get_text(map, "kind"), orl_get_text(map, "key"), emitted, stored, size, seconds,
               hits, saved, age, unused);
        saved_s += saved;
        bytes += orl_get_number(map, "bytes", 0);
    }
    orl_format_duration(saved_s, span, sizeof span);
    orl_format_amount(bytes, "B", total, sizeof total);
    printf("%zu map%s, %s; reusing %s saved %s\n", json_array_size(maps),
           json_array_size(maps) == 1 ? "" : "s", total, json_array_size(maps) == 1 ? "it" : "they",
           span);
}

/* Finds the only map whose key begins with start. */
static int find_map(const json_t *maps, const char *start, const json_t **ret_map,
                    struct orl_error *err)
{
    const json_t *map, *found = NULL;
    size_t i, n_found = 0;
    json_array_foreach(maps, i, map)
    {
        if (strncmp(orl_get_text(map, "key"), start, strlen(start)) != 0)
            continue;
        found = map;
        n_found++;
    }
    if (n_found != 1)
        return orl_error_set(err, ORL_ERR_NOT_FOUND, "%s map has a key that begins with %.64s",
                             n_found ? "more than one" : "no", start);
    *ret_map = found;
    return 0;
}

static int remove_map(struct orl_http *http, const json_t *maps, const char *start,
                      struct orl_error *err)
{
    char path[256];
    const json_t *map = NULL;
    int rc = find_map(maps, start, &map, err);
    if (rc)
        return rc;
    snprintf(path, sizeof path, "/v1/maps/%.20s/%.64s", orl_get_text(map, "kind"),
             orl_get_text(map, "key"));
    rc = orl_http_call(http, "DELETE", path, NULL, err);
    if (rc == 0)
        fprintf(stderr, "map %s: removed\n", orl_get_text(map, "key"));
    return rc;
}

int orl_cmd_maps(const struct orl_subcommand *self, int argc, char **argv)
{
    struct orl_daemon_command daemon = {0};
    const char *start = NULL;
    const struct orl_option options[] = {
        ORL_OPTION_SERVER(&daemon.server),
        {"remove", 0, "KEY", "remove the map whose key begins with KEY", &start, NULL},
    };
    json_t *reply = NULL;
    int rc;
    if (!orl_options_parse(self, argc, argv, options, 2, 0, 0, &daemon.operands, &rc))
        return rc;
    rc = orl_daemon_open(&daemon);
    if (rc == 0)
        rc = orl_http_call(&daemon.http, "GET", "/v1/maps", &reply, &daemon.err);
    if (rc == 0 && start)
        rc = remove_map(&daemon.http, json_object_get(reply, "maps"), start, &daemon.err);
    else if (rc == 0)
        print_maps(json_object_get(reply, "maps"));
    json_decref(reply);
    return orl_daemon_end(&daemon, rc);
}
