/*
 * State of a round (task_round.h), and its progress reports: when a part starts, ends or is lost,
 * and the fraction done.
 */
#ifndef ORL_DISTRIBUTED_TASK_ROUND_PROGRESS_H
#define ORL_DISTRIBUTED_TASK_ROUND_PROGRESS_H

#include "distributed/distributed_job.h"
#include "distributed/part_limits.h"

struct orl_part {
    bool done, due;               /* due: true if it is to be started */
    bool reported;                /* true if its start was reported */
    unsigned tries, limit_raises; /* limit_raises: number of times that its limits were raised */
    enum orl_part_state state;
    struct orl_part_needs needs;
    struct orl_part_limits limits; /* requested limits */
    double gone_s;                 /* time when the runner stopped listing it; 0: it is listed */
    double started_s;              /* start time; 0: not running */
    double held_until_s;           /* time until which it is held back; 0: not held */
};

/* The parts of a round and their states. */
struct orl_task_round {
    char name[ORL_TASK_ROUND_NAME];
    size_t n;
    struct orl_part *parts;
    struct orl_part_status *status;    /* states reported by the runner */
    struct orl_part_request *requests; /* room for all parts */
    double began_s;
    double fraction;       /* reported fraction done */
    double ended_s, ended; /* for ended parts that were seen running: seconds and work */
};

/* Returns the seconds that the part has been running; 0 if it is not. */
double orl_part_elapsed_s(const struct orl_distributed_job *distributed,
                          const struct orl_part *part);

/* Reports "start" once per try, even if the try was short. */
void orl_part_report_start(const struct orl_distributed_job *distributed,
                           struct orl_task_round *round, size_t i);
/* Reports "end", "again" or "failed", with the reason, and before it the start. */
void orl_part_report(const struct orl_distributed_job *distributed, struct orl_task_round *round,
                     size_t i, const char *what, const char *why);

/* Records a part that has ended well; its time scales the estimates for others. */
void orl_task_round_add_timing(struct orl_distributed_job *distributed,
                               struct orl_task_round *round, const struct orl_part *part);

/* Reports the fraction done to the run's watch (oriel/tasks.h). */
void orl_task_round_report_progress(const struct orl_distributed_job *distributed,
                                    struct orl_task_round *round);

#endif
