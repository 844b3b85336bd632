/*
 * Runs a job under several skies: the hours of a day, the days of a year. Each sky is run as the
 * job with that sky alone (run.h), one after the other. The bytes are those of separate jobs, and
 * maps are shared with such jobs through the store. Files of a sky are named after it:
 * <sky>.<view>.hdr.
 *
 * All skies are checked before the first one is run, so that a mistake in one of them (an hour that
 * the weather file does not have) costs nothing. A sky without light, as at night, is run like any
 * other, since lamps may be on. A deadline covers all skies: each gets an equal part of the time
 * left.
 */
#ifndef ORIEL_JOB_SKIES_H
#define ORIEL_JOB_SKIES_H

#include <oriel/job/run.h>

/* Callbacks of orl_run_skies, called by the lead thread with the sky's index. */
struct orl_skies_env {
    void *ctx;
    /* Returns true if an earlier run of the same job left the sky's result. The sky is then
     * skipped. May be NULL. */
    bool (*kept)(void *ctx, size_t index);
    /* Called when a sky's run begins. Later callbacks of the run refer to this job, which is valid
     * until done. May be NULL. */
    void (*begins)(void *ctx, size_t index, const struct orl_job *job, const char *file_prefix);
    /* Called with the sky's result, files included; valid during the call. A negative orl_err ends
     * the job. */
    int (*done)(void *ctx, size_t index, const struct orl_result *result, struct orl_error *err);
};

/* Runs the job. Returns 0 or a negative orl_err, whose primitive names the sky: "skies[3]". */
int orl_run_skies(const struct orl_job *job, const struct orl_run_env *env,
                  const struct orl_skies_env *skies, struct orl_error *err);

/*
 * Makes the job's plan (orl_plan_job), or the plans for the first `most` of its skies, one after
 * the other. Calls `tell` for each, with the sky's name (NULL for a job without a list of skies).
 * The first call also gets a curve (orl_plan_accuracy_curve); later calls get NULL. If the first
 * plan took over 20 s it has a curve only if the curve just states why no accuracy can be
 * predicted, which takes no time. Arguments are valid during the call; if `tell` returns a negative
 * orl_err, the function ends with it.
 */
int orl_plan_skies(const struct orl_job *job, const struct orl_run_env *env, size_t most,
                   int (*tell)(void *ctx, const char *sky, const struct orl_result *planned,
                               const struct orl_accuracy_curve *curve, struct orl_error *err),
                   void *ctx, struct orl_error *err);

#endif
