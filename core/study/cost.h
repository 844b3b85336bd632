/* What a study's runs are thought to take, before any was made: for progress and limits. */
#ifndef ORL_STUDY_COST_H
#define ORL_STUDY_COST_H

#include <oriel/study.h>

/* Seconds of one core that a run takes, roughly, with so many sensors. */
double orl_study_run_core_s(const struct orl_job *job, const struct orl_study_setting *setting,
                            double sensors);

#endif
