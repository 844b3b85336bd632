/*
 * Runners start the parts of a shared job (distributed_job.h): as processes on this machine, or by
 * Slurm. A part is a file WAVE-NUMBER.json in the shared folder, for `oriel part`. Files beside it
 * record that it is done or has failed. The runner only knows which parts are active.
 *
 * Slurm tasks have a name made of job and round, so that a run after a crash finds the tasks of the
 * run before it.
 */
#ifndef ORL_DISTRIBUTED_RUNNER_H
#define ORL_DISTRIBUTED_RUNNER_H

#include <stdatomic.h>
#include <stddef.h>
#include <stdint.h>

#include <oriel/base/error.h>

enum { ORL_TASK_ROUND_NAME = 64 };

enum orl_part_state {
    ORL_PART_UNKNOWN, /* the scheduler does not answer */
    ORL_PART_WAITING,
    ORL_PART_RUNNING,
    ORL_PART_GONE /* not active: ended or lost */
};

/* Limits for Slurm to enforce; 0: Slurm's own default. */
struct orl_part_limits {
    uint32_t minutes, mib;
};

/* A part to start. */
struct orl_part_request {
    uint32_t number;
    struct orl_part_limits limits;
};

/* A part as seen by its runner. */
struct orl_part_status {
    enum orl_part_state state;
    uint32_t task;                 /* Slurm's array job number; 0: none or unknown */
    struct orl_part_limits limits; /* limits it was submitted with, within Slurm's bounds */
};

/* Reason for the end of a part, as far as known. */
enum orl_part_end { ORL_PART_ENDED, ORL_PART_OUT_OF_TIME, ORL_PART_OUT_OF_MEMORY };

struct orl_runner {
    void *ctx;
    double files_delay_s; /* longest time until the files of an ended part are visible, seconds */
    /* Starts parts of a round; their numbers are below n_all. */
    int (*start)(void *ctx, const char *round, const struct orl_part_request *requests, size_t n,
                 size_t n_all, struct orl_error *err);
    /* Fills in ret_status for the n parts of the round, by number. */
    int (*poll)(void *ctx, const char *round, struct orl_part_status *ret_status, size_t n,
                struct orl_error *err);
    /* Returns why an ended part ended. NULL: the runner does not know. */
    enum orl_part_end (*end)(void *ctx, const char *round, uint32_t number);
    /* Ends all active parts of the round. After an error some may still be active. */
    int (*cancel)(void *ctx, const char *round, struct orl_error *err);
    void (*done)(void *ctx);
};

/* Configuration of a runner; all pointers are borrowed. */
struct orl_runner_spec {
    const char *folder;        /* the shared folder */
    const char *job;           /* digest of the job */
    const char *program;       /* path of the oriel program */
    uint32_t threads, most;    /* threads per part; parts at once */
    const char *const *words;  /* additional options for sbatch */
    size_t n_words;            /* number of words */
    const atomic_bool *cancel; /* set when an answer is no longer needed */
    double (*now_s)(void *ctx);
    double outage_limit_s; /* seconds that Slurm may be unavailable; 0: ORL_SLURM_OUTAGE_LIMIT_S */
    double command_s;      /* time limit for a Slurm command, seconds; 0: ORL_SLURM_COMMAND_S */
};

enum { ORL_SBATCH_OPTIONS_MAX = 64, ORL_SLURM_OUTAGE_LIMIT_S = 1800, ORL_SLURM_COMMAND_S = 30 };

/* Creates a runner that starts processes of the program. */
int orl_runner_local(const struct orl_runner_spec *spec, struct orl_runner *ret_runner,
                     struct orl_error *err);
/* Creates a runner that submits array jobs by sbatch. */
int orl_runner_slurm(const struct orl_runner_spec *spec, struct orl_runner *ret_runner,
                     struct orl_error *err);

/* Ends all Slurm tasks of a round; errors as for cancel above. Uses spec's job and clock. */
int orl_slurm_cancel(const struct orl_runner_spec *spec, const char *round, struct orl_error *err);

/* Returns the path of this program's file. */
int orl_own_program(char ret_path[4096], struct orl_error *err);

#endif
