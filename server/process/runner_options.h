/* Where large jobs run, as the daemon's arguments say: here, or in parts by Slurm. */
#ifndef ORL_SERVER_PROCESS_RUNNER_OPTIONS_H
#define ORL_SERVER_PROCESS_RUNNER_OPTIONS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <oriel/error.h>

enum { ORL_RUNNER_WORDS = 32, ORL_RUNNER_NAMED = 4 };

struct orl_runner_options {
    bool slurm;
    /* Borrowed from argv; NULL: not given. */
    const char *shared;                  /* the folder that all nodes see */
    const char *named[ORL_RUNNER_NAMED]; /* of sbatch: partition, account, qos, constraint */
    const char *words[ORL_RUNNER_WORDS]; /* more of its options, as they are */
    size_t n_words;
    uint32_t parts;        /* of a wave, and tasks at once */
    uint32_t part_threads; /* of each */
    uint32_t least_s;      /* jobs of less than that, by one core, stay here */
    bool any;              /* some of this was given */
};

/* What sbatch calls those that are named: "partition", ... */
extern const char *const orl_runner_named[ORL_RUNNER_NAMED];

void orl_runner_options_init(struct orl_runner_options *options);
/* An argument; *ret_known: it is one of these. */
int orl_runner_options_apply(struct orl_runner_options *options, const char *name,
                             const char *value, bool *ret_known, struct orl_error *err);
/* What they mean together. */
int orl_runner_options_check(const struct orl_runner_options *options, struct orl_error *err);

#endif
