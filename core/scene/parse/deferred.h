/*
 * Modifiers that are refused, until something uses them. Libraries define a thousand materials and
 * scenes use ten: one that is not simulated, or whose numbers are out of range, spoils nothing as
 * long as no surface is of it.
 */
#ifndef ORL_SCENE_PARSE_DEFERRED_H
#define ORL_SCENE_PARSE_DEFERRED_H

#include <oriel/error.h>

#include "base/arena.h"
#include "scene/parse/refusals.h"

struct orl_deferred_item {
    const char *file, *primitive, *message, *hint; /* in the arena */
    int code, line;
    bool used;
};

struct orl_deferred {
    struct orl_deferred_item *items;
    size_t count, room;
};

/* Whether an error in a modifier's definition can wait. */
static inline bool orl_is_deferrable(int code)
{
    return code == ORL_ERR_UNSUPPORTED || code == ORL_ERR_RANGE || code == ORL_ERR_NOT_FOUND;
}

/* Keeps what err says. Returns 0 or ORL_ERR_NOMEM. */
int orl_deferred_add(struct orl_deferred *deferred, const struct orl_error *err,
                     struct orl_arena *arena, uint32_t *ret_index);

/*
 * Something uses it. What is not simulated goes among the refusals, once, and 0 is returned; for
 * anything else its own code, and err says it.
 */
int orl_deferred_use(struct orl_deferred *deferred, uint32_t index, struct orl_refusals *refusals,
                     struct orl_error *err);

/* The first that nothing used, or NULL; ret_count: how many there are. */
const struct orl_deferred_item *orl_deferred_unused(const struct orl_deferred *deferred,
                                                    size_t *ret_count);

void orl_deferred_done(struct orl_deferred *deferred);

#endif
