#include "distributed/task_round.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include "distributed/runner.h"
#include "json/problem.h"

/* State of a part. */
struct part {
    bool done, due;               /* due: true if it is to be started */
    bool reported;                /* true if its start was reported */
    unsigned tries, limit_raises; /* limit_raises: number of times that its limits were raised */
    enum orl_part_state state;
    struct orl_part_needs needs;
    struct orl_part_limits limits; /* requested limits */
    double gone_s;                 /* time when the runner stopped listing it; 0: it is listed */
    double started_s;              /* start time; 0: not running */
    double held_until_s;           /* time until which it is held back; 0: not held */
};

/* The parts of a round and their states. */
struct task_round {
    char name[ORL_TASK_ROUND_NAME];
    size_t n;
    struct part *parts;
    struct orl_part_status *status;    /* states reported by the runner */
    struct orl_part_request *requests; /* room for all parts */
    double began_s;
    double fraction;       /* reported fraction done */
    double ended_s, ended; /* for ended parts that were seen running: seconds and work */
};

/* Returns the seconds that the part has been running; 0 if it is not. */
static double part_elapsed_s(const struct orl_distributed_job *distributed, const struct part *part)
{
    return part->started_s > 0 ? distributed->spec.now_s(NULL) - part->started_s : 0;
}

/* ---- Parts ----------------------------------------------------------------------------------- */

static void report_event(const struct orl_distributed_job *distributed,
                         const struct task_round *round, size_t i, const char *what,
                         const char *why)
{
    const struct orl_part_status *status = &round->status[i];
    const struct orl_part_event event = {.what = what,
                                         .round = round->name,
                                         .part = (uint32_t)i,
                                         .task = status->task,
                                         .ran_s = part_elapsed_s(distributed, &round->parts[i]),
                                         .limits = status->limits,
                                         .why = why};
    if (distributed->spec.part_event)
        distributed->spec.part_event(distributed->spec.ctx, &event);
}

/* Reports "start" once per try, even if the try was short. */
static void report_part_start(const struct orl_distributed_job *distributed,
                              struct task_round *round, size_t i)
{
    if (!round->parts[i].reported)
        report_event(distributed, round, i, "start", NULL);
    round->parts[i].reported = true;
}

/* Reports "end", "again" or "failed", with the reason, and before it the start. */
static void report_part(const struct orl_distributed_job *distributed, struct task_round *round,
                        size_t i, const char *what, const char *why)
{
    report_part_start(distributed, round, i);
    report_event(distributed, round, i, what, why);
}

/* ---- The round ------------------------------------------------------------------------------- */

/* Returns a part's weight in its round: estimated seconds on one node, or 1 if estimates are
 * missing. */
static double part_weight(const struct orl_distributed_job *distributed, const struct part *part,
                          bool known)
{
    return known ? part->needs.core_s / fmax(distributed->spec.threads, 1) : 1;
}

static bool is_known(const struct task_round *round)
{
    bool known = round->n > 0;
    for (size_t i = 0; i < round->n; i++)
        known = known && round->parts[i].needs.core_s > 0;
    return known;
}

/* Records a part that has ended well; its time scales the estimates for others. */
static void add_timing(struct orl_distributed_job *distributed, struct task_round *round,
                       const struct part *part)
{
    const double actual_s = part_elapsed_s(distributed, part);
    if (!(actual_s > 0))
        return;
    round->ended_s += actual_s;
    round->ended += part_weight(distributed, part, is_known(round));
    if (!(part->needs.core_s > 0))
        return;
    distributed->actual_s += actual_s;
    distributed->estimated_s += part_weight(distributed, part, true);
}

/*
 * Returns the fraction of the round's work that is done. A running part counts by its elapsed
 * time over its estimated time. The estimate is scaled by the time ratio of ended parts, if any. An
 * overrunning part counts as at most 90 % done.
 */
