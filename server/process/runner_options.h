/* The daemon's options for large jobs: run here, or in parts by Slurm. */
#ifndef ORL_SERVER_PROCESS_RUNNER_OPTIONS_H
#define ORL_SERVER_PROCESS_RUNNER_OPTIONS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <oriel/base/error.h>

enum { ORL_RUNNER_WORDS = 32, ORL_RUNNER_NAMED = 4 };

struct orl_runner_options {
    bool slurm;
    /* Borrowed from argv; NULL: not given. */
    const char *shared;                  /* folder that all nodes can access */
    const char *named[ORL_RUNNER_NAMED]; /* sbatch options: partition, account, qos, constraint */
    const char *words[ORL_RUNNER_WORDS]; /* further sbatch options, passed on unchanged */
    size_t n_words;
    uint32_t parts;        /* parts of a round, which is also the number of concurrent tasks */
    uint32_t part_threads; /* threads of each part */
    uint32_t least_s;      /* jobs with less work than these seconds of one core run here */
    bool any;              /* true if any of these options was given */
};

/* Names of the sbatch options in `named`: "partition", ... */
extern const char *const orl_runner_named[ORL_RUNNER_NAMED];

void orl_runner_options_init(struct orl_runner_options *options);
/* Applies an argument. *ret_known: true if it is one of these options. */
int orl_runner_options_apply(struct orl_runner_options *options, const char *name,
                             const char *value, bool *ret_known, struct orl_error *err);
/* Checks the options against each other. */
int orl_runner_options_check(const struct orl_runner_options *options, struct orl_error *err);

#endif
