/*
 * The job queue: waiting jobs by priority, then fair between clients.
 *
 * Among the jobs of the highest priority, the client that was served longest ago goes first, with
 * its oldest job. A client that was never served goes before all others; between equals, the one
 * whose job has waited longest. So two clients take turns, however many jobs either has queued.
 *
 * Clients with queued jobs are remembered, and also the most recently served of the others. A
 * forgotten client was served so long ago that it would be first anyway.
 *
 * Ownership: entries are the caller's, and must not move while queued.
 * Threads: one.
 */
#ifndef ORL_SERVER_JOBS_JOB_QUEUE_H
#define ORL_SERVER_JOBS_JOB_QUEUE_H

#include <stddef.h>
#include <stdint.h>

#include <oriel/base/error.h>

struct orl_queue;
struct orl_queue_client;

struct orl_queue_entry {
    int priority;                    /* larger goes first */
    int64_t order;                   /* order of arrival: smaller is earlier */
    struct orl_queue_client *client; /* NULL: not queued. The queue owns client and next */
    struct orl_queue_entry *next;
};

struct orl_queue *orl_queue_new(void);        /* NULL when out of memory */
void orl_queue_free(struct orl_queue *queue); /* NULL is allowed; entries are not freed */

/* Adds an entry. priority and order must be set. ORL_ERR_NOMEM. */
int orl_queue_add(struct orl_queue *queue, struct orl_queue_entry *entry, const char *client,
                  struct orl_error *err);
/* Removes an entry; does nothing if it is not queued. */
void orl_queue_remove(struct orl_queue *queue, struct orl_queue_entry *entry);
/* Returns the next entry. NULL: the queue is empty. */
struct orl_queue_entry *orl_queue_first(const struct orl_queue *queue);
/* Removes the next entry and counts it as its client's turn. NULL: the queue is empty. */
struct orl_queue_entry *orl_queue_pop(struct orl_queue *queue);

/* Returns the entry's position: 1 for the next; 0 if it is not queued. Time is linear in the number
 * of entries. */
size_t orl_queue_position(const struct orl_queue *queue, const struct orl_queue_entry *entry);

#endif
