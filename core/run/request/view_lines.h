/* A job's views, with those read from files. */
#ifndef ORL_RUN_REQUEST_VIEW_LINES_H
#define ORL_RUN_REQUEST_VIEW_LINES_H

#include <oriel/job/run.h>

/* Resolves the job's views: those in files are read, and sizes follow the pixel aspect. *ret_views
 * has as many as the job and owns what differs; free it by orl_run_views_done. */
int orl_run_resolve_views(const struct orl_job *job, const struct orl_files *files,
                          struct orl_view_request **ret_views, struct orl_error *err);
void orl_run_views_done(const struct orl_job *job, struct orl_view_request *views);

#endif
