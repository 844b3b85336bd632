/* What a study's request comes to: what it measures, its settings, and its reference. */
#ifndef ORL_STUDY_REQUEST_H
#define ORL_STUDY_REQUEST_H

#include <oriel/study.h>

bool orl_study_of_views(const struct orl_study_request *request);
int orl_study_list_settings(const struct orl_study_request *request,
                            struct orl_study_setting **ret_settings, size_t *ret_count,
                            struct orl_error *err);
/* Of each of the reference's runs. */
struct orl_study_setting orl_study_reference_setting(const struct orl_study_request *request);
/* The reference's seeds, from this on, are none of those that are judged. */
uint64_t orl_study_reference_seed(const struct orl_study_request *request);
void orl_study_free_given(struct orl_study_given *given, size_t count);

#endif
