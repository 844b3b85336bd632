/*
 * The files of a scene that a job names: its sensors, weather for its skies, and what its views are
 * lines of.
 */
#ifndef ORL_SERVER_CHECKS_JOB_INPUTS_H
#define ORL_SERVER_CHECKS_JOB_INPUTS_H

#include "checks/job_brief.h"
#include "store/bundle.h"

struct orl_job_inputs {
    struct orl_bundle files; /* each once; "resource" says that it is weather */
    const char *sensors;     /* the name of the one of these; NULL: none */
    json_t *views;           /* [name, entry or null] of each; NULL: none */
};
void orl_job_inputs_done(struct orl_job_inputs *inputs); /* all zeros are fine */

/* Have they come with the scene? ORL_ERR_NOT_FOUND when not, with the place in the document. */
int orl_job_inputs_check(const struct orl_job_brief *brief, const struct orl_bundle *scene,
                         struct orl_error *err);

/* Then: into *inputs, all zero before; what is in it is the caller's, whatever comes. */
int orl_job_inputs_note(const struct orl_job_brief *brief, const struct orl_bundle *scene,
                        struct orl_job_inputs *inputs, struct orl_error *err);

#endif
