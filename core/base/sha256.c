#include "base/sha256.h"

#include <string.h>

enum { BLOCK = 64 };

static const uint32_t first_state[8] = {0x6a09e667, 0xbb67ae85, 0x3c6ef372, 0xa54ff53a,
                                        0x510e527f, 0x9b05688c, 0x1f83d9ab, 0x5be0cd19};

#if defined(__x86_64__)

#include <cpuid.h>
#include <immintrin.h>

enum { GROUPS = 16 /* of four rounds */ };

static const uint32_t constants[4 * GROUPS] = {
    0x428a2f98, 0x71374491, 0xb5c0fbcf, 0xe9b5dba5, 0x3956c25b, 0x59f111f1, 0x923f82a4, 0xab1c5ed5,
    0xd807aa98, 0x12835b01, 0x243185be, 0x550c7dc3, 0x72be5d74, 0x80deb1fe, 0x9bdc06a7, 0xc19bf174,
    0xe49b69c1, 0xefbe4786, 0x0fc19dc6, 0x240ca1cc, 0x2de92c6f, 0x4a7484aa, 0x5cb0a9dc, 0x76f988da,
    0x983e5152, 0xa831c66d, 0xb00327c8, 0xbf597fc7, 0xc6e00bf3, 0xd5a79147, 0x06ca6351, 0x14292967,
    0x27b70a85, 0x2e1b2138, 0x4d2c6dfc, 0x53380d13, 0x650a7354, 0x766a0abb, 0x81c2c92e, 0x92722c85,
    0xa2bfe8a1, 0xa81a664b, 0xc24b8b70, 0xc76c51a3, 0xd192e819, 0xd6990624, 0xf40e3585, 0x106aa070,
    0x19a4c116, 0x1e376c08, 0x2748774c, 0x34b0bcb5, 0x391c0cb3, 0x4ed8aa4a, 0x5b9cca4f, 0x682e6ff3,
    0x748f82ee, 0x78a5636f, 0x84c87814, 0x8cc70208, 0x90befffa, 0xa4506ceb, 0xbef9a3f7, 0xc67178f2};

static bool has_instructions(void)
{
    unsigned a, b, c, d;
    if (!__get_cpuid(1, &a, &b, &c, &d) || !(c & bit_SSSE3) || !(c & bit_SSE4_1))
        return false;
    return __get_cpuid_count(7, 0, &a, &b, &c, &d) && (b & bit_SHA);
}

/* The instructions want the state as (a, b, e, f) and (c, d, g, h), the first ones on top. */
__attribute__((target("sha,sse4.1"))) static void
add_blocks(uint32_t state[8], const unsigned char *data, size_t blocks)
{
    const __m128i swap = _mm_set_epi64x(0x0c0d0e0f08090a0bLL, 0x0405060700010203LL);
    const __m128i cdab = _mm_shuffle_epi32(_mm_loadu_si128((const void *)state), 0xb1);
    const __m128i efgh = _mm_shuffle_epi32(_mm_loadu_si128((const void *)(state + 4)), 0x1b);
    __m128i abef = _mm_alignr_epi8(cdab, efgh, 8), cdgh = _mm_blend_epi16(efgh, cdab, 0xf0);
    for (; blocks > 0; blocks--, data += BLOCK) {
        const __m128i before[2] = {abef, cdgh};
        __m128i w[4];
        for (size_t i = 0; i < 4; i++)
            w[i] = _mm_shuffle_epi8(_mm_loadu_si128((const void *)(data + 16 * i)), swap);
#pragma GCC unroll 16
        for (size_t i = 0; i < GROUPS; i++) {
            const __m128i last = w[(i + 3) & 3];
            const __m128i k =
                _mm_add_epi32(w[i & 3], _mm_loadu_si128((const void *)(constants + 4 * i)));
            cdgh = _mm_sha256rnds2_epu32(cdgh, abef, k);
            abef = _mm_sha256rnds2_epu32(abef, cdgh, _mm_shuffle_epi32(k, 0x0e));
            w[i & 3] =
                _mm_sha256msg2_epu32(_mm_add_epi32(_mm_sha256msg1_epu32(w[i & 3], w[(i + 1) & 3]),
                                                   _mm_alignr_epi8(last, w[(i + 2) & 3], 4)),
                                     last);
        }
        abef = _mm_add_epi32(abef, before[0]);
        cdgh = _mm_add_epi32(cdgh, before[1]);
    }
    const __m128i feba = _mm_shuffle_epi32(abef, 0x1b), dchg = _mm_shuffle_epi32(cdgh, 0xb1);
    _mm_storeu_si128((void *)state, _mm_blend_epi16(feba, dchg, 0xf0));
    _mm_storeu_si128((void *)(state + 4), _mm_alignr_epi8(dchg, feba, 8));
}

#else

static bool has_instructions(void)
{
    return false;
}

static void add_blocks(uint32_t state[8], const unsigned char *data, size_t blocks)
{
    (void)state, (void)data, (void)blocks;
}

#endif

void orl_sha256_init(struct orl_sha256 *hash)
{
    hash->quick = has_instructions();
    hash->size = 0;
    memcpy(hash->state, first_state, sizeof hash->state);
    if (!hash->quick)
        crypto_hash_sha256_init(&hash->portable);
}

/* The end of the data, a set bit, zeros, and the length in bits. */
static void add_last(struct orl_sha256 *hash, const unsigned char *rest, size_t left)
{
    const size_t blocks = left < BLOCK - 8 ? 1 : 2;
    unsigned char last[2 * BLOCK] = {0};
    if (left > 0)
        memcpy(last, rest, left);
    last[left] = 0x80;
    for (unsigned i = 0; i < 8; i++)
        last[blocks * BLOCK - 1 - i] = (unsigned char)(hash->size * 8 >> 8 * i);
    add_blocks(hash->state, last, blocks);
}

void orl_sha256_add(struct orl_sha256 *hash, const void *data, size_t size)
{
    const size_t whole = size / BLOCK * BLOCK;
    hash->size += size;
    if (!hash->quick) {
        crypto_hash_sha256_update(&hash->portable, data, size);
        return;
    }
    add_blocks(hash->state, data, size / BLOCK);
    if (size > whole) /* the last piece */
        add_last(hash, (const unsigned char *)data + whole, size - whole);
}

void orl_sha256_finish(struct orl_sha256 *hash, unsigned char ret_digest[ORL_SHA256_BYTES])
{
    if (!hash->quick) {
        crypto_hash_sha256_final(&hash->portable, ret_digest);
        return;
    }
    if (hash->size % BLOCK == 0)
        add_last(hash, NULL, 0);
    for (unsigned i = 0; i < ORL_SHA256_BYTES; i++)
        ret_digest[i] = (unsigned char)(hash->state[i / 4] >> (24 - 8 * (i % 4)));
}

void orl_sha256(const void *data, size_t size, unsigned char ret_digest[ORL_SHA256_BYTES])
{
    struct orl_sha256 hash;
    orl_sha256_init(&hash);
    orl_sha256_add(&hash, data, size);
    orl_sha256_finish(&hash, ret_digest);
}
