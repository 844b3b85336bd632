#include "run/deadline.h"

#include <math.h>

/* A round fills that much of what is left, the last one that. */
static const double fill = 0.7, last_fill = 0.93, growth = 8;
/* Less than this share of the deadline is not worth a round; so much over it is still kept. */
static const double crumbs = 0.04, tolerance = 0.1;

struct orl_deadline_next orl_deadline_next(const struct orl_pace *pace, const struct orl_work *work,
                                           double deadline_s, double left_s)
{
    const double least = orl_pace_round_s(pace, work, work->least);
    const double end = fmax(least / last_fill, crumbs * deadline_s);
    struct orl_deadline_next next = {.step = ORL_DEADLINE_ROUND, .least_s = least};
    double seconds = fill * left_s;
    if (left_s < -tolerance * deadline_s)
        next.step = ORL_DEADLINE_TOO_LATE;
    else if (left_s < crumbs * deadline_s)
        next.step = ORL_DEADLINE_USED_UP;
    else if (left_s < least)
        next.step = ORL_DEADLINE_NO_ROOM;
    if (next.step != ORL_DEADLINE_ROUND)
        return next;
    next.last = left_s - seconds < end;
    if (next.last)
        seconds = last_fill * left_s;
    next.samples = orl_pace_samples(pace, work, fmax(seconds, least), growth * pace->samples);
    return next;
}

double orl_deadline_left_s(double round_s, double until_s, double deadline_s)
{
    return until_s - round_s < crumbs * deadline_s ? round_s : until_s;
}
