#include "run/goals/deadline.h"

#include <math.h>

/* Shares of the time left that a round fills, and that the last one fills. */
static const double fill = 0.7, last_fill = 0.93;
/* Multiples of the smallest round that must fit after a round. It is larger if views' rays follow
 * the samples, because that round is long and may take longer than estimated. */
static const double room = 1.075, room_of_views = 1.5;
/* Share of the deadline that is too short for a round; share by which exceeding it still counts as
 * kept. */
static const double too_short_share = 0.04, tolerance = 0.1;

/* Share for a first round that is expected to be the only one, before any measurement. */
static const double only_fill = 0.85;

double orl_deadline_first(const struct orl_work *work, double photons_s, double render_s,
                          double left_s)
{
    const double smallest = render_s + photons_s * work->least / ORL_DEFAULT_GATHER_SAMPLES;
    if (!orl_work_view_time_is_fixed(work) || 2 * smallest <= only_fill * left_s ||
        !(photons_s > 0))
        return work->least;
    const double samples = (only_fill * left_s - render_s) / photons_s * ORL_DEFAULT_GATHER_SAMPLES;
    return ORL_MAP_BATCHES * floor(fmin(fmax(samples, work->least), work->most) / ORL_MAP_BATCHES);
}

/* Returns the maximum samples of the next round. Views by maps begin with a quarter of the usual
 * photons. */
static double most_samples(const struct orl_throughput *throughput, const struct orl_work *work)
{
    const double growth = orl_work_view_time_is_fixed(work) ? 16 : 8;
    return growth * throughput->samples;
}

/*
 * Returns the number of rounds that fill a time. It is one, unless the largest possible round is
 * too short and more fit. It is also more if the next round would be the second of views whose rays
 * follow the samples: one round does not show how much of their time does.
 */
static double rounds_to_fill(const struct orl_throughput *throughput, const struct orl_work *work,
                             double seconds, double too_short_s)
{
    const double most = fmax(fmin(work->most, most_samples(throughput, work)), work->least);
    const bool unsure = work->ray_time_share > 0 && throughput->rounds < 2;
    const double longest = orl_throughput_round_s(throughput, work, most);
    const double rounds = fmax(ceil(seconds / longest), unsure ? 2 : 1);
    const bool fits = rounds * orl_throughput_round_s(throughput, work, work->least) <= seconds;
    return (unsure || seconds - longest > too_short_s) && fits ? rounds : 1;
}

struct orl_deadline_next orl_deadline_next(const struct orl_throughput *throughput,
                                           const struct orl_work *work, double deadline_s,
                                           double left_s)
{
    const double least = orl_throughput_round_s(throughput, work, work->least);
    const double margin = work->ray_time_share > 0 ? room_of_views : room;
    const double end = fmax(margin * least, too_short_share * deadline_s);
    struct orl_deadline_next next = {.step = ORL_DEADLINE_ROUND, .least_s = least};
    double seconds = fill * left_s;
    if (left_s < -tolerance * deadline_s)
        next.step = ORL_DEADLINE_TOO_LATE;
    else if (left_s < too_short_share * deadline_s)
        next.step = ORL_DEADLINE_USED_UP;
    else if (left_s < least)
        next.step = ORL_DEADLINE_NO_ROOM;
    if (next.step != ORL_DEADLINE_ROUND)
        return next;
    next.last = left_s - seconds < end;
    if (next.last) { /* or the first of several that together fill it */
        const double rounds =
            rounds_to_fill(throughput, work, last_fill * left_s, too_short_share * deadline_s);
        seconds = last_fill * left_s / rounds;
        next.last = rounds < 2;
    }
    next.samples = orl_throughput_samples(throughput, work, fmax(seconds, least),
                                          most_samples(throughput, work));
    return next;
}

double orl_deadline_left_s(double round_s, double until_s, double deadline_s)
{
    return until_s - round_s < too_short_share * deadline_s ? round_s : until_s;
}
