/*
 * The files that a year leaves, each whole or absent: tables, every grid's maps, carpets and page,
 * and those of all hours that are asked for.
 */
#ifndef ORL_API_ANNUAL_FILES_H
#define ORL_API_ANNUAL_FILES_H

#include <jansson.h>

#include <oriel/annual_phases.h>

#include "annual_json.h"

/* Whose files they are; borrowed. */
struct orl_annual_told {
    const struct orl_annual_job *job;
    const struct orl_run_env *run; /* output_folder exists; crew, cancel and progress are heeded */
    const struct orl_annual_result *result;
    const struct orl_annual_report *report;
    const struct orl_annual_phases *phases; /* of the job's formats; or NULL */
};

/* Of a job's time, what comes before them, more or less. */
#define ORL_ANNUAL_FILES_FROM 0.95

/* All but result.json. names: an array that gets theirs, below the folder. Returns 0,
 * ORL_ERR_NOMEM, _CANCELLED, _IO or _FULL. */
int orl_annual_files_write(const struct orl_annual_told *told, json_t *names,
                           struct orl_error *err);

#endif