static double fraction_done(const struct orl_distributed_job *distributed,
                            const struct task_round *round)
{
    const double most = 0.9;
    const bool known = is_known(round), measured = round->ended > 0;
    const double before =
        distributed->estimated_s > 0 ? distributed->actual_s / distributed->estimated_s : 1;
    const double time_ratio = measured ? round->ended_s / round->ended : before;
    double made = 0, all = 0;
    for (size_t i = 0; i < round->n; i++) {
        const struct part *part = &round->parts[i];
        const double own = part_weight(distributed, part, known),
                     estimated_s_of_part = time_ratio * own;
        all += own;
        if (part->done)
            made += own;
        else if ((known || measured) && estimated_s_of_part > 0)
            made += own * fmin(part_elapsed_s(distributed, part) / estimated_s_of_part, most);
    }
    return all > 0 ? made / all : 0;
}

/* Reports the fraction done to the run's watch (oriel/job/job_tasks.h). */
static void report_progress(const struct orl_distributed_job *distributed, struct task_round *round)
{
    if (!distributed->watch)
        return;
    round->fraction = fmin(fmax(round->fraction, fraction_done(distributed, round)), 1);
    distributed->watch->reported(distributed->watch->ctx, round->fraction);
}

enum { MOST_TRIES = 3, MOST_RAISED = 5 };

/* Interval between polls of the parts, in seconds. It grows with the round's age. */
static const double poll_least_s = 0.05, poll_most_s = 1, poll_share = 0.005;
/* Seconds until a full disk is checked again. */
static const double disk_full_retry_s = 10;

static double now_s(const struct orl_distributed_job *distributed)
{
    return distributed->spec.now_s(NULL);
}

/* ---- Counts ---------------------------------------------------------------------------------- */

static void count_lost(struct orl_distributed_job *distributed, struct task_round *round, size_t i,
                       const char *why)
{
    struct part *part = &round->parts[i];
    report_part(distributed, round, i, "again", why);
    distributed->count.again++;
    distributed->count.lost_s += part_elapsed_s(distributed, part);
    part->started_s = 0;
    part->reported = false;
}

/* Takes over the state reported by the runner. A part that ran and now waits was requeued by
 * Slurm. */
static void update_state(struct orl_distributed_job *distributed, struct task_round *round,
                         size_t i)
{
    struct part *part = &round->parts[i];
    const enum orl_part_state state = round->status[i].state;
    if (state == ORL_PART_UNKNOWN)
        return;
    if (part->started_s > 0 && state == ORL_PART_WAITING)
        count_lost(distributed, round, i, "Slurm requeued it");
    if (state == ORL_PART_RUNNING && part->started_s <= 0) {
        part->started_s = now_s(distributed);
        report_part_start(distributed, round, i);
    }
    part->state = state;
}

static bool is_same(const struct orl_parts_count *a, const struct orl_parts_count *b)
{
    return a->waiting == b->waiting && a->running == b->running && a->done == b->done &&
           a->held == b->held && a->again == b->again && a->rounds == b->rounds;
}

static void report_count(struct orl_distributed_job *distributed)
{
    if (is_same(&distributed->count, &distributed->reported))
        return;
    distributed->reported = distributed->count;
    if (distributed->spec.reported)
        distributed->spec.reported(distributed->spec.ctx, &distributed->count);
}

static void report_round(struct orl_distributed_job *distributed, const struct task_round *round,
                         uint64_t done_before)
{
    struct orl_parts_count *count = &distributed->count;
    count->waiting = count->running = count->held = 0;
    count->done = done_before;
    for (size_t i = 0; i < round->n; i++) {
        const struct part *part = &round->parts[i];
        count->done += part->done;
        count->running += !part->done && part->state == ORL_PART_RUNNING;
        count->waiting += !part->done && part->state != ORL_PART_RUNNING;
        count->held += part->held_until_s > 0;
    }
    report_count(distributed);
}

/* ---- Parts ----------------------------------------------------------------------------------- */

/* Returns the limits for a part's first try, from what is known of the job by now. */
static struct orl_part_limits first_limits(const struct orl_distributed_job *distributed,
                                           const struct part *part)
{
    const struct orl_part_limits_input input = {
        .load_s = distributed->load_s,
        .time_ratio =
            distributed->estimated_s > 0 ? distributed->actual_s / distributed->estimated_s : 1,
        .threads = distributed->spec.threads,
        .memory_bytes = distributed->spec.memory_bytes};
    return orl_part_limits(&part->needs, &input);
}

