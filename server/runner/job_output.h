/*
 * Between a job's document, what it asks for, and the files of its results. Pool threads; no state.
 */
#ifndef ORL_SERVER_RUNNER_JOB_OUTPUT_H
#define ORL_SERVER_RUNNER_JOB_OUTPUT_H

#include <stdatomic.h>

#include <oriel/run.h>
#include <oriel/study.h>

#include "store/bundle.h"
#include "task_json.h"

/*
 * Parses and validates a document. Returns what it asks for (orl_task_done), without the files
 * of its scene, and in *ret_scene_id (NULL is allowed) the scene's id, owned.
 */
int orl_job_read(const char *text, size_t size, struct orl_task *ret_task, char **ret_scene_id,
                 struct orl_error *err);

/* Gives the job the bundle's main files. */
int orl_job_set_scene(struct orl_task *task, const struct orl_bundle *bundle,
                      struct orl_error *err);

/* From now on orl_job_output_list, on this thread, heeds *cancel (ORL_ERR_CANCELLED); NULL:
 * nothing. */
void orl_job_output_heed(const atomic_bool *cancel);

/* Where a file of the results is. */
void orl_job_output_path(const char *folder, const char *name, char ret_path[ORL_PATH_MAX]);
/* Syncs a file of the results, or those of a view, and appends {"name", "bytes", "sha256"} of each
 * to list. */
int orl_job_output_list(const char *name, const char *folder, json_t *list, struct orl_error *err);
int orl_job_output_list_view(const struct orl_view_result *view, const char *folder, json_t *list,
                             struct orl_error *err);
int orl_job_output_list_sensors(const struct orl_sensor_files *sensors, const char *folder,
                                json_t *list, struct orl_error *err);
int orl_job_output_list_grids(const struct orl_result *result, const char *folder, json_t *list,
                              struct orl_error *err);

/* The same of the files of a job's sequences (sequence_json.h), if it has any. */
int orl_job_output_list_sequence(const json_t *results, const char *folder, json_t *list,
                                 struct orl_error *err);

/* Removes whatever else is in the folder. */
void orl_job_output_prune(const json_t *list, const char *folder);

/*
 * Writes result.json, with that state, into folder and syncs it and the images. *ret_summary is the
 * JSON text kept with the job's row: {"technique", "threads", "timings_s", "maps", "warnings",
 * "accuracy" of a job with a goal, "files": [{"name", "bytes", "sha256"}]}, owned; of warnings the
 * first ORL_JOB_WARNINGS.
 */
enum { ORL_JOB_WARNINGS = 32 };
int orl_job_output_write(const struct orl_result *result, const char *state, const char *folder,
                         char **ret_summary, struct orl_error *err);

/* The result of one sky as <sky>.json, on the list of files ... */
int orl_sky_output_write(const json_t *result, const char *sky, const char *folder, json_t *files,
                         struct orl_error *err);
/* ... and those that are done, of count (skies_result_json.h), with that state, which is added to
 * the list; the summary is {"threads", "timings_s", "skies": {"count", "done"}, "warnings",
 * "files"}. */
int orl_skies_output_write(json_t *results, const char *state, size_t count, const char *folder,
                           json_t *files, char **ret_summary, struct orl_error *err);

/*
 * The same of a year, whose files but result.json are there already, some in folders: the summary
 * is {"threads", "timings_s", "annual": {"accuracy", "verdicts": [{"rule", "target", "grid",
 * "unit", "value", "interval_95", "verdict", "note"}]}, "warnings", "files"}, of verdicts the first
 * ORL_JOB_VERDICTS: of rules, of the job's own targets, then of rules' targets.
 */
enum { ORL_JOB_VERDICTS = 64 };
int orl_annual_output_write(const json_t *document, const json_t *names, const char *folder,
                            char **ret_summary, struct orl_error *err);

/* The same of a study: result.json, study.csv, study.svg, study.png; {"threads", "warnings",
 * "files"}. */
int orl_study_output_write(const struct orl_study *study, const struct orl_study_request *request,
                           const char *folder, char **ret_summary, struct orl_error *err);

/*
 * The same of a BSDF that was made, whose file is there already: {"threads", "timings_s", "maps",
 * "bsdf":
 * {"id", "bytes"}, "warnings", "files"}. seconds: that the job took, and that making it did once.
 */
struct orl_bsdf_output {
    json_t *told, *warnings; /* of what was made; taken */
    const struct orl_map_info *kept;
    const char *file, *id; /* its name below folder; its digest */
    size_t bytes;
    uint32_t threads;
    double total_s;
};
int orl_bsdf_output_write(const struct orl_bsdf_output *output, const char *folder,
                          char **ret_summary, struct orl_error *err);

#endif
