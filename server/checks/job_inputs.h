/*
 * The files of a scene that a job names (task_json.h): its sensors, weather, what its views are
 * lines of.
 */
#ifndef ORL_SERVER_CHECKS_JOB_INPUTS_H
#define ORL_SERVER_CHECKS_JOB_INPUTS_H

#include "checks/job_brief.h"
#include "store/bundle.h"

struct orl_job_inputs {
    struct orl_bundle files; /* each once */
    json_t *uses;            /* [name, role, entry or null], of what is to be read; NULL: none */
};
void orl_job_inputs_done(struct orl_job_inputs *inputs); /* all zeros are fine */

/* What reading them tells. */
struct orl_job_inputs_found {
    uint64_t sensors;   /* of all files of them together */
    uint64_t year_rows; /* of the weather of a year; 0: there is none */
};

/* Have they come with the scene? ORL_ERR_NOT_FOUND when not, with the place in the document. */
int orl_job_inputs_check(const struct orl_job_brief *brief, const struct orl_bundle *scene,
                         struct orl_error *err);

/* Then: into *inputs, all zero before; what is in it is the caller's, whatever comes. */
int orl_job_inputs_note(const struct orl_job_brief *brief, const struct orl_bundle *scene,
                        struct orl_job_inputs *inputs, struct orl_error *err);

#endif