/* Starts all due parts at once. */
static int start_due(struct orl_distributed_job *distributed, struct task_round *round,
                     struct orl_error *err)
{
    size_t n = 0;
    for (size_t i = 0; i < round->n; i++) {
        struct part *part = &round->parts[i];
        if (!part->due)
            continue;
        if (part->limits.mib == 0)
            part->limits = first_limits(distributed, part);
        round->requests[n++] = (struct orl_part_request){(uint32_t)i, part->limits};
        part->due = false;
        part->tries++;
        part->gone_s = part->held_until_s = 0;
        part->state = ORL_PART_WAITING;
        distributed->parts++;
    }
    return n == 0 ? 0
                  : distributed->runner.start(distributed->runner.ctx, round->name, round->requests,
                                              n, round->n, err);
}

/* Reads the error of a failed part. */
static void read_error(const char *path, struct orl_error *ret_part_error)
{
    json_t *problem = json_load_file(path, 0, NULL);
    *ret_part_error = (struct orl_error){.code = 0};
    if (problem)
        orl_problem_to_error(problem, ret_part_error);
    if (ret_part_error->code == 0)
        orl_error_set(ret_part_error, ORL_ERR_INTERNAL,
                      "a part of the job failed and gave no reason");
    json_decref(problem);
}

/* Holds a part back until the disk has room. This does not count as a failure of the part. */
static void hold_part(const struct orl_distributed_job *distributed, struct part *part)
{
    part->held_until_s = now_s(distributed) + disk_full_retry_s;
    part->state = ORL_PART_WAITING;
}

/* Raises the exceeded limit if this program had set it. Returns true if it did; the part is
 * then restarted. */
static bool raise_limits(struct part *part, const struct orl_part_status *status,
                         enum orl_part_end end)
{
    const bool of_time = end == ORL_PART_OUT_OF_TIME;
    const uint32_t requested = of_time ? part->limits.minutes : part->limits.mib;
    const uint32_t granted = of_time ? status->limits.minutes : status->limits.mib;
    if (end == ORL_PART_ENDED || requested == 0 || granted < requested ||
        part->limit_raises == MOST_RAISED)
        return false;
    part->limits = orl_part_limits_raised(part->limits, end);
    part->limit_raises++;
    part->tries--;
    return true;
}

/* Describes why a part has no result. */
static void describe_end(const struct orl_distributed_job *distributed, const struct part *part,
                         const struct orl_part_status *status, enum orl_part_end end,
                         struct orl_error *ret_part_error)
{
    if (end == ORL_PART_OUT_OF_TIME)
        orl_error_set(ret_part_error, ORL_ERR_LIMIT,
                      "a part of the job exceeded its time limit (%u minutes in the last try)",
                      status->limits.minutes);
    else if (end == ORL_PART_OUT_OF_MEMORY)
        orl_error_set(ret_part_error, ORL_ERR_LIMIT,
                      "a part of the job exceeded its memory limit (%u MiB in the last try)",
                      status->limits.mib);
    else
        orl_error_set(ret_part_error, ORL_ERR_INTERNAL,
                      "a part of the job ended %u times without a result: it was killed, or its "
                      "node was lost; its log is in '%s'",
                      part->tries, distributed->folder);
}

/* Restarts a part that left an error or nothing, or fails if its tries are used up. */
static int restart_part(struct orl_distributed_job *distributed, struct task_round *round, size_t i,
                        const char *error_path, struct orl_error *err)
{
    struct part *part = &round->parts[i];
    enum orl_part_end end = ORL_PART_ENDED;
    struct orl_error part_error = {.code = 0};
    if (error_path)
        read_error(error_path, &part_error);
    if ((!error_path || part_error.code == ORL_ERR_CANCELLED) && distributed->runner.end)
        end = distributed->runner.end(distributed->runner.ctx, round->name, (uint32_t)i);
    if (!error_path || end != ORL_PART_ENDED)
        describe_end(distributed, part, &round->status[i], end, &part_error);
    if (error_path)
        unlink(error_path);
    if (part_error.code == ORL_ERR_FULL || !orl_folder_has_space(distributed->folder)) {
        count_lost(distributed, round, i, "the shared folder's disk is full");
        part->tries--;
        hold_part(distributed, part);
        return 0;
    }
    part->due = raise_limits(part, &round->status[i], end) || part->tries < MOST_TRIES;
    if (part->due)
        count_lost(distributed, round, i, part_error.message);
    else
        report_part(distributed, round, i, "failed", part_error.message);
    if (!part->due && err)
        *err = part_error;
    return part->due ? 0 : part_error.code;
}

