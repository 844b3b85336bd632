/*
 * SHA-256 of a whole file: libsodium's, or where the processor has instructions for it those, which
 * take a fifth of the time. FIPS 180-4. Any thread; call sodium_init before.
 */
#ifndef ORL_BASE_SHA256_H
#define ORL_BASE_SHA256_H

#include <stddef.h>

enum { ORL_SHA256_BYTES = 32 };

void orl_sha256(const void *data, size_t size, unsigned char ret_digest[ORL_SHA256_BYTES]);

#endif
