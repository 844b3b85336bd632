/*
 * Runners start the parts of a shared job (distributed_job.h): as processes on this machine, or by
 * Slurm. A part is a file WAVE-NUMBER.json in the shared folder, for `oriel part`. Files beside it
 * record that it is done or has failed. The runner only knows which parts are active. Below are
 * the programs that runners call, the limits of a part, and the bounds of a cluster.
 *
 * Slurm tasks have a name made of job and round, so that a run after a crash finds the tasks of the
 * run before it.
 */
#ifndef ORL_DISTRIBUTED_RUNNER_H
#define ORL_DISTRIBUTED_RUNNER_H

#include <stdatomic.h>
#include <stdbool.h>
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

/* Runs other programs by an argument vector, to their end within a time limit. */

enum { ORL_COMMAND_OUTPUT = 1 << 16 };

/*
 * Runs argv[0], found by PATH. ret_output: output and errors of the program, cut at the end if
 * too long; "" after an error. Returns the exit status (128 plus the number for a signal), or a
 * negative orl_err. ORL_ERR_NOT_FOUND: it cannot be started. ORL_ERR_IO: it exceeded the time
 * limit and was killed. ORL_ERR_CANCELLED: killed because *cancel was set (cancel NULL: never).
 */
int orl_command_run(char *const argv[], double limit_s, const atomic_bool *cancel,
                    char ret_output[ORL_COMMAND_OUTPUT], struct orl_error *err);

/*
 * Limits of memory and time for a part under Slurm. They are the estimate for its
 * tasks, with a margin because scenes and machines differ by factors. A part that exceeds a
 * limit is tried again with twice as much (task_round.c).
 */

/* Estimated needs of a part: time is the sum over its tasks, memory the maximum. */
struct orl_part_needs {
    double core_s;  /* seconds on one core; 0: unknown */
    uint64_t bytes; /* memory in addition to the job's own */
};

/* Facts about the job. */
struct orl_part_limits_input {
    double load_s;         /* seconds that the lead process needed to load; a part takes as long */
    double time_ratio;     /* actual over estimated seconds of ended parts */
    uint32_t threads;      /* threads per part */
    uint64_t memory_bytes; /* memory of the whole job with its tasks; 0: unknown, estimated as this
                              process's memory plus the tasks */
};

enum { ORL_PART_LEAST_MINUTES = 10, ORL_PART_LEAST_MIB = 256 };

struct orl_part_limits orl_part_limits(const struct orl_part_needs *needs,
                                       const struct orl_part_limits_input *input);

/* Returns the limits with the exceeded one doubled. */
struct orl_part_limits orl_part_limits_raised(struct orl_part_limits limits, enum orl_part_end end);

/*
 * Facts about a cluster for the Slurm runner: the largest time and memory for a part, and the
 * limit that an ended part exceeded.
 */

struct orl_slurm_bounds {
    bool known;
    struct orl_part_limits most; /* 0: no limit is requested */
};

/*
 * Gets the bounds from sinfo, for the partition in the options or else the default one. A bound
 * is 0 if the options set that limit or the cluster does not report its memory. If Slurm does
 * not answer, bounds stay unknown.
 */
void orl_slurm_bounds_query(const struct orl_runner_spec *spec, struct orl_slurm_bounds *bounds);

/* Returns limits reduced to the bounds. */
struct orl_part_limits orl_slurm_bounded(const struct orl_slurm_bounds *bounds,
                                         struct orl_part_limits limits);

/* Returns true if the output of a failed sbatch means a temporary failure, so that a retry may
 * succeed. Without a word it was ended from outside, as by a kernel without memory. */
bool orl_slurm_is_temporary_failure(const char *output);

/* Returns why a task of that name ended: from its log, and from squeue while that still lists
 * it. */
enum orl_part_end orl_slurm_end_reason(const struct orl_runner_spec *spec, const char *tasks,
                                       uint32_t task, uint32_t number);

#endif