static void check_held(const struct orl_distributed_job *distributed, struct part *part)
{
    if (now_s(distributed) < part->held_until_s)
        return;
    part->due = orl_folder_has_space(distributed->folder);
    if (!part->due)
        hold_part(distributed, part);
}

static void finish_part(struct orl_distributed_job *distributed, struct task_round *round, size_t i)
{
    struct part *part = &round->parts[i];
    report_part(distributed, round, i, "end", NULL);
    add_timing(distributed, round, part);
    part->done = true;
    part->held_until_s = 0;
}

static int check_part(struct orl_distributed_job *distributed, struct task_round *round, size_t i,
                      struct orl_error *err)
{
    struct part *part = &round->parts[i];
    char path[ORL_PART_PATH];
    if (orl_part_file(distributed->folder, round->name, i, "done", path)) {
        finish_part(distributed, round, i);
        return 0;
    }
    if (part->held_until_s > 0) {
        check_held(distributed, part);
        return 0;
    }
    if (orl_part_file(distributed->folder, round->name, i, "error", path))
        return restart_part(distributed, round, i, path, err);
    update_state(distributed, round, i);
    if (round->status[i].state != ORL_PART_GONE) {
        part->gone_s = 0;
        return 0;
    }
    orl_shared_folder_refresh(distributed->folder);
    if (part->gone_s <= 0)
        part->gone_s = now_s(distributed);
    return now_s(distributed) - part->gone_s < distributed->runner.files_delay_s
               ? 0
               : restart_part(distributed, round, i, NULL, err);
}

/* ---- The round ------------------------------------------------------------------------------- */

static void sleep_between_polls(const struct orl_distributed_job *distributed,
                                const struct task_round *round)
{
    const double share = poll_share * (now_s(distributed) - round->began_s);
    const double wait = share < poll_least_s  ? poll_least_s
                        : share > poll_most_s ? poll_most_s
                                              : share;
    const struct timespec time = {(time_t)wait, (long)(1e9 * (wait - floor(wait)))};
    nanosleep(&time, NULL);
}

static int wait_for_parts(struct orl_distributed_job *distributed, struct task_round *round,
                          struct orl_error *err)
{
    const uint64_t done_before = distributed->count.done;
    size_t left = round->n;
    int rc = 0;
    while (left > 0 && rc == 0) {
        rc = distributed->runner.poll(distributed->runner.ctx, round->name, round->status, round->n,
                                      err);
        left = 0;
        for (size_t i = 0; i < round->n && rc == 0; i++) {
            if (!round->parts[i].done)
                rc = check_part(distributed, round, i, err);
            left += !round->parts[i].done;
        }
        if (rc == 0)
            rc = start_due(distributed, round, err);
        report_round(distributed, round, done_before);
        if (rc == 0)
            report_progress(distributed, round);
        if (rc == 0 && left > 0 && atomic_load(distributed->spec.cancel))
            rc = orl_error_set(err, ORL_ERR_CANCELLED, "cancelled while its parts were running");
        if (left > 0 && rc == 0)
            sleep_between_polls(distributed, round);
    }
    return rc;
}

/* Ends a round. Active parts end with the run, unless a later run is to find them. */
static void end_round(struct orl_distributed_job *distributed, struct task_round *round, int rc,
                      struct orl_error *err)
{
    const atomic_bool *detach = distributed->spec.detach;
    struct orl_error second = {0};
    if (rc && detach && atomic_load(detach))
        return;
    if (rc && distributed->runner.cancel(distributed->runner.ctx, round->name, &second) && err)
        orl_error_hint(err, "%s%s%.300s", err->hint, err->hint[0] ? "; " : "", second.message);
    orl_task_round_remove_marker(distributed->folder, round->name);
}

