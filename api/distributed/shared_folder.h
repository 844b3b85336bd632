/*
 * The folder of a shared job (distributed_job.h) on disk:
 *
 *     job.json, files.json ({"NAME": "SHA-256"}), files/NAME   the job
 *     store/KIND-KEY.opm                                       tasks made
 *     WAVE-NUMBER.json, each with .done or .error              parts
 *     WAVE.wave                                                a round that has not ended
 *     WAVE.slurm                                               Slurm's job numbers
 *
 * Only its owner has access.
 */
#ifndef ORL_DISTRIBUTED_SHARED_FOLDER_H
#define ORL_DISTRIBUTED_SHARED_FOLDER_H

#include <jansson.h>
#include <stddef.h>

#include <oriel/base/error.h>
#include <oriel/job/job_tasks.h>

struct orl_shared_file {
    const char *name, *path; /* name in the job, and path of the file */
};

/*
 * Creates the job's folder at path. It replaces the folder of another job, but keeps one of the
 * same job by the same program version. A folder that no run created is left alone: an error.
 * *ret_job: digest of the document and files. *ret_earlier: number of tasks from an earlier
 * run.
 */
int orl_shared_folder_make(const char *path, const json_t *doc, const struct orl_shared_file *files,
                           size_t n_files, char ret_job[ORL_JOB_TASK_KEY], size_t *ret_earlier,
                           struct orl_error *err);

/* Computes the digest of the document and files in such a folder, and checks the files against
 * their digests. */
int orl_shared_folder_verify(const char *folder, char ret_job[ORL_JOB_TASK_KEY], json_t **ret_doc,
                             struct orl_error *err);

/* Makes a network file system look again for files that were absent. */
void orl_shared_folder_refresh(const char *folder);

#endif
