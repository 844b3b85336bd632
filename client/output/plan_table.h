/*
 * Prints a plan: as a table for `oriel plan`, or in one line. Lines of the table have at most
 * ORL_WRAP_COLUMNS columns.
 */
#ifndef ORL_CLIENT_OUTPUT_PLAN_TABLE_H
#define ORL_CLIENT_OUTPUT_PLAN_TABLE_H

#include <stddef.h>
#include <stdio.h>

#include <oriel/job/plan.h>
#include <oriel/job/run.h>

/* Prints the technique and its reason, a row per effect, and the total saving by effects left
 * out. */
void orl_plan_print(FILE *to, const struct orl_plan *plan);

/* Prints the estimated time for each accuracy, one per line, or why it is unknown. */
void orl_curve_print(FILE *to, const struct orl_accuracy_curve *curve);

/* Formats a plan in one line: "gather; 7 of 17 effects left out". */
void orl_format_plan(const struct orl_plan *plan, char *ret_text, size_t size);

#endif