static void round_done(struct task_round *round)
{
    free(round->parts);
    free(round->status);
    free(round->requests);
}

static int make_tables(struct orl_distributed_job *distributed, struct task_round *round,
                       struct orl_error *err)
{
    round->parts = calloc(round->n + 1, sizeof *round->parts);
    round->status = calloc(round->n + 1, sizeof *round->status);
    round->requests = calloc(round->n + 1, sizeof *round->requests);
    round->began_s = now_s(distributed);
    if (!round->parts || !round->status || !round->requests)
        return orl_error_no_memory(err);
    for (size_t i = 0; i < round->n; i++)
        round->parts[i].needs = orl_task_round_part_needs(distributed->folder, round->name, i);
    return 0;
}

/* Writes the round's files, and waits while the disk is full. */
static int write_round(struct orl_distributed_job *distributed, struct task_round *round,
                       const struct orl_job_task *tasks, size_t n, struct orl_error *err)
{
    int rc = orl_task_round_write(distributed, round->name, tasks, n, &round->n, err);
    round->began_s = now_s(distributed);
    while (rc == ORL_ERR_FULL && !atomic_load(distributed->spec.cancel)) {
        const double until_s = now_s(distributed) + disk_full_retry_s;
        distributed->count.held = 1;
        report_count(distributed);
        while (now_s(distributed) < until_s && !atomic_load(distributed->spec.cancel))
            sleep_between_polls(distributed, round);
        rc = orl_task_round_write(distributed, round->name, tasks, n, &round->n, err);
    }
    distributed->count.held = 0;
    return rc;
}

int orl_task_round_run(struct orl_distributed_job *distributed, const struct orl_job_task *tasks,
                       size_t n, struct orl_error *err)
{
    struct task_round round = {.n = 0};
    if (distributed->load_s <= 0)
        distributed->load_s = now_s(distributed) - distributed->opened_s;
    /* A unique name: tasks of an earlier run may still write files here. */
    snprintf(round.name, sizeof round.name, "%lx.%lx-wave%u", (long)distributed->began,
             (long)getpid(), ++distributed->count.rounds);
    int rc = write_round(distributed, &round, tasks, n, err);
    if (rc == 0)
        rc = make_tables(distributed, &round, err);
    if (rc == 0) {
        for (size_t i = 0; i < round.n; i++)
            round.parts[i].due = true;
        rc = start_due(distributed, &round, err);
        if (rc == 0)
            rc = wait_for_parts(distributed, &round, err);
        end_round(distributed, &round, rc, err);
    }
    round_done(&round);
    return rc;
}

/* ---- Rounds of an earlier run ---------------------------------------------------------------- */

/* Finishes a round of an earlier run. Its parts count as tried once; the runner reports which
 * are active. */
static int finish_earlier_round(struct orl_distributed_job *distributed, struct task_round *round,
                                struct orl_error *err)
{
    int rc = make_tables(distributed, round, err);
    if (rc)
        return rc;
    for (size_t i = 0; i < round->n; i++)
        round->parts[i].tries = 1;
    distributed->parts += round->n;
    distributed->count.rounds++;
    rc = wait_for_parts(distributed, round, err);
    end_round(distributed, round, rc, err);
    return rc;
}

int orl_task_round_adopt(struct orl_distributed_job *distributed, const struct orl_job_task *tasks,
                         size_t n, bool *ret_made, struct orl_error *err)
{
    struct task_round round = {.n = 0};
    int rc = 0;
    while (rc == 0 && orl_task_round_find(distributed->folder, round.name)) {
        round.n = orl_task_round_count_parts(distributed->folder, round.name);
        char again[sizeof round.name];
        rc = finish_earlier_round(distributed, &round, err);
        if (rc == 0 && orl_task_round_find(distributed->folder, again) &&
            strcmp(again, round.name) == 0)
            rc = orl_error_set(err, ORL_ERR_IO, "%s/%s.wave cannot be removed", distributed->folder,
                               round.name);
        if (rc == 0)
            orl_task_round_mark_made(distributed->folder, round.name, round.n, tasks, n, ret_made);
        round_done(&round);
        round = (struct task_round){.n = 0};
    }
    return rc;
}
