/* A round of a shared job (distributed_job.h): manages its parts from their files to their ends. */
#ifndef ORL_DISTRIBUTED_TASK_ROUND_H
#define ORL_DISTRIBUTED_TASK_ROUND_H

#include "distributed/distributed_job.h"
#include "distributed/runner.h"

/* Makes the tasks by parts, as a new round. */
int orl_task_round_run(struct orl_distributed_job *distributed, const struct orl_job_task *tasks,
                       size_t n, struct orl_error *err);

/*
 * Waits for rounds that an earlier run left, and restarts their lost parts. Sets ret_made for
 * the tasks that their parts have made.
 */
int orl_task_round_adopt(struct orl_distributed_job *distributed, const struct orl_job_task *tasks,
                         size_t n, bool *ret_made, struct orl_error *err);

/*
 * The files of a round (distributed_job.h): its parts with their tasks, and a marker that it has
 * not ended. Rounds are identified by name.
 */

enum { ORL_PART_PATH = 4300 };

/* Writes parts and marker. *ret_parts: number of parts; parts without tasks are not written. */
int orl_task_round_write(const struct orl_distributed_job *distributed, const char *round,
                         const struct orl_job_task *tasks, size_t n, size_t *ret_parts,
                         struct orl_error *err);

/* Finds a round in the folder that has not ended. Returns false if there is none. */
bool orl_task_round_find(const char *folder, char ret_round[ORL_TASK_ROUND_NAME]);
/* Removes the marker of a round that has ended. Returns false if that fails. */
bool orl_task_round_remove_marker(const char *folder, const char *round);
/* Returns the number of parts of a round that has not ended; 0 if it cannot be read. */
size_t orl_task_round_count_parts(const char *folder, const char *round);
/* Returns the estimated needs of a part; all zero if they cannot be read. */
struct orl_part_needs orl_task_round_part_needs(const char *folder, const char *round,
                                                size_t number);
/* Sets ret_made for those tasks that belong to the round's parts. */
void orl_task_round_mark_made(const char *folder, const char *round, size_t n_parts,
                              const struct orl_job_task *tasks, size_t n, bool *ret_made);

/* Returns true if the file WAVE-NUMBER.what exists. */
bool orl_part_file(const char *folder, const char *round, size_t number, const char *what,
                   char ret_path[ORL_PART_PATH]);

/* Returns true if a small file can be written in the folder: its disk and the owner's quota
 * have room. */
bool orl_folder_has_space(const char *folder);

/*
 * State of a round (task_round.h), and its progress reports: when a part starts, ends or is lost,
 * and the fraction done.
 */

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
