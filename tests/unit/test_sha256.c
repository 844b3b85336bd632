/* Nettle's SHA-256 against libsodium's, whole and in pieces. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <sodium.h>

#include <oriel/base/sha256.h>

#include "base/sampling/sampling.h"

static void every_length_agrees(void **state)
{
    enum { MOST = 700 };
    unsigned char data[MOST + 1], ours[ORL_SHA256_BYTES], theirs[ORL_SHA256_BYTES];
    struct orl_random random = orl_random_stream(1, ORL_PURPOSE_BENCH, 0);
    (void)state;
    assert_true(sodium_init() >= 0);
    for (size_t i = 0; i <= MOST; i++)
        data[i] = (unsigned char)orl_random_bits(&random);
    for (size_t size = 0; size <= MOST; size++) {
        orl_sha256(data + 1, size, ours); /* not aligned */
        crypto_hash_sha256(theirs, data + 1, size);
        assert_memory_equal(ours, theirs, sizeof ours);
        struct orl_sha256 hash;
        orl_sha256_init(&hash);
        for (size_t at = 0; at < size; at += 100)
            orl_sha256_add(&hash, data + 1 + at, size - at < 100 ? size - at : 100);
        orl_sha256_finish(&hash, ours);
        assert_memory_equal(ours, theirs, sizeof ours);
    }
}

/* The example of FIPS 180-4. */
static void abc_is_as_published(void **state)
{
    static const unsigned char wanted[4] = {0xba, 0x78, 0x16, 0xbf};
    unsigned char digest[ORL_SHA256_BYTES];
    (void)state;
    orl_sha256("abc", 3, digest);
    assert_memory_equal(digest, wanted, sizeof wanted);
}

int main(void)
{
    static const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_length_agrees),
        cmocka_unit_test(abc_is_as_published),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
