/*
 * Checks a job's document together with its scene's files (README.md has the table). These are the
 * scenes that the states of shades make, their schedules, matrices of other scenes, and glare
 * masks.
 */
#ifndef ORL_SERVER_CHECKS_CHILD_CHILD_DOCUMENT_H
#define ORL_SERVER_CHECKS_CHILD_CHILD_DOCUMENT_H

#include "checks/child/mapped_inputs.h"
#include "checks/job_inputs.h"

/* Runs in the child. opened: all files of the scene, with the document as its single file. Adds to
 * *found. */
int orl_child_document(struct orl_mapped_inputs *mapped, struct orl_job_inputs_found *found,
                       struct orl_error *err);

#endif
