/*
 * Between a job's document, struct orl_job and the files of its results. Pool threads; no state.
 */
#ifndef ORL_SERVER_JOB_OUTPUT_H
#define ORL_SERVER_JOB_OUTPUT_H

#include <oriel/run.h>

#include "store/bundle.h"

/*
 * Parses and validates a job document. Returns the job (orl_job_done), without its scene's files,
 * and in *ret_scene_id (NULL is allowed) the scene's id, owned.
 */
int orl_job_read(const char *text, size_t size, struct orl_job *ret_job, char **ret_scene_id,
                 struct orl_error *err);

/* Gives the job the bundle's main files. */
int orl_job_set_scene(struct orl_job *job, const struct orl_bundle *bundle, struct orl_error *err);

/*
 * Writes result.json into folder and syncs it and the images. *ret_summary is the JSON text kept
 * with the job's row: {"threads", "timings_s", "maps", "files": [{"name", "bytes"}]}, owned.
 */
int orl_job_output_write(const struct orl_result *result, const char *folder, char **ret_summary,
                         struct orl_error *err);

#endif
