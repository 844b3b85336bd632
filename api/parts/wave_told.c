#include "parts/wave_told.h"

#include <math.h>

double orl_part_ran_s(const struct orl_sharing *sharing, const struct orl_part *part)
{
    return part->runs_s > 0 ? sharing->spec.now_s(NULL) - part->runs_s : 0;
}

/* ---- Parts ----------------------------------------------------------------------------------- */

static void report_event(const struct orl_sharing *sharing, const struct orl_wave *wave, size_t i,
                         const char *what, const char *why)
{
    const struct orl_part_seen *seen = &wave->seen[i];
    const struct orl_part_news news = {.what = what,
                                       .wave = wave->name,
                                       .part = (uint32_t)i,
                                       .task = seen->task,
                                       .ran_s = orl_part_ran_s(sharing, &wave->parts[i]),
                                       .limits = seen->limits,
                                       .why = why};

    if (sharing->spec.part_told)
        sharing->spec.part_told(sharing->spec.ctx, &news);
}

void orl_part_tell_start(const struct orl_sharing *sharing, struct orl_wave *wave, size_t i)
{
    if (!wave->parts[i].told)
        report_event(sharing, wave, i, "start", NULL);
    wave->parts[i].told = true;
}

void orl_part_tell(const struct orl_sharing *sharing, struct orl_wave *wave, size_t i,
                   const char *what, const char *why)
{
    orl_part_tell_start(sharing, wave, i);
    report_event(sharing, wave, i, what, why);
}

/* ---- The wave -------------------------------------------------------------------------------- */

/* Returns a part's weight in its wave: estimated seconds on one node, or 1 if estimates are
 * missing. */
static double part_weight(const struct orl_sharing *sharing, const struct orl_part *part,
                          bool known)
{
    return known ? part->needs.core_s / fmax(sharing->spec.threads, 1) : 1;
}

static bool is_known(const struct orl_wave *wave)
{
    bool known = wave->n > 0;

    for (size_t i = 0; i < wave->n; i++)
        known = known && wave->parts[i].needs.core_s > 0;
    return known;
}

void orl_wave_learn(struct orl_sharing *sharing, struct orl_wave *wave, const struct orl_part *part)
{
    const double took_s = orl_part_ran_s(sharing, part);

    if (!(took_s > 0))
        return;
    wave->ended_s += took_s;
    wave->ended += part_weight(sharing, part, is_known(wave));
    if (!(part->needs.core_s > 0))
        return;
    sharing->took_s += took_s;
    sharing->foreseen_s += part_weight(sharing, part, true);
}

/*
 * Returns the fraction of the wave's work that is done. A running part counts by its elapsed
 * time over its estimated time. The estimate is scaled by the pace of ended parts, if any. An
 * overrunning part counts as at most 90 % done.
 */
static double share_made(const struct orl_sharing *sharing, const struct orl_wave *wave)
{
    const double most = 0.9;
    const bool known = is_known(wave), measured = wave->ended > 0;
    const double before = sharing->foreseen_s > 0 ? sharing->took_s / sharing->foreseen_s : 1;
    const double pace = measured ? wave->ended_s / wave->ended : before;
    double made = 0, all = 0;

    for (size_t i = 0; i < wave->n; i++) {
        const struct orl_part *part = &wave->parts[i];
        const double own = part_weight(sharing, part, known), thought_s = pace * own;

        all += own;
        if (part->done)
            made += own;
        else if ((known || measured) && thought_s > 0)
            made += own * fmin(orl_part_ran_s(sharing, part) / thought_s, most);
    }
    return all > 0 ? made / all : 0;
}

void orl_wave_tell_share(const struct orl_sharing *sharing, struct orl_wave *wave)
{
    if (!sharing->watch)
        return;
    wave->share = fmin(fmax(wave->share, share_made(sharing, wave)), 1);
    sharing->watch->told(sharing->watch->ctx, wave->share);
}
