/*
 * A job document on disk, as used by `oriel run` and `oriel submit`. Its file names are
 * relative to the document's own folder.
 */
#ifndef ORL_CLIENT_INPUT_JOB_FILE_H
#define ORL_CLIENT_INPUT_JOB_FILE_H

#include <jansson.h>

#include <oriel/base/error.h>
#include <oriel/job/run.h>

#include "input/project_folder.h"

struct orl_job_file {
    const char *path; /* borrowed from the command line */
    json_t *doc;      /* owned */
    char folder[4096];
    struct orl_project_folder
        project; /* project that the document names or is made from; else all zero */
};

/* Reads and parses the document; JSON errors have file and line. If its scene names a project,
 * the project is opened (project_folder.h) and listed on stderr. */
int orl_job_file_read(const char *path, struct orl_job_file *ret_file, struct orl_error *err);

/* Takes a document from memory, and resolves its project likewise. path: for messages, borrowed.
 * doc: borrowed, and changed. */
int orl_job_file_make(json_t *doc, const char *path, struct orl_job_file *ret_file,
                      struct orl_error *err);
/* Links a file into the folder of a document made from a project, by its own name. */
int orl_job_file_link(const struct orl_job_file *file, const char *path, struct orl_error *err);

/* Options for a project that is given in place of a document. Borrowed. */
struct orl_project_line {
    const char *sky;    /* name of a sky of the project, or a job's "sky" as JSON; or NULL */
    const char *states; /* "GROUP=STATE,..."; NULL */
    /* For a year: its weather file, the calendar year of its rows, and the rules to judge by,
     * such as "LEED,EN 17037". Each may be NULL; without weather the job is no year. */
    const char *weather, *year, *rules;
};
/* Makes the "scene" member that these options ask for. *ret_scene is a new reference, also
 * after an error. */
int orl_project_scene_to_json(const char *path, const struct orl_project_line *line,
                              json_t **ret_scene, struct orl_error *err);
/* Rows of options of all commands that accept a project: its sky and states. With other operands
 * they are refused. */
#define ORL_OPTIONS_PROJECT(line)                                                                  \
    {.name = "sky",                                                                                \
     .metavar = "SKY",                                                                             \
     .help = "a project's sky: its name, or a job's \"sky\" as JSON",                              \
     .value = &(line)->sky},                                                                       \
    {                                                                                              \
        .name = "states", .metavar = "GROUP=STATE,...",                                            \
        .help = "states of a project's window groups (default: first)", .value = &(line)->states   \
    }
/* Rows of run, submit and annual: those above, and a year of the project. */
#define ORL_OPTIONS_MODEL(line)                                                                    \
    ORL_OPTIONS_PROJECT(line),                                                                     \
        {.name = "weather",                                                                        \
         .metavar = "FILE",                                                                        \
         .help = "compute a project's year: weather file, EPW or WEA",                             \
         .value = &(line)->weather},                                                               \
        {.name = "year",                                                                           \
         .metavar = "YEAR",                                                                        \
         .help = "year of the weather file's rows, if it has several",                             \
         .value = &(line)->year},                                                                  \
    {                                                                                              \
        .name = "rules", .metavar = "NAME,...",                                                    \
        .help = "rules for a project's year, as \"LEED,EN 17037\"", .value = &(line)->rules        \
    }
enum { ORL_MODEL_OPTIONS = 5 }; /* rows of ORL_OPTIONS_MODEL */
/* Returns true if the line asks for a year of a project. */
bool orl_project_line_has_year(const struct orl_project_line *line);
/* Opens the document, or makes one for the project: a year if the line has a weather file, else
 * a render job. */
int orl_job_file_open(const char *path, const struct orl_project_line *line,
                      struct orl_job_file *ret_file, struct orl_error *err);
void orl_job_file_done(struct orl_job_file *file); /* NULL and half-filled are fine */

/* Decodes the document as a job, checked as far as possible without the scene. */
int orl_job_file_decode(const struct orl_job_file *file, struct orl_job *ret_job,
                        struct orl_error *err);

/* Replaces "sensors": {"file": NAME} by the file's array, also in grids. Other forms are left
 * as they are. */
int orl_job_file_inline_sensors(struct orl_job_file *file, struct orl_error *err);

/* Replaces files of views likewise by the view lines that they name. */
int orl_job_file_inline_views(struct orl_job_file *file, struct orl_error *err);

#endif
