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

#endif
