/* Tasks of a run's work that other processes may compute (oriel/job/job_tasks.h): finds them in the
 * store, makes the run's own, and stores these. */
#ifndef ORL_RUN_DISTRIBUTED_TASK_WORK_H
#define ORL_RUN_DISTRIBUTED_TASK_WORK_H

#include <oriel/base/sha256.h>
#include <oriel/job/job_tasks.h>

#include "run/run_state.h"

/* Memory in bytes: of a photon while its map is built; of a pixel with its error and the data for
 * its files. */
enum { ORL_PHOTON_BYTES = 60, ORL_PIXEL_BYTES = 64 };

/* Tasks of one stage, independent of each other. */
struct orl_task_work {
    struct orl_job_task *tasks;
    size_t n;
    void *ctx;
    /* Makes a task, records it in the run, and packs it. The caller owns *ret_data; its size is a
     * multiple of 4. */
    int (*make)(void *ctx, size_t index, void **ret_data, size_t *ret_size, struct orl_error *err);
    /* Unpacks a task found in the store. *ret_taken: true if it is well-formed. */
    int (*take)(void *ctx, size_t index, const void *data, size_t size, bool *ret_taken,
                struct orl_error *err);
    /* Reports the share of other processes' tasks that is done; may be NULL. */
    void (*told)(void *ctx, double share);
};

/* Makes or finds all tasks; only for distributed runs. */
int orl_run_tasks(const struct orl_run_env *env, const struct orl_task_work *work,
                  struct orl_error *err);

/* Sets core_s of each task by its work. Together the tasks take `share` of the render stage's
 * estimate. */
void orl_task_work_estimate(const struct orl_run_state *state, struct orl_task_work *work,
                            double share);

/* Returns true if the run is distributed; a pilot never is. */
bool orl_run_is_distributed(const struct orl_run_state *state);

/* orl_task_key_begin hashes the job, its sky and its round; orl_task_key_end finishes the key. */
void orl_task_key_begin(const struct orl_run_state *state, struct orl_sha256 *hash);
void orl_task_key_end(struct orl_sha256 *hash, char ret_key[ORL_JOB_TASK_KEY]);

/* Store the counters of something under its key, and add them in another run as its own.
 * orl_run_load_counts returns false if they could not be stored or found. */
void orl_run_store_counts(const struct orl_run_state *state, const char *key,
                          const struct orl_health *health);
bool orl_run_load_counts(struct orl_run_state *state, const char *key);

/* Store the result's warnings from `first` on under a key, and add those that the run has not
 * issued yet. */
void orl_run_store_warnings(const struct orl_run_state *state, const char *key, size_t first);
void orl_run_load_warnings(struct orl_run_state *state, const char *key);

/* Moves the counters of all threads to *ret_health. */
void orl_run_move_health(const struct orl_run_state *state, struct orl_health *ret_health);

#endif
