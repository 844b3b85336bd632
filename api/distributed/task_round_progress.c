#include "distributed/task_round_progress.h"

#include <math.h>

double orl_part_elapsed_s(const struct orl_distributed_job *distributed,
                          const struct orl_part *part)
{
    return part->started_s > 0 ? distributed->spec.now_s(NULL) - part->started_s : 0;
}

/* ---- Parts ----------------------------------------------------------------------------------- */

static void report_event(const struct orl_distributed_job *distributed,
                         const struct orl_task_round *round, size_t i, const char *what,
                         const char *why)
{
    const struct orl_part_status *status = &round->status[i];
    const struct orl_part_event event = {.what = what,
                                         .round = round->name,
                                         .part = (uint32_t)i,
                                         .task = status->task,
                                         .ran_s = orl_part_elapsed_s(distributed, &round->parts[i]),
                                         .limits = status->limits,
                                         .why = why};

    if (distributed->spec.part_event)
        distributed->spec.part_event(distributed->spec.ctx, &event);
}

void orl_part_report_start(const struct orl_distributed_job *distributed,
                           struct orl_task_round *round, size_t i)
{
    if (!round->parts[i].reported)
        report_event(distributed, round, i, "start", NULL);
    round->parts[i].reported = true;
}

void orl_part_report(const struct orl_distributed_job *distributed, struct orl_task_round *round,
                     size_t i, const char *what, const char *why)
{
    orl_part_report_start(distributed, round, i);
    report_event(distributed, round, i, what, why);
}

/* ---- The round --------------------------------------------------------------------------------
 */

/* Returns a part's weight in its round: estimated seconds on one node, or 1 if estimates are
 * missing. */
static double part_weight(const struct orl_distributed_job *distributed,
                          const struct orl_part *part, bool known)
{
    return known ? part->needs.core_s / fmax(distributed->spec.threads, 1) : 1;
}

static bool is_known(const struct orl_task_round *round)
{
    bool known = round->n > 0;

    for (size_t i = 0; i < round->n; i++)
        known = known && round->parts[i].needs.core_s > 0;
    return known;
}

void orl_task_round_add_timing(struct orl_distributed_job *distributed,
                               struct orl_task_round *round, const struct orl_part *part)
{
    const double actual_s = orl_part_elapsed_s(distributed, part);

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
                            const struct orl_task_round *round)
{
    const double most = 0.9;
    const bool known = is_known(round), measured = round->ended > 0;
    const double before =
        distributed->estimated_s > 0 ? distributed->actual_s / distributed->estimated_s : 1;
    const double time_ratio = measured ? round->ended_s / round->ended : before;
    double made = 0, all = 0;

    for (size_t i = 0; i < round->n; i++) {
        const struct orl_part *part = &round->parts[i];
        const double own = part_weight(distributed, part, known),
                     estimated_s_of_part = time_ratio * own;

        all += own;
        if (part->done)
            made += own;
        else if ((known || measured) && estimated_s_of_part > 0)
            made += own * fmin(orl_part_elapsed_s(distributed, part) / estimated_s_of_part, most);
    }
    return all > 0 ? made / all : 0;
}

void orl_task_round_report_progress(const struct orl_distributed_job *distributed,
                                    struct orl_task_round *round)
{
    if (!distributed->watch)
        return;
    round->fraction = fmin(fmax(round->fraction, fraction_done(distributed, round)), 1);
    distributed->watch->reported(distributed->watch->ctx, round->fraction);
}
