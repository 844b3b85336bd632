/*
 * A job document on disk, as `oriel run` and `oriel submit` take it: JSON whose file names are
 * relative to the document's own folder.
 */
#ifndef ORL_CLIENT_JOB_FILE_H
#define ORL_CLIENT_JOB_FILE_H

#include <jansson.h>

#include <oriel/error.h>
#include <oriel/run.h>

struct orl_job_file {
    const char *path; /* borrowed from the command line */
    json_t *doc;      /* owned */
    char folder[4096];
};

/* Reads and parses the document; mistakes in the JSON come with file and line. */
int orl_job_file_read(const char *path, struct orl_job_file *ret_file, struct orl_error *err);
void orl_job_file_done(struct orl_job_file *file); /* NULL and half-filled are fine */

/* The document as a job, checked as far as that goes without the scene. */
int orl_job_file_decode(const struct orl_job_file *file, struct orl_job *ret_job,
                        struct orl_error *err);

/* Replaces "sensors": {"file": NAME} by the array the file holds, in grids, too; other forms stay
 * as they are. */
int orl_job_file_inline_sensors(struct orl_job_file *file, struct orl_error *err);

/* The same of views: those of files get the line that they ask for. */
int orl_job_file_inline_views(struct orl_job_file *file, struct orl_error *err);

#endif
