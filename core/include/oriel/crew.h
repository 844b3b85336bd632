/*
 * A crew: threads lent by the caller, working together on one parallel loop at a time.
 *
 * The core starts no threads of its own when it runs inside a daemon: one thread leads (and calls
 * orl_crew_for), any number of others serve. A server may come late or not at all; the lead alone
 * finishes every loop. Iterations are claimed one by one, so that what an iteration computes must
 * depend on its index alone: this is what makes results independent of the crew's size.
 *
 * Locks: one mutex inside; callbacks run with it released.
 */
#ifndef ORIEL_CREW_H
#define ORIEL_CREW_H

#include <stdatomic.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct orl_crew;

/* A crew of at most size members, the lead included (size >= 1). NULL when out of memory. */
struct orl_crew *orl_crew_new(uint32_t size);
/* After dismiss, when every server has returned. NULL is allowed. */
void orl_crew_free(struct orl_crew *crew);

uint32_t orl_crew_size(const struct orl_crew *crew); /* of NULL: 1 */

/* Serves loops until orl_crew_dismiss; for member index 1..size-1, each on its own thread. */
void orl_crew_serve(struct orl_crew *crew, uint32_t member);
/* Tells the servers to return; called by the lead, once. */
void orl_crew_dismiss(struct orl_crew *crew);

/* body(arg, index, member): member 0..size-1 names the thread's scratch. */
typedef void (*orl_crew_body)(void *arg, size_t index, uint32_t member);

/* Runs body for every index in [0, count); returns when all are done. Lead thread only. Without a
 * crew (NULL) the caller does all. */
void orl_crew_for(struct orl_crew *crew, size_t count, orl_crew_body body, void *arg);

/* Has *cancel been set? NULL: never. */
bool orl_is_cancelled(const atomic_bool *cancel);

/* From now on orl_crew_try heeds *cancel, which any thread may set; NULL: nothing. Lead only. */
void orl_crew_heed(struct orl_crew *crew, const atomic_bool *cancel);
bool orl_crew_cancelled(const struct orl_crew *crew);
/*
 * The same as orl_crew_for until what the crew heeds is set: then iterations are left out, and it
 * returns ORL_ERR_CANCELLED; else 0. Without a crew (NULL) nothing is heeded.
 */
int orl_crew_try(struct orl_crew *crew, size_t count, orl_crew_body body, void *arg);

/* For programs without a thread pool: starts size-1 POSIX threads that serve the crew. */
struct orl_crew *orl_crew_start(uint32_t size);
/* Dismisses, joins and frees what orl_crew_start made. NULL is allowed. */
void orl_crew_stop(struct orl_crew *crew);

#endif
