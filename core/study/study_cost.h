/* Cost estimates of a study's runs before any was made, for progress and limits. */
#ifndef ORL_STUDY_STUDY_COST_H
#define ORL_STUDY_STUDY_COST_H

#include <oriel/job/study.h>

/* Estimates a run's time for that many sensors, in seconds of one core. */
double orl_study_run_core_s(const struct orl_job *job, const struct orl_study_setting *setting,
                            double sensors);

#endif
