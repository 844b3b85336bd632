/*
 * Where jobs in parts (parts/sharing.h) lie, and how their tasks are handed to Slurm: the daemon's
 * options (process/runner_options.h), looked over once at its start.
 *
 * A job's folder is below the shared one, by its id. The shared folder is the daemon's user's
 * alone, as it holds what others have uploaded.
 */
#ifndef ORL_SERVER_RUNNER_SHARED_PLACE_H
#define ORL_SERVER_RUNNER_SHARED_PLACE_H

#include "process/runner_options.h"
#include "store/folders.h"

enum { ORL_SHARED_WORD = 256 };

/* Does not move once it is open: words point into it. */
struct orl_shared_place {
    char folder[ORL_PATH_MAX], program[ORL_PATH_MAX]; /* program: oriel */
    char named[ORL_RUNNER_NAMED][ORL_SHARED_WORD];
    const char *words[ORL_RUNNER_NAMED + ORL_RUNNER_WORDS]; /* some borrowed from the options */
    size_t n_words;
    uint32_t parts, part_threads, least_s;
};

/* Makes the shared folder, should there be none. */
int orl_shared_place_open(const struct orl_runner_options *options,
                          struct orl_shared_place *ret_place, struct orl_error *err);

#endif
