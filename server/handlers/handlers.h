/*
 * The handlers, one file per resource (handle_*.c). Each is called on the loop thread when the
 * request's body is complete, and ends by replying or by sending work to the pool.
 */
#ifndef ORL_SERVER_HANDLERS_HANDLERS_H
#define ORL_SERVER_HANDLERS_HANDLERS_H

#include <stdio.h>

#include "http/context.h"
#include "http/request/request.h"

/* handle_service.c: the daemon's index, state, limits and contract */
void orl_handle_index(struct orl_request *request);
void orl_handle_health(struct orl_request *request);
void orl_handle_ready(struct orl_request *request);
void orl_handle_metrics(struct orl_request *request); /* handle_metrics.c */
void orl_handle_openapi(struct orl_request *request);
void orl_handle_limits(struct orl_request *request);

/* handle_dashboard.c: is_wanted returns true if the client prefers the page to the index */
bool orl_dashboard_is_wanted(const struct orl_request *request);
void orl_dashboard_reply(struct orl_request *request);
/* Adds the headers that bound what a page may load, and who may embed it, to the reply made. */
void orl_reply_page_headers(struct orl_request *request);
void orl_handle_dashboard_file(struct orl_request *request);
void orl_handle_javascript(struct orl_request *request); /* the client's module */

/* handle_guide.c: the guide's start page, pages and pictures, and search */
void orl_handle_guide(struct orl_request *request);
void orl_handle_guide_page(struct orl_request *request);
void orl_handle_guide_search(struct orl_request *request);

/* handle_scenes.c, handle_bsdfs.c: uploads; handle_stored_lists.c: lists of them */
void orl_handle_scene_list(struct orl_request *request);
void orl_handle_bsdf_list(struct orl_request *request);
void orl_handle_scene_post(struct orl_request *request);
void orl_handle_scene_get(struct orl_request *request);
void orl_handle_scene_delete(struct orl_request *request);
void orl_handle_bsdf_post(struct orl_request *request);
void orl_handle_bsdf_get(struct orl_request *request);
void orl_handle_bsdf_delete(struct orl_request *request);

/* handle_previews.c: previews: a scene's floor plan, directions of light from a BSDF */
void orl_handle_scene_outline(struct orl_request *request);
void orl_handle_bsdf_polar(struct orl_request *request);

/* handle_jobs.c: submitting, status, cancelling, removing; handle_job_list.c: the list;
 * handle_results.c: results and the job's document */
void orl_handle_job_post(struct orl_request *request);
void orl_handle_job_list(struct orl_request *request);
void orl_handle_job_get(struct orl_request *request);
void orl_handle_job_cancel(struct orl_request *request);
void orl_handle_job_delete(struct orl_request *request);
void orl_handle_job_result(struct orl_request *request);
void orl_handle_job_file(struct orl_request *request);
void orl_handle_job_document(struct orl_request *request);

/* handle_plans.c: the plan of a render job */
void orl_handle_plan_post(struct orl_request *request);

/* handle_session.c, handle_links.c: for browsers, which do not send tokens */
void orl_handle_session_get(struct orl_request *request);
void orl_handle_session_post(struct orl_request *request);
void orl_handle_session_delete(struct orl_request *request);
void orl_handle_job_links(struct orl_request *request);

/* handle_events.c: changes of jobs' states */
void orl_handle_job_events(struct orl_request *request);
void orl_handle_all_events(struct orl_request *request);

/* handle_stored_lists.c: photon maps and loaded BSDFs */
void orl_handle_map_list(struct orl_request *request);
void orl_handle_map_delete(struct orl_request *request);

/* routes.c: the table of all routes with their handlers */
extern const struct orl_routes orl_routes;

/*
 * Paged lists: their arguments, and the link to the next page (RFC 8288). Threads: the loop thread
 * only.
 */

/* Reads the argument limit, if given, from 1 to ORL_SERVER_LIST; an answer may have fewer items.
 * Returns false after a 400. */
bool orl_page_limit(struct orl_request *request, unsigned long *ret_limit);

/* Replies 400: an argument of the query is invalid. wanted: what it must be. Returns false. */
bool orl_page_refuse(struct orl_request *request, const char *wanted);

/*
 * Adds the header Link: <path?arguments&cursor=CURSOR>; rel="next" to the reply made. The arguments
 * are those of the request that names lists (ends with NULL). CURSOR may have letters, digits, '-'
 * and '.'.
 */
void orl_page_link(struct orl_request *request, const char *path, const char *const *names,
                   const char *cursor);

#endif
