/*
 * Quotas for bytes in flight: the disk space of request bodies, and of files unpacked from them,
 * before they are stored. They count against the storage budget (storage.h), and no client may use
 * all of it (clients.h).
 *
 * A quota is a limit and the bytes reserved below it. A reservation is one request's share of two
 * quotas; it grows until the request ends.
 *
 * Threads: a quota's any; a reservation's one at a time.
 */
#ifndef ORL_SERVER_HTTP_QUOTA_QUOTA_H
#define ORL_SERVER_HTTP_QUOTA_QUOTA_H

#include <stdatomic.h>
#include <stdint.h>

#include <oriel/base/error.h>

struct orl_quota {
    atomic_uint_least64_t reserved, most;
};

enum orl_quota_refusal { ORL_QUOTA_FITS, ORL_QUOTA_FULL, ORL_QUOTA_CLIENT_FULL };

struct orl_reservation {
    struct orl_quota *all, *own; /* all clients' and this client's; NULL: no bound */
    uint64_t bytes;
    enum orl_quota_refusal refused; /* why the last orl_reservation_grow failed */
};

/* Reserves bytes more. ORL_ERR_FULL, with hold->refused set, if they do not fit. With NULL every
 * reservation succeeds. */
int orl_reservation_grow(struct orl_reservation *reservation, uint64_t bytes,
                         struct orl_error *err);
/* Releases the whole reservation. */
void orl_reservation_release(struct orl_reservation *reservation);

#endif
