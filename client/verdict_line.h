/* Verdicts of a year as lines: `oriel annual`, `oriel status`, and at the end of `oriel wait`. */
#ifndef ORL_CLIENT_VERDICT_LINE_H
#define ORL_CLIENT_VERDICT_LINE_H

#include <jansson.h>
#include <stdio.h>

/*
 * A line each, as "pass       LEED: sDA300/50 >= 55 % (desks): 61 [60, 62.5]: NOTE". verdicts:
 * "verdicts" of a year's result or of its job's document, whose first are those of whole rules,
 * without a value; NULL: none.
 */
void orl_print_verdicts(FILE *to, const json_t *verdicts);

#endif
