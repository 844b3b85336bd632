/*
 * Writes the files of a year, each either whole or absent: tables, the maps, carpets and page of
 * every grid, and the hourly files that the job asks for.
 */
#ifndef ORL_API_ANNUAL_JOB_ANNUAL_FILES_H
#define ORL_API_ANNUAL_JOB_ANNUAL_FILES_H

#include <jansson.h>

#include <oriel/annual/annual_phases.h>

#include "annual_job/annual_json.h"

/* Results to write; all pointers are borrowed. */
struct orl_annual_outputs {
    const struct orl_annual_job *job;
    const struct orl_run_env *run; /* output_folder exists; crew, cancel and progress are used */
    const struct orl_annual_result *result;
    const struct orl_annual_report *report;
    const struct orl_phase_matrices *phases; /* for the job's formats; or NULL */
};

/* Fraction of the job's time at which writing files starts, roughly. */
#define ORL_ANNUAL_FILES_FROM 0.95

/* Writes all files but result.json, and appends their names, relative to the folder, to the array
 * names. Returns 0, ORL_ERR_NOMEM, _CANCELLED, _IO or _FULL. */
int orl_annual_files_write(const struct orl_annual_outputs *outputs, json_t *names,
                           struct orl_error *err);

#endif
