/* Settings and reference of a study, derived from its request. */
#ifndef ORL_STUDY_STUDY_REQUEST_H
#define ORL_STUDY_STUDY_REQUEST_H

#include <oriel/job/study.h>

bool orl_study_of_views(const struct orl_study_request *request);
int orl_study_list_settings(const struct orl_study_request *request,
                            struct orl_study_setting **ret_settings, size_t *ret_count,
                            struct orl_error *err);
/* Returns the setting of each run of the reference. */
struct orl_study_setting orl_study_reference_setting(const struct orl_study_request *request);
/* Returns the first seed of the reference. Its seeds differ from those of the measured runs. */
uint64_t orl_study_reference_seed(const struct orl_study_request *request);
void orl_study_free_external(struct orl_study_external *external, size_t count);

#endif
