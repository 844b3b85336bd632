/*
 * SHA-256 of large files: libsodium's, or where the processor has instructions for it those, which
 * take a fifth of the time. FIPS 180-4. Any thread; call sodium_init before.
 */
#ifndef ORL_BASE_SHA256_H
#define ORL_BASE_SHA256_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <sodium/crypto_hash_sha256.h>

enum { ORL_SHA256_BYTES = 32 };

struct orl_sha256 {
    bool quick; /* state and size are used, else portable */
    uint32_t state[8];
    uint64_t size;
    crypto_hash_sha256_state portable;
};

/* In pieces: all but the last are of a multiple of 64 bytes. */
void orl_sha256_init(struct orl_sha256 *hash);
void orl_sha256_add(struct orl_sha256 *hash, const void *data, size_t size);
void orl_sha256_finish(struct orl_sha256 *hash, unsigned char ret_digest[ORL_SHA256_BYTES]);

/* The whole at once. */
void orl_sha256(const void *data, size_t size, unsigned char ret_digest[ORL_SHA256_BYTES]);

#endif
