#include "base/shelf.h"

#include <pthread.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

struct item {
    struct item *next; /* next older item */
    char key[ORL_SHELF_KEY];
    void *thing;
    uint64_t bytes;
    bool shared;
    void (*let_go)(void *thing);
};

struct orl_shelf {
    pthread_mutex_t mutex;
    struct item *latest;
    struct orl_shelf_totals totals;
    uint64_t most; /* bytes */
};

struct orl_shelf *orl_shelf_new(uint64_t most_bytes)
{
    struct orl_shelf *shelf = calloc(1, sizeof *shelf);
    if (!shelf)
        return NULL;
    pthread_mutex_init(&shelf->mutex, NULL);
    shelf->most = most_bytes;
    return shelf;
}

/* Frees a list of items and their contents. */
static void free_items(struct item *items)
{
    while (items) {
        struct item *next = items->next;
        items->let_go(items->thing);
        free(items);
        items = next;
    }
}

void orl_shelf_free(struct orl_shelf *shelf)
{
    if (!shelf)
        return;
    free_items(shelf->latest);
    pthread_mutex_destroy(&shelf->mutex);
    free(shelf);
}

struct orl_shelf_totals orl_shelf_totals(struct orl_shelf *shelf)
{
    struct orl_shelf_totals totals = {0};
    if (!shelf)
        return totals;
    pthread_mutex_lock(&shelf->mutex);
    totals = shelf->totals;
    pthread_mutex_unlock(&shelf->mutex);
    return totals;
}

/* Removes the item under that key from the list; the mutex is held. */
static struct item *unlink_item(struct orl_shelf *shelf, const char *key)
{
    for (struct item **at = &shelf->latest; *at; at = &(*at)->next) {
        struct item *item = *at;
        if (strcmp(item->key, key) != 0)
            continue;
        *at = item->next;
        item->next = NULL;
        shelf->totals.bytes -= item->bytes;
        shelf->totals.things--;
        shelf->totals.shared -= item->shared;
        return item;
    }
    return NULL;
}

/* Removes the oldest items beyond the capacity from the list, and returns them; the mutex is
 * held. */
static struct item *unlink_oldest(struct orl_shelf *shelf)
{
    uint64_t bytes = 0, things = 0, shared = 0;
    struct item **at = &shelf->latest;
    while (*at && bytes + (*at)->bytes <= shelf->most) {
        bytes += (*at)->bytes;
        things++;
        shared += (*at)->shared;
        at = &(*at)->next;
    }
    struct item *rest = *at;
    *at = NULL;
    shelf->totals.bytes = bytes;
    shelf->totals.things = things;
    shelf->totals.shared = shared;
    return rest;
}

void *orl_shelf_take(struct orl_shelf *shelf, const char *key)
{
    if (!shelf)
        return NULL;
    pthread_mutex_lock(&shelf->mutex);
    struct item *item = unlink_item(shelf, key);
    shelf->totals.hits += item != NULL;
    pthread_mutex_unlock(&shelf->mutex);
    void *thing = item ? item->thing : NULL;
    free(item);
    return thing;
}

/* Creates an item. NULL: it is too large, or there is no shelf or no memory. */
static struct item *item_for(const struct orl_shelf *shelf, const char *key, void *thing,
                             uint64_t bytes, void (*let_go)(void *thing))
{
    struct item *item =
        shelf && bytes <= shelf->most && strlen(key) < ORL_SHELF_KEY ? malloc(sizeof *item) : NULL;
    if (!item)
        return NULL;
    *item = (struct item){.thing = thing, .bytes = bytes, .let_go = let_go};
    memcpy(item->key, key, strlen(key) + 1);
    return item;
}

static void link_item(struct orl_shelf *shelf, struct item *item)
{
    item->next = shelf->latest;
    shelf->latest = item;
}

void orl_shelf_put(struct orl_shelf *shelf, const char *key, void *thing, uint64_t bytes,
                   void (*let_go)(void *thing))
{
    struct item *item = item_for(shelf, key, thing, bytes, let_go);
    if (!item) {
        let_go(thing);
        return;
    }
    pthread_mutex_lock(&shelf->mutex);
    struct item *same = unlink_item(shelf, key);
    link_item(shelf, item);
    struct item *rest = unlink_oldest(shelf);
    pthread_mutex_unlock(&shelf->mutex);
    free_items(same);
    free_items(rest);
}

/* Adds a reference for the caller and moves the item to the front; the mutex is held. */
static void *reference_item(struct orl_shelf *shelf, const char *key,
                            const struct orl_shelf_sharing *sharing)
{
    struct item *item = unlink_item(shelf, key);
    if (!item)
        return NULL;
    link_item(shelf, item);
    shelf->totals.bytes += item->bytes;
    shelf->totals.things++;
    shelf->totals.shared++;
    return sharing->hold(item->thing);
}

void *orl_shelf_share(struct orl_shelf *shelf, const char *key,
                      const struct orl_shelf_sharing *sharing)
{
    if (!shelf)
        return NULL;
    pthread_mutex_lock(&shelf->mutex);
    void *thing = reference_item(shelf, key, sharing);
    shelf->totals.hits += thing != NULL;
    shelf->totals.shared_hits += thing != NULL;
    pthread_mutex_unlock(&shelf->mutex);
    return thing;
}

void *orl_shelf_put_shared(struct orl_shelf *shelf, const char *key, void *thing, uint64_t bytes,
                           const struct orl_shelf_sharing *sharing)
{
    struct item *item = item_for(shelf, key, thing, bytes, sharing->let_go), *rest = NULL;
    if (!item)
        return thing;
    item->shared = true;
    pthread_mutex_lock(&shelf->mutex);
    void *same = reference_item(shelf, key, sharing);
    if (!same) {
        sharing->hold(thing);
        link_item(shelf, item);
        rest = unlink_oldest(shelf);
    }
    pthread_mutex_unlock(&shelf->mutex);
    free_items(rest);
    if (!same)
        return thing;
    free(item);
    sharing->let_go(thing);
    return same;
}
