/*
 * The scheduler of checks. It keeps long or large uploads of one client from delaying others:
 *
 * - The waiting client with the fewest running checks goes first, then the one that came first. If
 *   there are several clients, none gets all the slots.
 * - A check gets a small memory grant at first (ORL_SERVER_CHECK_FIRST, or its slot's share of the
 *   free memory). If that is not enough, its larger grant still leaves some memory for the others.
 * - A check is long if it has run for more than ORL_SERVER_CHECK_QUICK_MS, or has the larger grant.
 *   One slot is reserved for quick checks. If long checks hold all slots while another check waits,
 *   the last one started yields. It runs again from its start, in one of the other slots, and
 *   yields no more.
 *
 * If n clients have checks waiting, the quick check of another client waits for about n *
 * ORL_SERVER_CHECK_QUICK_MS at most.
 *
 * Threads: the loop thread.
 */
#ifndef ORL_SERVER_CHECKS_CHECK_SCHEDULER_H
#define ORL_SERVER_CHECKS_CHECK_SCHEDULER_H

#include <stdint.h>

struct orl_check;
struct orl_checks;

/* Returns the largest memory grant of one check, bytes. */
uint64_t orl_check_memory_limit(const struct orl_checks *checks);

/* Appends the check to the waiting list. */
void orl_check_enqueue(struct orl_checks *checks, struct orl_check *check);
/* Queues the checks whose turn has come on the pool. Cancelled ones are queued too, so that they
 * end with an error. */
void orl_checks_start(struct orl_checks *checks);
/* Removes the check from the running ones; does not start the next one. */
void orl_check_remove_running(struct orl_checks *checks, struct orl_check *check);
/* Cancels one running check so that it yields, if a waiting check needs its slot. */
void orl_checks_preempt(struct orl_checks *checks);

#endif
