/*
 * Who is next: the jobs that wait, by priority, then fair between clients.
 *
 * Of those with the highest priority the client goes first that was served longest ago (never
 * before all others; between equals, whose job has waited longest), with its oldest job. So two
 * clients take turns, however many jobs either has queued.
 *
 * A client is remembered as long as it has jobs here, and, of the others, those served last:
 * whoever is forgotten was served so long ago that it would be first anyway.
 *
 * Ownership: entries are the caller's, and stay where they are while queued.
 * Threads: one.
 */
#ifndef ORL_SERVER_JOBS_QUEUE_H
#define ORL_SERVER_JOBS_QUEUE_H

#include <stddef.h>
#include <stdint.h>

#include <oriel/error.h>

struct orl_queue;
struct orl_queue_client;

struct orl_queue_entry {
    int priority;                    /* larger goes first */
    int64_t order;                   /* of arrival: smaller is older */
    struct orl_queue_client *client; /* NULL: not queued. Like next, the queue's */
    struct orl_queue_entry *next;
};

struct orl_queue *orl_queue_new(void);        /* NULL when out of memory */
void orl_queue_free(struct orl_queue *queue); /* NULL is allowed; entries are left alone */

/* priority and order must be set. ORL_ERR_NOMEM. */
int orl_queue_add(struct orl_queue *queue, struct orl_queue_entry *entry, const char *client,
                  struct orl_error *err);
/* Does nothing to an entry that is not queued. */
void orl_queue_remove(struct orl_queue *queue, struct orl_queue_entry *entry);
/* The next. NULL: nobody waits. */
struct orl_queue_entry *orl_queue_first(const struct orl_queue *queue);
/* Takes the next out, and counts it as its client's turn. NULL: nobody waits. */
struct orl_queue_entry *orl_queue_take(struct orl_queue *queue);

/* 1 for the next; 0 when it is not queued. Time goes with the number of entries. */
size_t orl_queue_position(const struct orl_queue *queue, const struct orl_queue_entry *entry);

#endif
