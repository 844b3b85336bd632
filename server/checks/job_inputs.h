/*
 * The files of a scene that a job names (task_json.h): its sensors, weather, what its views are
 * lines of; and all of a scene's that are read with the document (README.md has the table).
 */
#ifndef ORL_SERVER_CHECKS_JOB_INPUTS_H
#define ORL_SERVER_CHECKS_JOB_INPUTS_H

#include "checks/job_brief.h"
#include "store/bundle.h"

struct orl_job_inputs {
    struct orl_bundle files; /* each once */
    bool whole;              /* these are all of the scene's, and the document is read with them */
    json_t *uses;            /* [name, role, entry or null], of what is to be read; NULL: none */
};
void orl_job_inputs_done(struct orl_job_inputs *inputs); /* all zeros are fine */

/* What reading them tells. */
struct orl_job_inputs_found {
    uint64_t sensors;             /* of all files of them together */
    uint64_t year_rows;           /* of the weather of a year; 0: there is none */
    uint64_t surfaces, triangles; /* of the largest combination of states of shades */
    uint64_t matrix_bytes;        /* of a year by matrices, in memory */
};

/* Have they come with the scene? ORL_ERR_NOT_FOUND when not, with the place in the document. */
int orl_job_inputs_check(const struct orl_job_brief *brief, const struct orl_bundle *scene,
                         struct orl_error *err);

/* Then: into *inputs, all zero before; what is in it is the caller's, whatever comes. */
int orl_job_inputs_note(const struct orl_job_brief *brief, const struct orl_bundle *scene,
                        struct orl_job_inputs *inputs, struct orl_error *err);

#endif
