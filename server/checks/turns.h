/*
 * Whose turn it is to be checked, so that nobody's long or large uploads keep others waiting:
 *
 * - Who waits and has the fewest checks under way goes first, then who came first; among several
 *   clients none has all the lanes.
 * - A check is granted little memory at first (ORL_SERVER_CHECK_FIRST, or its lane's share of what
 *   is free), and what it may be granted when that is not enough leaves some for the others.
 * - A check that has gone on for longer than ORL_SERVER_CHECK_QUICK_MS is long, and so is one that
 *   takes the larger grant. One lane is for those that are not: where long ones hold all of them
 *   while another waits, the last one begun yields. It is done again from its start, in one of the
 *   other lanes, and yields no more.
 *
 * With n clients that have checks waiting, the quick check of another waits for about
 * n * ORL_SERVER_CHECK_QUICK_MS at the most.
 *
 * Threads: the loop thread.
 */
#ifndef ORL_SERVER_CHECKS_TURNS_H
#define ORL_SERVER_CHECKS_TURNS_H

#include <stdint.h>

struct orl_check;
struct orl_checks;

/* What one check may be granted, if it is to have all it can. */
uint64_t orl_check_most(const struct orl_checks *checks);

/* Behind those that wait already. */
void orl_check_wait(struct orl_checks *checks, struct orl_check *check);
/* Those whose turn it is are queued on the pool; so are those that were given up, to find that. */
void orl_checks_start(struct orl_checks *checks);
/* It runs no more; the next one is not begun by this. */
void orl_check_leave(struct orl_checks *checks, struct orl_check *check);
/* Has one yield, where that is what somebody waits for. */
void orl_checks_make_room(struct orl_checks *checks);

#endif
