/*
 * What a child makes of a render job before it is paid for: its plan (core's orl_plan_job), by one
 * thread. In the child's process alone; nothing is given back.
 */
#ifndef ORL_SERVER_CHECKS_CHILD_PLAN_H
#define ORL_SERVER_CHECKS_CHILD_PLAN_H

#include "checks/opened.h"

/* Of several skies so many are planned, the first. */
enum { ORL_PLAN_SKIES = 16 };

/*
 * opened: the scene's files, and the document as the single one. *ret_result is a new reference:
 * {"plans": [{"sky", "plan", "warnings", "curve"}], "more"}; sky is null of a job that has no list
 * of them.
 */
int orl_child_plan(struct orl_opened *opened, json_t **ret_result, struct orl_error *err);

#endif
