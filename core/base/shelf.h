/* Taking from a shelf and putting there (oriel/shelf.h). */
#ifndef ORL_BASE_SHELF_H
#define ORL_BASE_SHELF_H

#include <oriel/shelf.h>

enum { ORL_SHELF_KEY = 256 }; /* room for a key */

/* What lies under that key, now the caller's; NULL when there is nothing, or no shelf. */
void *orl_shelf_take(struct orl_shelf *shelf, const char *key);

/*
 * Takes the thing, to be let go by that function. What lay under the key is let go, and so is the
 * thing itself when it is larger than the shelf, or there is none.
 */
void orl_shelf_put(struct orl_shelf *shelf, const char *key, void *thing, uint64_t bytes,
                   void (*let_go)(void *thing));

/* How a thing is shared: held by whoever uses it, the shelf among them. */
struct orl_shelf_sharing {
    void *(*hold)(void *thing); /* called with the shelf locked: to count one more, no more */
    void (*let_go)(void *thing);
};

/* What lies under that key and stays there, held for the caller; or NULL. */
void *orl_shelf_share(struct orl_shelf *shelf, const char *key,
                      const struct orl_shelf_sharing *sharing);

/*
 * Puts a thing there to be shared, which the caller holds and goes on holding. Where another has
 * been put under that key meanwhile the caller's is let go, and that one held and returned.
 */
void *orl_shelf_put_shared(struct orl_shelf *shelf, const char *key, void *thing, uint64_t bytes,
                           const struct orl_shelf_sharing *sharing);

#endif
