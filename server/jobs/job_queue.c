#include "jobs/job_queue.h"

#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { IDLE_CLIENTS = 256, CLIENT_NAME = 128 };

struct orl_queue_client {
    char name[CLIENT_NAME];
    uint64_t turn;                 /* number of its last turn; 0: never served */
    struct orl_queue_entry *first; /* by priority, then by order */
    struct orl_queue_client *next;
};

struct orl_queue {
    struct orl_queue_client *clients;
    size_t n_idle; /* clients without entries */
    uint64_t turns;
};

struct orl_queue *orl_queue_new(void)
{
    return calloc(1, sizeof(struct orl_queue));
}

void orl_queue_free(struct orl_queue *queue)
{
    while (queue && queue->clients) {
        struct orl_queue_client *client = queue->clients;
        queue->clients = client->next;
        free(client);
    }
    free(queue);
}

/* Forgets the idle client that was served longest ago. */
static void forget_idle_client(struct orl_queue *queue)
{
    struct orl_queue_client **oldest = NULL;
    for (struct orl_queue_client **at = &queue->clients; *at; at = &(*at)->next)
        if (!(*at)->first && (!oldest || (*at)->turn < (*oldest)->turn))
            oldest = at;
    if (!oldest)
        return;
    struct orl_queue_client *client = *oldest;
    *oldest = client->next;
    free(client);
    queue->n_idle--;
}

static void client_is_idle(struct orl_queue *queue)
{
    if (++queue->n_idle > IDLE_CLIENTS)
        forget_idle_client(queue);
}

static struct orl_queue_client *find_client(struct orl_queue *queue, const char *name)
{
    struct orl_queue_client *client = queue->clients;
    while (client && strcmp(client->name, name) != 0)
        client = client->next;
    if (client)
        return client;
    client = calloc(1, sizeof *client);
    if (!client)
        return NULL;
    snprintf(client->name, sizeof client->name, "%s", name);
    client->next = queue->clients;
    queue->clients = client;
    queue->n_idle++;
    return client;
}

/* Compares two entries of one client. */
static bool is_before(const struct orl_queue_entry *a, const struct orl_queue_entry *b)
{
    return a->priority != b->priority ? a->priority > b->priority : a->order < b->order;
}

int orl_queue_add(struct orl_queue *queue, struct orl_queue_entry *entry, const char *name,
                  struct orl_error *err)
{
    struct orl_queue_client *client = find_client(queue, name);
    if (!client)
        return orl_error_no_memory(err);
    if (!client->first)
        queue->n_idle--;
    struct orl_queue_entry **at = &client->first;
    while (*at && is_before(*at, entry))
        at = &(*at)->next;
    entry->client = client;
    entry->next = *at;
    *at = entry;
    return 0;
}

void orl_queue_remove(struct orl_queue *queue, struct orl_queue_entry *entry)
{
    struct orl_queue_client *client = entry->client;
    if (!client)
        return;
    struct orl_queue_entry **at = &client->first;
    while (*at != entry)
        at = &(*at)->next;
    *at = entry->next;
    entry->client = NULL;
    entry->next = NULL;
    if (!client->first)
        client_is_idle(queue);
}

/* Compares the first entries, of one priority, of two clients: returns true if a goes first. */
static bool goes_first(const struct orl_queue_entry *a, const struct orl_queue_entry *b)
{
    return a->client->turn != b->client->turn ? a->client->turn < b->client->turn
                                              : a->order < b->order;
}

struct orl_queue_entry *orl_queue_first(const struct orl_queue *queue)
{
    struct orl_queue_entry *best = NULL;
    for (const struct orl_queue_client *client = queue->clients; client; client = client->next) {
        struct orl_queue_entry *first = client->first;
        if (first && (!best || first->priority > best->priority ||
                      (first->priority == best->priority && goes_first(first, best))))
            best = first;
    }
    return best;
}

struct orl_queue_entry *orl_queue_pop(struct orl_queue *queue)
{
    struct orl_queue_entry *best = orl_queue_first(queue);
    if (!best)
        return NULL;
    best->client->turn = ++queue->turns;
    orl_queue_remove(queue, best);
    return best;
}

/* Returns the client's first entry of that priority, or NULL; *ret_above counts its entries of
 * higher priority. */
static const struct orl_queue_entry *first_of(const struct orl_queue_client *client, int priority,
                                              size_t *ret_above)
{
    const struct orl_queue_entry *entry = client->first;
    for (; entry && entry->priority > priority; entry = entry->next)
        ++*ret_above;
    return entry && entry->priority == priority ? entry : NULL;
}

/*
 * Counts the entries that go first. These are all entries of a higher priority. Of the same
 * priority they are k of the entry's own client, and of each other client its turns until then: k,
 * or k + 1 if that client is ahead in the round. Turns that jobs of higher priority will take by
 * then are ignored, as are future jobs.
 */
size_t orl_queue_position(const struct orl_queue *queue, const struct orl_queue_entry *entry)
{
    size_t before = 0, own = 0;
    if (!entry->client)
        return 0;
    const struct orl_queue_entry *mine = first_of(entry->client, entry->priority, &before);
    for (const struct orl_queue_entry *at = mine; at != entry; at = at->next)
        own++;
    for (const struct orl_queue_client *client = queue->clients; client; client = client->next) {
        if (client == entry->client)
            continue;
        const struct orl_queue_entry *at = first_of(client, entry->priority, &before);
        size_t turns = at && goes_first(at, mine) ? own + 1 : own;
        for (; at && at->priority == entry->priority && turns > 0; at = at->next, turns--)
            before++;
    }
    return before + own + 1;
}
