/* Jobs in parts (sharing.h), as the command line asks for them. */
#ifndef ORL_CLIENT_SHARING_LINE_H
#define ORL_CLIENT_SHARING_LINE_H

#include <jansson.h>
#include <stdatomic.h>

#include "command.h"
#include "parts/sharing.h"

/* What it says. */
struct orl_sharing_line {
    const char *parts_text; /* --parts: of a wave, at the most */
    const char *sbatch;     /* --sbatch: options of it */
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

/* Whether the line asks for it; *ret_rc: ORL_EXIT_USAGE where it makes no sense. */
bool orl_sharing_asked(const struct orl_subcommand *self, const struct orl_sharing_line *line,
                       int *ret_rc);

/* A job that is shared, and what its specification borrows. */
struct orl_shared_job {
    struct orl_sharing sharing;
    char program[4096], folder[4096];
    char *options;                      /* owned; cut into words */
    const char *words[ORL_SLURM_WORDS]; /* in options */
    size_t n_words;
};

/* Lays it all out in output/parts, which is the owner's alone. doc: what names its scene's files
 * below folder. threads: of a part. The caller ends it with orl_shared_job_done, after an error,
 * too. */
int orl_shared_job_open(struct orl_shared_job *job, const struct orl_sharing_line *line,
                        const json_t *doc, const char *folder, const char *output, uint32_t threads,
                        const atomic_bool *cancel, struct orl_error *err);
/* With how many parts there were, on stderr. remove: the folder goes, with all pieces. */
void orl_shared_job_done(struct orl_shared_job *job, bool remove);

#endif
