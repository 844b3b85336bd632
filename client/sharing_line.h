/* Command-line options for jobs in parts (sharing.h). */
#ifndef ORL_CLIENT_SHARING_LINE_H
#define ORL_CLIENT_SHARING_LINE_H

#include <jansson.h>
#include <stdatomic.h>

#include "command.h"
#include "parts/sharing.h"

/* Values of the options. */
struct orl_sharing_line {
    const char *parts_text; /* --parts: largest number of parts in a wave */
    const char *sbatch;     /* --sbatch: options for it */
    bool slurm;             /* --slurm */
};
#define ORL_OPTIONS_SHARING(line)                                                                  \
    {.name = "parts",                                                                              \
     .metavar = "N",                                                                               \
     .help = "do it in up to N parts at a time, each a process of its own; same results",          \
     .value = &(line)->parts_text},                                                                \
        {.name = "slurm",                                                                          \
         .help = "parts are tasks of Slurm; DIR and this program are where all nodes see them",    \
         .flag = &(line)->slurm},                                                                  \
    {                                                                                              \
        .name = "sbatch", .metavar = "OPTIONS",                                                    \
        .help = "with --slurm: more options of sbatch, as \"--partition=long --time=60\"",         \
        .value = &(line)->sbatch                                                                   \
    }
enum { ORL_SHARING_OPTIONS = 3 };

/* Returns true if the line asks for parts. *ret_rc: ORL_EXIT_USAGE if the options are invalid. */
bool orl_sharing_asked(const struct orl_subcommand *self, const struct orl_sharing_line *line,
                       int *ret_rc);

/* A shared job, and the data that its specification borrows. */
struct orl_shared_job {
    struct orl_sharing sharing;
    char program[4096], folder[4096];
    char *options;                      /* owned; split into words */
    const char *words[ORL_SLURM_WORDS]; /* pointers into options */
    size_t n_words;
};

/* Lays the job out in output/parts, which only its owner may access. doc: names its scene's
 * files below folder. threads: per part. Call orl_shared_job_done afterwards, also after an
 * error. */
int orl_shared_job_open(struct orl_shared_job *job, const struct orl_sharing_line *line,
                        const json_t *doc, const char *folder, const char *output, uint32_t threads,
                        const atomic_bool *cancel, struct orl_error *err);
/* Ends the job and reports the number of parts on stderr. remove: also removes the folder with
 * all pieces. */
void orl_shared_job_done(struct orl_shared_job *job, bool remove);

#endif
