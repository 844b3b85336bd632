/*
 * What a scene holds that is not simulated: counted by kind while the rest is read on, and told all
 * at once. A scene with any of it is refused in the end; but modifiers that no surface uses change
 * nothing, and libraries of materials are full of them: such a refusal awaits its first use.
 */
#ifndef ORL_SCENE_REFUSALS_H
#define ORL_SCENE_REFUSALS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <oriel/error.h>

enum {
    ORL_MOST_REFUSALS = 24, /* kinds; more are counted together */
    ORL_MOST_AWAITING = 4096
};

struct orl_refusals {
    struct orl_refusal {
        char kind[48]; /* "texfunc", "!genprism" */
        uint64_t count;
        struct orl_error first;
    } kinds[ORL_MOST_REFUSALS];
    size_t n;
    uint64_t others;
    struct orl_awaiting *awaiting; /* in the order of the text */
    size_t n_awaiting, room;
};

/*
 * Notes one; err says where it is, why, and what to do. Returns its number, to be needed by, or 0
 * when it counts as needed already: from ORL_MOST_AWAITING on, or out of memory.
 */
uint32_t orl_refusals_note(struct orl_refusals *refusals, const struct orl_error *err);
/* Something uses that one; of number 0 nothing hangs. */
void orl_refusals_need(struct orl_refusals *refusals, uint32_t number);
/* Counts those that are needed, when all has been read. */
void orl_refusals_settle(struct orl_refusals *refusals);
void orl_refusals_done(struct orl_refusals *refusals);
/* Fills err with all of them, at the place of the first. Returns ORL_ERR_UNSUPPORTED. */
int orl_refusals_tell(const struct orl_refusals *refusals, struct orl_error *err);

#endif
