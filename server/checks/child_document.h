/*
 * A job's document checked together with its scene's files: the scenes that states of shades make,
 * their schedules, others' matrices, and masks of glare (README.md has the table).
 */
#ifndef ORL_SERVER_CHECKS_CHILD_DOCUMENT_H
#define ORL_SERVER_CHECKS_CHILD_DOCUMENT_H

#include "checks/job_inputs.h"
#include "checks/opened.h"

/* In the child: opened is all of the scene, and the document as its single file. Adds to *found. */
int orl_child_document(struct orl_opened *opened, struct orl_job_inputs_found *found,
                       struct orl_error *err);

#endif
