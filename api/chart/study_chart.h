/* Draws a study's chart: error against time, both logarithmic, with the given points. */
#ifndef ORL_CHART_STUDY_CHART_H
#define ORL_CHART_STUDY_CHART_H

#include <oriel/base/canvas.h>
#include <oriel/job/study.h>

/* Writes the chart to a file, whole or absent. title: NULL for none. Returns 0, ORL_ERR_NOMEM
 * or ORL_ERR_IO. */
int orl_study_chart_write(const struct orl_study *study, const char *title,
                          enum orl_canvas_kind kind, const char *path, struct orl_error *err);

#endif
