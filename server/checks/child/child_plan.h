/*
 * The plan of a render job before it is accepted (core's orl_plan_job), made in a check child with
 * one thread. Nothing is freed: the process ends with the check.
 */
#ifndef ORL_SERVER_CHECKS_CHILD_CHILD_PLAN_H
#define ORL_SERVER_CHECKS_CHILD_CHILD_PLAN_H

#include "checks/child/mapped_inputs.h"

/* Number of skies that are planned; the first ones if the job has more. */
enum { ORL_PLAN_SKIES = 16 };

/*
 * Plans the job. opened: the scene's files, with the document as the single file. *ret_result is a
 * new reference: {"plans": [{"sky", "plan", "warnings", "curve"}], "more"}. sky is null if the job
 * has no list of skies.
 */
int orl_child_plan(struct orl_mapped_inputs *mapped, json_t **ret_result, struct orl_error *err);

#endif
