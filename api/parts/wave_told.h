/*
 * State of a wave (wave.h), and its progress reports: when a part starts, ends or is lost, and
 * the fraction done.
 */
#ifndef ORL_PARTS_WAVE_TOLD_H
#define ORL_PARTS_WAVE_TOLD_H

#include "parts/limits.h"
#include "parts/sharing.h"

struct orl_part {
    bool done, due;         /* due: true if it is to be started */
    bool told;              /* true if its start was reported */
    unsigned tries, raised; /* raised: number of times that its limits were raised */
    enum orl_part_state state;
    struct orl_part_needs needs;
    struct orl_part_limits limits; /* requested limits */
    double gone_s;                 /* time when the runner stopped listing it; 0: it is listed */
    double runs_s;                 /* start time; 0: not running */
    double held_s;                 /* time until which it is held back; 0: not held */
};

/* The parts of a wave and their states. */
struct orl_wave {
    char name[ORL_WAVE_NAME];
    size_t n;
    struct orl_part *parts;
    struct orl_part_seen *seen;    /* states reported by the runner */
    struct orl_part_order *orders; /* room for all parts */
    double began_s;
    double share;          /* reported fraction done */
    double ended_s, ended; /* for ended parts that were seen running: seconds and work */
};

/* Returns the seconds that the part has been running; 0 if it is not. */
double orl_part_ran_s(const struct orl_sharing *sharing, const struct orl_part *part);

/* Reports "start" once per try, even if the try was short. */
void orl_part_tell_start(const struct orl_sharing *sharing, struct orl_wave *wave, size_t i);
/* Reports "end", "again" or "failed", with the reason, and before it the start. */
void orl_part_tell(const struct orl_sharing *sharing, struct orl_wave *wave, size_t i,
                   const char *what, const char *why);

/* Records a part that has ended well; its time scales the estimates for others. */
void orl_wave_learn(struct orl_sharing *sharing, struct orl_wave *wave,
                    const struct orl_part *part);

/* Reports the fraction done to the run's watch (oriel/pieces.h). */
void orl_wave_tell_share(const struct orl_sharing *sharing, struct orl_wave *wave);

#endif
