#include "http/hold.h"

#include <stdbool.h>
#include <stddef.h>

static bool take(struct orl_room *room, uint64_t bytes)
{
    if (!room)
        return true;
    const uint64_t before = atomic_fetch_add(&room->held, bytes);
    const uint64_t most = atomic_load(&room->most);
    if (before <= most && bytes <= most - before)
        return true;
    atomic_fetch_sub(&room->held, bytes);
    return false;
}

static void give_back(struct orl_room *room, uint64_t bytes)
{
    if (room)
        atomic_fetch_sub(&room->held, bytes);
}

int orl_hold_take(struct orl_hold *hold, uint64_t bytes, struct orl_error *err)
{
    if (!hold)
        return 0;
    hold->refused = ORL_HOLD_FITS;
    if (!take(hold->all, bytes)) {
        hold->refused = ORL_HOLD_NO_ROOM;
    } else if (!take(hold->own, bytes)) {
        give_back(hold->all, bytes);
        hold->refused = ORL_HOLD_OWN_SHARE;
    }
    if (hold->refused != ORL_HOLD_FITS)
        return orl_error_set(err, ORL_ERR_FULL, "there is no room for what is on its way here");
    hold->bytes += bytes;
    return 0;
}

void orl_hold_give_back(struct orl_hold *hold)
{
    give_back(hold->all, hold->bytes);
    give_back(hold->own, hold->bytes);
    hold->bytes = 0;
}
