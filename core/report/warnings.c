/* What a report shows that whoever asked for it ought to know. */
#include <oriel/annual_report.h>

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>

struct warning {
    struct orl_annual_result *result;
    void (*warned)(void *ctx, const char *warning);
    void *ctx;
    struct orl_error *err;
};

static int warn(const struct warning *w, const char *format, ...)
    __attribute__((format(printf, 2, 3)));
static int warn(const struct warning *w, const char *format, ...)
{
    struct orl_annual_result *r = w->result;
    char **grown = realloc(r->warnings, (r->n_warnings + 1) * sizeof *grown);
    char *text = NULL;
    va_list args;
    if (grown)
        r->warnings = grown;
    va_start(args, format);
    const int length = grown ? vasprintf(&text, format, args) : -1;
    va_end(args);
    if (length < 0)
        return orl_error_set(w->err, ORL_ERR_NOMEM, "out of memory");
    grown[r->n_warnings++] = text;
    if (w->warned)
        w->warned(w->ctx, text);
    return 0;
}

static bool sees_out(const struct orl_annual_report *report)
{
    size_t i = 0;
    while (i < report->n_views && report->views[i].layers == 0)
        i++;
    return i < report->n_views;
}

int orl_annual_report_warn(const struct orl_annual_report *report, struct orl_annual_result *result,
                           void (*warned)(void *ctx, const char *warning), void *ctx,
                           struct orl_error *err)
{
    const struct warning w = {result, warned, ctx, err};
    int code = 0;
    if (report->year.n_missing > 0)
        code =
            warn(&w, "%zu steps of the year are not in the weather file", report->year.n_missing);
    if (code == 0 && report->year.n_doubtful > 0)
        code = warn(&w,
                    "%zu steps have the sun up by 3 degrees or more and no light in the weather "
                    "file: they count as dark",
                    report->year.n_doubtful);
    if (code == 0 && report->n_unlit > 0)
        code = warn(&w, "no light ever reaches %zu sensors: are they inside of something?",
                    report->n_unlit);
    if (code == 0 && report->views && !sees_out(report))
        code =
            warn(&w, "no place sees out: openings are panes of glass, or those that the view out "
                     "names, of a building that is closed");
    return code;
}
