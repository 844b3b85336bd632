#include "http/hold.h"

#include <stdbool.h>
#include <stddef.h>

static bool reserve_bytes(struct orl_room *room, uint64_t bytes)
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

static void release_bytes(struct orl_room *room, uint64_t bytes)
{
    if (room)
        atomic_fetch_sub(&room->held, bytes);
}

int orl_hold_take(struct orl_hold *hold, uint64_t bytes, struct orl_error *err)
{
    if (!hold)
        return 0;
    hold->refused = ORL_HOLD_FITS;
    if (!reserve_bytes(hold->all, bytes)) {
        hold->refused = ORL_HOLD_NO_ROOM;
    } else if (!reserve_bytes(hold->own, bytes)) {
        release_bytes(hold->all, bytes);
        hold->refused = ORL_HOLD_OWN_SHARE;
    }
    if (hold->refused != ORL_HOLD_FITS)
        return orl_error_set(err, ORL_ERR_FULL, "there is no room for what is on its way here");
    hold->bytes += bytes;
    return 0;
}

void orl_hold_give_back(struct orl_hold *hold)
{
    release_bytes(hold->all, hold->bytes);
    release_bytes(hold->own, hold->bytes);
    hold->bytes = 0;
}
