/* Writes the files of a job's results. Pool threads; no state. */
#ifndef ORL_SERVER_RUNNER_JOB_OUTPUT_H
#define ORL_SERVER_RUNNER_JOB_OUTPUT_H

#include <stdatomic.h>

#include <oriel/job/run.h>
#include <oriel/job/study.h>

#include "job/job_request_json.h"
#include "store/files/scene_bundle.h"

/* Makes orl_job_output_list on this thread poll *cancel from now on (ORL_ERR_CANCELLED); NULL: no
 * polling. */
void orl_job_output_set_cancel(const atomic_bool *cancel);

/* Writes the path of a result file. */
void orl_job_output_path(const char *folder, const char *name, char ret_path[ORL_PATH_MAX]);
/* Sync a file of the results, or those of a view, and append {"name", "bytes", "sha256"} of each to
 * list. A name that is NULL is skipped. */
int orl_job_output_list(const char *name, const char *folder, json_t *list, struct orl_error *err);
int orl_job_output_list_view(const struct orl_view_result *view, const char *folder, json_t *list,
                             struct orl_error *err);
int orl_job_output_list_sensors(const struct orl_sensor_files *sensors, const char *folder,
                                json_t *list, struct orl_error *err);
int orl_job_output_list_grids(const struct orl_result *result, const char *folder, json_t *list,
                              struct orl_error *err);

/* Does so for the files of a job's sequences (view_json.h), if it has any. */
int orl_job_output_list_sequence(const json_t *results, const char *folder, json_t *list,
                                 struct orl_error *err);

/* Removes all files from the folder that are not on the list. */
void orl_job_output_prune(const json_t *list, const char *folder);

/*
 * Writes result.json, with that state, into folder, and syncs it and the images. *ret_summary is
 * the JSON text stored with the job's row: {"technique", "threads", "timings_s", "maps",
 * "warnings", "accuracy" of a job with a goal, "files": [{"name", "bytes", "sha256"}]}, owned by
 * the caller. It has the first ORL_JOB_WARNINGS warnings.
 */
enum { ORL_JOB_WARNINGS = 32 };
int orl_job_output_write(const struct orl_result *result, const char *state, const char *folder,
                         char **ret_summary, struct orl_error *err);

/* Writes the result of one sky as <sky>.json, and appends it to the list of files. */
int orl_sky_output_write(const json_t *result, const char *sky, const char *folder, json_t *files,
                         struct orl_error *err);
/* Writes result.json, with that state, of a job of `count` skies. results: the finished skies
 * (result_json.h). Appends the file to the list. The summary is {"threads", "timings_s",
 * "skies": {"count", "done"}, "warnings", "files"}. */
int orl_skies_output_write(json_t *results, const char *state, size_t count, const char *folder,
                           json_t *files, char **ret_summary, struct orl_error *err);

/*
 * Writes result.json of an annual job, whose other files exist already, some in subfolders. The
 * summary is {"threads", "timings_s", "annual": {"accuracy", "verdicts": [{"rule", "target",
 * "grid", "unit", "value", "interval_95", "verdict", "note"}]}, "warnings", "files"}. It has the
 * first ORL_JOB_VERDICTS verdicts: those of rules, then of the job's own targets, then of rules'
 * targets.
 */
enum { ORL_JOB_VERDICTS = 64 };
int orl_annual_output_write(const json_t *document, const json_t *names, const char *folder,
                            char **ret_summary, struct orl_error *err);

/* Writes a study's result.json, study.csv, study.svg and study.png. The summary is {"threads",
 * "warnings", "files"}. */
int orl_study_output_write(const struct orl_study *study, const struct orl_study_request *request,
                           const char *folder, char **ret_summary, struct orl_error *err);

/*
 * Writes result.json of a job that made a BSDF, whose file exists already. The summary is
 * {"threads", "timings_s", "maps", "bsdf": {"id", "bytes"}, "warnings", "files"}. The timings are
 * the job's seconds, and those that making the BSDF took when it was made.
 */
struct orl_bsdf_output {
    json_t *report, *warnings; /* report and warnings of the BSDF; owned by the call */
    const struct orl_map_info *kept;
    const char *file, *id; /* name below folder; digest */
    size_t bytes;
    uint32_t threads;
    double total_s;
};
int orl_bsdf_output_write(const struct orl_bsdf_output *output, const char *folder,
                          char **ret_summary, struct orl_error *err);

#endif
