/* The files that `oriel annual` leaves, each whole or absent. */
#ifndef ORL_CLIENT_ANNUAL_FILES_H
#define ORL_CLIENT_ANNUAL_FILES_H

#include <jansson.h>
#include <stdbool.h>

#include "local.h"

struct orl_annual_output {
    const char *folder; /* exists */
    bool honeybee, matrices;
};

/* All but result.json. files: an array that gets their names, below the folder. */
int orl_annual_files_write(const struct orl_annual_output *output,
                           const struct orl_local_year *year,
                           const struct orl_annual_report *report, json_t *files,
                           struct orl_error *err);

#endif
