/*
 * A wave (wave.h) as it stands, and what is told of it while it is under way: of each part when it
 * starts, ends or is lost, and how much of the whole is made.
 */
#ifndef ORL_PARTS_WAVE_TOLD_H
#define ORL_PARTS_WAVE_TOLD_H

#include "parts/limits.h"
#include "parts/sharing.h"

struct orl_part {
    bool done, due;         /* due: to be started */
    bool told;              /* that it has started */
    unsigned tries, raised; /* raised: times that its limits were */
    enum orl_part_state state;
    struct orl_part_needs needs;
    struct orl_part_limits limits; /* that are asked for */
    double gone_s;                 /* since when its runner has had it no more; 0: it has */
    double runs_s;                 /* since when it runs; 0: it does not */
    double held_s;                 /* until when it is held back; 0: it is not */
};

/* Parts of a wave, and how they stand. */
struct orl_wave {
    char name[ORL_WAVE_NAME];
    size_t n;
    struct orl_part *parts;
    struct orl_part_seen *seen;    /* as its runner tells */
    struct orl_part_order *orders; /* room for all */
    double began_s;
    double share;          /* that is made, as it was told */
    double ended_s, ended; /* of parts that were seen to run, and have ended: seconds, and work */
};

/* Seconds that it runs by now; 0: it does not. */
double orl_part_ran_s(const struct orl_sharing *sharing, const struct orl_part *part);

/* "start", once of each try, however short that was. */
void orl_part_tell_start(const struct orl_sharing *sharing, struct orl_wave *wave, size_t i);
/* "end", "again" or "failed", and why; the start before it. */
void orl_part_tell(const struct orl_sharing *sharing, struct orl_wave *wave, size_t i,
                   const char *what, const char *why);

/* It has ended well: what it took is a measure of the others. */
void orl_wave_learn(struct orl_sharing *sharing, struct orl_wave *wave,
                    const struct orl_part *part);

/* How much is made, to whom it may concern (oriel/pieces.h). */
void orl_wave_tell_share(const struct orl_sharing *sharing, struct orl_wave *wave);

#endif
