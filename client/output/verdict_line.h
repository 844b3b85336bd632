/* Prints verdicts of a year as lines, for `oriel annual`, `oriel status` and the end of `oriel
 * wait`. */
#ifndef ORL_CLIENT_OUTPUT_VERDICT_LINE_H
#define ORL_CLIENT_OUTPUT_VERDICT_LINE_H

#include <jansson.h>
#include <stdio.h>

/*
 * Prints a line per verdict: "pass       LEED: sDA300/50 >= 55 % (desks): 61 [60, 62.5]: NOTE".
 * verdicts: "verdicts" of a year's result or of its job's document; NULL: none. In the latter,
 * the first are those of whole rules, without a value.
 */
void orl_print_verdicts(FILE *to, const json_t *verdicts);

#endif
