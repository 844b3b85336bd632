/*
 * Distributes the computation of a panel's BSDF (oriel/bsdf/bsdf_make.h) over processes
 * (oriel/tasks.h). A task is the paths of a few incident directions; with an accuracy, those of
 * one round.
 */
#ifndef ORIEL_BSDF_BSDF_DISTRIBUTED_H
#define ORIEL_BSDF_BSDF_DISTRIBUTED_H

#include <oriel/bsdf/bsdf_make.h>
#include <oriel/job/job_tasks.h>
#include <oriel/job/run.h>

/* Borrowed. The store never blocks (orl_shared_store). */
struct orl_bsdf_task_store {
    const struct orl_job_tasks *tasks;
    const struct orl_map_store *store;
};

/* Returns a sharing object for the environment of orl_bsdf_make; it borrows the state. */
struct orl_bsdf_distributor orl_bsdf_distribute(struct orl_bsdf_task_store *state);

#endif
