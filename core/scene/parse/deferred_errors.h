/*
 * Modifiers whose definition was refused; the error is reported when something uses them. Libraries
 * define a thousand materials and scenes use ten: one that is not supported, or whose numbers are
 * out of range, is harmless if no surface uses it.
 */
#ifndef ORL_SCENE_PARSE_DEFERRED_ERRORS_H
#define ORL_SCENE_PARSE_DEFERRED_ERRORS_H

#include <oriel/base/error.h>

#include "base/memory/arena.h"
#include "scene/parse/refusals.h"

struct orl_deferred_error {
    const char *file, *primitive, *message, *hint; /* in the arena */
    int code, line;
    bool used;
};

struct orl_deferred_errors {
    struct orl_deferred_error *items;
    size_t count, room;
};

/* Returns true if an error in a modifier's definition can be deferred. */
static inline bool orl_is_deferrable(int code)
{
    return code == ORL_ERR_UNSUPPORTED || code == ORL_ERR_RANGE || code == ORL_ERR_NOT_FOUND;
}

/* Stores the error. Returns 0 or ORL_ERR_NOMEM. */
int orl_deferred_add(struct orl_deferred_errors *deferred, const struct orl_error *err,
                     struct orl_arena *arena, uint32_t *ret_index);

/*
 * Records a use. Unsupported modifiers are added to the refusals, once, and 0 is returned; for
 * other errors it returns their code and fills err.
 */
int orl_deferred_use(struct orl_deferred_errors *deferred, uint32_t index,
                     struct orl_refusals *refusals, struct orl_error *err);

/* Returns the first unused one, or NULL; *ret_count: number of unused ones. */
const struct orl_deferred_error *orl_deferred_unused(const struct orl_deferred_errors *deferred,
                                                     size_t *ret_count);

void orl_deferred_done(struct orl_deferred_errors *deferred);

#endif
