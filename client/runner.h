/*
 * Who runs the parts of a shared job (sharing.h): processes of this machine, or Slurm. A part is a
 * file, WAVE-NUMBER.json in the shared folder, for `oriel part`; whether it is done, or failed, is
 * told by files beside it, and not by its runner, who only knows which are under way.
 */
#ifndef ORL_CLIENT_RUNNER_H
#define ORL_CLIENT_RUNNER_H

#include <stddef.h>
#include <stdint.h>

#include <oriel/error.h>

enum orl_part_state {
    ORL_PART_UNKNOWN, /* who would know does not answer */
    ORL_PART_WAITING,
    ORL_PART_RUNNING,
    ORL_PART_GONE /* not under way: ended, or lost */
};

struct orl_runner {
    void *ctx;
    /* Starts these parts of a wave. */
    int (*start)(void *ctx, const char *wave, const uint32_t *numbers, size_t n,
                 struct orl_error *err);
    /* Of each of so many parts of the wave under way, by number. */
    int (*look)(void *ctx, enum orl_part_state *ret_states, size_t n, struct orl_error *err);
    /* Ends all that are under way. */
    void (*cancel)(void *ctx);
    void (*done)(void *ctx);
};

/* Both: folder is the shared one, borrowed; threads: of a part. */

/* Processes of this program, as many at once as that. */
int orl_runner_local(const char *folder, uint32_t threads, uint32_t most,
                     struct orl_runner *ret_runner, struct orl_error *err);
/* Array jobs by sbatch, as many tasks at once as that. options: more of sbatch's, with spaces
 * between them; NULL: none. */
int orl_runner_slurm(const char *folder, uint32_t threads, uint32_t most, const char *options,
                     struct orl_runner *ret_runner, struct orl_error *err);

#endif
