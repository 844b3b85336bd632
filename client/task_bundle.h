/*
 * All files that a document of any kind needs: its scene's and what they refer to (bundle.h), and
 * those that it names beside them.
 */
#ifndef ORL_CLIENT_TASK_BUNDLE_H
#define ORL_CLIENT_TASK_BUNDLE_H

#include "bundle.h"
#include "task_json.h"

/* Of a document that names its scene's files, below the folder. The caller ends it with
 * orl_bundle_done. */
int orl_task_bundle_collect(const char *folder, const struct orl_task *task,
                            struct orl_upload *ret_bundle, struct orl_error *err);

#endif
