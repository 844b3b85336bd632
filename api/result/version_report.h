/*
 * Output of `oriel --version` and `orield --version`: version and commit of the program, its
 * licence, and the libraries as they are at run time.
 */
#ifndef ORL_API_RESULT_VERSION_REPORT_H
#define ORL_API_RESULT_VERSION_REPORT_H

#include <stdbool.h>
#include <stdio.h>

#include <oriel/base/error.h>
#include <oriel/job/library_versions.h>

struct orl_version_report {
    const char *program; /* "oriel" */
    const char *commit;  /* "" if unknown */
    /* Libraries that the program uses beside those of core and api. */
    const struct orl_library_version *libraries;
    size_t n_libraries;
};

/* Prints a name and its value per line, the program first; or all as a JSON object. */
int orl_version_report_print(FILE *stream, const struct orl_version_report *report, bool as_json,
                             struct orl_error *err);

#endif
