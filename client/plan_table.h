/*
 * A plan for people: as a table for `oriel plan`, and in a line for those who only want the
 * picture. Lines of the table have at most ORL_WRAP_COLUMNS columns.
 */
#ifndef ORL_CLIENT_PLAN_TABLE_H
#define ORL_CLIENT_PLAN_TABLE_H

#include <stddef.h>
#include <stdio.h>

#include <oriel/plan.h>
#include <oriel/run.h>

/* The technique with its reason first, then a row per effect, then what leaving out comes to. */
void orl_plan_print(FILE *to, const struct orl_plan *plan);

/* What accuracies would take, a line of each, or why that is not known. */
void orl_curve_print(FILE *to, const struct orl_curve *curve);

/* "gather; 7 of 17 effects left out". */
void orl_format_plan(const struct orl_plan *plan, char *ret_text, size_t size);

#endif
