/* Access to the in-memory cache (oriel/shelf.h). */
#ifndef ORL_BASE_SHELF_H
#define ORL_BASE_SHELF_H

#include <oriel/shelf.h>

enum { ORL_SHELF_KEY = 256 }; /* size of a key's buffer */

/* Removes the entry under that key and passes it to the caller; NULL if there is none, or no
 * shelf. */
void *orl_shelf_take(struct orl_shelf *shelf, const char *key);

/*
 * Stores the thing and takes ownership; let_go destroys it. An existing entry of that key is
 * destroyed. The thing itself is destroyed if it exceeds the shelf's capacity, or there is no
 * shelf.
 */
void orl_shelf_put(struct orl_shelf *shelf, const char *key, void *thing, uint64_t bytes,
                   void (*let_go)(void *thing));

/* Reference counting of a shared thing; every user and the shelf hold a reference. */
struct orl_shelf_sharing {
    void *(*hold)(void *thing); /* adds a reference; called with the shelf locked, so it must do
                                   nothing else */
    void (*let_go)(void *thing);
};

/* Returns a reference to the entry under that key, which stays on the shelf; or NULL. */
void *orl_shelf_share(struct orl_shelf *shelf, const char *key,
                      const struct orl_shelf_sharing *sharing);

/*
 * Stores a shared thing; the caller keeps its reference. If the key has an entry by now, the
 * caller's reference is dropped, and a reference to that entry is returned.
 */
void *orl_shelf_put_shared(struct orl_shelf *shelf, const char *key, void *thing, uint64_t bytes,
                           const struct orl_shelf_sharing *sharing);

#endif
