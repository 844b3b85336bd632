/*
 * Checksum of 128 bits, as fast as reading (XXH3 of xxHash, inlined). It detects files that were
 * damaged, truncated or exchanged, but not forged ones. It is the same on every machine.
 */
#ifndef ORL_BASE_IO_CHECKSUM_H
#define ORL_BASE_IO_CHECKSUM_H

#include <stddef.h>
#include <string.h>

#define XXH_INLINE_ALL
#include <xxhash.h>

enum { ORL_CHECKSUM_BYTES = 16 };

struct orl_checksum {
    XXH3_state_t state;
};

static inline void orl_checksum_init(struct orl_checksum *sum)
{
    XXH3_128bits_reset(&sum->state);
}

static inline void orl_checksum_add(struct orl_checksum *sum, const void *data, size_t size)
{
    XXH3_128bits_update(&sum->state, data, size);
}

/* Returns the checksum in xxHash's canonical byte order. */
static inline void orl_checksum_finish(const struct orl_checksum *sum,
                                       unsigned char ret[ORL_CHECKSUM_BYTES])
{
    XXH128_canonical_t canonical;
    XXH128_canonicalFromHash(&canonical, XXH3_128bits_digest(&sum->state));
    memcpy(ret, canonical.digest, ORL_CHECKSUM_BYTES);
}

/* Returns the checksum of one buffer. */
static inline void orl_checksum_of(const void *data, size_t size,
                                   unsigned char ret[ORL_CHECKSUM_BYTES])
{
    XXH128_canonical_t canonical;
    XXH128_canonicalFromHash(&canonical, XXH3_128bits(data, size));
    memcpy(ret, canonical.digest, ORL_CHECKSUM_BYTES);
}

#endif
