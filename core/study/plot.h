/* A study's chart, drawn by cairo onto whatever surface: oriel/study.h has the files. */
#ifndef ORL_STUDY_PLOT_H
#define ORL_STUDY_PLOT_H

#include <cairo/cairo.h>

#include "study/chart.h"

/* Draws in page units. Returns 0, or ORL_ERR_NOMEM. */
int orl_chart_draw(const struct orl_chart *chart, const struct orl_study *study, cairo_t *cairo,
                   struct orl_error *err);

#endif
