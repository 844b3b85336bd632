/* Prints a study as tables: its points, the fits, and notes on the reference. */
#ifndef ORL_CLIENT_OUTPUT_STUDY_TABLE_H
#define ORL_CLIENT_OUTPUT_STUDY_TABLE_H

#include <stddef.h>
#include <stdio.h>

#include <jansson.h>

#include <oriel/job/study.h>

void orl_study_print(FILE *to, const struct orl_study *study);

/* Formats a point in short (study_json.h): "gather, 1.0 M photons, 256 samples: 1.2 s, rms 2.31
 * %". */
void orl_format_study_point(const json_t *point, char *ret_text, size_t size);

#endif
