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
 * The files of a round (task_round_files.c; format in distributed_job.h): its parts with their
 * tasks, and a marker that it has not ended. Rounds are identified by name.
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

#endif
