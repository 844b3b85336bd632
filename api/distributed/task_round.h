/* A round of a shared job (distributed_job.h): manages its parts from their files to their ends. */
#ifndef ORL_DISTRIBUTED_TASK_ROUND_H
#define ORL_DISTRIBUTED_TASK_ROUND_H

#include "distributed/distributed_job.h"

/* Makes the tasks by parts, as a new round. */
int orl_task_round_run(struct orl_distributed_job *distributed, const struct orl_job_task *tasks,
                       size_t n, struct orl_error *err);

/*
 * Waits for rounds that an earlier run left, and restarts their lost parts. Sets ret_made for
 * the tasks that their parts have made.
 */
int orl_task_round_adopt(struct orl_distributed_job *distributed, const struct orl_job_task *tasks,
                         size_t n, bool *ret_made, struct orl_error *err);

#endif
