#include "output/job_table.h"

#include <stdio.h>
#include <string.h>

#include "http/json_get.h"
#include "output/progress.h"

enum { NAME_WIDTH = 24, CELL = 32 };

/* Prints at most `most` UTF-8 characters, padded with blanks. */
static void print_padded(const char *text, int most)
{
    int characters = 0;

    for (const char *c = text; *c; c++) {
        if ((*c & 0xc0) != 0x80 && characters++ == most)
            break;
        putchar(*c);
    }
    printf("%*s", characters < most ? most - characters : 0, "");
}

/* Prints the name, or else the tags, if any. */
static void print_name(const json_t *job)
{
    const json_t *tags = json_object_get(job, "tags");
    char text[400] = "";
    size_t used = 0;

    if (*orl_json_text(job, "name")) {
        print_padded(orl_json_text(job, "name"), NAME_WIDTH);
        return;
    }
    for (size_t i = 0; i < json_array_size(tags) && used + 1 < sizeof text; i++) {
        const char *tag = json_string_value(json_array_get(tags, i));

        used +=
            (size_t)snprintf(text + used, sizeof text - used, "%s%s", i ? "," : "", tag ? tag : "");
    }
    print_padded(text, NAME_WIDTH);
}

/* Formats "42.0 %", or "" if unknown. */
static void format_share(double percent, char ret_text[CELL])
{
    if (percent >= 0)
        snprintf(ret_text, CELL, "%.1f %%", percent);
    else
        ret_text[0] = '\0';
}

void orl_print_job(const json_t *job)
{
    const double eta_s = orl_json_number(job, "eta_s", -1);
    const double position = orl_json_number(job, "queue_position", -1);
    char percent[CELL], eta[CELL] = "", error[CELL];

    format_share(orl_json_number(job, "percent", -1), percent);
    format_share(100 * orl_json_number(job, "error", -1), error);
    if (eta_s >= 0)
        orl_format_duration(eta_s, eta, sizeof eta);
    else if (position > 0)
        snprintf(eta, sizeof eta, "%.0f. in line", position);
    printf("%-8.8s  ", orl_json_text(job, "id"));
    print_name(job);
    printf("  %-6s  %-10s  %8s  %11s  %7s  %.19s\n", orl_json_text(job, "kind"),
           orl_json_text(job, "state"), percent, eta, error, orl_json_text(job, "created"));
}

void orl_print_job_heading(void)
{
    printf("%-8s  %-*s  %-6s  %-10s  %8s  %11s  %7s  %s\n", "id", NAME_WIDTH, "name", "kind",
           "state", "progress", "eta", "error", "created (UTC)");
}

void orl_print_jobs(const json_t *jobs)
{
    const json_t *job;
    size_t i;

    orl_print_job_heading();
    json_array_foreach(jobs, i, job)
    {
        orl_print_job(job);
    }
}
