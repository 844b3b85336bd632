/*
 * The files of a scene that a job names: its sensors, and weather for its skies.
 */
#ifndef ORL_SERVER_CHECKS_JOB_INPUTS_H
#define ORL_SERVER_CHECKS_JOB_INPUTS_H

#include "checks/job_brief.h"
#include "store/bundle.h"

struct orl_job_inputs {
    struct orl_bundle files; /* each once; "resource" says that it is weather */
    const char *sensors;     /* the name of the one of these; NULL: none */
};

/* Have they come with the scene? ORL_ERR_NOT_FOUND when not, with the place in the document. */
int orl_job_inputs_check(const struct orl_job_brief *brief, const struct orl_bundle *scene,
                         struct orl_error *err);

/* Then: into *inputs, all zero before; its files are the caller's, whatever comes. */
int orl_job_inputs_note(const struct orl_job_brief *brief, const struct orl_bundle *scene,
                        struct orl_job_inputs *inputs, struct orl_error *err);

#endif
