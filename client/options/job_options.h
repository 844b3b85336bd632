/*
 * Options that several commands share: members of a document, and jobs in parts.
 *
 * Members of a document: a command that accepts either a document or options
 * turns the options into a document first, so that both are checked by the same code.
 */
#ifndef ORL_CLIENT_OPTIONS_JOB_OPTIONS_H
#define ORL_CLIENT_OPTIONS_JOB_OPTIONS_H

#include <jansson.h>
#include <stdatomic.h>

#include "distributed/distributed_job.h"
#include "options/command.h"

enum { ORL_MEMBER_OPTIONS_MAX = 8 };

/* A member of the document, set by an option of its name. */
struct orl_member_option {
    const char *name, *metavar, *help;
    bool is_text; /* true: a string; false: a number, if it is one */
};

/* Members of a command, and their values on the line, NULL if absent. Borrowed. */
struct orl_member_options {
    const struct orl_member_option *items;
    size_t count; /* at most ORL_MEMBER_OPTIONS_MAX */
    const char *texts[ORL_MEMBER_OPTIONS_MAX];
};

/* Fills in one option per member. */
void orl_member_options_fill(struct orl_member_options *member_options,
                             struct orl_option *ret_options);
/* Sets the members in doc. Returns nonzero when out of memory or if text is not UTF-8. A value
 * that should be a number but is none is added as text, so that the decoder refuses it by name. */
int orl_member_options_apply(const struct orl_member_options *member_options, json_t *doc);
bool orl_member_options_any(const struct orl_member_options *member_options);
/* Makes a document of that kind, whose member names the files, with the members of the options. A
 * new reference; NULL: out of memory, or text is not UTF-8. */
json_t *orl_member_options_document(const struct orl_member_options *member_options,
                                    const char *kind, const char *member,
                                    const struct orl_operands *files);

/* Returns true if an operand is a document: FILE.json. */
bool orl_is_document_name(const char *operand);

/* Command-line options for jobs in parts (distributed_job.h). */

/* Values of the options. */
struct orl_distributed_options {
    const char *parts_text; /* --parts: largest number of parts in a round */
    const char *sbatch;     /* --sbatch: options for it */
    bool slurm;             /* --slurm */
};
#define ORL_OPTIONS_DISTRIBUTED(line)                                                              \
    {.name = "parts",                                                                              \
     .metavar = "N",                                                                               \
     .help = "compute in up to N parts, each in its own process",                                  \
     .value = &(line)->parts_text},                                                                \
        {.name = "slurm",                                                                          \
         .help = "run the parts as Slurm tasks; all nodes must see DIR",                           \
         .flag = &(line)->slurm},                                                                  \
    {                                                                                              \
        .name = "sbatch", .metavar = "OPTIONS",                                                    \
        .help = "options for sbatch, as \"--partition=long --time=60\"", .value = &(line)->sbatch  \
    }
enum { ORL_DISTRIBUTED_OPTIONS = 3 };

/* Returns true if the line asks for parts. *ret_rc: ORL_EXIT_USAGE if the options are invalid. */
bool orl_distributed_is_requested(const struct orl_subcommand *self,
                                  const struct orl_distributed_options *line, int *ret_rc);

/* Sharing of a run with other processes (oriel/job/job_tasks.h), and the store of its tasks and
 * maps. Borrowed. */
struct orl_local_distribution {
    const struct orl_job_tasks *tasks;
    const struct orl_map_store *store;
};

/* A job that may be shared, and the data that its specification borrows. */
struct orl_local_distributed {
    const struct orl_local_distribution *distribution; /* NULL: it is not shared */
    struct orl_local_distribution shared;
    struct orl_distributed_job distributed;
    char program[4096], folder[4096];
    char *options;                             /* owned; split into words */
    const char *words[ORL_SBATCH_OPTIONS_MAX]; /* pointers into options */
    size_t n_words;
};

/* Lays the job out in output/parts, which only its owner may access. line: NULL if the job is not
 * shared; then nothing is done. doc: names its scene's files below folder. threads: per part. Call
 * orl_local_distributed_done afterwards, also after an error. */
int orl_local_distributed_open(struct orl_local_distributed *job,
                               const struct orl_distributed_options *line, const json_t *doc,
                               const char *folder, const char *output, uint32_t threads,
                               struct orl_error *err);
/* Ends a shared job and reports the number of parts on stderr. remove: also removes the folder with
 * all tasks. */
void orl_local_distributed_done(struct orl_local_distributed *job, bool remove);

#endif
