#include "http/quota/quota.h"

#include <stdbool.h>
#include <stddef.h>

static bool reserve_bytes(struct orl_quota *quota, uint64_t bytes)
{
    if (!quota)
        return true;
    const uint64_t before = atomic_fetch_add(&quota->reserved, bytes);
    const uint64_t most = atomic_load(&quota->most);
    if (before <= most && bytes <= most - before)
        return true;
    atomic_fetch_sub(&quota->reserved, bytes);
    return false;
}

static void release_bytes(struct orl_quota *quota, uint64_t bytes)
{
    if (quota)
        atomic_fetch_sub(&quota->reserved, bytes);
}

int orl_reservation_grow(struct orl_reservation *reservation, uint64_t bytes, struct orl_error *err)
{
    if (!reservation)
        return 0;
    reservation->refused = ORL_QUOTA_FITS;
    if (!reserve_bytes(reservation->all, bytes)) {
        reservation->refused = ORL_QUOTA_FULL;
    } else if (!reserve_bytes(reservation->own, bytes)) {
        release_bytes(reservation->all, bytes);
        reservation->refused = ORL_QUOTA_CLIENT_FULL;
    }
    if (reservation->refused != ORL_QUOTA_FITS)
        return orl_error_set(err, ORL_ERR_FULL, "there is not enough space for the upload");
    reservation->bytes += bytes;
    return 0;
}

void orl_reservation_release(struct orl_reservation *reservation)
{
    release_bytes(reservation->all, reservation->bytes);
    release_bytes(reservation->own, reservation->bytes);
    reservation->bytes = 0;
}
