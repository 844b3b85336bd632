/*
 * Who runs the parts of a shared job (sharing.h): processes of this machine, or Slurm. A part is a
 * file, WAVE-NUMBER.json in the shared folder, for `oriel part`; whether it is done, or failed, is
 * told by files beside it, and not by its runner, who only knows which are under way.
 *
 * Slurm's tasks go by a name, made of the job and the wave: a run that has lost its memory finds
 * those of the run before it again.
 */
#ifndef ORL_PARTS_RUNNER_H
#define ORL_PARTS_RUNNER_H

#include <stdatomic.h>
#include <stddef.h>
#include <stdint.h>

#include <oriel/error.h>

enum { ORL_WAVE_NAME = 64 };

enum orl_part_state {
    ORL_PART_UNKNOWN, /* who would know does not answer */
    ORL_PART_WAITING,
    ORL_PART_RUNNING,
    ORL_PART_GONE /* not under way: ended, or lost */
};

/* What Slurm is to hold a part to; 0: to nothing but its own. */
struct orl_part_limits {
    uint32_t minutes, mib;
};

/* A part to be started. */
struct orl_part_order {
    uint32_t number;
    struct orl_part_limits limits;
};

/* What its runner knows of one. */
struct orl_part_seen {
    enum orl_part_state state;
    uint32_t task; /* of Slurm: the number of its array job; 0: none, or not known */
    struct orl_part_limits limits; /* that it was handed in with: no more than Slurm gives */
};

/* How one that is gone has ended, as far as that is known. */
enum orl_part_end { ORL_PART_ENDED, ORL_PART_OUT_OF_TIME, ORL_PART_OUT_OF_MEMORY };

struct orl_runner {
    void *ctx;
    double settle_s; /* what a part that is gone has written may take so long to be seen */
    /* Starts these parts of a wave, numbers below n_all. */
    int (*start)(void *ctx, const char *wave, const struct orl_part_order *orders, size_t n,
                 size_t n_all, struct orl_error *err);
    /* Of each of so many parts of the wave, by number. */
    int (*look)(void *ctx, const char *wave, struct orl_part_seen *ret_seen, size_t n,
                struct orl_error *err);
    /* Of one that is gone. NULL: of this runner nobody knows. */
    enum orl_part_end (*end)(void *ctx, const char *wave, uint32_t number);
    /* Ends all of the wave that are under way; an error: some may still be. */
    int (*cancel)(void *ctx, const char *wave, struct orl_error *err);
    void (*done)(void *ctx);
};

/* All borrowed. */
struct orl_runner_spec {
    const char *folder;        /* the shared one */
    const char *job;           /* a digest of it */
    const char *program;       /* oriel, by its path */
    uint32_t threads, most;    /* of a part; parts at once */
    const char *const *words;  /* more of sbatch's options */
    size_t n_words;            /* of them */
    const atomic_bool *cancel; /* nobody waits for an answer any more */
    double (*now_s)(void *ctx);
    double patience_s; /* Slurm may be away so long; 0: ORL_SLURM_PATIENCE_S */
    double command_s;  /* and one of its commands take so long; 0: ORL_SLURM_COMMAND_S */
};

enum { ORL_SLURM_WORDS = 64, ORL_SLURM_PATIENCE_S = 1800, ORL_SLURM_COMMAND_S = 30 };

/* Processes of the program. */
int orl_runner_local(const struct orl_runner_spec *spec, struct orl_runner *ret_runner,
                     struct orl_error *err);
/* Array jobs by sbatch. */
int orl_runner_slurm(const struct orl_runner_spec *spec, struct orl_runner *ret_runner,
                     struct orl_error *err);

/* Ends what Slurm has of a wave; as cancel above. Of spec: job and clock. */
int orl_slurm_cancel(const struct orl_runner_spec *spec, const char *wave, struct orl_error *err);

/* The path of this program's own file. */
int orl_own_program(char ret_path[4096], struct orl_error *err);

#endif
