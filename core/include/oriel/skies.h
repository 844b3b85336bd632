/*
 * A job under several skies: the hours of a day, the days of a year. Each is the job with that sky
 * alone (run.h), one after the other: the same bytes as by a job of its own, maps shared with such
 * jobs through the store. Files of a sky are named after it: <sky>.<view>.hdr.
 *
 * All skies are looked at before the first is run, so that a mistake in one of them (an hour that
 * the weather file does not have) costs nothing. A sky that gives no light, as at night, is run
 * like any other: lamps may be on. A deadline is that of all skies: each has an equal part of what
 * is left of it.
 */
#ifndef ORIEL_SKIES_H
#define ORIEL_SKIES_H

#include <oriel/run.h>

/* Called by the lead thread, each of them with the sky's index. */
struct orl_skies_env {
    void *ctx;
    /* Has an earlier run of the same job left the sky's result? Then it is not run again. May be
     * NULL. */
    bool (*kept)(void *ctx, size_t index);
    /* Its run begins: what the run's callbacks tell from now on is about this job, which is valid
     * until done. May be NULL. */
    void (*begins)(void *ctx, size_t index, const struct orl_job *job, const char *file_prefix);
    /* Its result, files included; valid during the call. A negative orl_err ends the job. */
    int (*done)(void *ctx, size_t index, const struct orl_result *result, struct orl_error *err);
};

/* Runs the job. Returns 0 or a negative orl_err, whose primitive names the sky: "skies[3]". */
int orl_run_skies(const struct orl_job *job, const struct orl_run_env *env,
                  const struct orl_skies_env *skies, struct orl_error *err);

/*
 * Makes the job's plan (orl_plan_job), or those under the first `most` of its skies, one after the
 * other, and gives each to tell with the sky's name, NULL for a job of no list of skies, and the
 * first with its curve (orl_plan_curve); else that is NULL. A plan that took over 20 s has a curve
 * only if that gives the reason why no accuracy can be predicted, which takes no time. What tell is
 * given is valid during the call; a negative orl_err of its ends it.
 */
int orl_plan_skies(const struct orl_job *job, const struct orl_run_env *env, size_t most,
                   int (*tell)(void *ctx, const char *sky, const struct orl_result *planned,
                               const struct orl_curve *curve, struct orl_error *err),
                   void *ctx, struct orl_error *err);

#endif
