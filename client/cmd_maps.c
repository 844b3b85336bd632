/* oriel maps: the photon maps and loaded BSDFs that the daemon holds, as a table. */
#include "command.h"

#include <stdio.h>

#include "http.h"
#include "json_get.h"
#include "progress.h"
#include "report.h"

static void print_maps(const json_t *maps)
{
    const json_t *map;
    size_t i;
    double saved_s = 0;
    char span[32];

    printf("%-8s %-12s %9s %9s %10s %9s %5s %9s\n", "kind", "key", "emitted", "stored", "size",
           "built in", "hits", "saved");
    json_array_foreach(maps, i, map)
    {
        const double seconds = orl_json_number(map, "seconds", 0);
        const double hits = orl_json_number(map, "hits", 0);
        const double saved = orl_json_number(map, "seconds_saved", hits * seconds);
        char emitted[32], stored[32], size[32];

        orl_format_amount(orl_json_number(map, "emitted", 0), "", emitted, sizeof emitted);
        orl_format_amount(orl_json_number(map, "stored", 0), "", stored, sizeof stored);
        orl_format_amount(orl_json_number(map, "bytes", 0), "B", size, sizeof size);
        printf("%-8s %-12.12s %9s %9s %10s %7.1f s %5.0f %7.1f s\n", orl_json_text(map, "kind"),
               orl_json_text(map, "key"), emitted, stored, size, seconds, hits, saved);
        saved_s += saved;
    }
    orl_format_duration(saved_s, span, sizeof span);
    printf("%zu maps; found ready, they saved %s\n", json_array_size(maps), span);
}

int orl_cmd_maps(const struct orl_command *self, int argc, char **argv)
{
    const char *server = NULL;
    const struct orl_option options[] = {ORL_OPTION_SERVER(&server)};
    struct orl_operands operands;
    struct orl_http http = {0};
    struct orl_error err = {0};
    json_t *reply = NULL;
    int rc;

    if (!orl_options_parse(self, argc, argv, options, 1, 0, 0, &operands, &rc))
        return rc;
    rc = orl_http_open(&http, server, &err);
    if (rc == 0)
        rc = orl_http_call(&http, "GET", "/v1/maps", &reply, &err);
    if (rc == 0)
        print_maps(json_object_get(reply, "maps"));
    json_decref(reply);
    orl_http_close(&http);
    return rc ? orl_report_error(&err) : ORL_EXIT_OK;
}
