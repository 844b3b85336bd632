/*
 * Views that are done before their job is, kept so that a job started anew need not render them
 * again.
 *
 * A job's work folder (partial/<job>) holds the images as they are made and, once those of a view
 * are synced, a note <view>.done beside them that names them. A note of another version of Oriel,
 * whose pictures might differ, is not believed. The notes go before the folder becomes the job's
 * results; the folder goes with a job that fails or is cancelled, and stays with one that is queued
 * again.
 *
 * Threads: any, one per folder.
 */
#ifndef ORL_SERVER_KEPT_VIEWS_H
#define ORL_SERVER_KEPT_VIEWS_H

#include <jansson.h>
#include <stdbool.h>

#include <oriel/run.h>

#include "store/folders.h"

/* Where the job works. */
void orl_kept_views_folder(const struct orl_folders *folders, const char *job_id,
                           char ret_path[ORL_PATH_MAX]);

/* Syncs the view's images and writes its note. */
int orl_kept_views_add(const char *folder, const struct orl_view_result *view,
                       struct orl_error *err);
/* Is the view of that name kept? Then *ret_view is filled: strings are the caller's. */
bool orl_kept_views_find(const char *folder, const char *name, struct orl_view_result *ret_view);
/* Removes the notes of the job's views. */
void orl_kept_views_forget(const char *folder, const struct orl_job *job);

/* Appends {"name", "bytes"} of each of the view's images to files. */
void orl_kept_views_list(const char *folder, const struct orl_view_result *view, json_t *files);

/* Removes the work folders of all jobs but those that are wanted. */
void orl_kept_views_sweep(const struct orl_folders *folders,
                          bool (*wanted)(void *ctx, const char *job_id), void *ctx);

#endif
