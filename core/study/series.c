/* Runs of one setting, seed after seed. */
#include "study/study_runs.h"

#include <stdlib.h>
#include <string.h>

void orl_series_done(struct orl_series *series)
{
    for (size_t i = 0; series->values && i < series->n_runs; i++)
        free(series->values[i]);
    free(series->values);
    free(series->errors);
    free(series->costs);
    memset(series, 0, sizeof *series);
}

/* Adds each new warning of a run to the study once. */
static void add_warnings(struct orl_runs_env *env, const struct orl_one_run *run)
{
    for (size_t i = 0; i < run->n_warnings; i++) {
        bool known = false;
        for (size_t k = 0; k < *env->n_warnings; k++)
            known = known || strcmp((*env->warnings)[k], run->warnings[i]) == 0;
        char **grown =
            known ? NULL : realloc(*env->warnings, (*env->n_warnings + 1) * sizeof *grown);
        if (!grown)
            continue;
        *env->warnings = grown;
        grown[*env->n_warnings] = strdup(run->warnings[i]);
        *env->n_warnings += grown[*env->n_warnings] != NULL;
    }
}

static int store_run(struct orl_series *series, size_t index, struct orl_one_run *run,
                     struct orl_error *err)
{
    if (index > 0 && run->count != series->count)
        return orl_error_set(err, ORL_ERR_INTERNAL,
                             "runs of one study have different numbers of values");
    series->count = run->count;
    series->costs[index] = run->cost;
    series->values[index] = run->values;
    run->values = NULL;
    free(series->errors);
    series->errors = run->errors;
    run->errors = NULL;
    return 0;
}

int orl_series_run(struct orl_runs_env *env, const struct orl_study_setting *setting,
                   uint64_t first_seed, uint32_t n_runs, struct orl_series *ret_series,
                   struct orl_error *err)
{
    struct orl_series series = {.n_runs = n_runs,
                                .values = calloc(n_runs, sizeof *series.values),
                                .costs = calloc(n_runs, sizeof *series.costs)};
    int code = 0;
    if (!series.values || !series.costs) {
        orl_series_done(&series);
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
    }
    if (!(env->before > 0))
        env->started_s = env->env->now_s(env->env->ctx);
    env->share = orl_study_run_core_s(&env->request->job, setting, env->sensors);
    env->step.setting = *setting;
    env->step.runs = n_runs;
    for (uint32_t i = 0; i < n_runs && code == 0; i++) {
        struct orl_one_run run = {0};
        env->step.run = i + 1;
        code = orl_shared_run_find(env, setting, first_seed + i, &run, err);
        if (code == 0) {
            add_warnings(env, &run);
            code = store_run(&series, i, &run, err);
        }
        orl_one_run_done(&run);
        env->before += env->share;
    }
    if (code < 0)
        orl_series_done(&series);
    else
        *ret_series = series;
    return code;
}
