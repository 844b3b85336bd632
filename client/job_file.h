/*
 * A job document on disk, as `oriel run` and `oriel submit` take it: JSON whose file names are
 * relative to the document's own folder.
 */
#ifndef ORL_CLIENT_JOB_FILE_H
#define ORL_CLIENT_JOB_FILE_H

#include <jansson.h>

#include <oriel/error.h>
#include <oriel/run.h>

#include "project.h"

struct orl_job_file {
    const char *path; /* borrowed from the command line */
    json_t *doc;      /* owned */
    char folder[4096];
    struct orl_project_place project; /* that the document names, or is made of; else all zero */
};

/* Reads and parses the document; mistakes in the JSON come with file and line. A project that it
 * names as its scene is opened (project.h), and told of on stderr. */
int orl_job_file_read(const char *path, struct orl_job_file *ret_file, struct orl_error *err);

/* What the command line says of a project in place of a document. Borrowed. */
struct orl_project_line {
    const char *sky;    /* its name in the project, or "sky" of a job, as JSON; NULL */
    const char *states; /* "GROUP=STATE,..."; NULL */
    /* The weather file of a year, without which the job is no year; the calendar year of the rows
     * to use; the rules to judge by, as in "LEED,EN 17037". Each may be NULL. */
    const char *weather, *year, *rules;
};
/* The scene of a document that asks for it, a new reference, after an error, too. */
int orl_project_wish(const char *path, const struct orl_project_line *line, json_t **ret_scene,
                     struct orl_error *err);
/* The same, where path may be that of a project; wishes of any other are refused. */
#define ORL_OPTIONS_PROJECT(line)                                                                  \
    {.name = "sky",                                                                                \
     .metavar = "SKY",                                                                             \
     .help =                                                                                       \
         "of a project: one of its own by name (oriel project lists them), or a job's \"sky\" "    \
         "as JSON, whose weather file is looked for here and in the project",                      \
     .value = &(line)->sky},                                                                       \
    {                                                                                              \
        .name = "states", .metavar = "GROUP=STATE,...",                                            \
        .help = "of a project: which state its moving parts are in (default: the first)",          \
        .value = &(line)->states                                                                   \
    }
/* Options for a year of a project. */
#define ORL_OPTIONS_YEAR(line)                                                                     \
    {.name = "weather",                                                                            \
     .metavar = "FILE",                                                                            \
     .help = "of a project: the year's weather, EPW or WEA",                                       \
     .value = &(line)->weather},                                                                   \
        {.name = "year",                                                                           \
         .metavar = "YEAR",                                                                        \
         .help = "of a project: the year of the weather file's rows, if it has several",           \
         .value = &(line)->year},                                                                  \
    {                                                                                              \
        .name = "rules", .metavar = "NAME,...",                                                    \
        .help = "of a project: what it is held to, as \"LEED,EN 17037\"", .value = &(line)->rules  \
    }
/* The document, or the one that is made of the project: a year where the line has a weather file,
 * else a render job. */
int orl_job_file_open(const char *path, const struct orl_project_line *line,
                      struct orl_job_file *ret_file, struct orl_error *err);
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
