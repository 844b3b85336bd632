/*
 * A one-page summary of a year: figures and verdicts with intervals, a grid over its plan, the
 * year as a carpet, and the assumptions. The page has A4 proportions, upright.
 */
#ifndef ORL_CHART_ANNUAL_PAGE_H
#define ORL_CHART_ANNUAL_PAGE_H

#include <oriel/annual/annual_report.h>
#include <oriel/base/canvas.h>

struct orl_annual_page {
    const char *title; /* NULL: only the grid's name */
    const struct orl_annual_request *request;
    const struct orl_report_request *report_request;
    const struct orl_annual_result *result;
    const struct orl_annual_report *report;
    const struct orl_annual_plans *plans;
    size_t grid;
    const atomic_bool *cancel; /* NULL: not cancellable */
};

/* Writes the page to a file. Returns 0, ORL_ERR_NOMEM, ORL_ERR_IO or ORL_ERR_CANCELLED. */
int orl_annual_page_write(const struct orl_annual_page *page, enum orl_canvas_kind kind,
                          const char *path, struct orl_error *err);

#endif
